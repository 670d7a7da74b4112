//! Pieces of lit triangles cut on a device against the CPU's: where the device's arithmetic is exact they have its bits, and take as many rays.

mod adapter;
mod crowd;
mod photon;

use etendue_conformance::scenes::{diffuse, point_light};
use etendue_core::backend::BackendError;
use etendue_core::direct::subdivide::{Limits, Robust};
use etendue_core::scene::{CompiledScene, MeshDesc, SceneDesc, ShapeKind};
use etendue_core::transport::first_shot::{Care, FirstShotError, LitPiece, Subdivision, Weights};
use etendue_cpu::CpuBackend;
use etendue_wgpu::{Mutation, Options, Step, WgpuBackend, wgpu};
use photon::{foggy, named, never_wait, plain, scene, scenes};
use std::sync::Arc;

/// Every rule: the source's to the letter too, where hardly anything but budgets ends a cut, and limits that demand cuts.
fn subdivisions() -> Vec<Subdivision> {
    let demanding = Limits { size: 0.02, largest: 0.4, least_depth: 2, depth: 9, budget: 90 };
    let letter = etendue_core::direct::subdivide::Published::default();
    vec![
        Subdivision::None,
        Subdivision::published(),
        Subdivision::Published(letter, demanding),
        Subdivision::Published(letter, Limits { budget: 256, ..Limits::default() }),
        Subdivision::robust(Weights::EXACT),
        Subdivision::robust(Weights::Density),
        Subdivision::Robust(Robust { relative: 0.02, ..Robust::default() }, demanding, Care::default()),
    ]
}

/// Pieces and the rays they took, by the host.
fn by_cpu(scene: &Arc<CompiledScene>, how: &Subdivision) -> Result<(Vec<LitPiece>, u64), FirstShotError> {
    let session = CpuBackend::new(None).unwrap().open_session(scene.clone()).unwrap();
    let (shot, rays) = session.make_first_shot(how, Weights::EXACT)?;
    Ok((shot.pieces().to_vec(), rays))
}

/// The same by the device.
fn by_device(
    device: &WgpuBackend,
    scene: &Arc<CompiledScene>,
    how: &Subdivision,
) -> Result<(Vec<LitPiece>, u64), BackendError> {
    let session = device.open_scene(scene.clone()).unwrap();
    let mut task = session.first_shot_task(how, Weights::EXACT)?;
    while task.step(true)? != Step::Done {}
    let (shot, rays) = task.finish()?;
    Ok((shot.pieces().to_vec(), rays))
}

/// What differs, and how many pieces there are.
fn differing(device: &WgpuBackend, scene: &Arc<CompiledScene>, how: &Subdivision) -> (usize, Option<String>) {
    let expected = match by_cpu(scene, how) {
        Ok(expected) => expected,
        Err(e) => {
            assert_eq!(by_device(device, scene, how).unwrap_err().to_string(), e.to_string());
            return (0, None);
        }
    };
    let found = by_device(device, scene, how).unwrap();
    let at = expected.0.iter().zip(&found.0).position(|(a, b)| a != b);
    let differs = found != expected;
    let said = format!(
        "{how:?}: {} pieces and {} rays, expected {} and {}; first at {at:?}: {:?}, expected {:?}",
        found.0.len(),
        found.1,
        expected.0.len(),
        expected.1,
        at.map(|i| found.0[i]),
        at.map(|i| expected.0[i]),
    );
    (expected.0.len(), differs.then_some(said))
}

fn same(
    device: &WgpuBackend,
    scenes: &[(String, Arc<CompiledScene>)],
    subdivisions: &[Subdivision],
    least: usize,
) {
    let (mut pieces, mut wrong) = (0, Vec::new());
    for (name, scene) in scenes {
        for how in subdivisions {
            let (some, said) = differing(device, scene, how);
            pieces += some;
            wrong.extend(said.map(|s| format!("{name} {s}")));
        }
    }
    assert!(pieces >= least, "{pieces}");
    assert!(wrong.is_empty(), "{} differ: {:#?}", wrong.len(), &wrong[..wrong.len().min(5)]);
}

#[test]
fn pieces_have_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_or_flushing() else { return };
    let some = [("plain".into(), scene(&plain())), ("stage".into(), named("stage"))];
    same(&device, &some, &subdivisions(), 1000);
}

#[test]
fn pieces_in_media_have_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_or_flushing() else { return };
    let mut foggy = foggy();
    foggy.shapes.retain(|s| !matches!(s.kind, ShapeKind::Sphere { .. } | ShapeKind::Disk { .. }));
    let few = [Subdivision::None, Subdivision::published(), Subdivision::robust(Weights::EXACT)];
    same(&device, &[("foggy".into(), scene(&foggy))], &few, 1000);
}

/// All scenes of the suite, and those with all that media can have: minutes.
#[test]
#[ignore = "minutes: the command is in TESTING.md"]
fn pieces_of_all_scenes_have_the_bits_of_the_cpu() {
    let Some(device) = adapter::exact_or_flushing() else { return };
    let mut all = scenes();
    for coloured in [false, true] {
        let mut desc = crowd::all_at_once(coloured);
        desc.shapes.retain(|s| !matches!(s.kind, ShapeKind::Sphere { .. } | ShapeKind::Disk { .. }));
        all.push((format!("flat {coloured}"), scene(&desc)));
    }
    same(&device, &all, &subdivisions(), 10_000);
}

/// A field of hills, some of whose triangles have no area, under so many lights.
fn hills(n: u32, lights: u32) -> SceneDesc {
    let height = |x: u32, y: u32| (x.wrapping_mul(7919) ^ y.wrapping_mul(104_729)) % 97;
    let at = |i: u32| {
        let (x, y) = (i % (n + 1), i / (n + 1));
        [x as f32 / n as f32 - 0.5, y as f32 / n as f32 - 0.5, 1e-3 * height(x, y) as f32]
    };
    let mut triangles = Vec::new();
    for y in 0..n {
        for x in 0..n {
            let a = y * (n + 1) + x;
            let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
            triangles.extend([[a, b, c], if (x + y) % 17 == 0 { [b, b, c] } else { [b, d, c] }]);
        }
    }
    SceneDesc {
        meshes: vec![MeshDesc {
            positions: (0..(n + 1) * (n + 1)).map(at).collect(),
            triangles,
            material: "ground".into(),
            ..MeshDesc::default()
        }],
        materials: vec![diffuse("ground", 0.5, 0.0)],
        lights: (0..lights)
            .map(|i| point_light([0.1 - 0.005 * i as f32, 0.2, 0.2 + 0.01 * i as f32], 1.0))
            .collect(),
        ..SceneDesc::default()
    }
}

/// More pairs than one list holds, in less room than there is for them.
#[test]
fn lists_may_be_many_and_room_little() {
    let Some(device) = adapter::exact_or_flushing() else { return };
    let many = scene(&hills(40, 90));
    assert!(90 * many.triangles.len() > 1 << 18);
    let glances = Care { glance: 1e-4, ..Care::default() };
    let mostly = Subdivision::Robust(Robust::default(), Limits::default(), glances);
    let (pieces, said) = differing(&device, &many, &mostly);
    assert!(pieces > 10_000 && said.is_none(), "{pieces} {said:?}");

    let limits = wgpu::Limits { max_storage_buffer_binding_size: 3 << 20, ..Default::default() };
    let options = Options { limits: Some(limits), ..Default::default() };
    let Some(small) = adapter::exact_with(options) else { return };
    let few = scene(&hills(20, 2));
    let (pieces, said) = differing(&small, &few, &Subdivision::robust(Weights::EXACT));
    assert!(pieces > 1000 && said.is_none(), "{pieces} {said:?}");
}

/// Where the device computes as it likes, the light is the same but for what a few cuts make of it.
#[test]
fn the_density_is_that_of_the_cpu() {
    let Some(device) = adapter::backend() else { return };
    let (scene, how) = (named("stage"), Subdivision::robust(Weights::EXACT));
    let sum = |pieces: &[LitPiece]| pieces.iter().map(|p| f64::from(p.importance)).sum::<f64>();
    let (found, expected) = (by_device(&device, &scene, &how).unwrap(), by_cpu(&scene, &how).unwrap());
    assert!((sum(&found.0) / sum(&expected.0) - 1.0).abs() < 1e-3);
    assert!((found.0.len() as f64 / expected.0.len() as f64 - 1.0).abs() < 0.02);
}

#[test]
fn mistakes_are_noticed() {
    // Right angles hide what oblique triangles do not.
    let scenes = [scene(&plain()), scene(&hills(4, 2))];
    let all: Vec<_> =
        subdivisions().into_iter().flat_map(|how| scenes.iter().map(move |s| (s, how))).collect();
    for (module, from, to) in [
        ("wavefront::pieces", "select(before, shares.first, k + 1u == count)", "k"),
        ("wavefront::pieces", "lane.budget += lane.spare;", ""),
        ("wavefront::pieces", "lane.waiting + count <= SUBDIVIDE_STACK", "lane.waiting + count <= 4u"),
        ("wavefront::pieces", "settled && !ends", "settled || ends"),
        ("direct::subdivide::walk", "scaled + vec4(total / 16.0f)", "scaled"),
        ("direct::subdivide::walk", "part.rounded != 0u || exact", "exact"),
        ("direct::subdivide::shape", "let y = -scaled.edges", "let y = scaled.edges"),
        ("direct::subdivide::walk", "SUBDIVIDE_DOUBT: f32 = 0.7f", "SUBDIVIDE_DOUBT: f32 = 0.8f"),
        ("transport::first_shot::pieces", "1.0f / 2048.0f", "1.0f / 1024.0f"),
    ] {
        let mutations = vec![Mutation { module, from, to }];
        let Some(device) = adapter::exact_with(Options { mutations, ..Options::default() }) else { return };
        let noticed = all.iter().any(|(scene, how)| differing(&device, scene, how).1.is_some());
        assert!(noticed, "{module}: {from}");
    }
}

#[test]
fn a_task_never_waits() {
    let Some(device) = adapter::backend() else { return };
    let (scene, how) = (scene(&plain()), Subdivision::robust(Weights::EXACT));
    let session = device.open_scene(scene.clone()).unwrap();
    let mut task = session.first_shot_task(&how, Weights::EXACT).unwrap();
    assert!(never_wait(|| task.step(false)) > 0);
    let (shot, rays) = task.finish().unwrap();
    assert_eq!((shot.pieces().to_vec(), rays), by_device(&device, &scene, &how).unwrap());
}

#[test]
fn what_has_no_pieces_says_so() {
    let Some(device) = adapter::backend() else { return };
    let how = Subdivision::published();
    let said = by_device(&device, &scene(&photon::furnished()), &how).unwrap_err();
    assert!(said.to_string().contains("round shapes"), "{said}");
    let mut unlit = plain();
    unlit.lights.clear();
    unlit.materials.iter_mut().for_each(|m| m.emission = [0.0; 3]);
    let said = by_device(&device, &scene(&unlit), &how).unwrap_err();
    assert_eq!(said.to_string(), FirstShotError::Dark.to_string());
}
