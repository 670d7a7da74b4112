//! Rows of form factors: the device says of each ray what it met, and the host counts.

use super::elements::place_words;
use super::scene::{OFFSETS, SceneBuffers};
use super::task::{Pace, WORKGROUP, bindings};
use crate::gpu::{Binding, Buffer, Gpu, Pending, Pipeline, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::{BackendError, Control, FormFactorJob};
use etendue_core::radiosity::form_factors::Row;
use etendue_core::radiosity::form_factors::rays::shares;
use etendue_core::radiosity::patches::PatchMap;
use etendue_core::scene::CompiledScene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Rays of the first submission, and most of any.
const FIRST: u64 = 1 << 14;
const MOST: u64 = 1 << 22;

/// The words of patches as `wavefront/rows.wgsl` reads them, and where each list begins.
struct Laid {
    words: Vec<u32>,
    /// The first rays of patches, patches of elements, first members, members, their primitives and counts.
    lists: [u32; 6],
}

/// `starts` are the first rays of the patches from `first_patch` on, modulo 2^32.
fn lay_down(scene: &CompiledScene, map: &PatchMap, first_patch: u32, starts: &[u32]) -> Laid {
    let parts = map.patches.parts();
    let mut words = place_words(scene, &map.elements).0;
    let mut lists = [0; 6];
    for (at, list) in lists.iter_mut().zip([
        starts,
        parts.of,
        parts.first,
        parts.members,
        parts.primitives,
        parts.cumulative,
    ]) {
        *at = words.len() as u32;
        words.extend_from_slice(list);
    }
    // So that patch p is at this plus p.
    lists[0] = lists[0].wrapping_sub(first_patch);
    Laid { words, lists }
}

/// A job on a device.
struct Rows<'a> {
    gpu: &'a Gpu,
    job: &'a FormFactorJob,
    per_side: u32,
    pipeline: Arc<Pipeline>,
    uniform: Buffer,
    met: Buffer,
    group: wgpu::BindGroup,
    lists: [u32; 6],
    /// The first ray of each patch of the job, and all rays last.
    starts: Vec<u64>,
    patches: Range<u32>,
}

/// A submission on its way.
struct Sent {
    pending: Pending,
    rays: u64,
}

impl Rows<'_> {
    fn total(&self) -> u64 {
        self.starts.last().copied().unwrap_or(0)
    }

    /// Sends rays from one on.
    fn send(&self, first: u64, rays: u64) -> Sent {
        let patch_of = |ray: u64| self.patches.start + self.starts.partition_point(|s| *s <= ray) as u32 - 1;
        let [starts, of, first_member, members, primitives, cumulative] = self.lists;
        let words = [
            self.job.seed as u32,
            (self.job.seed >> 32) as u32,
            first as u32,
            rays as u32,
            patch_of(first),
            patch_of(first + rays - 1) + 1,
            starts,
            of,
            first_member,
            members,
            primitives,
            cumulative,
            self.per_side,
            0,
        ];
        self.gpu.queue.write_buffer(&self.uniform.raw, 0, bytemuck::cast_slice(&words));
        let mut encoder = self.gpu.encoder();
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline.raw);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups((rays as u32).div_ceil(WORKGROUP), 1, 1);
        }
        Sent { pending: self.gpu.submit_and_read(encoder, &self.met, rays), rays }
    }

    /// Counts what the rays of whole patches met, from the patch with this place in the job on.
    fn count(&self, from: usize, until: usize, met: &[u32], n: usize) -> Vec<Row> {
        let base = self.starts[from];
        (from..until)
            .into_par_iter()
            .with_max_len(16)
            .map_init(
                || vec![0; n],
                |counts, i| {
                    let own = [self.starts[i], self.starts[i + 1]].map(|s| (s - base) as usize);
                    let met = &met[own[0]..own[1]];
                    Row::count(met.len() as u32, met.iter().copied(), counts)
                },
            )
            .collect()
    }

    /// All rows; a submission is on its way while the host counts the one before it.
    fn run(&self, n: usize, control: &dyn Control) -> Result<Vec<Row>, BackendError> {
        let (total, all) = (self.total(), self.starts.len() - 1);
        let words = self.gpu.binding_bytes() / 4;
        let mut pace = Pace::new(FIRST, MOST.min(self.gpu.dispatch_items(WORKGROUP)).min(words));
        let mut rows = Vec::with_capacity(all);
        // What the rays of the first patch that has no row yet met, and of what follows.
        let mut met: Vec<u32> = Vec::new();
        let (mut asked, mut answered, mut last) = (0, 0, Instant::now());
        let next = |asked: &mut u64, pace: &Pace| {
            let rays = pace.amount().min(total - *asked);
            let sent = (rays > 0).then(|| self.send(*asked, rays));
            *asked += rays;
            sent
        };
        let mut sent = next(&mut asked, &pace);
        while let Some(now) = sent {
            sent = next(&mut asked, &pace);
            let words = now.pending.wait(self.gpu)?;
            pace.took(now.rays, last.elapsed());
            last = Instant::now();
            answered += now.rays;
            met.extend(words);
            let from = rows.len();
            let until = self.starts.partition_point(|s| *s <= answered) - 1;
            rows.extend(self.count(from, until, &met, n));
            met.drain(..(self.starts[until] - self.starts[from]) as usize);
            if control.advance(until as u64, all as u64).is_break() {
                return Err(BackendError::Cancelled);
            }
        }
        Ok(rows)
    }
}

/// The rows of a job.
pub(super) fn form_factors(
    gpu: &Arc<Gpu>,
    scene: &CompiledScene,
    buffers: &SceneBuffers,
    map: &PatchMap,
    job: &FormFactorJob,
    control: &dyn Control,
) -> Result<Vec<Row>, BackendError> {
    check(scene, map)?;
    let n = map.patches.len();
    let end = job.patches.end.min(n as u32);
    let patches = job.patches.start.min(end)..end;
    if patches.is_empty() {
        return Ok(Vec::new());
    }
    let mut starts = vec![0];
    let mut sum = 0_u64;
    for rays in &shares(&map.patches, job.rays)[patches.start as usize..patches.end as usize] {
        sum += u64::from(*rays);
        starts.push(sum);
    }
    let wrapped: Vec<u32> = starts.iter().map(|s| *s as u32).collect();
    let laid = lay_down(scene, map, patches.start, &wrapped);
    let stack = buffers.stack;
    let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use wavefront::rows\n");
    let key = PipelineKey { name: format!("rows stack {stack}"), entry: "rows" };
    let link = Link { root: &root, features: &[], mutations: &[] };
    let pipeline = gpu.pipeline(key, link, &bindings([Binding::Write, Binding::Read]))?;
    gpu.scoped(|| {
        let words = gpu.upload("patches", &laid.words)?;
        let room = MOST.min(sum).min(gpu.dispatch_items(WORKGROUP)).min(gpu.binding_bytes() / 4);
        let met = gpu.room("what rays met", room)?;
        let uniform = gpu.uniform("job", &[0; 16]);
        let group = gpu.bind(&pipeline, &buffers.bound(&uniform, [&met, &words]));
        let per_side = map.elements.per_side() as u32;
        let lists = laid.lists;
        Rows { gpu, job, per_side, pipeline, uniform, met, group, lists, starts, patches }.run(n, control)
    })
}

/// Refuses the patches of another scene: shaders ask for what is not there.
fn check(scene: &CompiledScene, map: &PatchMap) -> Result<(), BackendError> {
    let parts = map.patches.parts();
    let triangles = scene.triangles.len() as u32;
    let fits = map.elements.parts().0.len() == scene.primitives().count()
        && parts.of.len() == map.elements.count()
        && parts.primitives.iter().all(|p| *p < triangles);
    if fits { Ok(()) } else { Err(BackendError::BadJob { reason: "the patches are those of another scene" }) }
}
