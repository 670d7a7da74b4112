//! Paths on the device: waves of slots, small submissions, and block means that the host adds up as the CPU does.

use super::bidirectional::{self, Plan, Room};
use super::scene::SceneBuffers;
use super::task::{Pace, Step, Task, WORKGROUP, is_played};
use super::wave::{self, Behind, Estimator, Form, PathStart, Wave};
use crate::gpu::{Buffer, Gpu, Pending};
use etendue_core::backend::{BackendError, JobStats, PathJob};
use etendue_core::film::Film;
use etendue_core::scene::CompiledScene;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Words that the host reads of each: what was measured, and rays.
const READ: u64 = 4;
/// Words that shaders ask of a job, and those behind them that not all estimators have.
const JOB_WORDS: usize = 16;
const MORE_WORDS: usize = bidirectional::JOB_WORDS;
/// Words before the lists of a queue.
const QUEUE_HEAD: u64 = 4;
/// Slots of a wave on a device of its own, and on one that the processor plays; and of one with samples from both ends.
const SLOTS: [u64; 2] = [1 << 18, 1 << 15];
const SLOTS_OF_BOTH_ENDS: [u64; 2] = [1 << 16, 1 << 13];
/// Steps of one submission at most.
const STEPS_MAX: u64 = 64;

/// What a submission left to be read.
#[derive(Debug)]
enum Waiting {
    /// How many slots still ask.
    Queue(Pending, Instant),
    /// What the slots measured.
    Results(Pending),
}

/// The part of a job that one wave takes.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Pairs of block and element, counted through the job.
    first_unit: u64,
    units: u64,
    first_sample: u32,
    samples: u32,
}

/// A job of paths, or of samples from both ends, in steps that never wait: for hosts with a frame loop. [`super::WgpuSession`] makes them.
#[derive(Debug)]
pub struct PathTask {
    gpu: Arc<Gpu>,
    job: PathJob,
    start: PathStart,
    form: Form,
    /// Where probes begin behind the states, and whether each block has one slot more.
    probes: u32,
    once: bool,
    wave: Wave,
    /// What the estimator asks of a job beside what all do.
    more: [u32; MORE_WORDS],
    /// Of samples from both ends.
    room: Option<Room>,
    slots: u64,
    uniform: Buffer,
    states: Buffer,
    queue: Buffer,
    groups: Buffer,
    group: wgpu::BindGroup,
    turn_group: wgpu::BindGroup,
    /// Where the next part begins, in units and in samples of its first one.
    next: (u64, u32),
    running: Option<(Part, Waiting)>,
    /// Of steps.
    pace: Pace,
    elements: u64,
    /// Sums of the unit that is cut by a wave's end, and means of the block that is not yet whole.
    sum: [f64; 3],
    means: Vec<[f64; 3]>,
    film: Film,
    stats: JobStats,
}

impl PathTask {
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        scene: &CompiledScene,
        buffers: &SceneBuffers,
        (job, estimator): (&PathJob, &Estimator),
        start: PathStart,
        film: Film,
    ) -> Result<Self, BackendError> {
        let mut asked = [0; MORE_WORDS];
        let mut plan = None;
        let form = match estimator {
            Estimator::Path => Form::paths(scene),
            Estimator::Airlight(single) => {
                asked[MORE_WORDS - 2..].copy_from_slice(&wave::airlight_words(*single));
                Form::airlight(scene)
            }
            Estimator::BothEnds(ends) => plan.insert(Plan::new(scene, ends, job.max_depth)).form.clone(),
        };
        let behind = Behind { words: form.probe_words(&start), ..Behind::default() };
        Self::make(gpu, (scene, buffers), job, (form, start, behind), (plan, asked), film)
    }

    /// Paths of any form.
    pub(super) fn with(
        gpu: &Arc<Gpu>,
        scene: &CompiledScene,
        buffers: &SceneBuffers,
        job: &PathJob,
        form: (Form, PathStart, Behind),
        film: Film,
    ) -> Result<Self, BackendError> {
        Self::make(gpu, (scene, buffers), job, form, (None, [0; MORE_WORDS]), film)
    }

    fn make(
        gpu: &Arc<Gpu>,
        (scene, buffers): (&CompiledScene, &SceneBuffers),
        job: &PathJob,
        (form, start, behind): (Form, PathStart, Behind),
        (plan, asked): (Option<Plan>, [u32; MORE_WORDS]),
        film: Film,
    ) -> Result<Self, BackendError> {
        let elements = film.len() as u64;
        let (more, once) = (behind.words.len() as u64, behind.once);
        let paths = elements * u64::from(job.blocks.end - job.blocks.start) * u64::from(job.block_length);
        let (own, beside) = plan.as_ref().map_or((form.rows, 0), Plan::words);
        let wanted = if plan.is_some() { SLOTS_OF_BOTH_ENDS } else { SLOTS };
        let slots = slots(gpu, wanted, own, paths + u64::from(once) * elements, beside + more)?;
        let wave = Wave::new(gpu, &form, buffers.stack)?;
        let first = form.rows * slots;
        let (behind_probes, behind_lists) = (first + more, QUEUE_HEAD + 2 * slots);
        let is_image = matches!(start, PathStart::Image { .. });
        let room = plan.map(|plan| {
            plan.room(scene, (job, film.settings()), (slots, is_image), (behind_probes, behind_lists))
        });
        let asked = room.as_ref().map_or(asked, |room| room.words);
        let (state_words, queue_words) =
            room.as_ref().map_or((behind_probes, behind_lists), |room| (room.states, room.queue));
        let g = gpu.clone();
        g.scoped(|| {
            let states = gpu.room("states", state_words)?;
            let queue = gpu.room("queue", queue_words)?;
            let (lights, free): (&[u32], &[u32]) =
                room.as_ref().map_or((&[], &[]), |room| (&room.lights, &room.free));
            for (buffer, at, words) in [
                (&states, first, &behind.words[..]),
                (&states, behind_probes, lights),
                (&queue, behind_lists, free),
            ] {
                if !words.is_empty() {
                    gpu.queue.write_buffer(&buffer.raw, 4 * at, bytemuck::cast_slice(words));
                }
            }
            if let Some((place, elements)) = &behind.elements {
                let mut encoder = gpu.encoder();
                let (from, size) = (&elements.words.raw, 4 * elements.word_count);
                let at = 4 * (first + *place as u64);
                encoder.copy_buffer_to_buffer(from, 0, &states.raw, at, size);
                gpu.submit(encoder);
            }
            let groups = gpu.room("groups", 4)?;
            let uniform = gpu.uniform("job", &[0; JOB_WORDS + MORE_WORDS]);
            // The pipelines have one layout in content; each its own object.
            let group = gpu.bind(&wave.start, &buffers.bound(&uniform, [&states, &queue]));
            let turn_group = gpu.bind(&wave.turn, &[&queue, &groups]);
            let mut film = film;
            if elements == 0 {
                // Blocks of nothing have been taken.
                film.add_blocks(job.blocks.clone(), &[])?;
            }
            Ok(Self {
                gpu: gpu.clone(),
                job: job.clone(),
                start,
                form,
                probes: behind.probes as u32,
                once,
                wave,
                more: asked,
                room,
                slots,
                uniform,
                states,
                queue,
                groups,
                group,
                turn_group,
                next: (0, 0),
                running: None,
                pace: Pace::new(4, STEPS_MAX),
                elements,
                sum: [0.0; 3],
                means: Vec::new(),
                film,
                stats: JobStats { paths, ..JobStats::default() },
            })
        })
    }

    /// Goes on as far as it can without waiting; with `wait`, until something has come back.
    ///
    /// # Errors
    /// The device's.
    pub fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        let gpu = self.gpu.clone();
        gpu.scoped(|| self.step_within(wait))
    }

    fn step_within(&mut self, wait: bool) -> Result<Step, BackendError> {
        let Some((part, waiting)) = self.running.take() else {
            return match self.next_part() {
                Some(part) => {
                    self.begin(part);
                    Ok(Step::Working)
                }
                None => Ok(Step::Done),
            };
        };
        let pending = match &waiting {
            Waiting::Queue(pending, _) | Waiting::Results(pending) => pending,
        };
        let Some(words) = pending.answer(&self.gpu, wait)? else {
            self.running = Some((part, waiting));
            return Ok(Step::Working);
        };
        match waiting {
            Waiting::Queue(_, sent) => {
                self.pace.took(self.pace.amount(), sent.elapsed());
                let asking = words.get(words.get(2).map_or(0, |turn| *turn as usize & 1)).copied();
                let next = if asking == Some(0) { self.read(part) } else { self.go_on() };
                self.running = Some((part, next));
                Ok(Step::Working)
            }
            Waiting::Results(_) => {
                self.take(part, &words)?;
                Ok(Step::Progress { done: self.done(), total: self.total() })
            }
        }
    }

    fn total(&self) -> u64 {
        self.elements * u64::from(self.job.blocks.end - self.job.blocks.start)
    }

    fn done(&self) -> u64 {
        self.next.0
    }

    /// Slots of a unit.
    fn length(&self) -> u64 {
        u64::from(self.job.block_length) + u64::from(self.once)
    }

    /// As much as the slots hold: whole units, or a part of one.
    fn next_part(&self) -> Option<Part> {
        let (unit, sample) = self.next;
        if unit >= self.total() {
            return None;
        }
        let length = self.length();
        let part = if sample == 0 && length <= self.slots {
            let units = (self.slots / length).min(self.total() - unit);
            Part { first_unit: unit, units, first_sample: 0, samples: length as u32 }
        } else {
            let samples = (length - u64::from(sample)).min(self.slots) as u32;
            Part { first_unit: unit, units: 1, first_sample: sample, samples }
        };
        Some(part)
    }

    fn begin(&mut self, part: Part) {
        let count = (part.units * u64::from(part.samples)) as u32;
        let (width, [a, b, c]) = match &self.start {
            PathStart::Image { width, inside } => (*width, inside.packed()),
            PathStart::Probes(_) => (0, [0; 3]),
        };
        let probes = if width == 0 { (self.form.rows * self.slots) as u32 + self.probes } else { 0 };
        let own: [u32; JOB_WORDS] = [
            self.job.seed as u32,
            (self.job.seed >> 32) as u32,
            self.slots as u32,
            count,
            self.elements as u32,
            (part.first_unit % self.elements) as u32,
            self.job.blocks.start + (part.first_unit / self.elements) as u32,
            part.samples,
            part.first_sample,
            self.job.max_depth,
            probes,
            width,
            a,
            b,
            c,
            0,
        ];
        self.gpu.queue.write_buffer(&self.uniform.raw, 0, bytemuck::cast_slice(&[own, self.more]));
        self.gpu.queue.write_buffer(&self.queue.raw, 0, bytemuck::cast_slice(&[0_u32; 4]));
        let mut encoder = self.gpu.encoder();
        for (at, words) in self.sums(self.blocks_begun(part)) {
            encoder.clear_buffer(&self.queue.raw, 4 * at, Some(4 * words));
        }
        self.pass(&mut encoder, |pass| {
            pass.set_pipeline(&self.wave.start.raw);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups(count.div_ceil(WORKGROUP), 1, 1);
            self.turn(pass);
        });
        self.running = Some((part, self.steps_into(encoder)));
    }

    fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, work: impl FnOnce(&mut wgpu::ComputePass<'a>)) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        work(&mut pass);
    }

    fn turn(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.wave.turn.raw);
        pass.set_bind_group(0, &self.turn_group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    fn go_on(&self) -> Waiting {
        self.steps_into(self.gpu.encoder())
    }

    fn steps_into(&self, mut encoder: wgpu::CommandEncoder) -> Waiting {
        self.pass(&mut encoder, |pass| {
            for _ in 0..self.pace.amount() {
                for pipeline in &self.wave.step {
                    pass.set_pipeline(&pipeline.raw);
                    pass.set_bind_group(0, &self.group, &[]);
                    pass.dispatch_workgroups_indirect(&self.groups.raw, 0);
                }
                self.turn(pass);
            }
        });
        let sent = Instant::now();
        Waiting::Queue(self.gpu.submit_and_read(encoder, &self.queue, 3), sent)
    }

    fn read(&self, part: Part) -> Waiting {
        let mut runs = vec![(&self.states, 0, READ * self.slots)];
        runs.extend(self.sums(self.blocks_done(part)).iter().map(|(at, words)| (&self.queue, *at, *words)));
        Waiting::Results(self.gpu.submit_and_read_all(self.gpu.encoder(), &runs))
    }

    /// Where the sums of blocks lie, of which there are none but for samples from both ends.
    fn sums(&self, blocks: Range<u32>) -> Vec<(u64, u64)> {
        self.room.as_ref().map_or_else(Vec::new, |room| room.sums(blocks))
    }

    /// The block of a unit; of what is behind the last one, the block after it.
    fn block(&self, unit: u64) -> u32 {
        self.job.blocks.start + (unit / self.elements.max(1)) as u32
    }

    /// Blocks whose first sample is in this part.
    fn blocks_begun(&self, part: Part) -> Range<u32> {
        let before = u64::from(part.first_sample > 0) + self.elements.max(1) - 1;
        self.block(part.first_unit + before)
            ..self.block(part.first_unit + part.units + self.elements.max(1) - 1)
    }

    /// Blocks whose last sample is in this part.
    fn blocks_done(&self, part: Part) -> Range<u32> {
        let whole = part.first_sample + part.samples == self.job.block_length;
        let done = if whole { part.units } else { 0 };
        self.block(part.first_unit)..self.block(part.first_unit + done)
    }

    /// Adds up what the slots measured, in the order of the samples: the CPU's sums.
    fn take(&mut self, part: Part, words: &[u32]) -> Result<(), BackendError> {
        let slots = self.slots as usize;
        let (measured, more) = words.split_at((3 * slots).min(words.len()));
        let (rays, mut landed) = more.split_at(slots.min(more.len()));
        let mut slot = 0;
        for _ in 0..part.units {
            let mut once = [0.0; 3];
            for sample in 0..part.samples {
                let value = [0, 1, 2].map(|c| f64::from(f32::from_bits(measured[c * slots + slot])));
                if part.first_sample + sample < self.job.block_length {
                    for (sum, x) in self.sum.iter_mut().zip(value) {
                        *sum += x;
                    }
                } else {
                    once = value;
                }
                self.stats.rays += u64::from(rays[slot]);
                slot += 1;
            }
            let taken = part.first_sample + part.samples;
            if u64::from(taken) < self.length() {
                self.next.1 = taken;
                continue;
            }
            self.next = (self.next.0 + 1, 0);
            let sum = std::mem::take(&mut self.sum);
            let length = f64::from(self.job.block_length.max(1));
            self.means.push([0, 1, 2].map(|c| sum[c] / length + once[c]));
            if self.means.len() as u64 == self.elements {
                let block = self.block(self.next.0 - 1);
                if let Some(room) = &self.room {
                    landed = room.add(&mut self.means, landed, self.job.block_length);
                }
                self.film.add_blocks(block..block + 1, &self.means)?;
                self.means.clear();
            }
        }
        Ok(())
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

impl Task for PathTask {
    type Made = (Film, JobStats);

    fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        Self::step(self, wait)
    }

    fn finish(self) -> (Film, JobStats) {
        Self::finish(self)
    }
}

/// Slots of a wave, of so many rows: what the job has use for, and what fits beside `more` words.
fn slots(gpu: &Gpu, [own, played]: [u64; 2], rows: u64, paths: u64, more: u64) -> Result<u64, BackendError> {
    let wanted = paths
        .next_multiple_of(u64::from(WORKGROUP))
        .clamp(u64::from(WORKGROUP), if is_played(gpu) { played } else { own });
    let words = gpu.binding_bytes() / 4;
    let fit = words.saturating_sub(more) / rows / u64::from(WORKGROUP) * u64::from(WORKGROUP);
    let fit = fit.min(gpu.dispatch_items(WORKGROUP));
    if fit == 0 {
        let what = "bytes for probes and a wave of paths in one binding";
        let asked = 4 * (more + rows * u64::from(WORKGROUP));
        return Err(BackendError::LimitExceeded { what, asked, allowed: gpu.binding_bytes() });
    }
    Ok(wanted.min(fit))
}
