//! Direct irradiance on the device: places in small submissions, and sums of a block in fixed point, which the host reads.

use super::WgpuSession;
use super::elements::ElementBuffers;
use super::features;
use super::scene::{OFFSETS, SceneBuffers};
use super::task::{Pace, Step, Task, WORKGROUP, bindings};
use crate::gpu::{Binding, Buffer, Gpu, Pending, Pipeline, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::{self, BackendError, JobStats, PathJob, Session as _};
use etendue_core::direct::irradiance::flux_unit;
use etendue_core::film::{Film, FilmSettings};
use etendue_core::illumination::{Basis, ElementSettings, Elements, FluxUnit, Sides};
use etendue_core::scene::CompiledScene;
use std::sync::Arc;
use std::time::Instant;

/// Words before the sums of elements, and of each element.
const HEAD: u64 = 4;
const SUMS: u64 = 6;
/// Shadow rays of the first submission.
const FIRST: u64 = 1 << 14;

impl WgpuSession {
    /// Direct irradiance as a task that never waits.
    ///
    /// # Errors
    /// As [`backend::Session::direct_irradiance`].
    pub fn direct_task(&self, job: &PathJob, elements: &ElementSettings) -> Result<DirectTask, BackendError> {
        let elements = self.elements(elements);
        let settings = backend::direct_film_settings(&self.scene, &elements, job);
        self.check_direct(job)?;
        self.direct(&self.source.gpu(), job, &elements, &settings)
    }

    pub(super) fn direct(
        &self,
        gpu: &Arc<Gpu>,
        job: &PathJob,
        elements: &Arc<Elements>,
        settings: &FilmSettings,
    ) -> Result<DirectTask, BackendError> {
        let (buffers, elements) =
            (self.buffers(gpu)?, self.elements.on(gpu, (&self.scene, self.media()), elements)?);
        DirectTask::new(gpu, &self.scene, &buffers, elements, job, Film::new(*settings))
    }

    pub(super) fn check_direct(&self, job: &PathJob) -> Result<(), BackendError> {
        job.check()?;
        self.check_photons()
    }
}

/// What is left to be read.
#[derive(Debug)]
struct Running {
    pending: Pending,
    sent: Instant,
    /// Whether the submission ends its block, and all sums come back.
    whole: bool,
    places: u64,
}

/// A job of direct irradiance, in steps that never wait: for hosts with a frame loop. [`super::WgpuSession`] makes them.
#[derive(Debug)]
pub struct DirectTask {
    gpu: Arc<Gpu>,
    job: PathJob,
    elements: Arc<ElementBuffers>,
    unit: FluxUnit,
    power: i32,
    pipeline: Arc<Pipeline>,
    uniform: Buffer,
    sums: Buffer,
    group: wgpu::BindGroup,
    /// Workgroups along y and z: one for each light without size.
    lights: [u32; 2],
    pace: Pace,
    /// The block, and the place of it with which the next submission begins.
    next: (u32, u64),
    running: Option<Running>,
    film: Film,
    stats: JobStats,
}

impl DirectTask {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        scene: &CompiledScene,
        buffers: &SceneBuffers,
        elements: Arc<ElementBuffers>,
        job: &PathJob,
        film: Film,
    ) -> Result<Self, BackendError> {
        let stack = buffers.stack;
        let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use wavefront::direct\n");
        // Surfaces count by their places alone where light is not changed on its way.
        let features = if scene.needs.volume() { features::of(scene) } else { Vec::new() };
        let name = format!("direct {} stack {stack}", features.join(" "));
        let key = PipelineKey { name, entry: "direct" };
        let link = Link { root: &root, features: &features, mutations: &[] };
        let pipeline = gpu.pipeline(key, link, &bindings([Binding::Write, Binding::Read]))?;
        let count = elements.lights[1];
        let groups = count.clamp(1, gpu.limits.max_compute_workgroups_per_dimension.max(1));
        let unit = flux_unit(scene);
        let primitives = scene.primitives().count() as u64;
        let blocks = u64::from(job.blocks.end - job.blocks.start);
        let g = gpu.clone();
        g.scoped(|| {
            let sums = gpu.room("sums of elements", HEAD + SUMS * elements.elements.count() as u64)?;
            let uniform = gpu.uniform("job", &[0; 16]);
            let group = gpu.bind(&pipeline, &buffers.bound(&uniform, [&sums, &elements.words]));
            Ok(Self {
                gpu: gpu.clone(),
                job: job.clone(),
                // That of one photon is one.
                power: unit.power().unwrap_or(0),
                unit,
                pipeline,
                uniform,
                sums,
                group,
                lights: [groups, count.div_ceil(groups)],
                pace: Pace::new(
                    (FIRST / u64::from(count.max(1))).max(u64::from(WORKGROUP)),
                    gpu.dispatch_items(WORKGROUP),
                ),
                next: (job.blocks.start, 0),
                running: None,
                film,
                stats: JobStats {
                    paths: primitives * blocks * u64::from(job.block_length),
                    ..JobStats::default()
                },
                elements,
            })
        })
    }

    /// Places of a block.
    fn places(&self) -> u64 {
        self.elements.divisions * u64::from(self.job.block_length)
    }

    fn step_within(&mut self, wait: bool) -> Result<Step, BackendError> {
        let Some(running) = self.running.take() else {
            if self.next.0 >= self.job.blocks.end {
                return Ok(Step::Done);
            }
            self.send();
            return Ok(Step::Working);
        };
        let Some(words) = running.pending.answer(&self.gpu, wait)? else {
            self.running = Some(running);
            return Ok(Step::Working);
        };
        self.pace.took(running.places, running.sent.elapsed());
        self.next.1 += running.places;
        if running.whole {
            self.take(&words)?;
            self.next = (self.next.0 + 1, 0);
        }
        let block = u64::from(self.next.0 - self.job.blocks.start);
        let blocks = u64::from(self.job.blocks.end - self.job.blocks.start);
        Ok(Step::Progress { done: block * self.places() + self.next.1, total: blocks * self.places() })
    }

    /// Sends the next places of a block.
    fn send(&mut self) {
        let (block, place) = self.next;
        let places = self.pace.amount().min(self.places() - place);
        let whole = place + places == self.places();
        let (elements, samples) = (&self.elements.elements, u64::from(self.job.block_length));
        let settings = elements.settings();
        let flags = u32::from(settings.basis == Basis::Linear)
            | u32::from(settings.sides == Sides::Apart) << 1
            | u32::from(self.elements.divisions != self.elements.primitives) << 2;
        let words = [
            self.job.seed as u32,
            (self.job.seed >> 32) as u32,
            block,
            self.job.block_length,
            (place / samples) as u32,
            (place % samples) as u32,
            places as u32,
            self.elements.primitives as u32,
            self.elements.lights[0],
            self.elements.lights[1],
            self.power as u32,
            elements.count() as u32,
            self.elements.nodes,
            elements.per_side() as u32,
            flags,
        ];
        self.gpu.queue.write_buffer(&self.uniform.raw, 0, bytemuck::cast_slice(&words));
        let mut encoder = self.gpu.encoder();
        if place == 0 {
            encoder.clear_buffer(&self.sums.raw, 0, None);
        }
        if places > 0 && self.lights[1] > 0 {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline.raw);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups((places as u32).div_ceil(WORKGROUP), self.lights[0], self.lights[1]);
        }
        let read = if whole { HEAD + SUMS * elements.count() as u64 } else { HEAD };
        let sent = Instant::now();
        let pending = self.gpu.submit_and_read(encoder, &self.sums, read);
        self.running = Some(Running { pending, sent, whole, places });
    }

    /// Takes the sums of a block into the film.
    fn take(&mut self, words: &[u32]) -> Result<(), BackendError> {
        let (head, sums) = words.split_at((HEAD as usize).min(words.len()));
        if let [low, high, ..] = head {
            self.stats.rays += u64::from(*low) | u64::from(*high) << 32;
        }
        let means: Vec<[f64; 3]> = sums
            .as_chunks::<{ SUMS as usize }>()
            .0
            .iter()
            .take(self.elements.elements.count())
            .enumerate()
            .map(|(i, &[r0, r1, g0, g1, b0, b1])| {
                let sums = [[r0, r1], [g0, g1], [b0, b1]];
                let flux = sums.map(|[low, high]| {
                    self.unit.flux((u64::from(low) | u64::from(high) << 32).cast_signed())
                });
                self.elements.elements.irradiance(i, flux)
            })
            .collect();
        self.film.add_blocks(self.next.0..self.next.0 + 1, &means)?;
        Ok(())
    }

    /// Goes on as far as it can without waiting; with `wait`, until something has come back.
    ///
    /// # Errors
    /// The device's.
    pub fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        let gpu = self.gpu.clone();
        gpu.scoped(|| self.step_within(wait))
    }

    /// The film and what the job took. Blocks that are not whole are not in it.
    pub fn finish(self) -> (Film, JobStats) {
        (self.film, self.stats)
    }

    /// What is in the film so far: whole blocks.
    pub fn film(&self) -> &Film {
        &self.film
    }
}

impl Task for DirectTask {
    type Made = (Film, JobStats);

    fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        Self::step(self, wait)
    }

    fn finish(self) -> (Film, JobStats) {
        Self::finish(self)
    }
}
