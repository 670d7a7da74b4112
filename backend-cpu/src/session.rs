//! A scene with its tree, and the jobs on it.

use crate::bidirectional::{self, Place};
use crate::kept::Kept;
use crate::linear::Linear;
use crate::photons::{self, Photons, Target};
use crate::radiosity::Radiosity;
use crate::schedule::{image_chunks, run_blocks, single_chunks};
use crate::simd::widest;
use crate::tree::Tree;
use etendue_core::backend::{
    self, BackendError, BidirectionalJob, Control, FormFactorJob, GatherJob, GivenMap, JobStats, PathJob,
    PhotonJob, PhotonStart, Probe, Session,
};
use etendue_core::film::{Film, FilmSettings};
use etendue_core::illumination::{ElementSettings, Elements};
use etendue_core::medium::Inside;
use etendue_core::radiosity::blocks::{self, BlockError, BlockOperator};
use etendue_core::radiosity::form_factors::near::{NearPair, NearSettings};
use etendue_core::radiosity::form_factors::{FormFactors, Row};
use etendue_core::radiosity::patches::{PatchMap, PatchSettings};
use etendue_core::radiosity::relight::{RelightError, Relighter, Symmetric, Workspace};
use etendue_core::radiosity::tiles::{Kind, RateCurves, Rates, TileError, Tiles};
use etendue_core::radiosity::transfer::Transfer;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::first_shot::{self, FirstShot, FirstShotError, Forecast, Subdivision, Weights};
use etendue_core::transport::gather::{MapView, ProbePlace};
use etendue_core::transport::volume::{
    Airlight, LightMedia, SingleScatter, Surroundings, has_airlight, probe_starts,
};
use etendue_core::transport::{Paths, ProbeStart, TransportCode};
use etendue_core::with_tracer;
use std::convert::Infallible;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// A scene opened on the CPU.
#[derive(Debug)]
pub struct CpuSession {
    pool: Arc<rayon::ThreadPool>,
    scene: Arc<CompiledScene>,
    tree: Tree,
    preparation: Vec<(&'static str, f64)>,
    code: TransportCode,
    surroundings: Surroundings,
    /// What the lights send into, once it is asked for.
    media: OnceLock<LightMedia>,
    /// The last density of photons' starts that was asked for, and the last elements.
    shot: Kept<(Subdivision, Weights), FirstShot>,
    elements: Kept<ElementSettings, Elements>,
}

impl CpuSession {
    pub(crate) fn new(pool: Arc<rayon::ThreadPool>, scene: Arc<CompiledScene>) -> Result<Self, BackendError> {
        let start = Instant::now();
        let tree = Tree::build(&scene.primitives());
        let preparation = vec![("tree", start.elapsed().as_secs_f64())];
        let code = TransportCode::of(&scene.needs);
        let surroundings = Surroundings::of(&scene, &tree);
        Ok(Self {
            pool,
            scene,
            tree,
            preparation,
            code,
            surroundings,
            media: OnceLock::new(),
            shot: Kept::default(),
            elements: Kept::default(),
        })
    }

    /// The tree, for hosts that trace rays of their own.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Overrides the choice of code by [`TransportCode::of`]: to measure what a scene saves by it. The results are
    /// the same for any code that covers the scene.
    pub fn with_code(mut self, code: TransportCode) -> Self {
        self.code = code;
        self
    }

    /// The density from which photons start on surfaces; kept until another is asked for.
    ///
    /// # Errors
    /// [`FirstShotError`].
    pub fn first_shot(
        &self,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<Arc<FirstShot>, FirstShotError> {
        self.shot.get(&(*subdivision, weights), || Ok(self.make_first_shot(subdivision, weights)?.0))
    }

    /// The same, made anew; and the shadow rays that it took.
    ///
    /// # Errors
    /// [`FirstShotError`].
    pub fn make_first_shot(
        &self,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<(FirstShot, u64), FirstShotError> {
        let place = (&self.tree, self.media());
        self.pool.install(|| photons::first_shot(&self.scene, place, subdivision, weights))
    }

    fn radiosity(&self) -> Radiosity {
        Radiosity::on(Linear::on(self.pool.clone()))
    }

    fn media(&self) -> &LightMedia {
        self.media.get_or_init(|| LightMedia::new(&self.scene, &self.tree, self.surroundings.outside))
    }

    fn place(&self) -> Place<'_> {
        let (pool, scene, tree) = (&*self.pool, &*self.scene, &self.tree);
        Place { pool, scene, tree, code: self.code, surroundings: self.surroundings }
    }

    fn shot_of(&self, job: &PhotonJob) -> Result<Option<Arc<FirstShot>>, FirstShotError> {
        match &job.start {
            PhotonStart::Surfaces { subdivision, weights } => {
                self.first_shot(subdivision, *weights).map(Some)
            }
            PhotonStart::Lights { .. } => Ok(None),
        }
    }

    fn photons<'a>(
        &'a self,
        job: &'a PhotonJob,
        elements: &'a Elements,
        shot: Option<&'a FirstShot>,
    ) -> Photons<'a> {
        let (scene, tree, media) = (&*self.scene, &self.tree, self.media());
        Photons { scene, tree, media, camera: self.surroundings.camera, elements, code: self.code, job, shot }
    }

    fn gather(
        &self,
        job: &GatherJob,
        target: Target<'_>,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let maps = job.maps(target.edges());
        let elements = self.elements(&maps.elements);
        let shot = self.shot_of(&maps)?;
        let photons = self.photons(&maps, &elements, shot.as_deref());
        photons::gather(&self.pool, photons, job, target, control, film)
    }

    /// Probes on their surfaces. Without a final gather each needs one.
    fn places(&self, probes: &[Probe], gather: bool) -> Result<Vec<ProbePlace>, BackendError> {
        backend::place_probes((&self.scene, &self.tree), self.surroundings.outside, probes, gather)
    }

    fn read(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        target: Target<'_>,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let elements = self.elements(&map.elements);
        map.check(&elements)?;
        let view = MapView { elements: &elements, all: map.values, caustics: &[] };
        photons::read(
            &self.pool,
            (&self.scene, &self.tree, self.code),
            job,
            (&view, map.gather),
            target,
            control,
            film,
        )
    }

    /// Surfaces alone.
    fn check(&self, job: &PathJob, film: &Film, expected: &FilmSettings) -> Result<(), BackendError> {
        job.check()?;
        BackendError::unless_covered("radiosity", self.scene.needs.beyond_surfaces())?;
        Ok(film.check(expected)?)
    }

    /// What photons carry.
    fn check_photons(&self, film: &Film, expected: &FilmSettings) -> Result<(), BackendError> {
        BackendError::unless_covered("photon", self.scene.needs.beyond_photons())?;
        Ok(film.check(expected)?)
    }

    /// What paths carry.
    fn check_paths(&self, job: &PathJob, film: &Film, expected: &FilmSettings) -> Result<(), BackendError> {
        job.check()?;
        BackendError::unless_covered("path", self.scene.needs.beyond_paths())?;
        Ok(film.check(expected)?)
    }
}

widest! {
    /// [`Paths::pixel_block`] of a job.
    fn pixel_block[T: Paths](
        tracer: &T,
        tree: &Tree,
        pixel: [u32; 2],
        job: &PathJob,
        block: u32,
    ) -> ([f64; 3], u64) {
        tracer.pixel_block(tree, pixel, job.seed, block, job.block_length)
    }
}

widest! {
    /// [`Paths::probe_block`] of a job.
    fn probe_block[T: Paths](
        tracer: &T,
        tree: &Tree,
        probe: (u32, &ProbeStart),
        job: &PathJob,
        block: u32,
    ) -> ([f64; 3], u64) {
        tracer.probe_block(tree, probe, job.seed, block, job.block_length)
    }
}

impl Session for CpuSession {
    fn scene(&self) -> &CompiledScene {
        &self.scene
    }

    fn preparation(&self) -> &[(&'static str, f64)] {
        &self.preparation
    }

    fn elements(&self, settings: &ElementSettings) -> Arc<Elements> {
        let Ok(elements) =
            self.elements.get(settings, || Ok::<_, Infallible>(Elements::new(&self.scene, *settings)));
        elements
    }

    fn path_image(
        &self,
        job: &PathJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, job)?;
        self.check_paths(job, film, &expected)?;
        let chunks = image_chunks(expected.width, expected.height);
        let width = expected.width;
        let camera = self.surroundings.camera;
        with_tracer!(self.code, (&*self.scene, job.max_depth, camera), |tracer| {
            let mean = |element: u32, block: u32| {
                let pixel = [element % width, element / width];
                pixel_block(&tracer, &self.tree, pixel, job, block)
            };
            run_blocks(&self.pool, job, &chunks, mean, control, film)
        })
    }

    fn path_probes(
        &self,
        job: &PathJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, job, probes.len());
        self.check_paths(job, film, &expected)?;
        let probes = backend::check_probes(probes)?;
        let starts = probe_starts(&self.scene, &self.tree, self.surroundings.outside, &probes);
        let chunks = single_chunks(starts.len());
        with_tracer!(self.code, (&*self.scene, job.max_depth, Inside::NOTHING), |tracer| {
            let mean = |element: u32, block: u32| {
                probe_block(&tracer, &self.tree, (element, &starts[element as usize]), job, block)
            };
            run_blocks(&self.pool, job, &chunks, mean, control, film)
        })
    }

    fn airlight_image(
        &self,
        job: &PathJob,
        single: SingleScatter,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        single.check()?;
        if !has_airlight(&self.scene) {
            return self.path_image(job, control, film);
        }
        let expected = backend::image_film_settings(&self.scene, job)?;
        self.check_paths(job, film, &expected)?;
        let width = expected.width;
        // One instance: what a scene does not need costs little beside the rays of nodes.
        let tracer =
            Airlight::<true, true, true>::new(&self.scene, job.max_depth, self.surroundings.camera, single);
        let mean = |element: u32, block: u32| {
            let pixel = [element % width, element / width];
            pixel_block(&tracer, &self.tree, pixel, job, block)
        };
        let chunks = image_chunks(width, expected.height);
        run_blocks(&self.pool, job, &chunks, mean, control, film)
    }

    fn bidirectional_image(
        &self,
        job: &BidirectionalJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, &job.path)?;
        self.check_paths(&job.path, film, &expected)?;
        bidirectional::image(self.place(), job, control, film)
    }

    fn bidirectional_probes(
        &self,
        job: &BidirectionalJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, &job.path, probes.len());
        self.check_paths(&job.path, film, &expected)?;
        let probes = backend::check_probes(probes)?;
        let starts = probe_starts(&self.scene, &self.tree, self.surroundings.outside, &probes);
        bidirectional::probes(self.place(), job, &starts, control, film)
    }

    fn forecast(&self, subdivision: &Subdivision, photons: u64) -> Result<Forecast, BackendError> {
        BackendError::unless_covered("photon", self.scene.needs.beyond_photons())?;
        Ok(first_shot::forecast(&self.scene, (&self.tree, self.media()), subdivision, photons)?)
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
        job.check()?;
        self.check_photons(film, &expected)?;
        let place = (&*self.scene, &self.tree, self.media(), &*elements);
        photons::direct(&self.pool, place, job, control, film)
    }

    fn illumination(
        &self,
        job: &PhotonJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        job.check()?;
        let elements = self.elements(&job.elements);
        let expected = backend::illumination_film_settings(&self.scene, &elements, job)?;
        self.check_photons(film, &expected)?;
        let shot = self.shot_of(job)?;
        photons::run(&self.pool, self.photons(job, &elements, shot.as_deref()), control, film)
    }

    fn photon_image(
        &self,
        job: &GatherJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, &job.path)?;
        job.check(&self.scene)?;
        self.check_photons(film, &expected)?;
        let target = Target::Image { width: expected.width, height: expected.height };
        self.gather(job, target, control, film)
    }

    fn photon_probes(
        &self,
        job: &GatherJob,
        probes: &[Probe],
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::probe_film_settings(&self.scene, &job.path, probes.len());
        job.check(&self.scene)?;
        self.check_photons(film, &expected)?;
        let places = self.places(probes, job.gather)?;
        self.gather(job, Target::Probes(&places), control, film)
    }

    fn map_image(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        let expected = backend::image_film_settings(&self.scene, job)?;
        self.check(job, film, &expected)?;
        let target = Target::Image { width: expected.width, height: expected.height };
        self.read(job, map, target, control, film)
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
        self.check(job, film, &expected)?;
        let places = self.places(probes, map.gather)?;
        self.read(job, map, Target::Probes(&places), control, film)
    }

    fn patches(&self, settings: &PatchSettings) -> Result<PatchMap, BackendError> {
        let elements = self.elements(&settings.elements(&self.scene));
        self.radiosity().patches((&self.scene, &self.tree), elements, settings)
    }

    fn form_factors(
        &self,
        map: &PatchMap,
        job: &FormFactorJob,
        control: &dyn Control,
    ) -> Result<Vec<Row>, BackendError> {
        self.radiosity().form_factors((&self.scene, &self.tree), map, job, control)
    }

    fn near_form_factors(
        &self,
        map: &PatchMap,
        pairs: &[[u32; 2]],
        settings: &NearSettings,
        control: &dyn Control,
    ) -> Result<Vec<NearPair>, BackendError> {
        self.radiosity().near_form_factors((&self.scene, &self.tree), map, pairs, settings, control)
    }

    fn transfer(&self, map: &PatchMap) -> Result<Transfer, BackendError> {
        Ok(self.radiosity().transfer((&self.scene, &self.tree), map))
    }

    fn rate_curves(&self, symmetric: &Symmetric<'_>) -> RateCurves {
        self.radiosity().rate_curves(symmetric)
    }

    fn tiles(
        &self,
        symmetric: &Symmetric<'_>,
        want: &(dyn Fn(usize, usize) -> Kind + Sync),
    ) -> Result<Tiles, TileError> {
        self.radiosity().tiles(symmetric, want)
    }

    fn with_coarse(&self, relighter: Relighter, rates: Rates) -> Result<Relighter, RelightError> {
        relighter.with_coarse(&Linear::on(self.pool.clone()), rates)
    }

    fn encode_blocks(
        &self,
        form_factors: &FormFactors,
        albedo: &[[f32; 3]],
        settings: &blocks::Settings<'_>,
    ) -> Result<BlockOperator, BlockError> {
        BlockOperator::encode(&Linear::on(self.pool.clone()), form_factors, albedo, settings)
    }

    fn relight_blocks(
        &self,
        operator: &BlockOperator,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        room: &mut blocks::Workspace,
    ) -> Result<(), BlockError> {
        operator.relight(&Linear::on(self.pool.clone()), light, indirect, room)
    }

    fn relight(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        passes: u32,
        room: &mut Workspace,
    ) -> Result<(), RelightError> {
        relighter.relight(&Linear::on(self.pool.clone()), light, indirect, passes, room)
    }

    fn converge(
        &self,
        relighter: &Relighter,
        light: (&[[f32; 3]], &[[f32; 3]]),
        indirect: &mut [[f32; 3]],
        until: (u32, f64),
        room: &mut Workspace,
    ) -> Result<u32, RelightError> {
        relighter.converge(&Linear::on(self.pool.clone()), light, indirect, until, room)
    }
}
