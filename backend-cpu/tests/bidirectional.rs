//! Bidirectional path tracing against path tracing, strategy by strategy and where others went wrong.

#![allow(clippy::disallowed_methods, reason = "statistics in f64")]

use etendue_core::backend::{
    BidirectionalJob, NoControl, PathJob, Probe, Session, image_film_settings, probe_film_settings,
};
use etendue_core::film::Film;
use etendue_core::scene::{
    CameraDesc, LightDesc, MaterialDesc, MaterialKind, MediumDesc, MeshDesc, Reflectance, Roughness,
    SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_core::transport::bidirectional::{CUTOFF, Heuristic};
use etendue_cpu::{CpuBackend, CpuSession};
use std::sync::Arc;

/// Standard errors that means may be apart: one of the hundred comparisons here exceeds them by chance once in 1000 runs of other seeds.
const LIMIT: f64 = 4.5;

fn material(name: &str, kind: MaterialKind, emission: [f32; 3]) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission }
}

fn grey(name: &str, albedo: f32) -> MaterialDesc {
    material(
        name,
        MaterialKind::Diffuse { albedo: Reflectance::flat([albedo, 0.8 * albedo, 0.6 * albedo]) },
        [0.0; 3],
    )
}

fn shape(kind: ShapeKind, material: &str, interior: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: interior.into(), exterior: String::new() }
}

fn camera(medium: &str) -> CameraDesc {
    CameraDesc {
        position: [0.0, 0.1, 0.95],
        look_at: [0.1, -0.2, -1.0],
        up: [0.0, 1.0, 0.0],
        fov_x_deg: 70.0,
        resolution: [4, 4],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: medium.into(),
    }
}

/// A closed room from -1 to 1 with a block, a lamp at the ceiling, and a glossy wall.
fn room() -> SceneDesc {
    let phong = MaterialKind::DiffusePhong {
        albedo: Reflectance::flat([0.3, 0.2, 0.4]),
        specular: [0.4; 3],
        exponent: 20.0,
    };
    let wall = |center: [f32; 3], u: [f32; 3], v: [f32; 3], material: &str| {
        shape(ShapeKind::Rectangle { center, u, v }, material, "")
    };
    let black = MaterialKind::Diffuse { albedo: Reflectance::flat([0.0; 3]) };
    SceneDesc {
        camera: Some(camera("")),
        materials: vec![
            grey("wall", 0.7),
            material("gloss", phong, [0.0; 3]),
            material("lamp", black, [8.0, 6.0, 5.0]),
        ],
        shapes: vec![
            wall([0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], "wall"),
            wall([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], "wall"),
            wall([0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], "gloss"),
            wall([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], "wall"),
            wall([-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], "wall"),
            wall([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], "wall"),
            shape(ShapeKind::Box { min: [-0.6, -1.0, -0.5], max: [-0.1, -0.2, 0.0] }, "wall", ""),
            wall([0.1, 0.98, 0.0], [0.3, 0.0, 0.0], [0.0, 0.0, 0.3], "lamp"),
        ],
        ..SceneDesc::default()
    }
}

fn open(desc: &SceneDesc, threads: usize) -> CpuSession {
    let (scene, report) = compile(desc).unwrap();
    assert!(report.cleanups.is_empty(), "{report:?}");
    CpuBackend::new(Some(threads)).unwrap().open_session(Arc::new(scene)).unwrap()
}

fn job(blocks: u32, block_length: u32, max_depth: u32) -> PathJob {
    PathJob { seed: 5, block_length, blocks: 0..blocks, max_depth }
}

fn path(session: &CpuSession, job: &PathJob) -> Film {
    let mut film = Film::new(image_film_settings(session.scene(), job).unwrap());
    session.path_image(job, &NoControl, &mut film).unwrap();
    film
}

fn both(session: &CpuSession, job: &BidirectionalJob) -> Film {
    let mut film = Film::new(image_film_settings(session.scene(), &job.path).unwrap());
    session.bidirectional_image(job, &NoControl, &mut film).unwrap();
    assert_eq!((film.invalid(), film.saturated()), (0, 0));
    film
}

/// Mean of all pixels and channels, and its standard error from the pixels' own (as if they were independent: splats make them less than that, at most).
fn mean(film: &Film) -> (f64, f64) {
    let n = (3 * film.len()) as f64;
    let (mut sum, mut variance) = (0.0, 0.0);
    for i in 0..film.len() {
        sum += film.mean(i).iter().sum::<f64>();
        variance += film.variance(i).unwrap().iter().sum::<f64>();
    }
    // Channels of one pixel rise and fall together.
    (sum / n, (3.0 * variance).sqrt() / n)
}

/// Means agree, and the first is known within this part of the second.
fn agree(what: &str, a: (f64, f64), b: (f64, f64), power: f64) {
    let error = (a.1 * a.1 + b.1 * b.1).sqrt();
    assert!(
        (a.0 - b.0).abs() <= LIMIT * error,
        "{what}: {a:?} {b:?}, {:.1} standard errors",
        (a.0 - b.0) / error
    );
    assert!(a.1 <= power * b.0 && b.1 <= 0.25 * b.0, "{what}: known by {} and {} of {}", a.1, b.1, b.0);
}

/// All pixels agree by themselves.
fn pixels_agree(what: &str, a: &Film, b: &Film) {
    for i in 0..a.len() {
        let (va, vb) = (a.variance(i).unwrap(), b.variance(i).unwrap());
        for c in 0..3 {
            let error = (va[c] + vb[c]).sqrt();
            let (x, y) = (a.mean(i)[c], b.mean(i)[c]);
            assert!(
                (x - y).abs() <= 5.5 * error + 1e-5 * y,
                "{what}, pixel {i} channel {c}: {x} {y} +- {error}"
            );
        }
    }
}

/// A fog that fills the room.
fn fog(sigma_s: [f32; 3], g: f32) -> MediumDesc {
    MediumDesc::new("fog", [0.2, 0.1, 0.05], sigma_s, g)
}

fn foggy() -> SceneDesc {
    let mut desc = room();
    desc.media.push(fog([0.6, 0.9, 1.4], 0.3));
    for s in &mut desc.shapes {
        s.exterior = "fog".into();
    }
    desc.camera = Some(camera("fog"));
    desc
}

#[test]
fn each_strategy_alone_agrees_with_the_others() {
    for (name, desc) in [("room", room()), ("fog", foggy())] {
        let session = open(&desc, 2);
        for edges in 2..=4_u32 {
            let longer = path(&session, &job(32, 128, edges));
            let shorter = path(&session, &job(32, 128, edges - 1));
            let (a, b) = (mean(&longer), mean(&shorter));
            let truth = (a.0 - b.0, (a.1 * a.1 + b.1 * b.1).sqrt());
            for s in 0..=edges {
                let only = Some([s, edges + 1 - s]);
                let film =
                    both(&session, &BidirectionalJob { only, ..BidirectionalJob::new(job(32, 128, edges)) });
                // What is scattered right before a camera that stands in fog has no finite variance.
                let power = if name == "fog" && s == edges { 0.6 } else { 0.08 };
                agree(&format!("{name}, {only:?}"), mean(&film), truth, power);
            }
        }
    }
}

#[test]
fn heuristics_and_paths_agree() {
    for (name, desc) in [("room", room()), ("fog", foggy())] {
        let session = open(&desc, 2);
        let truth = path(&session, &job(32, 64, u32::MAX));
        for heuristic in [Heuristic::Power, Heuristic::Balance, Heuristic::Cutoff(CUTOFF)] {
            let film = both(
                &session,
                &BidirectionalJob { heuristic, ..BidirectionalJob::new(job(32, 64, u32::MAX)) },
            );
            let what = format!("{name}, {heuristic:?}");
            agree(&what, mean(&film), mean(&truth), 0.02);
            pixels_agree(&what, &film, &truth);
        }
    }
}

#[test]
fn all_kinds_of_light_and_glass_agree_with_paths() {
    let intensity = [0.7, 0.6, 0.5];
    let lights = [
        ("point", Some(LightDesc::Point { position: [0.3, 0.4, 0.1], intensity })),
        (
            "spot",
            Some(LightDesc::Spot {
                position: [0.3, 0.6, 0.1],
                direction: [-0.2, -1.0, -0.3],
                intensity,
                cone_deg: 50.0,
                falloff_deg: 30.0,
            }),
        ),
        ("sphere", None),
    ];
    for (name, light) in lights {
        for media in [false, true] {
            let mut desc = if media { foggy() } else { room() };
            desc.shapes.pop();
            match &light {
                Some(light) => desc.lights.push(light.clone()),
                None => desc.shapes.push(ShapeDesc {
                    exterior: if media { "fog".into() } else { String::new() },
                    ..shape(ShapeKind::Sphere { center: [0.2, 0.5, 0.0], radius: 0.15 }, "lamp", "")
                }),
            }
            let session = open(&desc, 2);
            let job = job(32, 64, u32::MAX);
            let (film, truth) = (both(&session, &BidirectionalJob::new(job.clone())), path(&session, &job));
            let what = format!("{name}, media {media}");
            agree(&what, mean(&film), mean(&truth), 0.02);
            // Next to a lamp without size in a medium paths have no variance that samples would show: their error bars say too little.
            if !media || light.is_none() {
                pixels_agree(&what, &film, &truth);
            }
        }
    }
}

/// The room open above to a beam, with a glass ball, a pane and a film of colour.
#[test]
fn glass_panes_and_beams_agree_with_paths() {
    let mut desc = room();
    desc.shapes.remove(1);
    desc.materials.push(material(
        "glass",
        MaterialKind::Dielectric { ior: [1.5; 3], schlick: false },
        [0.0; 3],
    ));
    desc.materials.push(material(
        "pane",
        MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: false },
        [0.0; 3],
    ));
    let film = MaterialKind::ThinFilm { reflect: [0.1, 0.2, 0.3], transmit: [0.8, 0.5, 0.3] };
    desc.materials.push(material("film", film, [0.0; 3]));
    desc.shapes.push(shape(ShapeKind::Sphere { center: [0.4, -0.5, -0.1], radius: 0.3 }, "glass", ""));
    let across = |x: f32, material: &str| {
        let kind = ShapeKind::Rectangle { center: [x, 0.0, -0.6], u: [0.0, 0.5, 0.0], v: [0.0, 0.0, 0.3] };
        shape(kind, material, "")
    };
    desc.shapes.push(across(0.2, "pane"));
    desc.shapes.push(across(-0.3, "film"));
    desc.lights.push(LightDesc::Directional { direction: [0.2, -1.0, -0.1], irradiance: [1.0; 3] });
    let mut beam = desc.clone();
    beam.shapes.retain(|s| s.material != "lamp");
    let session = open(&beam, 2);
    // Paths find what a lamp sends through glass by chance, and what a beam sends never: the lamp alone, then the beam on what is lit straight or through panes.
    let job = job(32, 256, 5);
    let mut lamp = desc.clone();
    lamp.lights.clear();
    let lamp = open(&lamp, 2);
    let (film, truth) = (both(&lamp, &BidirectionalJob::new(job.clone())), path(&lamp, &job));
    agree("lamp and glass", mean(&film), mean(&truth), 0.02);
    desc.shapes.retain(|s| s.material != "glass");
    let open_room = open(&desc, 2);
    let (a, b) = (both(&open_room, &BidirectionalJob::new(job.clone())), path(&open_room, &job));
    // A mirror image of the beam by a pane is a caustic too: none of it is here by more than 15 percent of 4 percent.
    let (a, b) = (mean(&a), mean(&b));
    assert!(a.0 >= b.0 - LIMIT * a.1.hypot(b.1) && a.0 < 1.1 * b.0, "{a:?} {b:?}");
    // The beam through the ball, without the lamp: more than without its caustic.
    let with = mean(&both(&session, &BidirectionalJob::new(job.clone())));
    let without = mean(&path(&session, &job));
    assert!(with.0 > without.0 + 3.0 * with.1.hypot(without.1), "{with:?} {without:?}");
}

/// One thing of each rough kind in the room: what the lobes of both ends carry must be the same light.
#[test]
fn rough_surfaces_agree_with_paths() {
    let rough = Roughness::Ggx(0.3);
    let albedo = Reflectance::flat([0.6, 0.4, 0.3]);
    let kinds = [
        (
            "metal",
            MaterialKind::RoughConductor { eta: [0.2, 0.9, 1.1], k: [3.9, 2.4, 2.2], roughness: rough },
        ),
        ("glass", MaterialKind::RoughDielectric { ior: [1.5; 3], schlick: false, roughness: rough }),
        ("prism", MaterialKind::RoughDielectric { ior: [1.3, 1.5, 1.9], schlick: false, roughness: rough }),
        (
            "plastic",
            MaterialKind::Plastic { albedo: albedo.clone(), ior: 1.5, roughness: None, nonlinear: true },
        ),
        (
            "rough plastic",
            MaterialKind::Plastic {
                albedo,
                ior: 1.5,
                roughness: Some(Roughness::Beckmann(0.2)),
                nonlinear: false,
            },
        ),
        ("film", MaterialKind::ScatteringFilm { reflect: [0.3, 0.2, 0.1], transmit: [0.5, 0.6, 0.3] }),
    ];
    for (name, kind) in kinds {
        let mut desc = room();
        desc.materials.push(material(name, kind, [0.0; 3]));
        desc.shapes.push(shape(ShapeKind::Sphere { center: [0.3, -0.5, -0.2], radius: 0.4 }, name, ""));
        let session = open(&desc, 2);
        let job = job(32, 512, 6);
        let (film, truth) = (both(&session, &BidirectionalJob::new(job.clone())), path(&session, &job));
        agree(name, mean(&film), mean(&truth), 0.01);
        pixels_agree(name, &film, &truth);
    }
}

#[test]
fn dispersion_keeps_the_mean() {
    let mut desc = room();
    let prism = MaterialKind::Dielectric { ior: [1.3, 1.5, 1.9], schlick: false };
    desc.materials.push(material("prism", prism, [0.0; 3]));
    desc.shapes.push(shape(ShapeKind::Box { min: [0.2, -0.9, -0.6], max: [0.7, -0.2, -0.1] }, "prism", ""));
    let session = open(&desc, 2);
    let job = job(32, 256, 6);
    let (film, truth) = (both(&session, &BidirectionalJob::new(job.clone())), path(&session, &job));
    agree("prism", mean(&film), mean(&truth), 0.02);
}

/// Interpolated normals on a coarse ball: seen from the light they need their own correction.
#[test]
fn interpolated_normals_agree_with_paths() {
    let mut desc = room();
    let (mut positions, mut triangles) = (vec![], vec![]);
    let n = 5;
    for i in 0..=n {
        for j in 0..=2 * n {
            let (theta, phi) =
                (std::f32::consts::PI * i as f32 / n as f32, std::f32::consts::PI * j as f32 / n as f32);
            positions.push([theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()]);
        }
    }
    for i in 0..n as u32 {
        for j in 0..2 * n as u32 {
            let at = |i: u32, j: u32| i * (2 * n as u32 + 1) + j;
            if i > 0 {
                triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            }
            if i + 1 < n as u32 {
                triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
            }
        }
    }
    let normals = positions.clone();
    let (r, c) = (0.45, [0.25, -0.35, -0.2]);
    for p in &mut positions {
        *p = [0, 1, 2].map(|k| c[k] + r * p[k]);
    }
    desc.meshes.push(MeshDesc {
        positions,
        normals,
        triangles,
        shading_normals: true,
        material: "wall".into(),
        ..MeshDesc::default()
    });
    let session = open(&desc, 2);
    let job = job(32, 256, 4);
    let (film, truth) = (both(&session, &BidirectionalJob::new(job.clone())), path(&session, &job));
    agree("interpolated", mean(&film), mean(&truth), 0.03);
    pixels_agree("interpolated", &film, &truth);
    // Without the correction vertices next to the light would be off by percents.
    let only = Some([2, 2]);
    let alone = both(
        &session,
        &BidirectionalJob { only, ..BidirectionalJob::new(PathJob { max_depth: 3, ..job.clone() }) },
    );
    let [a, b] = [3, 2].map(|max_depth| mean(&path(&session, &PathJob { max_depth, ..job.clone() })));
    agree("interpolated, (2, 2)", mean(&alone), (a.0 - b.0, a.1.hypot(b.1)), 0.05);
}

/// A point light in a closed room: others see fireflies of 10^4 where vertices lie next to each other in corners.
#[test]
fn a_point_light_in_a_closed_room_has_no_fireflies() {
    let mut desc = room();
    desc.shapes.pop();
    desc.lights.push(LightDesc::Point { position: [0.3, 0.4, 0.1], intensity: [0.7; 3] });
    desc.camera.as_mut().unwrap().resolution = [24, 24];
    let session = open(&desc, 2);
    let job = job(16, 16, u32::MAX);
    let (film, truth) = (both(&session, &BidirectionalJob::new(job.clone())), path(&session, &job));
    let largest = |f: &Film| (0..f.len()).map(|i| f.mean(i)[1]).fold(0.0, f64::max);
    assert!(largest(&film) < 2.0 * largest(&truth), "{} {}", largest(&film), largest(&truth));
    agree("closed room", mean(&film), mean(&truth), 0.03);
}

#[test]
fn a_lamp_outside_a_fog_lights_it() {
    // A ball of fog behind a null boundary, lit from outside by a spot and by a lamp, seen from outside.
    let mut desc = SceneDesc {
        camera: Some(CameraDesc {
            position: [0.0, 0.0, 4.0],
            look_at: [0.0; 3],
            fov_x_deg: 30.0,
            ..camera("")
        }),
        materials: vec![material("null", MaterialKind::Null, [0.0; 3])],
        media: vec![fog([1.5; 3], 0.6)],
        shapes: vec![shape(ShapeKind::Sphere { center: [0.0; 3], radius: 1.0 }, "null", "fog")],
        ..SceneDesc::default()
    };
    let black = MaterialKind::Diffuse { albedo: Reflectance::flat([0.0; 3]) };
    desc.materials.push(material("lamp", black, [5.0; 3]));
    let lamp = ShapeKind::Disk { center: [0.0, 2.5, 0.0], normal: [0.0, -1.0, 0.0], radius: 0.5 };
    desc.shapes.push(shape(lamp, "lamp", ""));
    let session = open(&desc, 2);
    let job = job(32, 128, u32::MAX);
    let (film, truth) = (both(&session, &BidirectionalJob::new(job.clone())), path(&session, &job));
    agree("lamp outside", mean(&film), mean(&truth), 0.03);
    pixels_agree("lamp outside", &film, &truth);
    desc.shapes.pop();
    desc.lights.push(LightDesc::Spot {
        position: [0.0, 2.0, 0.5],
        direction: [0.0, -1.0, -0.2],
        intensity: [6.0; 3],
        cone_deg: 25.0,
        falloff_deg: 10.0,
    });
    let outside = open(&desc, 2);
    let (film, truth) = (both(&outside, &BidirectionalJob::new(job.clone())), path(&outside, &job));
    agree("spot outside", mean(&film), mean(&truth), 0.03);
    // And one within.
    if let Some(LightDesc::Spot { position, .. }) = desc.lights.last_mut() {
        *position = [0.0, 0.6, 0.1];
    }
    let within = open(&desc, 2);
    let (film, truth) = (both(&within, &BidirectionalJob::new(job.clone())), path(&within, &job));
    agree("spot within", mean(&film), mean(&truth), 0.03);
}

#[test]
fn probes_agree_with_paths() {
    for (name, desc) in [("room", room()), ("fog", foggy())] {
        let session = open(&desc, 2);
        let job = job(32, 128, u32::MAX);
        let probes = [
            Probe { position: [0.4, -1.0, 0.2], normal: [0.0, 1.0, 0.0] },
            Probe { position: [-1.0, 0.1, -0.3], normal: [1.0, 0.0, 0.0] },
            Probe { position: [0.2, 0.0, 0.1], normal: [0.3, -1.0, 0.2] },
        ];
        let settings = probe_film_settings(session.scene(), &job, probes.len());
        let (mut a, mut b) = (Film::new(settings), Film::new(settings));
        session.path_probes(&job, &probes, &NoControl, &mut a).unwrap();
        session.bidirectional_probes(&BidirectionalJob::new(job), &probes, &NoControl, &mut b).unwrap();
        pixels_agree(name, &b, &a);
        for i in 0..3 {
            assert!(b.variance(i).unwrap()[0].sqrt() < 0.04 * b.mean(i)[0]);
        }
    }
}

#[test]
fn any_number_of_threads_and_any_split_give_the_same_bits() {
    for desc in [room(), foggy()] {
        let job = |blocks| {
            BidirectionalJob::new(PathJob { seed: 9, block_length: 16, blocks, max_depth: u32::MAX })
        };
        let whole = both(&open(&desc, 1), &job(0..6));
        for threads in [2, 5] {
            let session = open(&desc, threads);
            assert!(both(&session, &job(0..6)) == whole);
            let mut parts = both(&session, &job(4..6));
            parts.merge(&both(&session, &job(0..4))).unwrap();
            assert!(parts == whole);
        }
    }
}
