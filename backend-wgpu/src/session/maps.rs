//! Jobs of photons and of their maps.

use super::WgpuSession;
use super::gather::{Map, Target, blocks};
use super::photons::PhotonTask;
use super::task::Task as _;
use crate::gpu::Gpu;
use etendue_core::backend::{
    self, BackendError, Control, GatherJob, GivenMap, JobStats, PathJob, PhotonJob, PhotonStart, Probe,
    Session as _,
};
use etendue_core::film::{Film, FilmSettings};
use etendue_core::illumination::Elements;
use etendue_core::transport::first_shot::FirstShot;
use etendue_core::transport::gather::ProbePlace;
use etendue_core::transport::volume::LightMedia;
use std::sync::Arc;

impl WgpuSession {
    /// An illumination map as a task that never waits.
    ///
    /// # Errors
    /// As [`backend::Session::illumination`].
    pub fn illumination_task(&self, job: &PhotonJob) -> Result<PhotonTask, BackendError> {
        job.check()?;
        let elements = self.elements(&job.elements);
        let settings = backend::illumination_film_settings(&self.scene, &elements, job)?;
        self.check_photons()?;
        let shot = self.shot_of(job)?;
        self.photons(&self.source.gpu(), (job, shot.as_deref()), &elements, false, &settings)
    }

    pub(super) fn media(&self) -> &LightMedia {
        self.media.get_or_init(|| LightMedia::new(&self.scene, &self.tree, self.surroundings.outside))
    }

    /// The density of a job that starts on surfaces.
    fn shot_of(&self, job: &PhotonJob) -> Result<Option<Arc<FirstShot>>, BackendError> {
        let PhotonStart::Surfaces { subdivision, weights } = job.start else { return Ok(None) };
        let make = || self.make_first_shot(&subdivision, weights);
        self.shot.get(&(subdivision, weights), make).map(Some)
    }

    fn photons(
        &self,
        gpu: &Arc<Gpu>,
        (job, shot): (&PhotonJob, Option<&FirstShot>),
        elements: &Arc<Elements>,
        caustics: bool,
        settings: &FilmSettings,
    ) -> Result<PhotonTask, BackendError> {
        let (buffers, elements) =
            (self.buffers(gpu)?, self.elements.on(gpu, (&self.scene, self.media()), elements)?);
        let film = Film::new(*settings);
        PhotonTask::new(gpu, (&self.scene, self.media()), &buffers, elements, (job, shot), caustics, film)
    }

    pub(super) fn illuminate(
        &self,
        job: &PhotonJob,
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        job.check()?;
        let elements = self.elements(&job.elements);
        let expected = backend::illumination_film_settings(&self.scene, &elements, job)?;
        self.check_photons()?;
        film.check(&expected)?;
        let shot = self.shot_of(job)?;
        let (part, stats) = self.source.run(|gpu| {
            self.photons(gpu, (job, shot.as_deref()), &elements, false, &expected)?.drive(control)
        })?;
        film.merge(&part)?;
        Ok(stats)
    }

    /// What photons carry.
    pub(super) fn check_photons(&self) -> Result<(), BackendError> {
        BackendError::unless_covered("photon", self.scene.needs.beyond_photons())
    }

    pub(super) fn image_target(&self, width: u32) -> Target<'static> {
        Target::Image { width, inside: self.surroundings.camera }
    }

    /// Probes on their surfaces. Without a final gather each needs one.
    pub(super) fn places(&self, probes: &[Probe], gather: bool) -> Result<Vec<ProbePlace>, BackendError> {
        backend::place_probes((&self.scene, &self.tree), self.surroundings.outside, probes, gather)
    }

    /// An image or probes, by maps of the job's own photons.
    pub(super) fn gather(
        &self,
        job: &GatherJob,
        (expected, target): (&FilmSettings, Target<'_>),
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        job.check(&self.scene)?;
        self.check_photons()?;
        film.check(expected)?;
        let maps = job.maps(target.edges());
        let elements = self.elements(&maps.elements);
        let settings = backend::illumination_film_settings(&self.scene, &elements, &maps)?;
        let shot = self.shot_of(&maps)?;
        let needs = &self.scene.needs;
        // Only where rays gather they are needed apart: what is read itself has them in the map.
        let sent_on = needs.mirrors || needs.refraction || needs.panes;
        let caustics = (job.gather || needs.round_shapes) && sent_on && needs.point_like_lights;
        let (part, stats) = self.source.run(|gpu| {
            let (buffers, on_device) =
                (self.buffers(gpu)?, self.elements.on(gpu, (&self.scene, self.media()), &elements)?);
            blocks(
                &job.path,
                u64::from(job.photons),
                control,
                Film::new(*expected),
                |block, control| {
                    let one = PhotonJob { replicates: block..block + 1, ..maps.clone() };
                    let task = self.photons(gpu, (&one, shot.as_deref()), &elements, caustics, &settings)?;
                    Ok(task.drive_all(control)?.finish_values())
                },
                |values, one, control, film| {
                    let (all, caustics) = values.split_at(elements.count().min(values.len()));
                    let map = Map { elements: on_device.clone(), all, caustics, gather: job.gather };
                    map.read(gpu, (&self.scene, &buffers), one, target, control, film)
                },
            )
        })?;
        film.merge(&part)?;
        Ok(stats)
    }

    /// An image or probes, from a map that is given.
    pub(super) fn read(
        &self,
        job: &PathJob,
        map: &GivenMap<'_>,
        (expected, target): (&FilmSettings, Target<'_>),
        control: &dyn Control,
        film: &mut Film,
    ) -> Result<JobStats, BackendError> {
        job.check()?;
        BackendError::unless_covered("radiosity", self.scene.needs.beyond_surfaces())?;
        film.check(expected)?;
        let elements = self.elements(&map.elements);
        map.check(&elements)?;
        let (part, stats) = self.source.run(|gpu| {
            let (buffers, elements) =
                (self.buffers(gpu)?, self.elements.on(gpu, (&self.scene, self.media()), &elements)?);
            let map = Map { elements, all: map.values, caustics: &[], gather: map.gather };
            map.read(gpu, (&self.scene, &buffers), job, target, control, Film::new(*expected))
        })?;
        film.merge(&part)?;
        Ok(stats)
    }
}
