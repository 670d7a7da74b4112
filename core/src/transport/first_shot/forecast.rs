//! Does a start on surfaces pay? What maps of one accuracy will cost, from a few photons and a few pairs.
//!
//! The unit is a ray of a photon's walk, so that the answer is the same on any machine. From the lights (first hits weighted by the albedo) photons carry w_i
//! after their first hit, 0 where they leave the scene: the noise of N of them goes with E w^2 / N. From surfaces all carry nearly the same, E w, and fewer are needed by
//! (E w)^2 / E w^2; each saves the ray that led to the surface, and the precomputation comes on top.

use super::{FirstShotError, StartPlan, Subdivision};
use crate::direct::subdivide::Workspace;
use crate::geometry::Intersector;
use crate::math;
use crate::sampling::numbers::Numbers;
use crate::scene::CompiledScene;
use crate::transport::photon::{
    LightPlan, PICK_GROUP, Photon, PhotonFlight, PhotonTracer, START_GROUP, Through, WALK_GROUP, Way,
};
use crate::transport::volume::LightMedia;

/// Photons that are tried, and pairs.
const PHOTONS: u32 = 1 << 12;
const PAIRS: usize = 1 << 12;
/// (E w)^2 / E w^2 of exact weights, as measured on five scenes (0.88 to 0.95).
const EVENNESS: f64 = 0.92;
/// A shadow ray of a start or of the precomputation in rays of a walk; rays that a start with exact weights takes beside its walk: looks, and the share of
/// photons from the lights.
const SHADOW: f64 = 0.5;
const START: f64 = 0.5 * SHADOW + 0.1;
/// What a pair and a piece cost beside their rays.
const PAIR: f64 = 0.1;
const PIECE: f64 = 1.0;

/// What maps of one accuracy would cost \[rays\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// By photons from the lights.
    pub lights: f64,
    /// By photons from surfaces, the precomputation left out.
    pub surfaces: f64,
    /// The precomputation.
    pub precomputation: f64,
    /// Share of the lights' photons that leave their first hit, or meet none of theirs in closed form.
    pub survival: f64,
}

impl Forecast {
    /// Whether photons should start on surfaces.
    pub fn surfaces_pay(&self) -> bool {
        self.surfaces + self.precomputation < self.lights
    }
}

/// Forecasts the cost of a map as accurate as `photons` photons from the lights would make it; `media`: what the lights send into.
///
/// # Errors
/// As for the density of starts.
pub fn forecast<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    (intersector, media): (&I, &LightMedia),
    subdivision: &Subdivision,
    photons: u64,
) -> Result<Forecast, FirstShotError> {
    let plan = StartPlan::new(scene, media, *subdivision)?;
    let lights = LightPlan::new(scene).map_err(|_| FirstShotError::Dark)?;
    let walk = if scene.needs.volume() {
        try_photons(
            &PhotonTracer::<Through, true, true, true>::new(scene, u32::MAX),
            (scene, media),
            intersector,
            &lights,
        )
    } else {
        try_photons(
            &PhotonTracer::<(), true, true, true>::new(scene, u32::MAX),
            (scene, media),
            intersector,
            &lights,
        )
    };
    // NaN is no flux either.
    if walk.sum.partial_cmp(&0.0) != Some(core::cmp::Ordering::Greater) {
        return Err(FirstShotError::Dark);
    }
    let n = photons as f64;
    let fewer = walk.sum * walk.sum / (f64::from(PHOTONS) * walk.squares * EVENNESS);
    Ok(Forecast {
        lights: n * walk.rays / f64::from(PHOTONS),
        surfaces: n * fewer * (walk.later_rays / walk.sum + START),
        precomputation: precomputation(intersector, &plan),
        survival: walk.sum / walk.emitted,
    })
}

#[derive(Default)]
struct Tried {
    rays: f64,
    /// Flux after the first hit, its square, and what was sent out.
    sum: f64,
    squares: f64,
    emitted: f64,
    /// Rays of a photon that a start would need too, weighted by its flux.
    later_rays: f64,
}

fn try_photons<W: Way, I: Intersector + ?Sized>(
    tracer: &PhotonTracer<'_, W, true, true, true>,
    (scene, media): (&CompiledScene, &LightMedia),
    intersector: &I,
    lights: &LightPlan,
) -> Tried {
    let flight = PhotonFlight::<W>::new(scene, u32::MAX, media);
    let mut tried = Tried::default();
    for index in 0..PHOTONS {
        let numbers = Numbers::random(0x5EED, 0).with_index(index);
        let pick = numbers.bits4(PICK_GROUP)[0];
        let (photon, light) = lights.start(scene, pick, numbers.group4(START_GROUP), false);
        let straight = !photon.registers_first;
        let photon = Photon { survives_first: true, ..photon };
        let mut photon = flight.begin(intersector, photon, (light, index), &numbers);
        let sent = f64::from(math::mean(photon.flux));
        let (mut carried, mut rays) = (if straight { 0.0 } else { sent }, 0.0);
        loop {
            let mut took = 0;
            let landed = flight.fly(intersector, &mut photon, &numbers, &mut took);
            rays += took as f64;
            let Some(hit) = landed else { break };
            let Some((surface, _)) = tracer.land(&photon, &hit) else { break };
            let [u, v, lobe, survive] = numbers.group4(WALK_GROUP.wrapping_add(photon.hits));
            let chance = tracer.scatter(&mut photon, &surface, [u, v], lobe);
            if survive >= chance {
                break;
            }
            photon.flux /= chance;
            if photon.hits == 1 && straight {
                carried = f64::from(math::mean(photon.flux));
            }
        }
        tried.rays += rays;
        tried.emitted += sent;
        tried.sum += carried;
        tried.squares += carried * carried;
        tried.later_rays += carried * (rays - f64::from(u8::from(straight)));
    }
    tried
}

fn precomputation<I: Intersector + ?Sized>(intersector: &I, plan: &StartPlan<'_>) -> f64 {
    let pairs = plan.pairs();
    if pairs == 0 {
        return 0.0;
    }
    // Every n-th pair, from the middle of the first n.
    let step = pairs.div_ceil(PAIRS);
    let mut workspace = Workspace::new();
    let (mut rays, mut pieces, mut looked) = (0, 0_u64, 0_u64);
    let mut pair = step / 2;
    while pair < pairs {
        rays += plan.pieces(intersector, pair, &mut workspace, |_| pieces += 1);
        looked += 1;
        pair += step;
    }
    let each = (rays as f64 * SHADOW + pieces as f64 * PIECE) / looked.max(1) as f64 + PAIR;
    each * pairs as f64
}
