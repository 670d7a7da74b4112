//! Baking an operator from a scene, and light from it.

mod encode;
mod light;
mod transport;
mod truth;

pub use encode::{Encoded, PASSES, encode};
pub use light::{PatchLight, Relit, map_image, map_probes, patch_light, radiosity_map, relight, relit};
pub use transport::{Rooms, Transport};
pub use truth::{CodecError, Judge, Light, ProbeLights, Truth, probe_lights};

use super::{PassControl, Watcher};
use etendue_core::backend::{BackendError, FormFactorJob, Session};
use etendue_core::radiosity::blocks::BlockError;
use etendue_core::radiosity::form_factors::{self, Balance, FormFactors, Row, RowError};
use etendue_core::radiosity::order;
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::radiosity::relight::RelightError;
use etendue_core::radiosity::tiles::SIDE;
use std::time::Instant;

/// Steps of balancing form factors.
const BALANCE_STEPS: u32 = 30;

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

/// Form factors of a scene as they were counted and balanced: what all codecs store, each in its way.
#[derive(Clone, Debug)]
pub struct Counted {
    /// Patches in the order of the tiles.
    pub map: PatchMap,
    /// Form factors between them.
    pub form_factors: FormFactors,
    /// Share of each patch that is not covered; see [`FormFactors::seen`].
    pub seen: Vec<f32>,
    /// What balancing did.
    pub balance: Balance,
    /// What codecs are measured by.
    pub truth: Truth,
    /// Rays of all patches.
    pub rays: u64,
    /// Seconds by stage.
    pub stages: Vec<(&'static str, f64)>,
    /// The order of the patches before they were put in that of the tiles.
    voxels: Vec<u32>,
}

/// Counts the form factors of a session's scene; of the settings, the codec and its passes do not matter.
///
/// # Errors
/// [`BakeError`]; being stopped is one ([`BackendError::Cancelled`]).
pub fn count(
    session: &dyn Session,
    settings: &BakeSettings,
    watcher: &dyn Watcher,
) -> Result<Counted, BakeError> {
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
    Ok(Counted { map, form_factors, seen, balance, truth, rays, stages: clock.stages, voxels })
}

impl Counted {
    /// The operator of a codec, what that costs, and the seconds it took.
    ///
    /// # Errors
    /// Of form factors that make no operator.
    pub fn store(
        &self,
        session: &dyn Session,
        codec: Codec,
        passes: Option<u32>,
    ) -> Result<(Operator, CodecError, f64), BakeError> {
        let start = Instant::now();
        let Encoded { transport, passes, error } =
            encode(session, (&self.form_factors, &self.voxels), &self.truth, codec, passes)?;
        let operator = Operator {
            map: self.map.clone(),
            transport,
            escaped: self.form_factors.escaped.clone(),
            seen: self.seen.clone(),
            passes,
        };
        Ok((operator, error, start.elapsed().as_secs_f64()))
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
    let counted = count(session, settings, watcher)?;
    let (operator, error, seconds) = counted.store(session, settings.codec, settings.passes)?;
    let Counted { form_factors, balance, rays, mut stages, .. } = counted;
    stages.push(("encode", seconds));
    Ok(Baked { operator, form_factors, balance, error, rays, stages })
}

/// The inverse of a permutation.
fn inverse(order: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; order.len()];
    for (new, old) in order.iter().enumerate() {
        inverse[*old as usize] = new as u32;
    }
    inverse
}
