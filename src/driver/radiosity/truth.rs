//! What a codec is measured by: probe lights, and the light of all their bounces.

use super::{BakeError, Rooms, Transport};
use etendue_core::backend::Session;
use etendue_core::radiosity::form_factors::FormFactors;
use etendue_core::radiosity::patches::PatchMap;
use etendue_core::radiosity::relight::{RelightError, Relighter, Symmetric, Workspace, weights};
use etendue_core::radiosity::tiles::{Kind, Rates};

/// A patch that sees less than this of others lights nothing.
const SEES: f64 = 0.05;
/// When irradiance stands: passes at most, and relative change of one.
const STANDS: (u32, f64) = (200, 2e-7);

/// Error of irradiance against the exact solution, area-weighted, over probe lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CodecError {
    /// Root mean square over the lights.
    pub rms: f64,
    /// The worst light's.
    pub worst: f64,
    /// Greatest relative error of the total flux.
    pub energy: f64,
}

/// What probe lights are for: those that weights of passes are found by are not those that the error is measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeLights {
    /// Measuring.
    Measure,
    /// Finding weights.
    Fit,
}

/// Lights that a codec is judged by: direct irradiance on all patches, eight of them, or fourteen to find weights by. Single lit patches are the hardest; lamps near a wall, suns and an even light follow.
pub fn probe_lights(map: &PatchMap, row_sums: &[f64], purpose: ProbeLights) -> Vec<Light> {
    let n = map.patches.len();
    match purpose {
        // One even light there is: it measures.
        ProbeLights::Measure => {
            let mut lights = lights_from(map, row_sums, n / 14, [[0.48, 0.80, 0.36], [-0.6, 0.64, 0.48]]);
            lights.push(vec![COLOUR; n]);
            lights
        }
        ProbeLights::Fit => [
            (n / 35, [[0.0, 0.8, 0.6], [-0.36, 0.48, -0.8]]),
            (4 * n / 35, [[0.8, 0.6, 0.0], [0.28, 0.96, 0.0]]),
        ]
        .into_iter()
        .flat_map(|(offset, suns)| lights_from(map, row_sums, offset, suns))
        .collect(),
    }
}

/// What all probe lights have.
const COLOUR: [f32; 3] = [1.0, 0.8, 0.6];

/// Two lit patches, three lamps near patches and two suns; the patches are sevenths of all apart, from an offset on.
fn lights_from(map: &PatchMap, row_sums: &[f64], offset: usize, suns: [[f32; 3]; 2]) -> Vec<Light> {
    let list = map.patches.list();
    let n = list.len();
    let mut lights = Vec::new();
    // From there on the first patch that sees something.
    let at = |k: usize| {
        let first = (k * n / 7 + offset).min(n.saturating_sub(1));
        (first..n).chain(0..first).find(|i| row_sums.get(*i).is_some_and(|s| *s > SEES)).unwrap_or(first)
    };
    for k in [1, 4] {
        let mut one = vec![[0.0; 3]; n];
        one[at(k)] = COLOUR;
        lights.push(one);
    }
    let extent = (0..3)
        .map(|k| {
            let (lo, hi) = list
                .iter()
                .fold((f32::MAX, f32::MIN), |(lo, hi), p| (lo.min(p.position[k]), hi.max(p.position[k])));
            hi - lo
        })
        .fold(0.0, f32::max);
    // Lamps a twentieth of the scene before a patch: they light what faces them, with nothing in the way.
    for k in [0, 2, 5] {
        let p = &list[at(k)];
        let lamp = [0, 1, 2].map(|c| p.position[c] + 0.05 * extent * p.normal[c]);
        lights.push(
            list.iter()
                .map(|q| {
                    let d = [0, 1, 2].map(|c| lamp[c] - q.position[c]);
                    let squared: f32 = d.iter().map(|x| x * x).sum();
                    let cosine: f32 = (0..3).map(|c| d[c] * q.normal[c]).sum::<f32>()
                        / squared.sqrt().max(f32::MIN_POSITIVE);
                    COLOUR.map(|c| c * cosine.max(0.0) / squared.max(1e-4 * extent * extent))
                })
                .collect(),
        );
    }
    for sun in suns {
        lights.push(
            list.iter()
                .map(|q| COLOUR.map(|x| x * (0..3).map(|c| sun[c] * q.normal[c]).sum::<f32>().max(0.0)))
                .collect(),
        );
    }
    lights
}

/// A number per patch and channel.
pub type Light = Vec<[f32; 3]>;

/// Probe lights, and light of all their bounces from form factors as they are.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Form factors in f32, with their clusters in f32.
    pub relighter: Relighter,
    /// Direct irradiance of each light that measures.
    pub lights: Vec<Light>,
    /// Indirect irradiance of each.
    pub exact: Vec<Light>,
    /// What patches emit themselves, and its indirect irradiance: a light that measures too, the one that the scene comes with. Without emission, nothing.
    pub own: Option<[Light; 2]>,
    /// The same for lights that weights are found by.
    pub fit: [Vec<Light>; 2],
    /// Bounces that the light is of; `None`: all.
    pub bounces: Option<u32>,
}

impl Truth {
    /// By passes over f32 until nothing moves, or one for each of so many bounces.
    ///
    /// # Errors
    /// Of form factors that make no operator.
    pub fn new(
        session: &dyn Session,
        form_factors: &FormFactors,
        map: &PatchMap,
        albedo: &[[f32; 3]],
        bounces: Option<u32>,
    ) -> Result<Self, BakeError> {
        let symmetric = Symmetric::new(form_factors);
        let tiles = session.tiles(&symmetric, &|_, _| Kind::F32).map_err(RelightError::Tiles)?;
        let relighter = Relighter::of(form_factors, albedo, tiles)?;
        let relighter = match bounces {
            None => session.with_coarse(relighter, Rates::Uniform(Kind::F32))?,
            Some(_) => relighter,
        };
        let mut room = Workspace::default();
        let mut solve = |light: (&[[f32; 3]], &[[f32; 3]])| -> Result<Light, BakeError> {
            let mut indirect = vec![[0.0; 3]; light.0.len()];
            match bounces {
                None => {
                    session.converge(&relighter, light, &mut indirect, STANDS, &mut room)?;
                }
                Some(k) => session.relight(&relighter, light, &mut indirect, k, &mut room)?,
            }
            Ok(indirect)
        };
        let row_sums = form_factors.row_sums();
        let [lights, fit] = [ProbeLights::Measure, ProbeLights::Fit].map(|p| probe_lights(map, &row_sums, p));
        let [exact, fitted] =
            [&lights, &fit].map(|list| list.iter().map(|l| solve((l, &[]))).collect::<Result<Vec<_>, _>>());
        let (exact, fitted) = (exact?, fitted?);
        let emission: Light = map.patches.list().iter().map(|p| p.emission).collect();
        let own = if emission.iter().any(|e| *e != [0.0; 3]) {
            let indirect = solve((&vec![[0.0; 3]; emission.len()], &emission))?;
            Some([emission, indirect])
        } else {
            None
        };
        Ok(Self { relighter, lights, exact, own, fit: [fit, fitted], bounces })
    }

    /// Weights for so many passes.
    ///
    /// # Errors
    /// Of numbers that do not fit.
    pub fn weights(&self, session: &dyn Session, passes: u32) -> Result<Vec<f32>, BakeError> {
        let mut room = Workspace::default();
        let plain = self.relighter.clone().with_weights(Vec::new())?;
        weights::fit(plain.areas(), &self.fit[0], &self.fit[1], passes, |light, passes, found| {
            Ok(session.relight(&plain, (light, &[]), found, passes, &mut room)?)
        })
    }

    /// Error of a transport over the lights that measure.
    ///
    /// # Errors
    /// Of numbers that do not fit.
    pub fn measure(
        &self,
        session: &dyn Session,
        transport: &Transport,
        passes: u32,
    ) -> Result<CodecError, BakeError> {
        let mut rooms = Rooms::default();
        let mut found = vec![[0.0; 3]; self.relighter.len()];
        let mut judge = Judge::default();
        for (direct, truth) in self.lights.iter().zip(&self.exact) {
            transport.relight(session, (direct, &[]), &mut found, passes, &mut rooms)?;
            judge.add(self.relighter.areas(), &found, truth);
        }
        if let Some([emission, truth]) = &self.own {
            let dark = vec![[0.0; 3]; emission.len()];
            transport.relight(session, (&dark, emission), &mut found, passes, &mut rooms)?;
            judge.add(self.relighter.areas(), &found, truth);
        }
        Ok(judge.error())
    }
}

/// Collects errors of lights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Judge {
    error: CodecError,
    squares: f64,
    lights: f64,
}

impl Judge {
    /// One light's irradiance, and the truth. A light of which nothing comes back is left out.
    pub fn add(&mut self, areas: &[f32], found: &[[f32; 3]], truth: &[[f32; 3]]) {
        let (mut d, mut s, mut a, mut b) = (0.0, 0.0, 0.0, 0.0);
        for ((x, t), area) in found.iter().zip(truth).zip(areas) {
            for c in 0..3 {
                let (x, t, area) = (f64::from(x[c]), f64::from(t[c]), f64::from(*area));
                d += area * (x - t) * (x - t);
                s += area * t * t;
                a += area * x;
                b += area * t;
            }
        }
        if s > 0.0 && b > 0.0 {
            self.squares += d / s;
            self.lights += 1.0;
            self.error.worst = self.error.worst.max((d / s).sqrt());
            self.error.energy = self.error.energy.max((a / b - 1.0).abs());
        }
    }

    /// Of all of them.
    pub fn error(&self) -> CodecError {
        CodecError { rms: (self.squares / self.lights.max(1.0)).sqrt(), ..self.error }
    }
}
