//! Jobs of photons: illumination maps, and images and probes from them.

use super::{Budget, Outcome, Settings, Watcher, block_length, drive, even, first_job};
use etendue_core::backend::{self, BackendError, GatherJob, PathJob, PhotonJob, PhotonStart, Probe, Session};
use etendue_core::film::Film;
use etendue_core::illumination::{ElementSettings, Elements};
use etendue_core::light::emit::is_point_like;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::first_shot::{FirstShotError, Subdivision, Weights};
use etendue_core::transport::photon::Sequence;

/// Most photons of a block's map.
const PHOTONS_MAX: u64 = 1 << 26;
/// Square of the longest edge of an element that suits a scene, over its area.
const ELEMENT_SHARE: f64 = 1.0 / 32768.0;

/// Photons of a replicate: about a sixteenth of all where their number is known, a power of two, and never so few that adding the replicate up
/// costs more than its photons.
pub fn photons_per_replicate(budget: Budget) -> u32 {
    const RANGE: [u64; 2] = [1 << 10, 1 << 22];
    match budget {
        Budget::Samples(n) => 1 << (n / 16).clamp(RANGE[0], RANGE[1]).ilog2(),
        Budget::Seconds(_) | Budget::Error(_) => 1 << 16,
    }
}

/// How photons are traced and summed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonSettings {
    /// Where they start.
    pub start: PhotonStart,
    /// Where their numbers come from.
    pub sequence: Sequence,
    /// What the map is divided into.
    pub elements: ElementSettings,
}

/// Photons that are expected of a budget that does not say.
fn expected_photons(budget: Budget) -> u64 {
    match budget {
        Budget::Samples(n) => n,
        // Half a million a second and core is common; the choice is no closer than that.
        Budget::Seconds(seconds) => (seconds * 1e6) as u64,
        Budget::Error(_) => 1 << 22,
    }
}

/// Where photons should start for the least cost: on surfaces where what that saves, forecast for the budget, is more than what it takes to prepare.
/// Depends on the scene and the budget, not on the machine.
///
/// # Errors
/// When the scene needs more than surfaces, or nothing emits.
pub fn choose_start(session: &dyn Session, budget: Budget) -> Result<PhotonStart, BackendError> {
    let weights = Weights::EXACT;
    let subdivision = Subdivision::robust(weights);
    match session.forecast(&subdivision, expected_photons(budget)) {
        Ok(forecast) if forecast.surfaces_pay() => {
            tracing::debug!(?forecast, "photons start on surfaces");
            Ok(PhotonStart::Surfaces { subdivision, weights })
        }
        Ok(forecast) => {
            tracing::debug!(?forecast, "photons start at the lights");
            Ok(PhotonStart::LIGHTS)
        }
        Err(BackendError::FirstShot(FirstShotError::RoundShapes { .. } | FirstShotError::Table)) => {
            Ok(PhotonStart::LIGHTS)
        }
        Err(BackendError::FirstShot(FirstShotError::Dark)) => Err(BackendError::Dark),
        Err(e) => Err(e),
    }
}

/// Irradiance on elements of the scene's surfaces by photons; for the rest of light, start them so that the direct light of lights without size does not count. The budget counts photons;
/// errors are weighted by area.
///
/// # Errors
/// As [`Session::illumination`]; being stopped is no error.
pub fn illumination(
    session: &dyn Session,
    settings: &Settings,
    photons: &PhotonSettings,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let of = |job: &PathJob| PhotonJob {
        seed: job.seed,
        photons: job.block_length,
        replicates: job.blocks.clone(),
        max_hits: job.max_depth,
        start: photons.start,
        sequence: photons.sequence,
        elements: photons.elements,
    };
    let block_length = photons_per_replicate(settings.budget);
    let first = PathJob { seed: settings.seed, block_length, blocks: 0..0, max_depth: settings.max_depth };
    let elements = session.elements(&photons.elements);
    let film = Film::new(backend::illumination_film_settings(session.scene(), &elements, &of(&first))?);
    drive(film, first, settings.budget, watcher, &|i| elements.weight(i), |job, control, film| {
        session.illumination(&of(job), control, film)
    })
}

/// How images and probes come from maps of photons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherSettings {
    /// How photons are traced and summed; sides must be apart.
    pub photons: PhotonSettings,
    /// Photons of all blocks together where the number of samples is the budget, rounded up to a power of two a block.
    pub count: u64,
    /// Whether the first diffuse surface gathers its light by rays, instead of being read itself.
    pub gather: bool,
}

/// Photons of the map of each block of samples, a power of two: equal parts of `count` where the number of blocks is known.
pub fn photons_per_block(budget: Budget, count: u64) -> u32 {
    match budget {
        Budget::Samples(n) => {
            let blocks = n.div_ceil(u64::from(block_length(budget))).max(1);
            count.div_ceil(blocks).clamp(1, PHOTONS_MAX).next_power_of_two() as u32
        }
        Budget::Seconds(_) | Budget::Error(_) => 1 << 16,
    }
}

impl GatherSettings {
    pub(super) fn job(&self, path: &PathJob, budget: Budget) -> GatherJob {
        GatherJob {
            path: path.clone(),
            photons: photons_per_block(budget, self.count),
            start: self.photons.start,
            sequence: self.photons.sequence,
            elements: self.photons.elements,
            gather: self.gather,
        }
    }
}

/// The longest edge of a map's elements that suits a scene \[m\]: about 2^17 elements on all its surfaces together.
pub fn element_size(scene: &CompiledScene) -> f32 {
    // Four elements on a square of this side: two right triangles whose longest edge it must cover.
    (scene.area() * ELEMENT_SHARE).sqrt() as f32
}

/// An image from maps of photons, one a block of samples.
///
/// # Errors
/// As [`Session::photon_image`]; being stopped is no error.
pub fn photon_image(
    session: &dyn Session,
    settings: &Settings,
    gather: &GatherSettings,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::image_film_settings(session.scene(), &first)?);
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.photon_image(&gather.job(job, settings.budget), control, film)
    })
}

/// The irradiance at probes from maps of photons, one a block of samples.
///
/// # Errors
/// As [`Session::photon_probes`]; being stopped is no error.
pub fn photon_probes(
    session: &dyn Session,
    probes: &[Probe],
    settings: &Settings,
    gather: &GatherSettings,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let first = first_job(settings);
    let film = Film::new(backend::probe_film_settings(session.scene(), &first, probes.len()));
    drive(film, first, settings.budget, watcher, &even, |job, control, film| {
        session.photon_probes(&gather.job(job, settings.budget), probes, control, film)
    })
}

/// Blocks of points of direct irradiance, and the most and least points of a block on each division of a primitive.
const DIRECT_BLOCKS: u32 = 8;
const DIRECT_POINTS: [u64; 2] = [2, 64];
/// Shadow rays of direct irradiance that a map may take where the least number of points does not ask for more.
const DIRECT_RAYS: u64 = 1 << 23;

/// Points of a block of direct irradiance on each division, a power of two: many where few divisions and lights ask for them.
fn direct_points(scene: &CompiledScene, elements: &Elements) -> u32 {
    let divisions: u64 = (0..scene.primitives().count() as u32).map(|p| u64::from(elements.cells(p))).sum();
    let lights = scene.lights.iter().filter(|l| is_point_like(l)).count() as u64;
    let points = DIRECT_RAYS / (divisions * lights * u64::from(DIRECT_BLOCKS)).max(1);
    1 << points.clamp(DIRECT_POINTS[0], DIRECT_POINTS[1]).ilog2()
}

/// Direct irradiance of lights without size on elements, from eight blocks of points on each division, 16 to 512 in all.
///
/// # Errors
/// As [`Session::direct_irradiance`]; being stopped is no error.
pub fn direct_irradiance(
    session: &dyn Session,
    seed: u64,
    elements: &ElementSettings,
    watcher: &dyn Watcher,
) -> Result<Outcome, BackendError> {
    let divided = session.elements(elements);
    let block_length = direct_points(session.scene(), &divided);
    let first = PathJob { seed, block_length, blocks: 0..0, max_depth: 1 };
    let film = Film::new(backend::direct_film_settings(session.scene(), &divided, &first));
    let budget = Budget::Samples(u64::from(DIRECT_BLOCKS * block_length));
    drive(film, first, budget, watcher, &|i| divided.weight(i), |job, control, film| {
        session.direct_irradiance(job, elements, control, film)
    })
}
