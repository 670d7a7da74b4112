//! Lit triangles cut into pieces on the device: the density of photons' starts. Decisions and samples are the device's; what pieces send on is core's, on the host.

use super::WgpuSession;
use super::features;
use super::scene::{OFFSETS, SceneBuffers};
use super::task::{Pace, Step, Task, WORKGROUP, bindings, is_played};
use crate::gpu::{Binding, Buffer, Gpu, Pending, Pipeline, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::{BackendError, NoControl, Session as _};
use etendue_core::direct::subdivide::{Bary, Limits};
use etendue_core::transport::first_shot::{
    FirstShot, FirstShotError, How, LitPiece, Pair, StartPlan, Subdivision, Weights,
};
use std::sync::Arc;
use std::time::Instant;

/// Words before the pieces, and of a piece; of a pair; of a lane, of a part that waits, and of what a lane remembers.
const HEAD: u64 = 4;
const PIECE: u64 = 12;
const PAIR: u64 = 6;
const ROWS: u64 = 33;
const PART: u64 = 15;
const REMEMBERED: u64 = 4 * 256;
/// Parts that wait at most, and cuts above a piece: those of core.
const STACK: u64 = 96;
const CUTS: u64 = 48;
/// Pairs in one list.
const LIST: usize = 1 << 18;
/// Lanes on a device of its own, and on one that the processor plays.
const LANES: [u64; 2] = [1 << 13, 1 << 10];
/// Pieces for which there is room at least.
const ROOM: u64 = 1 << 19;
/// Samples of a lane in the first submission, and in any.
const FIRST: u64 = 4;
const MOST: u64 = 64;

impl WgpuSession {
    /// The density of starts on surfaces, its triangles cut by the device, as a task that never waits. Jobs make theirs so where the device is more
    /// than the processor, which cuts them quicker itself.
    ///
    /// # Errors
    /// [`FirstShotError`] as a [`BackendError`]; the device's.
    pub fn first_shot_task(
        &self,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<FirstShotTask<'_>, BackendError> {
        self.check_photons()?;
        self.pieces_task(&self.source.gpu(), subdivision, weights)
    }

    fn pieces_task(
        &self,
        gpu: &Arc<Gpu>,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<FirstShotTask<'_>, BackendError> {
        let plan = StartPlan::new(&self.scene, self.media(), *subdivision)?;
        FirstShotTask::new(gpu, self, &*self.buffers(gpu)?, plan, (subdivision, weights))
    }

    /// The density of starts, made where that is quickest.
    pub(super) fn make_first_shot(
        &self,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<FirstShot, BackendError> {
        if is_played(&self.source.gpu()) {
            self.first_shot_by_host(subdivision, weights)
        } else {
            self.first_shot_by_device(subdivision, weights)
        }
    }

    fn first_shot_by_host(
        &self,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<FirstShot, BackendError> {
        let place = (&self.tree, self.media());
        Ok(etendue_cpu::first_shot(&self.scene, place, subdivision, weights)?.0)
    }

    fn first_shot_by_device(
        &self,
        subdivision: &Subdivision,
        weights: Weights,
    ) -> Result<FirstShot, BackendError> {
        let made = self.source.run(|gpu| self.pieces_task(gpu, subdivision, weights)?.drive(&NoControl))?;
        Ok(made?.0)
    }
}

/// What the device is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The next list is to be sent.
    List,
    /// Its pairs are cut.
    Cut,
    /// So many pieces are to be read.
    Read(u64),
}

/// A list of pairs, and of each its pieces so far, with their places in its order.
#[derive(Debug, Default)]
struct List {
    pairs: Vec<usize>,
    pieces: Vec<Vec<(u32, [u32; PIECE as usize - 2])>>,
}

/// Pieces in the making, in steps that never wait: for hosts with a frame loop. [`WgpuSession`] makes them.
pub struct FirstShotTask<'a> {
    gpu: Arc<Gpu>,
    plan: StartPlan<'a>,
    weights: Weights,
    limits: Limits,
    tolerances: [f32; 2],
    pipeline: Arc<Pipeline>,
    uniform: Buffer,
    work: Buffer,
    made: Buffer,
    group: wgpu::BindGroup,
    lanes: u64,
    capacity: u64,
    /// Where media, lanes, stacks and what is remembered begin.
    at: [u64; 4],
    pace: Pace,
    stage: Stage,
    list: List,
    /// The number of the first pair of the list, and the pair that comes after it.
    first: u32,
    next: usize,
    running: Option<(Pending, u64, Instant)>,
    pieces: Vec<LitPiece>,
    rays: u64,
}

/// What a pair is to the device: its triangle, its light, how it is cut with the least depth, and three numbers.
fn words(pair: &Pair<'_>) -> [u32; PAIR as usize] {
    let (how, [x, y, z]) = match &pair.how {
        How::Whole => (0, [0.0; 3]),
        How::Glance(place) => (1, *place),
        How::Published(_, limits) => (2 | u32::from(limits.least_depth) << 8, [0.0; 3]),
        How::Robust(rule, limits) => (3 | u32::from(limits.least_depth) << 8, [rule.share, 0.0, 0.0]),
    };
    [pair.triangle, pair.light, how, x.to_bits(), y.to_bits(), z.to_bits()]
}

impl<'a> FirstShotTask<'a> {
    fn new(
        gpu: &Arc<Gpu>,
        session: &WgpuSession,
        buffers: &SceneBuffers,
        plan: StartPlan<'a>,
        (subdivision, weights): (&Subdivision, Weights),
    ) -> Result<Self, BackendError> {
        let scene = session.scene();
        let (limits, tolerances) = match subdivision {
            Subdivision::None => (Limits { depth: 0, ..Limits::default() }, [0.0; 2]),
            Subdivision::Published(rule, limits) => (*limits, [rule.relative, rule.absolute]),
            Subdivision::Robust(rule, limits, _) => (*limits, [rule.relative, rule.absolute]),
        };
        let stack = buffers.stack;
        let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use wavefront::pieces\n");
        // Surfaces count by their places alone where light is not changed on its way.
        let features = if scene.needs.volume() { features::of(scene) } else { Vec::new() };
        let key =
            PipelineKey { name: format!("pieces {} stack {stack}", features.join(" ")), entry: "pieces" };
        let link = Link { root: &root, features: &features, mutations: &[] };
        let pipeline = gpu.pipeline(key, link, &bindings([Binding::Write, Binding::Write]))?;
        let media = if scene.needs.volume() { light_media(session) } else { Vec::new() };
        let list = plan.pairs().min(LIST) as u64;
        let waiting =
            STACK.min(3 * u64::from(limits.depth).min(CUTS) + 1).min(u64::from(limits.budget.max(1)));
        let lane = ROWS + PART * waiting + REMEMBERED;
        let before = PAIR * list + media.len() as u64;
        let fit = (gpu.binding_bytes() / 4).saturating_sub(before) / lane;
        let group_size = u64::from(WORKGROUP);
        let lanes = LANES[usize::from(is_played(gpu))].min(fit).min(list.next_multiple_of(group_size));
        let lanes = (lanes / group_size * group_size).max(group_size);
        let capacity = ROOM.max(lanes * MOST).min(gpu.binding_bytes() / (4 * PIECE) - 1);
        let rows = before;
        let stacks = rows + ROWS * lanes;
        let samples = stacks + PART * waiting * lanes;
        let g = gpu.clone();
        g.scoped(|| {
            let work = gpu.room("pairs and lanes", samples + REMEMBERED * lanes)?;
            if !media.is_empty() {
                gpu.queue.write_buffer(&work.raw, 4 * PAIR * list, bytemuck::cast_slice(&media));
            }
            let made = gpu.room("pieces", HEAD + PIECE * capacity)?;
            let uniform = gpu.uniform("job", &[0; 16]);
            let group = gpu.bind(&pipeline, &buffers.bound(&uniform, [&work, &made]));
            Ok(Self {
                gpu: gpu.clone(),
                plan,
                weights,
                limits,
                tolerances,
                pipeline,
                uniform,
                work,
                made,
                group,
                lanes,
                capacity,
                at: [PAIR * list, rows, stacks, samples],
                pace: Pace::new(FIRST, MOST.min(capacity / lanes)),
                stage: Stage::List,
                list: List::default(),
                first: 0,
                next: 0,
                running: None,
                pieces: Vec::new(),
                rays: 0,
            })
        })
    }

    /// Goes on as far as it can without waiting; with `wait`, until something has come back. Progress counts pairs of a light and a triangle.
    ///
    /// # Errors
    /// The device's.
    pub fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        let gpu = self.gpu.clone();
        gpu.scoped(|| self.step_within(wait))
    }

    fn step_within(&mut self, wait: bool) -> Result<Step, BackendError> {
        let Some((pending, steps, sent)) = self.running.take() else {
            if self.stage == Stage::List && !self.send_list() {
                return Ok(Step::Done);
            }
            self.running = Some(self.send());
            return Ok(Step::Working);
        };
        let Some(words) = pending.answer(&self.gpu, wait)? else {
            self.running = Some((pending, steps, sent));
            return Ok(Step::Working);
        };
        let [_, made, done, rays] = *words.first_chunk().unwrap_or(&[0; HEAD as usize]);
        if let Stage::Read(_) = self.stage {
            self.take(&words);
        } else {
            self.pace.took(steps, sent.elapsed());
            self.rays += u64::from(rays);
        }
        let all = done as usize >= self.list.pairs.len();
        let full = u64::from(made) + self.lanes * self.pace.amount() > self.capacity;
        self.stage = match self.stage {
            Stage::Read(_) if all => {
                self.keep();
                Stage::List
            }
            Stage::Cut if all || full => Stage::Read(made.into()),
            _ => Stage::Cut,
        };
        let progress = self.next - self.list.pairs.len() + done as usize;
        Ok(Step::Progress { done: progress as u64, total: self.plan.pairs() as u64 })
    }

    /// Sends the next list. Whether there was one.
    fn send_list(&mut self) -> bool {
        self.first += self.list.pairs.len() as u32;
        let mut list = List::default();
        let mut sent: Vec<u32> = Vec::new();
        while self.next < self.plan.pairs() && list.pairs.len() < LIST {
            if let Some(pair) = self.plan.pair(self.next) {
                list.pairs.push(self.next);
                sent.extend(words(&pair));
            }
            self.next += 1;
        }
        list.pieces.resize_with(list.pairs.len(), Vec::new);
        self.list = list;
        if sent.is_empty() {
            return false;
        }
        self.gpu.queue.write_buffer(&self.work.raw, 0, bytemuck::cast_slice(&sent));
        let job = [
            self.list.pairs.len() as u32,
            self.first,
            self.lanes as u32,
            self.at[0] as u32,
            self.at[1] as u32,
            self.at[2] as u32,
            self.at[3] as u32,
            self.limits.size.to_bits(),
            // Not a number is no limit.
            if self.limits.largest.is_nan() { f32::INFINITY } else { self.limits.largest }.to_bits(),
            self.limits.depth.into(),
            self.limits.budget,
            self.tolerances[0].to_bits(),
            self.tolerances[1].to_bits(),
        ];
        self.gpu.queue.write_buffer(&self.uniform.raw, 0, bytemuck::cast_slice(&job));
        self.gpu.queue.write_buffer(&self.made.raw, 0, bytemuck::cast_slice(&[0_u32; HEAD as usize]));
        self.stage = Stage::Cut;
        true
    }

    /// Sends samples of all lanes, or asks for the pieces.
    fn send(&self) -> (Pending, u64, Instant) {
        let sent = Instant::now();
        let mut encoder = self.gpu.encoder();
        if let Stage::Read(pieces) = self.stage {
            let pending = self.gpu.submit_and_read(encoder, &self.made, HEAD + PIECE * pieces);
            return (pending, 0, sent);
        }
        let steps = self.pace.amount();
        // Rays are those of this submission.
        self.gpu.queue.write_buffer(&self.made.raw, 12, &[0; 4]);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline.raw);
        pass.set_bind_group(0, &self.group, &[]);
        for _ in 0..steps {
            pass.dispatch_workgroups((self.lanes / u64::from(WORKGROUP)) as u32, 1, 1);
        }
        drop(pass);
        (self.gpu.submit_and_read(encoder, &self.made, HEAD), steps, sent)
    }

    /// Takes the pieces that were made, and makes room.
    fn take(&mut self, words: &[u32]) {
        for words in words.get(HEAD as usize..).unwrap_or_default().as_chunks::<{ PIECE as usize }>().0 {
            let [pair, place, rest @ ..] = *words;
            if let Some(pieces) = self.list.pieces.get_mut(pair as usize) {
                pieces.push((place, rest));
            }
        }
        self.gpu.queue.write_buffer(&self.made.raw, 4, &[0; 4]);
    }

    /// Pieces of the list, all of which are there, as core makes them, in its order.
    fn keep(&mut self) {
        for (number, made) in self.list.pairs.iter().zip(&mut self.list.pieces) {
            let Some(pair) = self.plan.pair(*number) else { continue };
            made.sort_unstable_by_key(|(place, _)| *place);
            for (place, [a1, a2, b1, b2, c1, c2, x, y, z, fraction]) in made.iter() {
                let corners = [(a1, a2), (b1, b2), (c1, c2)].map(|(p, q)| Bary::try_new(*p, *q));
                let [Some(a), Some(b), Some(c)] = corners else { continue };
                let irradiance = [x, y, z].map(|w| f32::from_bits(*w));
                let fraction = f32::from_bits(*fraction);
                self.pieces.extend(pair.piece([a, b, c], irradiance, fraction, place & 1 == 1));
            }
        }
        self.list.pieces.clear();
    }

    /// The density, once all steps are done, and the shadow rays it took.
    ///
    /// # Errors
    /// [`FirstShotError`].
    pub fn finish(self) -> Result<(FirstShot, u64), FirstShotError> {
        Ok((FirstShot::new(&self.plan, self.pieces, self.weights)?, self.rays))
    }
}

impl Task for FirstShotTask<'_> {
    type Made = Result<(FirstShot, u64), FirstShotError>;

    fn step(&mut self, wait: bool) -> Result<Step, BackendError> {
        Self::step(self, wait)
    }

    fn finish(self) -> Self::Made {
        Self::finish(self)
    }
}

/// What is outside, then what each light sends into.
fn light_media(session: &WgpuSession) -> Vec<u32> {
    let media = session.media();
    let lights = 0..session.scene().lights.len();
    // A light without size sends into the same all over it; others have no pieces.
    let of = lights.map(|light| media.all_over(light).unwrap_or(media.outside()).packed());
    [media.outside().packed()].into_iter().chain(of).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapter;
    use etendue_conformance::analytic::compiled;
    use etendue_conformance::scenes::{diffuse, point_light, room};
    use etendue_core::backend::{Arithmetic, Backend as _};
    use etendue_core::scene::SceneDesc;

    /// Jobs take either: that of this machine's device would take one alone.
    #[test]
    fn the_density_is_the_same_wherever_it_is_made() {
        let Some(backend) = adapter::backend() else { return };
        let desc = SceneDesc {
            meshes: vec![room([0.0; 3], 1.0, "wall")],
            materials: vec![diffuse("wall", 0.6, 0.0)],
            lights: vec![point_light([0.1, 0.2, 0.8], 3.0)],
            ..SceneDesc::default()
        };
        let session = backend.open_scene(compiled(&desc).unwrap()).unwrap();
        let (how, weights) = (Subdivision::robust(Weights::EXACT), Weights::EXACT);
        let by_host = session.first_shot_by_host(&how, weights).unwrap();
        let by_device = session.first_shot_by_device(&how, weights).unwrap();
        assert!(by_host.pieces().len() > 50);
        if backend.arithmetic() == Arithmetic::Ieee {
            assert_eq!(by_device.pieces(), by_host.pieces());
        }
        let sums = [&by_host, &by_device].map(|s| s.survival());
        assert!((sums[0] / sums[1] - 1.0).abs() < 1e-3, "{sums:?}");
    }
}
