//! Photons on the device: waves that walk in small submissions, in order where the job wants it, and sums of a replicate in fixed point, which the host reads.

mod dispatch;
mod tables;
mod wave;

use super::elements::ElementBuffers;
use super::scene::SceneBuffers;
use super::task::{Pace, Step, Task, WORKGROUP, is_played};
use crate::gpu::{Buffer, Gpu, Pending};
use etendue_core::backend::{BackendError, JobStats, PhotonJob, PhotonStart};
use etendue_core::film::Film;
use etendue_core::illumination::FluxUnit;
use etendue_core::scene::CompiledScene;
use etendue_core::transport::first_shot::FirstShot;
use etendue_core::transport::photon::{LightPlan, Replicate, Sequence, WALK_GROUP, WAVE};
use etendue_core::transport::volume::LightMedia;
use std::sync::Arc;
use std::time::Instant;
use tables::{JOB_WORDS, Numbers, Tables};
use wave::{Kind, Wave, rows};

/// Words before the lists.
const HEAD: u64 = 16;
/// Words of sums of an element.
const SUMS: u64 = 6;
/// Photons of a submission, or of a wave that walks one by one, on a device of its own, and on one that the processor plays.
const SLOTS: [u64; 2] = [1 << 18, 1 << 15];
/// Steps of one submission at most.
const STEPS_MAX: u64 = 64;
/// Photons that an invocation takes in order, and counts that one adds up.
const RUN: u64 = 64;
const SCAN_RUN: u64 = 256;
/// Passes of the sort.
const PASSES: u32 = 6;
/// Digits of a pass.
const DIGITS: u64 = 32;

/// What of a wave is done next, from which item on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Start(u64),
    /// Rays that are asked for.
    Fly(u64),
    /// Those that have landed are put in order.
    Order,
    /// They are scattered.
    Scatter(u64),
    /// The sums of the replicate are read.
    Sums,
}

/// A photons' job, in steps that never wait: for hosts with a frame loop. [`super::WgpuSession`] makes them.
#[derive(Debug)]
pub struct PhotonTask {
    gpu: Arc<Gpu>,
    job: PhotonJob,
    elements: Arc<ElementBuffers>,
    tables: Tables,
    unit: FluxUnit,
    /// Sets of sums: with a second one for caustics.
    sets: u64,
    kind: Kind,
    wave: Wave,
    slots: u64,
    window: u64,
    uniform: Buffer,
    sums: Buffer,
    groups: Buffer,
    group: wgpu::BindGroup,
    turn_group: wgpu::BindGroup,
    pace: Pace,
    replicate: u32,
    /// The first photon of the wave, how many of its photons still walk, those that ask, and hits of all so far.
    first: u64,
    alive: u64,
    asking: u64,
    bounce: u32,
    stage: Stage,
    running: Option<(Pending, Instant)>,
    done: u64,
    film: Film,
    values: Vec<[f64; 3]>,
    stats: JobStats,
}

impl PhotonTask {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        (scene, media): (&CompiledScene, &LightMedia),
        buffers: &SceneBuffers,
        elements: Arc<ElementBuffers>,
        (job, shot): (&PhotonJob, Option<&FirstShot>),
        caustics: bool,
        film: Film,
    ) -> Result<Self, BackendError> {
        let plan = LightPlan::new(scene).map_err(|_| BackendError::Dark)?;
        let surfaces = matches!(job.start, PhotonStart::Surfaces { .. });
        // What lights send into is known of most.
        let searches =
            !scene.glows.is_empty() || (0..scene.lights.len()).any(|light| media.all_over(light).is_none());
        let follows = scene.needs.volume() && (surfaces || searches);
        let kind = Kind { sorted: job.sequence == Sequence::Sorted, surfaces, follows };
        let wave = Wave::new(gpu, scene, buffers.stack, kind)?;
        let total = plan.total().into_iter().fold(0.0, f64::max);
        let unit = FluxUnit::new(total, job.photons);
        let (sets, count) = (1 + u64::from(caustics), elements.elements.count() as u64);
        let window = SLOTS[usize::from(is_played(gpu))].min(gpu.dispatch_items(WORKGROUP));
        let wanted = if kind.sorted { u64::from(job.photons.min(WAVE)) } else { window };
        let slots = u64::from(job.photons).min(wanted).next_multiple_of(u64::from(WORKGROUP));
        let mut tables = Tables::new(
            (scene, media),
            &plan,
            &elements,
            (job, unit, caustics),
            shot,
            (rows(scene) * slots, slots),
        );
        let lists = if kind.sorted { 7 * slots + 128 } else { 3 * slots };
        tables.numbers.lists = lists as u32;
        let g = gpu.clone();
        g.scoped(|| {
            let states = gpu.room("states of photons", tables.end())?;
            let mut encoder = gpu.encoder();
            let (from, at) = (&elements.words.raw, 4 * tables.elements_at);
            encoder.copy_buffer_to_buffer(from, 0, &states.raw, at, 4 * elements.word_count);
            gpu.submit(encoder);
            if !tables.words.is_empty() {
                let at = 4 * tables.words_at();
                gpu.queue.write_buffer(&states.raw, at, bytemuck::cast_slice(&tables.words));
            }
            let sums = gpu.room("lists and sums of photons", HEAD + lists + sets * SUMS * count)?;
            let groups = gpu.room("groups", 8)?;
            let uniform = gpu.uniform("job", &[0; JOB_WORDS]);
            let group = gpu.bind(&wave.start, &buffers.bound(&uniform, [&states, &sums]));
            let turn_group = gpu.bind(&wave.turn, &[&sums, &groups]);
            let replicates = u64::from(job.replicates.end - job.replicates.start);
            Ok(Self {
                gpu: gpu.clone(),
                job: job.clone(),
                elements,
                tables,
                unit,
                sets,
                kind,
                wave,
                slots,
                window,
                uniform,
                sums,
                groups,
                group,
                turn_group,
                pace: Pace::new(4, STEPS_MAX),
                replicate: job.replicates.start,
                first: 0,
                alive: 0,
                asking: 0,
                bounce: 0,
                stage: Stage::Start(0),
                running: None,
                done: 0,
                film,
                values: Vec::new(),
                stats: JobStats { paths: replicates * u64::from(job.photons), ..JobStats::default() },
            })
        })
    }

    /// Photons of this wave.
    fn count(&self) -> u64 {
        (u64::from(self.job.photons) - self.first).min(self.slots)
    }

    /// Words before the sums.
    fn sums_at(&self) -> u64 {
        HEAD + u64::from(self.tables.numbers.lists)
    }

    fn step_within(&mut self, wait: bool) -> Result<Step, BackendError> {
        let Some((pending, sent)) = self.running.take() else {
            if self.replicate >= self.job.replicates.end {
                return Ok(Step::Done);
            }
            self.send();
            return Ok(Step::Working);
        };
        let Some(words) = pending.answer(&self.gpu, wait)? else {
            self.running = Some((pending, sent));
            return Ok(Step::Working);
        };
        let before = self.done;
        if self.stage == Stage::Sums {
            self.take(&words)?;
        } else {
            self.advance(&words, sent);
        }
        if self.done == before && self.stage != Stage::Start(0) {
            return Ok(Step::Working);
        }
        Ok(Step::Progress { done: self.done, total: self.stats.paths })
    }

    /// What comes next, by the head that a submission left.
    fn advance(&mut self, head: &[u32], sent: Instant) {
        let word = |i: usize| u64::from(head.get(i).copied().unwrap_or(0));
        let asked = std::mem::replace(&mut self.asking, word(word(2) as usize & 1));
        let (window, sorted) = (self.window, self.kind.sorted);
        self.stage = match self.stage {
            Stage::Start(at) if at + window < self.count() => Stage::Start(at + window),
            Stage::Fly(at) if sorted && at + window < asked => Stage::Fly(at + window),
            Stage::Scatter(at) if at + window < self.alive => Stage::Scatter(at + window),
            Stage::Order => {
                let landed = word(8);
                self.gone(self.alive.saturating_sub(landed));
                if landed == 0 { self.wave_over(head) } else { Stage::Scatter(0) }
            }
            Stage::Scatter(_) => {
                self.bounce += 1;
                Stage::Fly(0)
            }
            Stage::Start(_) | Stage::Fly(_) | Stage::Sums => {
                if !sorted {
                    self.pace.took(self.pace.amount(), sent.elapsed());
                }
                match (self.asking, sorted) {
                    (0, true) => Stage::Order,
                    (0, false) => {
                        self.gone(self.alive);
                        self.wave_over(head)
                    }
                    _ => Stage::Fly(0),
                }
            }
        };
    }

    /// So many photons are no more.
    fn gone(&mut self, photons: u64) {
        self.alive -= photons;
        self.done += photons;
    }

    /// A wave has ended with this head.
    fn wave_over(&mut self, head: &[u32]) -> Stage {
        let pair = |i: usize| match head.get(i..i + 2) {
            Some([low, high]) => u64::from(*low) | u64::from(*high) << 32,
            _ => 0,
        };
        self.stats.rays += pair(4);
        self.stats.hits += pair(6);
        self.first += self.slots;
        if self.first < u64::from(self.job.photons) { Stage::Start(0) } else { Stage::Sums }
    }

    /// Sends the next part of the wave's work.
    fn send(&mut self) {
        let replicate = Replicate::new(self.job.seed, self.job.sequence, self.job.photons, self.replicate);
        self.tables.replicate(self.replicate, &replicate);
        let first = self.first as u32;
        let mut encoder = self.gpu.encoder();
        if self.stage == Stage::Start(0) {
            (self.alive, self.asking, self.bounce) = (self.count(), 0, 0);
            // All are in order, in the first list, before the first pass.
            let mut head = [0_u32; HEAD as usize];
            [head[8], head[10]] = [self.alive as u32, PASSES];
            self.gpu.queue.write_buffer(&self.sums.raw, 0, bytemuck::cast_slice(&head));
            if first == 0 {
                encoder.clear_buffer(&self.sums.raw, 4 * self.sums_at(), None);
            }
        }
        let window = match self.stage {
            Stage::Start(at) | Stage::Fly(at) | Stage::Scatter(at) => at,
            Stage::Order | Stage::Sums => 0,
        };
        self.tables.numbers = Numbers {
            first,
            count: self.count() as u32,
            window: window as u32,
            group: WALK_GROUP.wrapping_add(self.bounce),
            offset: replicate.roulette_offset(first, self.bounce),
            ..self.tables.numbers
        };
        self.gpu.queue.write_buffer(&self.uniform.raw, 0, bytemuck::bytes_of(&self.tables.numbers));
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            self.work(&mut pass);
        }
        let sent = Instant::now();
        let pending = if self.stage == Stage::Sums {
            let words = self.sets * SUMS * self.elements.elements.count() as u64;
            self.gpu.submit_and_read_from(encoder, (&self.sums, self.sums_at()), words)
        } else {
            self.gpu.submit_and_read(encoder, &self.sums, HEAD)
        };
        self.running = Some((pending, sent));
    }

    /// Takes the sums of a replicate: irradiance on elements, of each set.
    fn take(&mut self, words: &[u32]) -> Result<(), BackendError> {
        let elements = &self.elements.elements;
        let count = elements.count();
        let value = |(i, &[r0, r1, g0, g1, b0, b1]): (usize, &[u32; SUMS as usize])| {
            let flux = [[r0, r1], [g0, g1], [b0, b1]]
                .map(|[low, high]| self.unit.flux((u64::from(low) | u64::from(high) << 32).cast_signed()));
            elements.irradiance(i, flux)
        };
        self.values = words.as_chunks::<{ SUMS as usize }>().0.iter().enumerate().map(value).collect();
        let means = self.values.get(..count).unwrap_or_default();
        self.film.add_blocks(self.replicate..self.replicate + 1, means)?;
        self.replicate += 1;
        (self.first, self.stage) = (0, Stage::Start(0));
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

    /// The film and what the job took. Replicates that are not whole are not in it.
    pub fn finish(self) -> (Film, JobStats) {
        (self.film, self.stats)
    }

    /// Irradiance \[W/m^2\] per element of the last replicate, of caustics behind it where they are kept; and what the job took.
    pub(super) fn finish_values(self) -> (Vec<[f32; 3]>, JobStats) {
        (self.values.iter().map(|v| v.map(|x| x as f32)).collect(), self.stats)
    }

    /// What is in the film so far: whole replicates.
    pub fn film(&self) -> &Film {
        &self.film
    }
}

impl Task for PhotonTask {
    type Made = (Film, JobStats);

    fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        Self::step(self, wait)
    }

    fn finish(self) -> (Film, JobStats) {
        Self::finish(self)
    }
}
