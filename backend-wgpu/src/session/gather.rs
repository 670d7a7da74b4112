//! Images and probes from maps: what the shaders read beside the scene, and for each block of samples one map, then all pixels or probes from it.

use super::elements::ElementBuffers;
use super::path::PathTask;
use super::scene::SceneBuffers;
use super::task::{Portion, Task as _};
use super::wave::{Behind, Form, PathStart};
use crate::gpu::Gpu;
use etendue_core::backend::{BackendError, Control, JobStats, PathJob};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, Sides};
use etendue_core::medium::Inside;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::ProbeStart;
use etendue_core::transport::gather::{GatherLights, ProbePlace};
use std::sync::Arc;

/// Words of the head of what lies behind the states.
const HEAD: usize = 16;

/// Where light is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target<'a> {
    /// At the pixels of the camera, which stands in this.
    Image {
        width: u32,
        inside: Inside,
    },
    Probes(&'a [ProbePlace]),
}

impl Target<'_> {
    /// Edges from the sensor to the first surface.
    pub(super) fn edges(self) -> u32 {
        match self {
            Self::Image { .. } => 1,
            Self::Probes(_) => 0,
        }
    }

    fn start(self) -> PathStart {
        match self {
            Self::Image { width, inside } => PathStart::Image { width, inside },
            Self::Probes(places) => {
                let start =
                    |p: &ProbePlace| ProbeStart { point: p.point, normal: p.normal, inside: p.inside };
                PathStart::Probes(places.iter().map(start).collect())
            }
        }
    }
}

/// A map on its way to the device.
#[derive(Clone, Debug)]
pub(super) struct Map<'a> {
    pub(super) elements: Arc<ElementBuffers>,
    /// Irradiance \[W/m^2\] of each element.
    pub(super) all: &'a [[f32; 3]],
    /// Of it, what came from lights without size by mirrors alone; may be empty.
    pub(super) caustics: &'a [[f32; 3]],
    /// Whether the first diffuse surface gathers its light by rays.
    pub(super) gather: bool,
}

impl Map<'_> {
    /// What shaders read of it, as `wavefront/gather.wgsl` has it.
    fn behind(&self, scene: &CompiledScene, job: &PathJob, target: Target<'_>) -> Behind {
        let lights = GatherLights::new(scene);
        let lights = lights.parts();
        let settings = self.elements.elements.settings();
        let mut words = vec![0; HEAD + self.elements.word_count as usize];
        let add = |words: &mut Vec<u32>, more: &[u32]| {
            let at = words.len() as u32;
            words.extend(more);
            at
        };
        let mut choice = |(list, counts): (&[u32], &[u32])| {
            // Lights whose weights have no counts are never picked.
            let at = add(&mut words, list);
            [at, list.len() as u32, add(&mut words, counts)]
        };
        let (point_like, surfaces) = (choice(lights.point_like), choice(lights.surfaces));
        let surfaces = if lights.surfaces.1.is_empty() { [0; 3] } else { surfaces };
        let mut values = |of: &[[f32; 3]]| add(&mut words, bytemuck::cast_slice(of));
        let (all, caustics) = (values(self.all), values(self.caustics));
        let probes = words.len();
        let is_near = job.max_depth == u32::MAX && settings.largest.is_finite() && self.gather;
        let flags = [
            settings.basis == Basis::Linear,
            settings.sides == Sides::Apart,
            self.gather,
            !self.caustics.is_empty(),
        ];
        let mut once = false;
        if let Target::Probes(places) = target {
            once = true;
            words.extend(places.iter().flat_map(|p| probe_words(scene, p, self.gather)));
        }
        let [p, s] = [point_like, surfaces];
        let head = [
            HEAD as u32,
            self.elements.nodes,
            self.elements.elements.per_side() as u32,
            flags.iter().zip(0..).map(|(f, i)| u32::from(*f) << i).sum(),
            if is_near { settings.largest.to_bits() } else { 0 },
            all,
            caustics,
            p[0],
            p[1],
            p[2],
            s[0],
            s[1],
            s[2],
            lights.surface_share.to_bits(),
            job.block_length + u32::from(once),
            0,
        ];
        words[..HEAD].copy_from_slice(&head);
        Behind { words, probes, elements: Some((HEAD, self.elements.clone())), once }
    }

    /// Reads the map in blocks of samples.
    pub(super) fn read(
        &self,
        gpu: &Arc<Gpu>,
        (scene, buffers): (&CompiledScene, &SceneBuffers),
        job: &PathJob,
        target: Target<'_>,
        control: &dyn Control,
        film: Film,
    ) -> Result<(Film, JobStats), BackendError> {
        let behind = self.behind(scene, job, target);
        let form = (Form::gather(scene), target.start(), behind);
        PathTask::with(gpu, scene, buffers, job, form, film)?.drive(control)
    }
}

/// Point and extent, normal, nothing, the hit, bits, what it lies in, nothing.
fn probe_words(scene: &CompiledScene, place: &ProbePlace, gather: bool) -> [u32; 16] {
    let [x, y, z] = place.point.position.to_array().map(f32::to_bits);
    let [nx, ny, nz] = place.normal.to_array().map(f32::to_bits);
    let (hit, front) = place
        .hit
        .map_or(([0; 3], false), |(hit, front)| ([hit.primitive, hit.b1.to_bits(), hit.b2.to_bits()], front));
    let is_round = place.hit.is_some_and(|(hit, _)| hit.primitive as usize >= scene.triangles.len());
    let bits = u32::from(place.hit.is_some()) | u32::from(front) << 1 | u32::from(gather || is_round) << 2;
    let [primitive, b1, b2] = hit;
    let [m0, m1, m2] = place.inside.packed();
    [x, y, z, place.point.extent.to_bits(), nx, ny, nz, 0, primitive, b1, b2, bits, m0, m1, m2, 0]
}

/// The maps of a job's blocks, one after another, each read in its block.
pub(super) fn blocks(
    job: &PathJob,
    photons: u64,
    control: &dyn Control,
    film: Film,
    mut photons_of: impl FnMut(u32, &dyn Control) -> Result<(Vec<[f32; 3]>, JobStats), BackendError>,
    mut read: impl FnMut(&[[f32; 3]], &PathJob, &dyn Control, Film) -> Result<(Film, JobStats), BackendError>,
) -> Result<(Film, JobStats), BackendError> {
    let (mut film, mut stats) = (film, JobStats::default());
    let samples = film.len() as u64 * u64::from(job.block_length);
    let all = u64::from(job.blocks.end - job.blocks.start) * (photons + samples);
    for (done, block) in (0_u64..).zip(job.blocks.clone()) {
        let before = done * (photons + samples);
        let walking = Portion { control, before, factor: 1, all };
        let (values, took) = photons_of(block, &walking)?;
        stats += JobStats { paths: 0, ..took };
        let factor = u64::from(job.block_length);
        let reading = Portion { control, before: before + photons, factor, all };
        let one = PathJob { blocks: block..block + 1, ..job.clone() };
        let took;
        (film, took) = read(&values, &one, &reading, film)?;
        stats += took;
    }
    Ok((film, stats))
}
