//! Rooms for tests of images and probes from maps of photons, and what is asked of them.
#![allow(dead_code, unreachable_pub, reason = "each test binary has this module to itself and uses its part")]

pub mod agree;

use etendue_core::backend::{
    GatherJob, NoControl, PathJob, PhotonStart, Probe, Session, image_film_settings, probe_film_settings,
};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, ElementSettings, Sides};
use etendue_core::scene::{
    CameraDesc, LightDesc, MaterialDesc, MaterialKind, Reflectance, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::{CpuBackend, CpuSession};
use std::sync::Arc;

pub fn shape(kind: ShapeKind, material: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: String::new(), exterior: String::new() }
}

pub fn made_of(name: &str, kind: MaterialKind) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [0.0; 3] }
}

pub fn diffuse(name: &str, albedo: [f32; 3], emission: [f32; 3]) -> MaterialDesc {
    let kind = MaterialKind::Diffuse { albedo: Reflectance::flat(albedo) };
    MaterialDesc { emission, ..made_of(name, kind) }
}

/// Walls of [-1, 1]^3, fronts inward, each of its own name: x+ x- y+ y- z+ z-.
pub fn room(albedo: [f32; 3], emission: [f32; 3]) -> SceneDesc {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0_f32]];
    let mut shapes = Vec::new();
    let mut materials = Vec::new();
    for i in 0..3 {
        for side in [1.0, -1.0_f32] {
            let name = format!("{}{}", ["x", "y", "z"][i], if side > 0.0 { '+' } else { '-' });
            let center = axes[i].map(|x| x * side);
            // u x v points along +axis i; the front must face the centre.
            let (u, v) = (axes[(i + 1) % 3].map(|x| -side * x), axes[(i + 2) % 3]);
            shapes.push(shape(ShapeKind::Rectangle { center, u, v }, &name));
            materials.push(diffuse(&name, albedo, emission));
        }
    }
    let camera = CameraDesc {
        position: [-0.85, 0.3, -0.9],
        look_at: [0.4, -0.3, 0.5],
        up: [0.0, 1.0, 0.0],
        fov_x_deg: 75.0,
        resolution: [24, 24],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: String::new(),
    };
    SceneDesc { camera: Some(camera), shapes, materials, ..SceneDesc::default() }
}

/// Gives a wall another material.
pub fn wall(desc: &mut SceneDesc, name: &str, kind: MaterialKind) {
    desc.materials.iter_mut().find(|m| m.name == name).unwrap().kind = kind;
}

pub fn lamp(desc: &mut SceneDesc) {
    desc.materials.push(diffuse("lamp", [0.2; 3], [4.0, 5.0, 6.0]));
    let kind = ShapeKind::Rectangle { center: [0.2, 0.97, 0.1], u: [0.3, 0.0, 0.0], v: [0.0, 0.0, 0.2] };
    desc.shapes.push(shape(kind, "lamp"));
}

pub fn point(desc: &mut SceneDesc) {
    desc.lights.push(LightDesc::Point { position: [-0.4, 0.5, 0.5], intensity: [1.0, 0.8, 0.6] });
}

pub fn spot(desc: &mut SceneDesc) {
    desc.lights.push(LightDesc::Spot {
        position: [0.6, 0.7, -0.5],
        direction: [-0.5, -1.0, 0.3],
        intensity: [3.0, 3.0, 2.0],
        cone_deg: 35.0,
        falloff_deg: 20.0,
    });
}

pub fn furniture(desc: &mut SceneDesc) {
    desc.materials.push(diffuse("dark", [0.1, 0.2, 0.7], [0.0; 3]));
    desc.materials.push(diffuse("grey", [0.5; 3], [0.0; 3]));
    desc.shapes.push(shape(ShapeKind::Box { min: [-0.7, -0.99, -0.1], max: [-0.2, -0.3, 0.5] }, "dark"));
    desc.shapes.push(shape(ShapeKind::Sphere { center: [0.5, -0.6, 0.4], radius: 0.3 }, "grey"));
}

pub fn session(desc: &SceneDesc, threads: Option<usize>) -> CpuSession {
    let (scene, _) = compile(desc).unwrap();
    CpuBackend::new(threads).unwrap().open_session(Arc::new(scene)).unwrap()
}

pub const JOB: GatherJob = GatherJob {
    path: PathJob { seed: 3, block_length: 64, blocks: 0..16, max_depth: u32::MAX },
    photons: 1 << 14,
    start: PhotonStart::LIGHTS,
    sequence: Sequence::Sorted,
    elements: ElementSettings { basis: Basis::Constant, sides: Sides::Apart, largest: 0.1 },
    gather: true,
};

/// Probes on the six walls, four on each, off its middle.
pub fn on_walls() -> Vec<Probe> {
    let mut probes = Vec::new();
    for i in 0..3 {
        for side in [1.0, -1.0_f32] {
            for [a, b] in [[-0.63_f32, -0.47], [0.41, -0.52], [-0.35, 0.66], [0.57, 0.38]] {
                let mut position = [0.0; 3];
                position[i] = side;
                position[(i + 1) % 3] = a;
                position[(i + 2) % 3] = b;
                let mut normal = [0.0; 3];
                normal[i] = -side;
                probes.push(Probe { position, normal });
            }
        }
    }
    probes
}

pub fn probe_film(session: &CpuSession, job: &GatherJob, probes: &[Probe]) -> Film {
    Film::new(probe_film_settings(session.scene(), &job.path, probes.len()))
}

pub fn image_film(session: &CpuSession, job: &GatherJob) -> Film {
    Film::new(image_film_settings(session.scene(), &job.path).unwrap())
}

pub fn gather_probes(session: &CpuSession, job: &GatherJob, probes: &[Probe]) -> Film {
    let mut film = probe_film(session, job, probes);
    let stats = session.photon_probes(job, probes, &NoControl, &mut film).unwrap();
    assert!(stats.rays > 0);
    assert_eq!((film.invalid(), film.saturated()), (0, 0));
    film
}

pub fn gather_image(session: &CpuSession, job: &GatherJob) -> Film {
    let mut film = image_film(session, job);
    session.photon_image(job, &NoControl, &mut film).unwrap();
    assert_eq!((film.invalid(), film.saturated()), (0, 0));
    film
}

pub fn path_probes(session: &CpuSession, job: &PathJob, probes: &[Probe]) -> Film {
    let mut film = Film::new(probe_film_settings(session.scene(), job, probes.len()));
    session.path_probes(job, probes, &NoControl, &mut film).unwrap();
    film
}

/// Mean and standard error of independent numbers.
pub fn mean_and_error(each: &[f64]) -> (f64, f64) {
    let n = each.len() as f64;
    let mean = each.iter().sum::<f64>() / n;
    (mean, (each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt())
}

/// Mean and standard error of each channel at each element.
pub fn results(film: &Film) -> Vec<[(f64, f64); 3]> {
    let at = |i| {
        let (mean, error) = (film.mean(i), film.standard_error(i).unwrap());
        [0, 1, 2].map(|c| (mean[c], error[c]))
    };
    (0..film.len()).map(at).collect()
}

/// Side of the tiles of [`tiles`].
pub const TILE: usize = 6;

/// Means over tiles and their standard errors: pixels that share maps do not err independently, blocks do.
pub fn tiles(blocks: &[Film]) -> Vec<[(f64, f64); 3]> {
    let settings = blocks[0].settings();
    let (width, height) = (settings.width as usize, settings.height as usize);
    let across = width / TILE;
    let mean = |film: &Film, tile: usize| -> [f64; 3] {
        let (x, y) = (tile % across * TILE, tile / across * TILE);
        let mut sum = [0.0; 3];
        for i in 0..TILE * TILE {
            let value = film.mean((y + i / TILE) * width + x + i % TILE);
            sum = [0, 1, 2].map(|c| sum[c] + value[c] / (TILE * TILE) as f64);
        }
        sum
    };
    let of = |tile: usize| {
        let each: Vec<[f64; 3]> = blocks.iter().map(|film| mean(film, tile)).collect();
        [0, 1, 2].map(|c| {
            let each: Vec<f64> = each.iter().map(|x| x[c]).collect();
            mean_and_error(&each)
        })
    };
    (0..across * (height / TILE)).map(of).collect()
}

/// An image's blocks as films of their own.
pub fn image_blocks(job: &PathJob, mut image: impl FnMut(&PathJob) -> Film) -> Vec<Film> {
    job.blocks.clone().map(|b| image(&PathJob { blocks: b..b + 1, ..job.clone() })).collect()
}
