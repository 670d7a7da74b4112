//! A scene on a device, and the jobs on it.

mod bidirectional;
mod direct;
mod elements;
mod features;
mod gather;
mod maps;
mod path;
mod photons;
mod pieces;
mod reach;
mod rows;
mod scene;
mod task;
mod wave;

#[cfg(test)]
pub(crate) use scene::OFFSETS;

pub use direct::DirectTask;
pub use path::PathTask;
pub use photons::PhotonTask;
pub use pieces::FirstShotTask;
pub(crate) use scene::SceneBuffers;
pub use task::Step;
pub(crate) use wave::{Estimator, PathStart};

use crate::gpu::{Gpu, Source};
use crate::relight::Prepared;
use bidirectional::BothEnds;
use elements::KeptElements;
use etendue_core::backend::{
    self, BackendError, BidirectionalJob, Control, FormFactorJob, GatherJob, GivenMap, JobStats, PathJob,
    PhotonJob, Probe, Session, check_probes,
};
use etendue_core::film::{Film, FilmSettings};
use etendue_core::illumination::{ElementSettings, Elements};
use etendue_core::radiosity::blocks::{self, BlockError, BlockOperator};
use etendue_core::radiosity::form_factors::near::{NearPair, NearSettings};
use etendue_core::radiosity::form_factors::reach::Walks;
use etendue_core::radiosity::form_factors::{FormFactors, Row};
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::radiosity::relight::{RelightError, Relighter, Symmetric, Workspace};
use etendue_core::radiosity::tiles::{Kind, RateCurves, Rates, TileError, Tiles};
use etendue_core::radiosity::transfer::Transfer;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::first_shot::{self, FirstShot, Forecast, Subdivision, Weights};
use etendue_core::transport::volume::{LightMedia, SingleScatter, Surroundings, has_airlight, probe_starts};
use etendue_cpu::{Kept, Radiosity};
use etendue_tree::WideTree;
use gather::Target;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;
use task::Task as _;

/// A scene opened on a device. Its buffers are sent once, and again only to a device that replaces a lost one.
#[derive(Debug)]
pub struct WgpuSession {
    source: Arc<Source>,
    scene: Arc<CompiledScene>,
    tree: WideTree,
    surroundings: Surroundings,
    preparation: Vec<(&'static str, f64)>,
    sent: Mutex<Option<(Arc<Gpu>, Arc<SceneBuffers>)>>,
    elements: KeptElements,
    /// What the lights send into, once it is asked for.
    media: OnceLock<LightMedia>,
    /// The density of photons' starts that was asked for last.
    shot: Kept<(Subdivision, Weights), FirstShot>,
    operators: Prepared,
    /// What of a bake the host does.
    host: Radiosity,
}

impl WgpuSession {
    pub(crate) fn new(source: Arc<Source>, scene: Arc<CompiledScene>) -> Result<Self, BackendError> {
        let start = Instant::now();
        let tree = WideTree::build(&scene.primitives());
        let built = start.elapsed().as_secs_f64();
        let surroundings = Surroundings::of(&scene, &tree);
        let mut session = Self {
            source,
            scene,
            tree,
            surroundings,
            preparation: Vec::new(),
            elements: KeptElements::default(),
            media: OnceLock::new(),
            shot: Kept::default(),
            sent: Mutex::new(None),
            operators: Prepared::default(),
            host: Radiosity::default(),
        };
        let start = Instant::now();
        session.source.clone().run(|gpu| session.buffers(gpu))?;
        session.preparation = vec![("tree", built), ("upload", start.elapsed().as_secs_f64())];
        Ok(session)
    }

    /// The scene's buffers on this device.
    fn buffers(&self, gpu: &Arc<Gpu>) -> Result<Arc<SceneBuffers>, BackendError> {
        let mut sent = self.sent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, buffers)) = &*sent
            && Arc::ptr_eq(of, gpu)
        {
            return Ok(buffers.clone());
        }
        let buffers = Arc::new(SceneBuffers::new(gpu, &self.scene, &self.tree)?);
        *sent = Some((gpu.clone(), buffers.clone()));
        Ok(buffers)
    }

    fn task(
        &self,
        gpu: &Arc<Gpu>,
        job: (&PathJob, &Estimator),
        start: PathStart,
        settings: &FilmSettings,
    ) -> Result<PathTask, BackendError> {
        let buffers = self.buffers(gpu)?;
        PathTask::new(gpu, &self.scene, &buffers, job, start, Film::new(*settings))
    }

    fn both_ends(&self, job: &BidirectionalJob) -> Estimator {
        let media = LightMedia::new(&self.scene, &self.tree, self.surroundings.outside);
        Estimator::BothEnds(BothEnds::new(job, &self.scene, &media))
    }

    /// What the walk cannot see in two edges, or there is none of, is not summed.
    fn airlight(&self, job: &PathJob, single: SingleScatter) -> Result<Estimator, BackendError> {
        single.check()?;
        let any = job.max_depth >= 2 && has_airlight(&self.scene);
        Ok(if any { Estimator::Airlight(single) } else { Estimator::Path })
    }

    /// An image as a task that never waits; [`PathTask::step`] drives it, within a host's frame loop say.
    ///
    /// # Errors
    /// As [`Session::path_image`].
    pub fn path_image_task(&self, job: &PathJob) -> Result<PathTask, BackendError> {
        let settings = backend::image_film_settings(&self.scene, job)?;
        self.check_paths(job)?;
        self.task(&self.source.gpu(), (job, &Estimator::Path), self.image(settings.width), &settings)
    }

    /// An image with summed airlight as a task that never waits.
    ///
    /// # Errors
    /// As [`Session::airlight_image`].
    pub fn airlight_image_task(
        &self,
        job: &PathJob,
        single: SingleScatter,
    ) -> Result<PathTask, BackendError> {
        let estimator = self.airlight(job, single)?;
        let settings = backend::image_film_settings(&self.scene, job)?;
        self.check_paths(job)?;
        self.task(&self.source.gpu(), (job, &estimator), self.image(settings.width), &settings)
    }

    /// Probes as a task that never waits.
    ///
    /// # Errors
    /// As [`Session::path_probes`].
    pub fn path_probes_task(&self, job: &PathJob, probes: &[Probe]) -> Result<PathTask, BackendError> {
        let settings = backend::probe_film_settings(&self.scene, job, probes.len());
        self.check_paths(job)?;
        self.task(&self.source.gpu(), (job, &Estimator::Path), self.probes(probes)?, &settings)
    }

    /// An image from both ends as a task that never waits.
    ///
    /// # Errors
    /// As [`Session::bidirectional_image`].
    pub fn bidirectional_image_task(&self, job: &BidirectionalJob) -> Result<PathTask, BackendError> {
        let settings = backend::image_film_settings(&self.scene, &job.path)?;
        self.check_paths(&job.path)?;
        let estimator = self.both_ends(job);
        self.task(&self.source.gpu(), (&job.path, &estimator), self.image(settings.width), &settings)
    }

    /// Probes from both ends as a task that never waits.
    ///
    /// # Errors
    /// As [`Session::bidirectional_probes`].
    pub fn bidirectional_probes_task(
        &self,
        job: &BidirectionalJob,
        probes: &[Probe],
    ) -> Result<PathTask, BackendError> {
        let settings = backend::probe_film_settings(&self.scene, &job.path, probes.len());
        self.check_paths(&job.path)?;
        let estimator = self.both_ends(job);
        self.task(&self.source.gpu(), (&job.path, &estimator), self.probes(probes)?, &settings)
    }

    fn image(&self, width: u32) -> PathStart {
        PathStart::Image { width, inside: self.surroundings.camera }
    }

    fn probes(&self, probes: &[Probe]) -> Result<PathStart, BackendError> {
        let probes = check_probes(probes)?;
        Ok(PathStart::Probes(probe_starts(&self.scene, &self.tree, self.surroundings.outside, &probes)))
    }

    /// What paths carry.
    fn check_paths(&self, job: &PathJob) -> Result<(), BackendError> {
        job.check()?;
        BackendError::unless_covered("path", self.scene.needs.beyond_paths())
    }

    fn run(
        &self,
        job: (&PathJob, &Estimator),
        start: &PathStart,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let (part, stats) =
            self.source.run(|gpu| self.task(gpu, job, start.clone(), film.settings())?.drive(control))?;
        film.merge(&part)?;
        Ok(stats)
    }
}

impl Session for WgpuSession {
    fn scene(&self) -> &CompiledScene {
        &self.scene
    }

    fn preparation(&self) -> &[(&'static str, f64)] {
        &self.preparation
    }

    fn elements(&self, settings: &ElementSettings) -> Arc<Elements> {
        self.elements.of(&self.scene, settings)
    }

    fn path_image(
        &self,
        job: &PathJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, job)?;
        self.check_paths(job)?;
        film.check(&expected)?;
        self.run((job, &Estimator::Path), &self.image(expected.width), control, film)
    }

    fn path_probes(
        &self,
        job: &PathJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, job, probes.len());
        self.check_paths(job)?;
        film.check(&expected)?;
        self.run((job, &Estimator::Path), &self.probes(probes)?, control, film)
    }

    fn airlight_image(
        &self,
        job: &PathJob,
        single: SingleScatter,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let estimator = self.airlight(job, single)?;
        let expected = backend::image_film_settings(&self.scene, job)?;
        self.check_paths(job)?;
        film.check(&expected)?;
        self.run((job, &estimator), &self.image(expected.width), control, film)
    }

    fn bidirectional_image(
        &self,
        job: &BidirectionalJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, &job.path)?;
        self.check_paths(&job.path)?;
        film.check(&expected)?;
        let estimator = self.both_ends(job);
        self.run((&job.path, &estimator), &self.image(expected.width), control, film)
    }

    fn bidirectional_probes(
        &self,
        job: &BidirectionalJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, &job.path, probes.len());
        self.check_paths(&job.path)?;
        film.check(&expected)?;
        let estimator = self.both_ends(job);
        self.run((&job.path, &estimator), &self.probes(probes)?, control, film)
    }

    fn direct_irradiance(
        &self,
        job: &PathJob,
        elements: &ElementSettings,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let elements = self.elements(elements);
        let expected = backend::direct_film_settings(&self.scene, &elements, job);
        self.check_direct(job)?;
        film.check(&expected)?;
        let (part, stats) =
            self.source.run(|gpu| self.direct(gpu, job, &elements, &expected)?.drive(control))?;
        film.merge(&part)?;
        Ok(stats)
    }

    fn forecast(&self, subdivision: &Subdivision, photons: u64) -> Result<Forecast, BackendError> {
        self.check_photons()?;
        // A few thousand photons, once: the host's tree is at hand.
        Ok(first_shot::forecast(&self.scene, (&self.tree, self.media()), subdivision, photons)?)
    }

    fn illumination(
        &self,
        job: &PhotonJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        self.illuminate(job, control, film)
    }

    fn photon_image(
        &self,
        job: &GatherJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, &job.path)?;
        self.gather(job, (&expected, self.image_target(expected.width)), control, film)
    }

    fn photon_probes(
        &self,
        job: &GatherJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, &job.path, probes.len());
        let places = self.places(probes, job.gather)?;
        self.gather(job, (&expected, Target::Probes(&places)), control, film)
    }

    fn map_image(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, job)?;
        self.read(job, map, (&expected, self.image_target(expected.width)), control, film)
    }

    fn map_probes(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, job, probes.len());
        let places = self.places(probes, map.gather)?;
        self.read(job, map, (&expected, Target::Probes(&places)), control, film)
    }

    fn patches(&self, settings: &PatchSettings) -> Result<PatchMap, BackendError> {
        let elements = self.elements(&settings.elements(&self.scene));
        let walker = |walks: &Walks, reached: &[AtomicBool]| {
            self.source.run(|gpu| {
                let buffers = self.buffers(gpu)?;
                reach::walk(gpu, &self.scene, &buffers, &elements, walks, reached)
            })
        };
        self.host.patches_by((&self.scene, &self.tree), elements.clone(), settings, &walker)
    }

    fn form_factors(
        &self,
        map: &PatchMap,
        job: &FormFactorJob,
        control: &dyn Control,
    ) -> Result<Vec<Row>, BackendError> {
        self.source.run(|gpu| {
            let buffers = self.buffers(gpu)?;
            rows::form_factors(gpu, &self.scene, &buffers, map, job, control)
        })
    }

    fn near_form_factors(
        &self,
        map: &PatchMap,
        pairs: &[[u32; 2]],
        settings: &NearSettings,
        control: &dyn Control,
    ) -> Result<Vec<NearPair>, BackendError> {
        self.host.near_form_factors((&self.scene, &self.tree), map, pairs, settings, control)
    }

    fn transfer(&self, map: &PatchMap) -> Result<Transfer, BackendError> {
        Ok(self.host.transfer((&self.scene, &self.tree), map))
    }

    fn rate_curves(&self, symmetric: &Symmetric<'_>) -> RateCurves {
        self.host.rate_curves(symmetric)
    }

    fn tiles(
        &self,
        symmetric: &Symmetric<'_>,
        want: &(dyn Fn(usize, usize) -> Kind + Sync),
    ) -> Result<Tiles, TileError> {
        self.host.tiles(symmetric, want)
    }

    fn with_coarse(&self, relighter: Relighter, rates: Rates) -> Result<Relighter, RelightError> {
        relighter.with_coarse(self.host.linear(), rates)
    }

    fn encode_blocks(
        &self,
        form_factors: &FormFactors,
        albedo: &[[f32; 3]],
        settings: &blocks::Settings<'_>,
    ) -> Result<BlockOperator, BlockError> {
        BlockOperator::encode(self.host.linear(), form_factors, albedo, settings)
    }

    fn relight(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
        _room: &mut Workspace,
    ) -> Result<(), RelightError> {
        self.operators.relight(&self.source, relighter, light, indirect, passes)
    }

    fn converge(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        until: (u32, f64),
        _room: &mut Workspace,
    ) -> Result<u32, RelightError> {
        self.operators.converge(&self.source, relighter, light, indirect, until)
    }

    fn relight_blocks(
        &self,
        operator: &BlockOperator,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        _room: &mut blocks::Workspace,
    ) -> Result<(), BlockError> {
        self.operators.relight_blocks(&self.source, operator, light, indirect)
    }
}
