//! The boundary to backends: whole jobs over slices, nothing virtual per ray.
//!
//! A [`Backend`] opens a compiled scene as a [`Session`]; a session runs jobs. Every job names its range of sample
//! blocks, so that a job can be split anywhere and its films merged in any order to the same bits. Backends also
//! evaluate single numeric kernels over batches ([`Backend::map`]): the door through which the conformance suite
//! reaches their math.

use crate::film::{Film, FilmError, FilmSettings, scale_exponent};
use crate::illumination::{self, ElementSettings, Elements, Sides};
use crate::kernel::Kernel;
use crate::math::Vec3;
use crate::radiosity::blocks::{self, BlockError, BlockOperator};
use crate::radiosity::form_factors::near::{NearPair, NearSettings};
use crate::radiosity::form_factors::{FormFactors, Row};
use crate::radiosity::patches::{PatchMap, PatchSettings};
use crate::radiosity::polynomial;
use crate::radiosity::relight::{RelightError, Relighter, Symmetric, Workspace};
use crate::radiosity::tiles::{self, Kind, RateCurves, Rates, TileError, Tiles};
use crate::radiosity::transfer::Transfer;
use crate::scene::CompiledScene;
use crate::transport::bidirectional::{self, Heuristic};
use crate::transport::first_shot::{FirstShotError, Forecast, Subdivision, Weights};
use crate::transport::photon::{LightPlan, Sequence};
use crate::transport::volume::SingleScatter;
use alloc::boxed::Box;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt;
use core::ops::{ControlFlow, Range};

/// Who computes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendInfo {
    /// `cpu`, `wgpu`, ...
    pub name: &'static str,
    /// The device, in words.
    pub adapter: String,
    /// Version of the backend's package.
    pub version: &'static str,
}

/// What a backend can do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capabilities {
    /// Path-traced images and probes.
    pub path: bool,
    /// The same by bidirectional path tracing.
    pub bidirectional: bool,
    /// [`Backend::map`] for every [`Kernel`].
    pub kernels: bool,
}

/// Why a backend did not do a job.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BackendError {
    /// The backend cannot do this at all.
    Unsupported {
        /// Which backend.
        backend: &'static str,
        /// What was asked, in words.
        what: String,
    },
    /// The scene needs transport that the method lacks.
    SceneNeeds {
        /// The method.
        method: &'static str,
        /// What is missing, in words.
        missing: String,
    },
    /// An image was asked for and the scene has no camera.
    NoCamera,
    /// Photons were asked for and nothing in the scene emits.
    Dark,
    /// Photons cannot start on the surfaces of this scene.
    FirstShot(FirstShotError),
    /// No device.
    NoAdapter {
        /// What was looked for.
        wanted: String,
    },
    /// The device has too little of something.
    LimitExceeded {
        /// The resource.
        what: &'static str,
        /// How much was needed.
        asked: u64,
        /// How much there is.
        allowed: u64,
    },
    /// A probe is not usable.
    BadProbe {
        /// Its index.
        index: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A job's numbers make no sense.
    BadJob {
        /// What is wrong.
        reason: &'static str,
    },
    /// Slices passed to [`Backend::map`] do not fit the kernel.
    WrongLength {
        /// The kernel's name.
        kernel: &'static str,
        /// `constants`, `items` or `out`.
        slice: &'static str,
        /// Words found.
        found: usize,
        /// Words expected.
        expected: usize,
    },
    /// The film does not belong to the job.
    Film(FilmError),
    /// The control stopped the job; the film holds nothing of it.
    Cancelled,
}

impl fmt::Display for BackendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsupported { backend, what } => write!(f, "the {backend} backend does not support {what}"),
            Self::SceneNeeds { method, missing } => {
                write!(f, "the scene needs {missing}, which method `{method}` of this version does not carry")
            }
            Self::Dark => write!(f, "nothing in the scene emits light: there are no photons to start"),
            Self::FirstShot(e) => e.fmt(f),
            Self::NoCamera => write!(f, "the scene has no [camera], and an image needs one"),
            Self::NoAdapter { wanted } => write!(f, "no adapter found: {wanted}"),
            Self::LimitExceeded { what, asked, allowed } => {
                write!(f, "the job needs {asked} {what}, but only {allowed} are there")
            }
            Self::BadProbe { index, reason } => write!(f, "probe {index}: {reason}"),
            Self::BadJob { reason } => write!(f, "job: {reason}"),
            Self::WrongLength { kernel, slice, found, expected } => {
                write!(f, "kernel {kernel}: {slice} has {found} words, expected {expected}")
            }
            Self::Film(e) => e.fmt(f),
            Self::Cancelled => write!(f, "cancelled"),
        }
    }
}

impl core::error::Error for BackendError {}

impl From<FirstShotError> for BackendError {
    fn from(e: FirstShotError) -> Self {
        Self::FirstShot(e)
    }
}

impl From<FilmError> for BackendError {
    fn from(e: FilmError) -> Self {
        Self::Film(e)
    }
}

/// Something that computes.
pub trait Backend: Send + Sync {
    /// Who this is.
    fn info(&self) -> BackendInfo;

    /// What it can do.
    fn capabilities(&self) -> Capabilities;

    /// Makes a scene ready for jobs (builds trees, uploads buffers).
    ///
    /// # Errors
    /// When the backend or its device cannot hold the scene.
    fn open(&self, scene: Arc<CompiledScene>) -> Result<Box<dyn Session>, BackendError>;

    /// Evaluates one kernel over a batch: item i reads `items[i * n ..][.. n]` and writes `out[i * m ..][.. m]`, the
    /// word counts n and m being the kernel's own ([`Kernel::shape`]).
    ///
    /// # Errors
    /// When a slice has the wrong length or the backend has no such kernel.
    fn map(
        &self,
        kernel: Kernel,
        constants: &[u32],
        items: &[u32],
        out: &mut [u32],
    ) -> Result<(), BackendError>;
}

/// Progress out, cancellation in. Called from worker threads, a few hundred times a second at most.
pub trait Control: Sync {
    /// `done` of `total` units of the running job are finished. `Break` cancels it.
    fn advance(&self, done: u64, total: u64) -> ControlFlow<()>;
}

/// Neither watches nor cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoControl;

impl Control for NoControl {
    fn advance(&self, _done: u64, _total: u64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

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
        bidirectional::Settings { max_depth: path.max_depth, heuristic: *heuristic, only: *only }
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

    /// Whether ways from the sensor to the map have several lengths, by mirrors, Phong lobes or round shapes: then no one limit of the photons' arrivals makes
    /// a limit of all edges.
    pub fn ways_differ(scene: &CompiledScene) -> bool {
        scene.needs.beyond_diffuse() || scene.needs.round_shapes
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
            "a limit of depth needs a scene of diffuse surfaces without spheres and disks with method `photon`"
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

/// A scene that is ready for jobs.
pub trait Session: Send + Sync {
    /// The scene.
    fn scene(&self) -> &CompiledScene;

    /// Seconds that opening took, by stage (name, seconds).
    fn preparation(&self) -> &[(&'static str, f64)];

    /// The scene's surfaces divided into elements; a session may keep what it made last.
    fn elements(&self, settings: &ElementSettings) -> Arc<Elements> {
        Arc::new(Elements::new(self.scene(), *settings))
    }

    /// Path-traces an image into `film` (of [`image_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// When the scene needs more than surfaces, has no camera, the film does not fit, or the control cancels.
    fn path_image(
        &self,
        job: &PathJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError>;

    /// Path-traces the irradiance at probes into `film` (of [`probe_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// As for images; also when a probe is not finite or has no normal.
    fn path_probes(
        &self,
        job: &PathJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError>;

    /// Path-traces an image, with light of lights without size that is scattered once on its way to the camera summed along the camera's rays, into `film` (of [`image_film_settings`]). On an
    /// error the film is unchanged.
    ///
    /// # Errors
    /// As [`Self::path_image`]; also without nodes; or the backend has no such job.
    fn airlight_image(
        &self,
        job: &PathJob,
        single: SingleScatter,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, single, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "summed single scattering".into() })
    }

    /// Traces an image from both ends into `film` (of [`image_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// As [`Self::path_image`]; or the backend has no such job.
    fn bidirectional_image(
        &self,
        job: &BidirectionalJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "bidirectional path tracing".into() })
    }

    /// Traces the irradiance at probes from both ends into `film` (of [`probe_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// As [`Self::path_probes`]; or the backend has no such job.
    fn bidirectional_probes(
        &self,
        job: &BidirectionalJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, probes, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "bidirectional path tracing".into() })
    }

    /// What an illumination map as accurate as `photons` photons from the lights would make it costs from there and from surfaces; the same on every machine.
    ///
    /// # Errors
    /// As [`crate::transport::first_shot::forecast`], when the scene needs more than surfaces, or the backend has no photons.
    fn forecast(&self, subdivision: &Subdivision, photons: u64) -> Result<Forecast, BackendError> {
        let _ = (subdivision, photons);
        Err(BackendError::Unsupported { backend: "chosen", what: "illumination maps".into() })
    }

    /// Direct irradiance of lights without size on elements of the scene's surfaces, into `film` (of [`direct_film_settings`]); samples are
    /// points on each division of a primitive, with a shadow ray to each light. On an error the film is unchanged.
    ///
    /// # Errors
    /// When the scene needs more than surfaces, the film does not fit, the control cancels, or the backend has no such job.
    fn direct_irradiance(
        &self,
        job: &PathJob,
        elements: &ElementSettings,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, elements, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "illumination maps".into() })
    }

    /// Irradiance on elements of the scene's surfaces by photons, into `film` (of [`illumination_film_settings`]). On an error the
    /// film is unchanged.
    ///
    /// # Errors
    /// When the scene needs more than surfaces, nothing emits, the film does not fit, the control cancels, or the backend has no photons.
    fn illumination(
        &self,
        job: &PhotonJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "illumination maps".into() })
    }

    /// An image from maps of photons into `film` (of [`image_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// When the scene needs more than surfaces, has no camera, nothing emits, the job does not fit the scene ([`GatherJob::check`]), the film does not fit, the
    /// control cancels, or the backend has no photons.
    fn photon_image(
        &self,
        job: &GatherJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "images from illumination maps".into() })
    }

    /// The irradiance at probes from maps of photons into `film` (of [`probe_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// As for images but for the camera; also when a probe is not finite or has no normal, or without a final gather lies on no surface.
    fn photon_probes(
        &self,
        job: &GatherJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, probes, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "probes from illumination maps".into() })
    }

    /// An image from a map that is given: numbers per element ([`crate::transport::gather::MapView::all`]). Into `film` (of [`image_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// When the scene needs more than surfaces, has no camera, the map or the film does not fit, the control cancels, or the backend has no such job.
    fn map_image(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, map, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "images from illumination maps".into() })
    }

    /// The irradiance at probes from a map that is given, into `film` (of [`probe_film_settings`]). On an error the film is unchanged.
    ///
    /// # Errors
    /// As for images but for the camera; also when a probe is not finite or has no normal, or without a final gather lies on no surface.
    fn map_probes(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let _ = (job, map, probes, control, film);
        Err(BackendError::Unsupported { backend: "chosen", what: "probes from illumination maps".into() })
    }

    /// The scene as patches; see [`crate::radiosity::patches`].
    ///
    /// # Errors
    /// When surfaces are not all diffuse triangles, or the backend has no patches.
    fn patches(&self, settings: &PatchSettings) -> Result<PatchMap, BackendError> {
        let _ = settings;
        Err(BackendError::Unsupported { backend: "chosen", what: "patches".into() })
    }

    /// What the rays of patches meet, for the patches of the job's range, in their order.
    ///
    /// # Errors
    /// When the control cancels, or the backend has no patches.
    fn form_factors(
        &self,
        map: &PatchMap,
        job: &FormFactorJob,
        control: &dyn Control,
    ) -> Result<Vec<Row>, BackendError> {
        let _ = (map, job, control);
        Err(BackendError::Unsupported { backend: "chosen", what: "form factors".into() })
    }

    /// Form factors of single pairs of patches, in their order; see [`crate::radiosity::form_factors::near`].
    ///
    /// # Errors
    /// When the control cancels, or the backend has no patches.
    fn near_form_factors(
        &self,
        map: &PatchMap,
        pairs: &[[u32; 2]],
        settings: &NearSettings,
        control: &dyn Control,
    ) -> Result<Vec<NearPair>, BackendError> {
        let _ = (map, pairs, settings, control);
        Err(BackendError::Unsupported { backend: "chosen", what: "form factors of pairs".into() })
    }

    /// How numbers of patches become numbers of elements; see [`crate::radiosity::transfer`].
    ///
    /// # Errors
    /// When the backend has no patches.
    fn transfer(&self, map: &PatchMap) -> Result<Transfer, BackendError> {
        let _ = map;
        Err(BackendError::Unsupported { backend: "chosen", what: "patches".into() })
    }

    /// What tiles of form factors lose in each kind.
    fn rate_curves(&self, symmetric: &Symmetric<'_>) -> RateCurves {
        let n = symmetric.len();
        let row = |row| tiles::curve_row(n, row, |i, j| symmetric.entry(i, j));
        RateCurves::new((0..tiles::tile_rows(n)).map(row).collect())
    }

    /// Tiles of form factors, in the kinds that are wanted by row and column.
    ///
    /// # Errors
    /// Too many patches.
    fn tiles(
        &self,
        symmetric: &Symmetric<'_>,
        want: &(dyn Fn(usize, usize) -> Kind + Sync),
    ) -> Result<Tiles, TileError> {
        let n = symmetric.len();
        let row = |row| tiles::encode_row(n, row, |column| want(row, column), |i, j| symmetric.entry(i, j));
        tiles::join_rows(n, (0..tiles::tile_rows(n)).map(row))
    }

    /// Makes the second level of a relighter; see [`Relighter::with_coarse`].
    ///
    /// # Errors
    /// As there.
    fn with_coarse(&self, relighter: Relighter, rates: Rates) -> Result<Relighter, RelightError> {
        relighter.with_coarse(&polynomial::Portable, rates)
    }

    /// Indirect irradiance on patches; see [`Relighter::relight`], whose bits these are.
    ///
    /// # Errors
    /// Of numbers that do not fit.
    fn relight(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
        room: &mut Workspace,
    ) -> Result<(), RelightError> {
        relighter.relight(&polynomial::Portable, light, indirect, passes, room)
    }

    /// Form factors in texture blocks; see [`BlockOperator::encode`].
    ///
    /// # Errors
    /// As there.
    fn encode_blocks(
        &self,
        form_factors: &FormFactors,
        albedo: &[[f32; 3]],
        settings: &blocks::Settings<'_>,
    ) -> Result<BlockOperator, BlockError> {
        BlockOperator::encode(&polynomial::Portable, form_factors, albedo, settings)
    }

    /// Indirect light by texture blocks; see [`BlockOperator::relight`], whose bits these are.
    ///
    /// # Errors
    /// Of numbers that do not fit.
    fn relight_blocks(
        &self,
        operator: &BlockOperator,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        room: &mut blocks::Workspace,
    ) -> Result<(), BlockError> {
        operator.relight(&polynomial::Portable, light, indirect, room)
    }

    /// The same to convergence; see [`Relighter::converge`].
    ///
    /// # Errors
    /// As [`Self::relight`].
    fn converge(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        until: (u32, f64),
        room: &mut Workspace,
    ) -> Result<u32, RelightError> {
        relighter.converge(&polynomial::Portable, light, indirect, until, room)
    }
}

/// Settings of the film of a job of direct irradiance on this scene: one row of its elements.
pub fn direct_film_settings(scene: &CompiledScene, elements: &Elements, job: &PathJob) -> FilmSettings {
    film_settings(scene, job, elements.count().min(u32::MAX as usize) as u32, 1)
}

/// Settings of the film of an illumination map of this scene: one row of its elements.
///
/// # Errors
/// When nothing emits.
pub fn illumination_film_settings(
    scene: &CompiledScene,
    elements: &Elements,
    job: &PhotonJob,
) -> Result<FilmSettings, BackendError> {
    let plan = LightPlan::new(scene).map_err(|_| BackendError::Dark)?;
    Ok(illumination::film_settings(elements.count(), plan.total(), scene.area(), job.seed, job.photons))
}

/// The largest radiance, intensity or irradiance that a scene's lights state.
fn brightest(scene: &CompiledScene) -> f32 {
    scene.lights.iter().flat_map(|l| l.radiance).chain(scene.environment).fold(0.0_f32, |m, x| m.max(x))
}

/// Settings of the film of an image job on this scene.
///
/// # Errors
/// When the scene has no camera.
pub fn image_film_settings(scene: &CompiledScene, job: &PathJob) -> Result<FilmSettings, BackendError> {
    let camera = scene.camera.as_ref().ok_or(BackendError::NoCamera)?;
    Ok(film_settings(scene, job, camera.width, camera.height))
}

/// Settings of the film of a probe job on this scene: one row of probes.
pub fn probe_film_settings(scene: &CompiledScene, job: &PathJob, probes: usize) -> FilmSettings {
    film_settings(scene, job, probes.min(u32::MAX as usize) as u32, 1)
}

fn film_settings(scene: &CompiledScene, job: &PathJob, width: u32, height: u32) -> FilmSettings {
    FilmSettings {
        width,
        height,
        seed: job.seed,
        block_length: job.block_length,
        scale_exponent: scale_exponent(brightest(scene)),
    }
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
