//! The radiosity operator: bytes, time and error of each way to store it.
#![allow(clippy::disallowed_methods, reason = "numbers for people, in f64: no kernel")]

pub mod bake;
pub mod fast;
pub mod probes;
pub mod published;
pub mod scenes;
pub mod small;

use etendue::core::backend::{FormFactorJob, NoControl, Session};
use etendue::core::radiosity::form_factors::{self, FormFactors};
use etendue::core::radiosity::order;
use etendue::core::radiosity::patches::{PatchMap, PatchSettings};
use etendue::core::radiosity::tiles::SIDE;
use etendue::core::scene::CompiledScene;
use etendue::cpu::{CpuBackend, CpuSession};
use etendue::driver::radiosity::{BakeSettings, Truth};
use std::error::Error;
use std::sync::Arc;

/// What everything here may fail with.
pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Steps of balancing form factors, as a bake has them.
const BALANCE_STEPS: u32 = 30;

/// A session of a scene with so many threads.
///
/// # Errors
/// Of the backend.
pub fn open(scene: &Arc<CompiledScene>, threads: usize) -> Outcome<CpuSession> {
    Ok(CpuBackend::new(Some(threads))?.open_session(scene.clone())?)
}

/// Form factors of a scene and exact light, which all codecs share.
pub struct Made {
    /// Patches in the order of the tiles.
    pub map: PatchMap,
    /// The order of voxels: where the patches were before.
    pub voxels: Vec<u32>,
    /// Form factors, balanced.
    pub form_factors: FormFactors,
    /// Probe lights and their exact light.
    pub truth: Truth,
}

impl Made {
    /// What a bake does before it encodes.
    ///
    /// # Errors
    /// Of the driver.
    pub fn new(session: &dyn Session, count: u32) -> Outcome<Self> {
        let defaults = BakeSettings::default();
        let map = session.patches(&PatchSettings { count, ..defaults.patches })?;
        let order = order::kd(map.patches.list(), SIDE);
        let map = PatchMap { patches: map.patches.reordered(&order), ..map };
        let mut voxels = vec![0; order.len()];
        for (new, old) in order.iter().enumerate() {
            voxels[*old as usize] = new as u32;
        }
        let patches = 0..map.patches.len() as u32;
        let job = FormFactorJob { seed: defaults.patches.seed, rays: defaults.rays, patches };
        let rows = session.form_factors(&map, &job, &NoControl)?;
        let (mut form_factors, _) = form_factors::assemble(&map.patches.areas(), &rows)?.seen();
        let targets = form_factors.targets();
        form_factors::balance(&mut form_factors, &targets, BALANCE_STEPS);
        let albedo: Vec<[f32; 3]> = map.patches.list().iter().map(|p| p.albedo).collect();
        let truth = Truth::new(session, &form_factors, &map, &albedo, None)?;
        Ok(Self { map, voxels, form_factors, truth })
    }

    /// Patches.
    pub fn len(&self) -> usize {
        self.form_factors.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.form_factors.is_empty()
    }

    /// Bytes per pair of patches.
    pub fn per_pair(&self, bytes: usize) -> f64 {
        bytes as f64 / (self.len() as f64 * self.len() as f64)
    }
}

/// A target and whether it was reached, as a line of a list.
pub fn target(what: &str, found: &str, reached: bool) -> String {
    format!("- {what}: {found}; {}.\n", if reached { "reached" } else { "**not reached**" })
}
