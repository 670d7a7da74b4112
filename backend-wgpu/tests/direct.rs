//! Direct irradiance on a device against the CPU: where the device's arithmetic is exact, films are equal to the last bit, elsewhere nearly so.

mod adapter;
mod photon;

use etendue_conformance::analytic::compiled;
use etendue_conformance::scenes::{cases, diffuse, floor, point_light, room, shape, sphere};
use etendue_core::backend::{Arithmetic, Backend, BackendError, NoControl, PathJob, direct_film_settings};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, ElementSettings, Sides};
use etendue_core::scene::{CompiledScene, LightDesc, MeshDesc, SceneDesc, ShapeKind};
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Mutation, Options, wgpu};
use photon::{After, never_wait};
use std::ops::Range;
use std::sync::Arc;

fn job(blocks: Range<u32>) -> PathJob {
    PathJob { seed: 0x1234_5678_9abc, block_length: 8, blocks, max_depth: u32::MAX }
}

/// Elements of the size that primitives have, of a third and of an eighth of the scene.
fn settings(scene: &CompiledScene) -> Vec<ElementSettings> {
    let extent = (scene.bounds.hi - scene.bounds.lo).max_element();
    let mut all = Vec::new();
    for basis in [Basis::Constant, Basis::Linear] {
        for (sides, part) in [(Sides::Together, 0.12), (Sides::Together, f32::INFINITY), (Sides::Apart, 0.3)]
        {
            all.push(ElementSettings { basis, sides, largest: part * extent });
        }
    }
    all
}

/// A room with a ball, a disk and a triangle too thin for an element of its own, under lights of each kind.
fn furnished() -> SceneDesc {
    let disk = ShapeKind::Disk { center: [0.3, -0.4, 0.1], radius: 0.4, normal: [0.2, 0.1, 0.9] };
    let thin = MeshDesc {
        positions: vec![[-0.9, -0.9, -0.5], [0.9, -0.9, -0.5], [0.0, -0.9, -0.5 + 1e-7], [0.0, -0.2, 0.6]],
        triangles: vec![[0, 1, 2], [0, 1, 3]],
        ..room([0.0; 3], 1.0, "wall")
    };
    SceneDesc {
        meshes: vec![room([0.0; 3], 1.0, "wall"), thin],
        shapes: vec![sphere([-0.4, 0.3, -0.5], 0.35, "wall"), shape(disk, "wall")],
        materials: vec![diffuse("wall", 0.6, 0.0)],
        lights: vec![
            point_light([0.1, 0.2, 0.8], 3.0),
            LightDesc::Spot {
                position: [-0.5, -0.5, 0.9],
                direction: [0.4, 0.6, -1.0],
                intensity: [5.0, 2.0, 0.1],
                cone_deg: 50.0,
                falloff_deg: 20.0,
            },
            LightDesc::Directional { direction: [0.3, -0.2, -1.0], irradiance: [0.7, 0.8, 0.9] },
        ],
        ..SceneDesc::default()
    }
}

/// A floor under a sun and more lamps than one invocation takes, one of them within the floor.
fn lamps() -> SceneDesc {
    let lamp = |i: u32| {
        let x = i as f32 * 0.37;
        point_light([x % 3.0 - 1.5, (x * 1.7) % 3.0 - 1.5, 0.05 * i as f32], 0.01 * i as f32)
    };
    let mut lights: Vec<LightDesc> = (0..150).map(lamp).collect();
    lights.push(LightDesc::Directional { direction: [1.0, 0.5, -0.3], irradiance: [2.0, 1.0, 0.5] });
    SceneDesc {
        shapes: vec![floor(0.0, 1.5, "floor"), sphere([0.2, 0.1, 0.6], 0.4, "floor")],
        materials: vec![diffuse("floor", 0.5, 0.0)],
        lights,
        ..SceneDesc::default()
    }
}

fn film(scene: &CompiledScene, settings: &ElementSettings, job: &PathJob) -> Film {
    let elements = etendue_core::illumination::Elements::new(scene, *settings);
    Film::new(direct_film_settings(scene, &elements, job))
}

fn scene(desc: &SceneDesc) -> Arc<CompiledScene> {
    compiled(desc).unwrap()
}

/// Whether an element is the same but for the rounding of a device that computes as it likes.
fn is_near(a: &Film, b: &Film, element: usize) -> bool {
    let pairs = a.mean(element).into_iter().zip(b.mean(element));
    pairs.into_iter().all(|(a, b)| (a - b).abs() <= 1e-4 * b.abs() + 1e-6)
}

#[test]
fn films_have_the_bits_of_the_cpu() {
    let Some(device) = adapter::backend() else { return };
    let is_exact = device.arithmetic() == Arithmetic::Ieee;
    let cpu = CpuBackend::new(None).unwrap();
    let mut scenes = vec![("furnished".to_string(), scene(&furnished())), ("lamps".into(), scene(&lamps()))];
    for case in cases::cases() {
        let compiled = scene(&case.scene);
        if compiled.needs.point_like_lights && !compiled.needs.volume() {
            scenes.push((case.name.clone(), compiled));
        }
    }
    scenes.push(("foggy".into(), scene(&photon::foggy())));
    assert!(scenes.len() > 3);
    let (mut lit, mut wrong) = (0, Vec::new());
    for (name, scene) in &scenes {
        let (ours, theirs) = (device.open(scene.clone()).unwrap(), cpu.open(scene.clone()).unwrap());
        for settings in settings(scene) {
            let job = job(3..5);
            let (mut a, mut b) = (film(scene, &settings, &job), film(scene, &settings, &job));
            let found = ours.direct_irradiance(&job, &settings, &NoControl, &mut a).unwrap();
            let expected = theirs.direct_irradiance(&job, &settings, &NoControl, &mut b).unwrap();
            lit += (0..a.len()).filter(|i| a.mean(*i) != [0.0; 3]).count();
            let differing: Vec<usize> = (0..a.len())
                .filter(|i| if is_exact { a.mean(*i) != b.mean(*i) } else { !is_near(&a, &b, *i) })
                .collect();
            let is_right = if is_exact {
                found == expected && a == b
            } else {
                // A ray that passes an edge may meet it.
                differing.len() <= a.len() / 500
            };
            if !is_right {
                let at = differing.first().map(|i| (i, a.mean(*i), b.mean(*i)));
                let count = differing.len();
                wrong.push(format!("{name} {settings:?}: {found:?} {expected:?}; {count} differ, {at:?}"));
            }
        }
    }
    assert!(lit > 10_000, "{lit}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn mistakes_are_noticed() {
    let scene = scene(&furnished());
    let cpu = CpuBackend::new(None).unwrap().open(scene.clone()).unwrap();
    let settings = ElementSettings { basis: Basis::Linear, sides: Sides::Apart, largest: 0.5 };
    let (mut expected, mut found) =
        (film(&scene, &settings, &job(0..1)), film(&scene, &settings, &job(0..1)));
    cpu.direct_irradiance(&job(0..1), &settings, &NoControl, &mut expected).unwrap();
    for (module, from, to) in [
        ("illumination::sums", "u32(old + x.x < old)", "0u"),
        ("wavefront::direct", "light < job.light_count", "light + 1u < job.light_count"),
        ("direct::irradiance", "math_abs(cos)", "math_max_number(cos, 0.0f)"),
        ("illumination::elements", "12.0f * cell.bary - 3.0f", "9.0f * cell.bary - 2.0f"),
        ("illumination::elements", "from_front || !map.sides_apart", "true"),
        ("illumination::lattice", "p = vec2(1.0f - local.x, 1.0f - local.y)", "p = local"),
        ("illumination", "~whole.x + 1u", "~whole.x"),
    ] {
        let mutations = vec![Mutation { module, from, to }];
        let Some(device) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
        let session = device.open(scene.clone()).unwrap();
        let before = found.clone();
        session.direct_irradiance(&job(0..1), &settings, &NoControl, &mut found).unwrap();
        assert_ne!(found, expected, "{module}: {from}");
        found = before;
    }
}

#[test]
fn any_split_of_blocks_merges_to_the_same_bits() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&furnished());
    let session = device.open(scene.clone()).unwrap();
    let settings = ElementSettings { basis: Basis::Linear, sides: Sides::Apart, largest: 0.2 };
    let run = |blocks: Range<u32>| {
        let mut film = film(&scene, &settings, &job(blocks.clone()));
        session.direct_irradiance(&job(blocks), &settings, &NoControl, &mut film).unwrap();
        film
    };
    let whole = run(0..8);
    for cut in [0, 1, 5] {
        let mut parts = run(cut..8);
        parts.merge(&run(0..cut)).unwrap();
        assert_eq!(parts, whole, "{cut}");
    }
}

#[test]
fn a_cancelled_job_leaves_the_film_as_it_was() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&furnished());
    let session = device.open(scene.clone()).unwrap();
    let settings = ElementSettings::default();
    let mut film = film(&scene, &settings, &job(0..1));
    session.direct_irradiance(&job(0..1), &settings, &NoControl, &mut film).unwrap();
    let before = film.clone();
    for calls in [1, 3] {
        let control = After::calls(calls);
        let found = session.direct_irradiance(&job(1..9), &settings, &control, &mut film);
        assert!(matches!(found, Err(BackendError::Cancelled)), "{found:?}");
        assert_eq!(film, before);
    }
}

#[test]
fn a_task_never_waits() {
    let Some(device) = adapter::backend() else { return };
    let scene = scene(&furnished());
    let session = device.open_scene(scene.clone()).unwrap();
    let settings = ElementSettings { largest: 0.1, ..ElementSettings::default() };
    let mut task = session.direct_task(&job(0..3), &settings).unwrap();
    let last = never_wait(|| task.step(false));
    assert!(last > 0);
    let mut by_job = film(&scene, &settings, &job(0..3));
    use etendue_core::backend::Session as _;
    session.direct_irradiance(&job(0..3), &settings, &NoControl, &mut by_job).unwrap();
    assert_eq!(task.finish().0, by_job);
}

#[test]
fn what_does_not_fit_is_an_error() {
    let Some(device) = adapter::backend() else { return };
    let settings = ElementSettings::default();
    let scene = scene(&furnished());
    let session = device.open(scene.clone()).unwrap();
    let mut other = film(&scene, &ElementSettings { largest: 0.2, ..settings }, &job(0..1));
    let found = session.direct_irradiance(&job(0..1), &settings, &NoControl, &mut other);
    assert!(matches!(found, Err(BackendError::Film(_))), "{found:?}");
    let odd = PathJob { block_length: 3, ..job(0..1) };
    let found = session.direct_irradiance(&odd, &settings, &NoControl, &mut other);
    assert!(matches!(found, Err(BackendError::BadJob { .. })), "{found:?}");

    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 14, ..Default::default() };
    let options = Options { limits: Some(limits), ..Default::default() };
    let Some(small) = adapter::backend_with(options) else { return };
    let fine = ElementSettings { largest: 0.01, ..settings };
    let mut film = film(&scene, &fine, &job(0..1));
    let found = small.open(scene).unwrap().direct_irradiance(&job(0..1), &fine, &NoControl, &mut film);
    assert!(matches!(found, Err(BackendError::LimitExceeded { .. })), "{found:?}");
}
