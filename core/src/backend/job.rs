//! Jobs: what is to be computed, and what decides its bits.

use super::BackendError;
use crate::geometry::Intersector;
use crate::illumination::{ElementSettings, Elements, Sides};
use crate::math::Vec3;
use crate::medium::Inside;
use crate::scene::CompiledScene;
use crate::transport::bidirectional::{self, Heuristic};
use crate::transport::first_shot::{Subdivision, Weights};
use crate::transport::gather::ProbePlace;
use crate::transport::photon::Sequence;
use crate::transport::place_probe;
use crate::transport::volume::inside_of_probe;
use alloc::vec::Vec;
use core::ops::Range;

/// What a job cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JobStats {
    /// Rays traced, of all kinds.
    pub rays: u64,
    /// Paths, photons or points started.
    pub paths: u64,
    /// Arrivals of photons that were registered.
    pub hits: u64,
}

impl core::ops::AddAssign for JobStats {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.paths += other.paths;
        self.hits += other.hits;
    }
}

/// Settings shared by path-traced jobs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathJob {
    /// Seed of all samples.
    pub seed: u64,
    /// Samples per block; a power of two. Part of the job: other lengths give other bits.
    pub block_length: u32,
    /// The sample blocks to compute.
    pub blocks: Range<u32>,
    /// Largest number of edges of a path, as Mitsuba counts them (1: emission seen directly, 2: direct light);
    /// `u32::MAX` for no limit.
    pub max_depth: u32,
}

impl PathJob {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A block length that is no power of two or above 2^16, or an empty or reversed range of blocks.
    pub fn check(&self) -> Result<(), BackendError> {
        if !self.block_length.is_power_of_two() || self.block_length > 1 << 16 {
            return Err(BackendError::BadJob { reason: "block_length must be a power of two up to 65536" });
        }
        if self.blocks.start > self.blocks.end {
            return Err(BackendError::BadJob { reason: "the range of blocks runs backwards" });
        }
        Ok(())
    }
}

/// An image or probes by bidirectional path tracing; see [`crate::transport::bidirectional`].
#[derive(Clone, Debug, PartialEq)]
pub struct BidirectionalJob {
    /// Samples and their blocks: of each pixel or probe as many walks from it as from lights.
    pub path: PathJob,
    /// How strategies share paths.
    pub heuristic: Heuristic,
    /// One strategy alone; see [`crate::transport::bidirectional::Settings::only`].
    pub only: Option<[u32; 2]>,
}

impl BidirectionalJob {
    /// By all strategies and the power heuristic.
    pub fn new(path: PathJob) -> Self {
        Self { path, heuristic: Heuristic::Power, only: None }
    }

    /// What is asked of the estimator.
    pub fn settings(&self) -> bidirectional::Settings {
        let Self { path, heuristic, only } = self;
        bidirectional::Settings::new(path.max_depth, *heuristic, *only)
    }
}

/// Where photons start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhotonStart {
    /// At the lights, by flux.
    Lights {
        /// Whether the first arrivals from point, spot and directional lights count: no where their direct light is added in closed form.
        registers_direct: bool,
        /// Whether photons survive their first hit whatever the albedo, and are weighted by it.
        survives_first: bool,
    },
    /// On the surfaces that lights without size light, by the flux that these send on; see [`crate::transport::first_shot`]. Direct light does not count.
    Surfaces {
        /// How these are cut into pieces.
        subdivision: Subdivision,
        /// What photons carry.
        weights: Weights,
    },
}

impl PhotonStart {
    /// At the lights, without their direct light; first hits weighted by the albedo, which is a little faster for an error than gambling them.
    pub const LIGHTS: Self = Self::Lights { registers_direct: false, survives_first: true };
}

/// An illumination map by photons.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonJob {
    /// Seed of all samples.
    pub seed: u64,
    /// Photons of a replicate; a power of two. Part of the job: other numbers give other bits.
    pub photons: u32,
    /// The replicates to compute; each is independent of the others, and their spread is the error.
    pub replicates: Range<u32>,
    /// Most arrivals of a photon; `u32::MAX` for no limit.
    pub max_hits: u32,
    /// Where they start.
    pub start: PhotonStart,
    /// Where their numbers come from.
    pub sequence: Sequence,
    /// What the map is divided into.
    pub elements: ElementSettings,
}

impl PhotonJob {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number of photons that is no power of two or above 2^26, or a reversed range of replicates.
    pub fn check(&self) -> Result<(), BackendError> {
        if !self.photons.is_power_of_two() || self.photons > 1 << 26 {
            return Err(BackendError::BadJob {
                reason: "photons must be a power of two up to 2^26 a replicate",
            });
        }
        if self.replicates.start > self.replicates.end {
            return Err(BackendError::BadJob { reason: "the range of replicates runs backwards" });
        }
        Ok(())
    }
}

/// An image or probes from maps of photons, by tracing back; see [`crate::transport::gather`]. Each block of samples has a map of its own, that of the photons' replicate
/// of its number: the spread of the blocks is the error of samples and map together.
#[derive(Clone, Debug, PartialEq)]
pub struct GatherJob {
    /// Samples and their blocks. The number of edges counts those of the photons.
    pub path: PathJob,
    /// Photons of each block's map; a power of two. Part of the job: other numbers give other bits.
    pub photons: u32,
    /// Where photons start. The direct light of lights without size must not count.
    pub start: PhotonStart,
    /// Where their numbers come from.
    pub sequence: Sequence,
    /// What maps are divided into. Sides must be apart.
    pub elements: ElementSettings,
    /// Whether the first diffuse surface gathers its light by rays, instead of being read itself.
    pub gather: bool,
}

impl GatherJob {
    /// The photons of the maps, for a film of nothing. `edges`: those from the sensor to where a map is read without a final gather, 1 for an image and 0 for probes.
    pub fn maps(&self, edges: u32) -> PhotonJob {
        let back = edges + u32::from(self.gather);
        PhotonJob {
            seed: self.path.seed,
            photons: self.photons,
            replicates: self.path.blocks.clone(),
            max_hits: match self.path.max_depth {
                u32::MAX => u32::MAX,
                n => n.saturating_sub(back),
            },
            start: self.start,
            sequence: self.sequence,
            elements: self.elements,
        }
    }

    /// Whether ways from the sensor to the map have several lengths, by mirrors, Phong lobes, media, what light passes or round shapes: then no one limit of the photons' arrivals makes
    /// a limit of all edges.
    pub fn ways_differ(scene: &CompiledScene) -> bool {
        scene.needs.beyond_diffuse() || scene.needs.round_shapes || scene.needs.volume()
    }

    /// Checks the numbers, for a scene.
    ///
    /// # Errors
    /// As [`PathJob::check`] and [`PhotonJob::check`]; also photons that register direct light, sides together, and a limit of depth where ways to the map
    /// have several lengths ([`Self::ways_differ`]).
    pub fn check(&self, scene: &CompiledScene) -> Result<(), BackendError> {
        self.path.check()?;
        self.maps(0).check()?;
        let reason = if matches!(self.start, PhotonStart::Lights { registers_direct: true, .. }) {
            "a map to be read must not hold the direct light of lights without size"
        } else if self.elements.sides != Sides::Apart {
            "a map to be read must have its sides apart"
        } else if self.path.max_depth != u32::MAX && Self::ways_differ(scene) {
            "a limit of depth needs a scene of diffuse surfaces without spheres, disks and media with method `photon`"
        } else {
            return Ok(());
        };
        Err(BackendError::BadJob { reason })
    }
}

/// Numbers of a map of one scene.
#[derive(Clone, Copy, Debug)]
pub struct GivenMap<'a> {
    /// What it is divided into; sides must be apart.
    pub elements: ElementSettings,
    /// Irradiance \[W/m^2\] per element, the direct light of lights without size left out.
    pub values: &'a [[f32; 3]],
    /// Whether the first diffuse surface gathers its light by rays, instead of being read itself.
    pub gather: bool,
}

impl GivenMap<'_> {
    /// Checks that it is one of these elements.
    ///
    /// # Errors
    /// [`BackendError::BadJob`]: another number of elements, or sides together.
    pub fn check(&self, elements: &Elements) -> Result<(), BackendError> {
        if self.elements.sides == Sides::Apart && self.values.len() == elements.count() {
            return Ok(());
        }
        Err(BackendError::BadJob {
            reason: "the map has another number of elements than the scene, or its sides are together",
        })
    }
}

/// Rays between patches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormFactorJob {
    /// Seed of all rays.
    pub seed: u64,
    /// Rays of a patch of mean area; larger ones have more, by area.
    pub rays: u32,
    /// The patches to do.
    pub patches: Range<u32>,
}

/// A point on a surface where irradiance is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Position \[m\].
    pub position: [f32; 3],
    /// Normal of the receiving side, any length but zero.
    pub normal: [f32; 3],
}

/// Checks probes before a job and returns them with unit normals.
///
/// # Errors
/// The first probe that is not finite or has no normal.
pub fn check_probes(probes: &[Probe]) -> Result<Vec<(Vec3, Vec3)>, BackendError> {
    let mut out = Vec::with_capacity(probes.len());
    for (index, p) in probes.iter().enumerate() {
        if p.position.iter().chain(&p.normal).any(|x| !x.is_finite()) {
            return Err(BackendError::BadProbe { index, reason: "position and normal must be finite" });
        }
        let n = crate::math::normalize_or(Vec3::from_array(p.normal), Vec3::ZERO);
        if n == Vec3::ZERO {
            return Err(BackendError::BadProbe { index, reason: "the normal must not be zero" });
        }
        out.push((Vec3::from_array(p.position), n));
    }
    Ok(out)
}

/// Probes on the surfaces on which they lie, and the media there; `outside`: those around the scene. Without a final gather each needs a surface.
///
/// # Errors
/// As [`check_probes`]; also the first probe that lies on none where one is needed.
pub fn place_probes<I: Intersector + ?Sized>(
    (scene, intersector): (&CompiledScene, &I),
    outside: Inside,
    probes: &[Probe],
    gather: bool,
) -> Result<Vec<ProbePlace>, BackendError> {
    let places: Vec<_> = check_probes(probes)?
        .into_iter()
        .map(|(p, n)| {
            let place = place_probe(scene, intersector, p, n);
            let inside = inside_of_probe(scene, intersector, outside, (&place.point, n));
            ProbePlace { inside, ..place }
        })
        .collect();
    match places.iter().position(|p| p.hit.is_none()) {
        Some(index) if !gather => {
            let reason =
                "it lies on no surface, and a map is read on surfaces alone: a final gather needs none";
            Err(BackendError::BadProbe { index, reason })
        }
        _ => Ok(places),
    }
}
