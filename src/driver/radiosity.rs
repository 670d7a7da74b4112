//! Baking an operator from a scene, and light from it.

use super::{Outcome, PassControl, Settings, Watcher, drive, even, first_job};
use etendue_core::backend::{self, BackendError, FormFactorJob, GivenMap, Probe, Session};
use etendue_core::film::Film;
use etendue_core::illumination::ElementSettings;
use etendue_core::math::PI;
use etendue_core::radiosity::blocks::{self, BlockError, BlockOperator, Matrix};
use etendue_core::radiosity::form_factors::{self, Balance, FormFactors, Row, RowError};
use etendue_core::radiosity::order;
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::radiosity::relight::{RelightError, Relighter, Symmetric, Workspace, weights};
use etendue_core::radiosity::tiles::{Kind, Rates, SIDE};
use std::time::Instant;

/// Steps of balancing form factors.
const BALANCE_STEPS: u32 = 30;
/// What a bit may cost in the clusters' inverses, over what it may cost in form factors.
/// What a bit may cost in the clusters' inverses, over what it may cost in form factors: what they err by is mended by the passes.
const COARSE: f64 = 32.0;
/// Steps of the search for the cheapest tiles, and how near to the limit it may end.
const SEARCH_STEPS: u32 = 9;
const NEAR: f64 = 0.97;
/// Passes that a bake begins its search with, and the most of a scene whose light decays slowly.
pub const PASSES: u32 = 3;
const PASSES_MOST: u32 = 12;
/// Share of the allowed error, in the root mean square, that is left to passes.
const PASSES_SHARE: f64 = 0.6;
/// What passes may leave where form factors are stored as they are.
const FULL_ERROR: f64 = 0.005;
/// A patch that sees less than this of others lights nothing.
const SEES: f64 = 0.05;
/// Most plain bounces.
const BOUNCES_MOST: u32 = 200;
/// When irradiance stands: passes at most, and relative change of one.
const STANDS: (u32, f64) = (200, 2e-7);

/// How form factors are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Codec {
    /// The fewest bytes for which the error of irradiance over probe lights, in the root mean square, stays below this.
    Auto {
        /// Relative error.
        max_error: f64,
    },
    /// Eight bits an entry, nothing for tiles where all is 0.
    Tiles,
    /// f16.
    F16,
    /// f32.
    F32,
    /// As published: the sum of the powers of so many bounces, its largest entries kept, the rest as logarithms in BC1.
    Published {
        /// Bounces; `None`: all.
        bounces: Option<u32>,
        /// Share of entries kept.
        keep: f32,
        /// Order of rows and columns.
        order: Order,
    },
    /// The same with all bounces, colours outside, and each loss mended.
    Bc1 {
        /// Share of entries kept.
        keep: f32,
    },
    /// Form factors in BC4, bounced when run.
    Bc4 {
        /// Share of entries kept.
        keep: f32,
    },
}

/// Orders of the published codec.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// That of voxels.
    Voxels,
    /// By halves in six dimensions.
    Kd,
    /// Each row after the one that is most like it.
    Greedy1,
    /// Then columns the same way.
    Greedy2,
}

/// How light gets from patch to patch.
#[derive(Clone, Debug, PartialEq)]
pub enum Transport {
    /// Form factors in tiles.
    Tiles(Box<Relighter>),
    /// Texture blocks.
    Blocks(Box<BlockOperator>),
}

/// Room for relighting.
#[derive(Clone, Debug, Default)]
pub struct Rooms {
    tiles: Workspace,
    blocks: blocks::Workspace,
}

impl Transport {
    /// Bytes of everything a relighting reads.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Tiles(t) => t.bytes(),
            Self::Blocks(b) => b.bytes(),
        }
    }

    /// Indirect irradiance \[W/m^2\] from direct irradiance and emission. Of the published codec, which gives radiosity, black patches get none.
    ///
    /// # Errors
    /// Of numbers that do not fit.
    pub fn relight(
        &self,
        session: &dyn Session,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
        rooms: &mut Rooms,
    ) -> Result<(), BakeError> {
        match self {
            Self::Tiles(t) => session.relight(t, light, indirect, passes, &mut rooms.tiles)?,
            Self::Blocks(b) => {
                session.relight_blocks(b, light, indirect, &mut rooms.blocks)?;
                b.to_irradiance(indirect);
            }
        }
        Ok(())
    }
}

/// How to bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeSettings {
    /// Patches, and the seed of everything.
    pub patches: PatchSettings,
    /// Rays of a patch of mean area.
    pub rays: u32,
    /// How form factors are stored.
    pub codec: Codec,
    /// Passes of a relighting; `None`: as few as the codec's error allows, at least [`PASSES`].
    pub passes: Option<u32>,
    /// Bounces of the indirect light, each a pass; `None`: all.
    pub bounces: Option<u32>,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            patches: PatchSettings { count: 4096, seed: 0 },
            rays: 4096,
            codec: Codec::Auto { max_error: 0.01 },
            passes: None,
            bounces: None,
        }
    }
}

/// Why nothing was baked.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The backend cannot, or was stopped.
    #[error("{0}")]
    Backend(#[from] BackendError),
    /// Rows that do not fit.
    #[error("{0}")]
    Rows(#[from] RowError),
    /// No operator of these form factors.
    #[error("{0}")]
    Relight(#[from] RelightError),
    /// No texture blocks of them.
    #[error("{0}")]
    Blocks(#[from] BlockError),
    /// The scene has no surface that light reaches.
    #[error("the scene has no surface that light can reach: there are no patches")]
    NoPatches,
}

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

/// An operator and what it was made of.
#[derive(Clone, Debug)]
pub struct Operator {
    /// Patches in the order of the tiles.
    pub map: PatchMap,
    /// What relights.
    pub transport: Transport,
    /// Share of each patch's rays that see the sky.
    pub escaped: Vec<f32>,
    /// Share of each patch that is not covered; see [`FormFactors::seen`].
    pub seen: Vec<f32>,
    /// Passes of a relighting.
    pub passes: u32,
}

impl Operator {
    /// Bytes of everything a relighting reads.
    pub fn bytes(&self) -> usize {
        self.transport.bytes()
    }
}

/// A bake.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The operator.
    pub operator: Operator,
    /// Form factors as they were counted and balanced, in the order of the tiles.
    pub form_factors: FormFactors,
    /// What balancing did.
    pub balance: Balance,
    /// Measured error of the codec.
    pub error: CodecError,
    /// Rays of all patches.
    pub rays: u64,
    /// Seconds by stage.
    pub stages: Vec<(&'static str, f64)>,
}

/// Seconds by stage.
struct Clock {
    stages: Vec<(&'static str, f64)>,
    last: Instant,
}

impl Clock {
    fn new() -> Self {
        Self { stages: Vec::new(), last: Instant::now() }
    }

    fn done(&mut self, name: &'static str) {
        self.stages.push((name, self.last.elapsed().as_secs_f64()));
        self.last = Instant::now();
    }
}

/// Bakes the operator of a session's scene.
///
/// # Errors
/// [`BakeError`]; being stopped is one ([`BackendError::Cancelled`]).
pub fn bake(
    session: &dyn Session,
    settings: &BakeSettings,
    watcher: &dyn Watcher,
) -> Result<Baked, BakeError> {
    let mut clock = Clock::new();
    let map = session.patches(&settings.patches)?;
    if map.patches.is_empty() {
        return Err(BakeError::NoPatches);
    }
    clock.done("patches");
    let order = order::kd(map.patches.list(), SIDE);
    let map = PatchMap { patches: map.patches.reordered(&order), ..map };
    let voxels = inverse(&order);
    clock.done("order");
    let job = FormFactorJob {
        seed: settings.patches.seed,
        rays: settings.rays,
        patches: 0..map.patches.len() as u32,
    };
    let control = PassControl::whole(watcher, u64::from(settings.rays));
    let rows = session.form_factors(&map, &job, &control)?;
    clock.done("rays");
    let (mut form_factors, seen) = form_factors::assemble(&map.patches.areas(), &rows)?.seen();
    let rays = rows.iter().map(|r: &Row| u64::from(r.rays)).sum();
    drop(rows);
    let targets = form_factors.targets();
    let balance = form_factors::balance(&mut form_factors, &targets, BALANCE_STEPS);
    clock.done("balance");
    let albedo: Vec<[f32; 3]> = map.patches.list().iter().map(|p| p.albedo).collect();
    let truth = Truth::new(session, &form_factors, &map, &albedo, settings.bounces)?;
    clock.done("exact");
    let Encoded { transport, passes, error } =
        encode(session, (&form_factors, &voxels), &truth, settings.codec, settings.passes)?;
    clock.done("encode");
    let operator = Operator { map, transport, escaped: form_factors.escaped.clone(), seen, passes };
    Ok(Baked { operator, form_factors, balance, error, rays, stages: clock.stages })
}

/// What probe lights are for: those that weights of passes are found by are not those that the error is measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeLights {
    /// Measuring.
    Measure,
    /// Finding weights.
    Fit,
}

/// Lights that a codec is judged by: direct irradiance on all patches, eight of them. Single lit patches are the hardest; lamps near a wall, suns and an even light follow.
pub fn probe_lights(map: &PatchMap, row_sums: &[f64], purpose: ProbeLights) -> Vec<Vec<[f32; 3]>> {
    let list = map.patches.list();
    let n = list.len();
    let colour = [1.0, 0.8, 0.6];
    let (offset, suns) = match purpose {
        ProbeLights::Measure => (n / 14, [[0.48, 0.80, 0.36], [-0.6, 0.64, 0.48]]),
        ProbeLights::Fit => (n / 35, [[0.0, 0.8, 0.6], [-0.36, 0.48, -0.8]]),
    };
    let mut lights = Vec::new();
    // From there on the first patch that sees something.
    let at = |k: usize| {
        let first = (k * n / 7 + offset).min(n.saturating_sub(1));
        (first..n).chain(0..first).find(|i| row_sums.get(*i).is_some_and(|s| *s > SEES)).unwrap_or(first)
    };
    for k in [1, 4] {
        let mut one = vec![[0.0; 3]; n];
        one[at(k)] = colour;
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
                    colour.map(|c| c * cosine.max(0.0) / squared.max(1e-4 * extent * extent))
                })
                .collect(),
        );
    }
    for sun in suns {
        lights.push(
            list.iter()
                .map(|q| colour.map(|x| x * (0..3).map(|c| sun[c] * q.normal[c]).sum::<f32>().max(0.0)))
                .collect(),
        );
    }
    lights.push(vec![colour; n]);
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
        let mut solve = |lights: &[Vec<[f32; 3]>]| -> Result<Vec<Vec<[f32; 3]>>, BakeError> {
            let mut all = Vec::new();
            for direct in lights {
                let mut indirect = vec![[0.0; 3]; direct.len()];
                match bounces {
                    None => {
                        session.converge(&relighter, (direct, &[]), &mut indirect, STANDS, &mut room)?;
                    }
                    Some(k) => session.relight(&relighter, (direct, &[]), &mut indirect, k, &mut room)?,
                }
                all.push(indirect);
            }
            Ok(all)
        };
        let row_sums = form_factors.row_sums();
        let [lights, fit] = [ProbeLights::Measure, ProbeLights::Fit].map(|p| probe_lights(map, &row_sums, p));

        let (exact, fitted) = (solve(&lights)?, solve(&fit)?);
        Ok(Self { relighter, lights, exact, fit: [fit, fitted], bounces })
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

/// Form factors as a codec stores them.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// What relights.
    pub transport: Transport,
    /// In so many passes.
    pub passes: u32,
    /// What that costs.
    pub error: CodecError,
}

/// The inverse of a permutation.
fn inverse(order: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; order.len()];
    for (new, old) in order.iter().enumerate() {
        inverse[*old as usize] = new as u32;
    }
    inverse
}

/// Texture blocks as a codec says; `voxels` is the order of the patches before they were put in order.
fn encode_blocks(
    session: &dyn Session,
    (form_factors, voxels): (&FormFactors, &[u32]),
    truth: &Truth,
    codec: Codec,
) -> Result<Encoded, BakeError> {
    let settings = match codec {
        Codec::Published { bounces, keep, order } => blocks::Settings {
            matrix: bounces.map_or(Matrix::AllBounces, Matrix::Bounces),
            keep,
            order: match order {
                Order::Voxels => blocks::Order::Given(voxels),
                Order::Kd => blocks::Order::Patches,
                Order::Greedy1 => blocks::Order::Greedy { passes: 1 },
                Order::Greedy2 => blocks::Order::Greedy { passes: 2 },
            },
            ..blocks::Settings::published(PASSES)
        },
        Codec::Bc4 { keep } => {
            blocks::Settings { keep, ..blocks::Settings::bounced(bounces_needed(session, truth)?) }
        }
        Codec::Bc1 { keep } => blocks::Settings { keep, ..blocks::Settings::mended() },
        Codec::Auto { .. } | Codec::Tiles | Codec::F16 | Codec::F32 => blocks::Settings::mended(),
    };
    let made = session.encode_blocks(form_factors, &truth.relighter.albedo_list(), &settings)?;
    let passes = match settings.matrix {
        Matrix::FormFactors { bounces } => bounces,
        _ => 1,
    };
    let transport = Transport::Blocks(Box::new(made));
    let error = truth.measure(session, &transport, passes)?;
    Ok(Encoded { transport, passes, error })
}

/// Plain bounces after which little is left to come.
fn bounces_needed(session: &dyn Session, truth: &Truth) -> Result<u32, BakeError> {
    if let Some(bounces) = truth.bounces {
        return Ok(bounces);
    }
    let plain = Transport::Tiles(Box::new(truth.relighter.clone().without_coarse()));
    let mut bounces = 4;
    while bounces < BOUNCES_MOST && truth.measure(session, &plain, bounces)?.rms > FULL_ERROR {
        bounces += bounces / 2;
    }
    Ok(bounces)
}

/// Stores form factors as the codec says, and measures what that costs; `voxels` is the order of the patches before they were put in order.
///
/// # Errors
/// Of form factors that make no operator.
pub fn encode(
    session: &dyn Session,
    (form_factors, voxels): (&FormFactors, &[u32]),
    truth: &Truth,
    codec: Codec,
    passes: Option<u32>,
) -> Result<Encoded, BakeError> {
    let albedo = truth.relighter.albedo_list();
    let limit = match codec {
        Codec::Published { .. } | Codec::Bc1 { .. } | Codec::Bc4 { .. } => {
            return encode_blocks(session, (form_factors, voxels), truth, codec);
        }
        Codec::Auto { max_error } => max_error * PASSES_SHARE,
        Codec::Tiles | Codec::F16 | Codec::F32 => FULL_ERROR,
    };
    // As few passes as leave the tiles room for errors of their own.
    let mut count = truth.bounces.or(passes).unwrap_or(PASSES);
    let weights = loop {
        if truth.bounces.is_some() {
            break Vec::new();
        }
        let weights = truth.weights(session, count)?;
        let made = Transport::Tiles(Box::new(truth.relighter.clone().with_weights(weights.clone())?));
        let good = truth.measure(session, &made, count)?.rms <= limit;
        if good || passes.is_some() || count >= PASSES_MOST {
            break weights;
        }
        count += 1;
    };
    let symmetric = Symmetric::new(form_factors);
    let make = |want: &(dyn Fn(usize, usize) -> Kind + Sync), coarse: Rates| -> Result<Encoded, BakeError> {
        let tiles = session.tiles(&symmetric, want).map_err(RelightError::Tiles)?;
        let relighter = Relighter::of(form_factors, &albedo, tiles)?
            .with_coarse_of(&truth.relighter, coarse)?
            .with_weights(weights.clone())?;
        let transport = Transport::Tiles(Box::new(relighter));
        let error = truth.measure(session, &transport, count)?;
        Ok(Encoded { transport, passes: count, error })
    };
    let uniform = |kind: Kind| make(&|_, _| kind, Rates::Uniform(kind));
    match codec {
        Codec::F32 | Codec::Published { .. } | Codec::Bc1 { .. } | Codec::Bc4 { .. } => uniform(Kind::F32),
        Codec::F16 => uniform(Kind::F16),
        Codec::Tiles => uniform(Kind::Bits8),
        Codec::Auto { max_error } => {
            let curves = session.rate_curves(&symmetric);
            // The error grows with what a bit may cost; look for the largest cost that is allowed.
            let (mut low, mut high) = (1e-12_f64, 1e-3_f64);
            let mut best = None;
            for _ in 0..SEARCH_STEPS {
                let lambda = (low * high).sqrt();
                let coarse = Rates::Cheapest { lambda: COARSE * lambda };
                let found = make(&|row, column| curves.kind(row, column, lambda), coarse)?;
                let rms = found.error.rms;
                if rms <= max_error {
                    low = lambda;
                    best = Some(found);
                    if rms >= NEAR * max_error {
                        break;
                    }
                } else {
                    high = lambda;
                }
            }
            match best {
                Some(best) => Ok(best),
                // Nothing in few bits is good enough.
                None => uniform(Kind::F32),
            }
        }
    }
}

/// Irradiance on patches \[W/m^2\] that no patch has sent: that of lights without size, and of the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchLight {
    /// From lights without size.
    pub direct: Vec<[f32; 3]>,
    /// From the sky.
    pub sky: Vec<[f32; 3]>,
    /// From lights without size, on elements.
    pub elements: Vec<[f32; 3]>,
}

/// The light of the session's scene on the patches of an operator.
///
/// # Errors
/// As [`Session::direct_irradiance`].
pub fn patch_light(
    session: &dyn Session,
    operator: &Operator,
    seed: u64,
    watcher: &dyn Watcher,
) -> Result<PatchLight, BackendError> {
    let map = &operator.map;
    let n = map.patches.len();
    let mut sums = vec![[0.0_f64; 3]; n];
    let outcome = super::direct_irradiance(session, seed, map.elements.settings(), watcher)?;
    if outcome.cancelled {
        return Err(BackendError::Cancelled);
    }
    for (patch, (sum, seen)) in sums.iter_mut().zip(&operator.seen).enumerate() {
        let mut area = 0.0;
        for element in map.patches.members(patch) {
            let weight = map.elements.weight(*element as usize);
            let value = outcome.film.mean(*element as usize);
            area += weight;
            *sum = [0, 1, 2].map(|c| sum[c] + weight * value[c]);
        }
        // What is covered has no light, and no part in the mean.
        *sum = sum.map(|s| s / (area * f64::from(*seen)).max(f64::MIN_POSITIVE));
    }
    let environment = session.scene().environment;
    let sky = operator.escaped.iter().map(|e| environment.map(|l| e * PI * l)).collect();
    let narrow = |v: [f64; 3]| v.map(|x| x as f32);
    let elements = (0..map.elements.count()).map(|e| narrow(outcome.film.mean(e))).collect();
    Ok(PatchLight { direct: sums.into_iter().map(narrow).collect(), sky, elements })
}

/// Indirect irradiance on patches for their light: what patches send each other, emission of surfaces included.
///
/// # Errors
/// Of numbers that do not fit.
pub fn relight(
    session: &dyn Session,
    operator: &Operator,
    light: &PatchLight,
    rooms: &mut Rooms,
) -> Result<Vec<[f32; 3]>, BakeError> {
    let direct: Vec<[f32; 3]> =
        light.direct.iter().zip(&light.sky).map(|(d, s)| [0, 1, 2].map(|c| d[c] + s[c])).collect();
    let emission: Vec<[f32; 3]> = operator.map.patches.list().iter().map(|p| p.emission).collect();
    let mut indirect = vec![[0.0; 3]; direct.len()];
    operator.transport.relight(session, (&direct, &emission), &mut indirect, operator.passes, rooms)?;
    Ok(indirect)
}

/// A map to read or to gather from: all irradiance on elements but the direct light of lights without size.
///
/// # Errors
/// As [`Session::transfer`].
pub fn radiosity_map(
    session: &dyn Session,
    operator: &Operator,
    light: &PatchLight,
    indirect: &[[f32; 3]],
) -> Result<Vec<[f32; 3]>, BackendError> {
    let all: Vec<[f32; 3]> =
        indirect.iter().zip(&light.sky).map(|(i, s)| [0, 1, 2].map(|c| i[c] + s[c])).collect();
    Ok(session.transfer(&operator.map)?.apply(&all))
}

/// All light of an operator's scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Relit {
    /// What no patch has sent.
    pub light: PatchLight,
    /// Indirect irradiance on patches \[W/m^2\].
    pub indirect: Vec<[f32; 3]>,
    /// On elements: all but the direct light of lights without size.
    pub values: Vec<[f32; 3]>,
    /// Seconds by stage.
    pub stages: Vec<(&'static str, f64)>,
}

/// The light of the session's scene, all bounces, on its elements.
///
/// # Errors
/// [`BakeError`]; being stopped is one ([`BackendError::Cancelled`]).
pub fn relit(
    session: &dyn Session,
    operator: &Operator,
    seed: u64,
    watcher: &dyn Watcher,
) -> Result<Relit, BakeError> {
    let mut clock = Clock::new();
    let light = patch_light(session, operator, seed, watcher)?;
    clock.done("direct");
    let indirect = relight(session, operator, &light, &mut Rooms::default())?;
    clock.done("relight");
    let values = radiosity_map(session, operator, &light, &indirect)?;
    clock.done("transfer");
    Ok(Relit { light, indirect, values, stages: clock.stages })
}

/// What a map of an operator is read by.
#[derive(Clone, Copy, Debug)]
pub struct RadiosityView<'a> {
    /// Elements of the map.
    pub elements: ElementSettings,
    /// Their numbers.
    pub values: &'a [[f32; 3]],
    /// Whether the first diffuse surface gathers its light by rays.
    pub gather: bool,
}

impl RadiosityView<'_> {
    fn given(&self) -> GivenMap<'_> {
        GivenMap { elements: self.elements, values: self.values, gather: self.gather }
    }
}

/// An image from a map.
///
/// # Errors
/// As [`Session::map_image`]; being stopped is no error.
pub fn map_image(
    session: &dyn Session,
    settings: &Settings,
    view: &RadiosityView<'_>,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::image_film_settings(session.scene(), &first)?);
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.map_image(job, &view.given(), control, film)
    })
}

/// The irradiance at probes from a map.
///
/// # Errors
/// As [`Session::map_probes`]; being stopped is no error.
pub fn map_probes(
    session: &dyn Session,
    probes: &[Probe],
    settings: &Settings,
    view: &RadiosityView<'_>,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::probe_film_settings(session.scene(), &first, probes.len()));
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.map_probes(job, &view.given(), probes, control, film)
    })
}
