//! The boundary to backends: whole jobs over slices, nothing virtual per ray.
//!
//! A [`Backend`] opens a compiled scene as a [`Session`]; a session runs jobs. Every job names its range of sample
//! blocks, so that a job can be split anywhere and its films merged in any order to the same bits. Backends also
//! evaluate single numeric kernels over batches ([`Backend::map`]): the door through which the conformance suite
//! reaches their math.

mod error;
mod film;
mod job;

pub use error::BackendError;
pub use film::{direct_film_settings, illumination_film_settings, image_film_settings, probe_film_settings};
pub use job::{
    BidirectionalJob, FormFactorJob, GatherJob, GivenMap, JobStats, PathJob, PhotonJob, PhotonStart, Probe,
    check_probes, place_probes,
};

use crate::film::Film;
use crate::illumination::{ElementSettings, Elements};
use crate::kernel::Kernel;
use crate::radiosity::blocks::{self, BlockError, BlockOperator};
use crate::radiosity::form_factors::near::{NearPair, NearSettings};
use crate::radiosity::form_factors::{FormFactors, Row};
use crate::radiosity::patches::{PatchMap, PatchSettings};
use crate::radiosity::polynomial;
use crate::radiosity::relight::{RelightError, Relighter, Symmetric, Workspace};
use crate::radiosity::tiles::{self, Kind, RateCurves, Rates, TileError, Tiles};
use crate::radiosity::transfer::Transfer;
use crate::scene::CompiledScene;
use crate::transport::first_shot::{Forecast, Subdivision};
use crate::transport::volume::SingleScatter;
use alloc::boxed::Box;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::ControlFlow;

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

/// How a backend's float operations round, and so how near its numbers must come to the scalar reference's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arithmetic {
    /// As IEEE 754 has it, one after the other as written: the reference's bits.
    Ieee,
    /// The same, but that numbers below 2^-126 are zero.
    FlushesSubnormals,
    /// Otherwise: quotients and roots with errors, products fused, sums reordered. Near, but not equal.
    #[default]
    Loose,
}

impl Arithmetic {
    /// In words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Ieee => "IEEE 754",
            Self::FlushesSubnormals => "IEEE 754 without subnormal numbers",
            Self::Loose => "rounded otherwise than by IEEE 754",
        }
    }
}

/// What a backend can do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capabilities {
    /// Path-traced images and probes.
    pub path: bool,
    /// The same by bidirectional path tracing.
    pub bidirectional: bool,
    /// All of these through media, and boundaries that light passes ([`crate::scene::SceneNeeds::volume`]).
    pub volume: bool,
    /// [`Backend::map`] for every [`Kernel`].
    pub kernels: bool,
}

/// Something that computes.
pub trait Backend: Send + Sync {
    /// Who this is.
    fn info(&self) -> BackendInfo;

    /// What it can do.
    fn capabilities(&self) -> Capabilities;

    /// How its float operations round. It may try some of them to know, and wait for its device. By default nothing is promised.
    fn arithmetic(&self) -> Arithmetic {
        Arithmetic::Loose
    }

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
