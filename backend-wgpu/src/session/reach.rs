//! Walks that find what light can get to, on the device: each marks the element sides that it meets.

use super::elements::place_words;
use super::scene::{OFFSETS, SceneBuffers};
use super::task::{Pace, WORKGROUP, bindings};
use crate::gpu::{Binding, Gpu, PipelineKey};
use crate::shaders::Link;
use etendue_core::backend::BackendError;
use etendue_core::illumination::Elements;
use etendue_core::radiosity::form_factors::reach::{From, HITS, Walks, begins};
use etendue_core::scene::CompiledScene;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Walks of the first submission.
const FIRST: u64 = 1 << 12;

/// Takes walks, and marks what they meet; how many left the scene.
pub(super) fn walk(
    gpu: &Arc<Gpu>,
    scene: &CompiledScene,
    buffers: &SceneBuffers,
    elements: &Elements,
    walks: &Walks,
    reached: &[AtomicBool],
) -> Result<u32, BackendError> {
    let stack = buffers.stack;
    let root = format!("{OFFSETS}const TREE_STACK: u32 = {stack}u;\n//: use wavefront::reach\n");
    let key = PipelineKey { name: format!("reach stack {stack}"), entry: "reach" };
    let link = Link { root: &root, features: &[], mutations: &[] };
    let pipeline = gpu.pipeline(key, link, &bindings([Binding::Write, Binding::Read]))?;
    let count = u64::from(walks.count);
    let (centre, radius) = scene.bounding_sphere();
    let (seed, replicate) = walks.numbers;
    let marks = gpu.scoped(|| {
        let words = gpu.upload("elements", &place_words(scene, elements).0)?;
        let found = 1 + (elements.count() as u64).div_ceil(32);
        let marks = gpu.room("marks of elements", found)?;
        let uniform = gpu.uniform("job", &[0; 16]);
        let group = gpu.bind(&pipeline, &buffers.bound(&uniform, [&marks, &words]));
        let mut pace = Pace::new(FIRST, gpu.dispatch_items(WORKGROUP));
        let mut first = 0;
        loop {
            let taken = pace.amount().min(count - first);
            let last = first + taken == count;
            let words = [
                centre.x.to_bits(),
                centre.y.to_bits(),
                centre.z.to_bits(),
                radius.to_bits(),
                seed as u32,
                (seed >> 32) as u32,
                replicate,
                u32::from(walks.from == From::Infinity),
                begins(scene),
                first as u32,
                taken as u32,
                HITS,
                elements.count() as u32,
                elements.per_side() as u32,
            ];
            gpu.queue.write_buffer(&uniform.raw, 0, bytemuck::cast_slice(&words));
            let mut encoder = gpu.encoder();
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&pipeline.raw);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups((taken as u32).div_ceil(WORKGROUP), 1, 1);
            }
            let sent = Instant::now();
            let answer = gpu.submit_and_read(encoder, &marks, if last { found } else { 1 }).wait(gpu)?;
            pace.took(taken, sent.elapsed());
            first += taken;
            if last {
                return Ok(answer);
            }
        }
    })?;
    let (left, marks) = marks.split_first().map_or((0, &[][..]), |(left, marks)| (*left, marks));
    for (element, reached) in reached.iter().enumerate() {
        if marks.get(element / 32).is_some_and(|word| word >> (element % 32) & 1 == 1) {
            reached.store(true, Ordering::Relaxed);
        }
    }
    Ok(left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mutation, Options, WgpuBackend, adapter};
    use etendue_conformance::analytic::compiled;
    use etendue_conformance::scenes::{camera, diffuse, point_light, room};
    use etendue_core::radiosity::patches::PatchSettings;
    use etendue_core::scene::{LightDesc, SceneDesc};
    use etendue_cpu::Radiosity;
    use etendue_tree::WideTree;

    /// A room without a lid under a lamp, a spot and a sun, with a camera.
    fn court() -> CompiledScene {
        let mut walls = room([0.0; 3], 1.0, "wall");
        let heights: Vec<f32> = walls.positions.iter().map(|p| p[2]).collect();
        walls.triangles.retain(|t| t.iter().any(|v| heights[*v as usize] < 0.9));
        let spot = LightDesc::Spot {
            position: [-0.5, -0.5, 0.9],
            direction: [0.4, 0.6, -1.0],
            intensity: [5.0, 2.0, 0.1],
            cone_deg: 50.0,
            falloff_deg: 20.0,
        };
        let sun = LightDesc::Directional { direction: [0.3, -0.2, -1.0], irradiance: [0.7, 0.8, 0.9] };
        let desc = SceneDesc {
            meshes: vec![walls],
            materials: vec![diffuse("wall", 0.6, 0.0)],
            lights: vec![point_light([0.1, 0.2, 0.8], 3.0), spot, sun],
            camera: Some(camera([0.6, -0.7, 0.3], [-0.4, 0.2, -0.8], 60.0, [32, 24])),
            ..SceneDesc::default()
        };
        CompiledScene::clone(&compiled(&desc).unwrap())
    }

    /// So few walks that what one of them meets counts.
    const ALL: [Walks; 3] = [
        Walks { from: From::Inside, numbers: (3, 0), count: 16 },
        Walks { from: From::Inside, numbers: (1 << 40, 0), count: 150 },
        Walks { from: From::Infinity, numbers: (3, 1), count: 100 },
    ];

    type Marks = (u32, Vec<bool>);

    fn marks(count: usize, walk: impl FnOnce(&[AtomicBool]) -> u32) -> Marks {
        let reached: Vec<AtomicBool> = (0..count).map(|_| AtomicBool::new(false)).collect();
        let left = walk(&reached);
        (left, reached.into_iter().map(AtomicBool::into_inner).collect())
    }

    fn on_device(backend: &WgpuBackend, scene: &CompiledScene, elements: &Elements) -> Vec<Marks> {
        let gpu = backend.source.gpu();
        let tree = WideTree::build(&scene.primitives());
        let buffers = SceneBuffers::new(&gpu, scene, &tree).unwrap();
        let take = |walks| {
            marks(elements.count(), |reached| walk(&gpu, scene, &buffers, elements, walks, reached).unwrap())
        };
        ALL.iter().map(take).collect()
    }

    #[test]
    fn walks_mark_what_those_of_the_cpu_do() {
        let Some(device) = adapter::exact_with(Options::default()) else { return };
        let scene = court();
        let elements = Elements::new(&scene, PatchSettings { count: 300, seed: 0 }.elements(&scene));
        let tree = WideTree::build(&scene.primitives());
        let take = |walks| {
            let ground = (&scene, &tree, &elements);
            marks(elements.count(), |reached| Radiosity::default().walk(ground, walks, reached))
        };
        let expected: Vec<Marks> = ALL.iter().map(take).collect();
        for (left, marks) in &expected {
            let met = marks.iter().filter(|m| **m).count();
            assert!(*left > 5 && met > 20 && met < marks.len() / 2, "{left} {met} of {}", marks.len());
        }
        assert!(on_device(&device, &scene, &elements) == expected);
        for (module, from, to) in [
            ("wavefront::reach", "atomicAdd(&marks[0], 1u)", "atomicAdd(&marks[0], 2u)"),
            ("wavefront::reach", "hit.b2, surface.from_front)", "hit.b2, true)"),
            ("radiosity::form_factors::reach", "begins).x", "begins).y"),
            ("radiosity::form_factors::reach", "REACH_WALK_GROUP + hits", "REACH_WALK_GROUP"),
        ] {
            let mutations = vec![Mutation { module, from, to }];
            let Some(device) = adapter::exact_with(Options { mutations, ..Options::default() }) else {
                return;
            };
            assert!(on_device(&device, &scene, &elements) != expected, "{module}: {from}");
        }
    }
}
