//! White furnaces: in light that is the same from everywhere nothing that loses no energy can be seen, and what loses some reads its albedo.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod albedo;

use etendue_core::backend::{BidirectionalJob, NoControl, PathJob, Session, image_film_settings};
use etendue_core::film::Film;
use etendue_core::scene::{
    CameraDesc, EnvironmentDesc, EnvironmentImage, GridDesc, LightDesc, MaterialDesc, MaterialKind,
    MediumDesc, MeshDesc, Reflectance, Roughness, SceneDesc, ShapeDesc, ShapeKind, compile,
};
use etendue_cpu::CpuBackend;
use std::sync::Arc;

/// Standard errors that a mean may be off its truth. Of the thousand comparisons here another seed would fail one with a probability of 1 %.
const LIMIT: f64 = 4.5;
/// What means may be off their truth in all, statistics included.
const WITHIN: f64 = 1e-3;
/// The same where lights are joined to paths from both ends by every run.
const WITHIN_QUICKLY: f64 = 5e-3;
/// What f32 may add to it on the way of a path.
const ROUNDING: f64 = 2e-5;
/// Blocks of all pixels at first: enough for standard errors to be trusted.
const BLOCKS: u32 = 64;
/// Samples of a block of all pixels.
const LENGTH: u32 = 1024;
/// Blocks of a pixel at most.
const BLOCKS_MAX: u32 = 1 << 14;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    Path,
    Bdpt,
}

const METHODS: [Method; 2] = [Method::Path, Method::Bdpt];

fn material(name: &str, kind: MaterialKind, emission: f32) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [emission; 3] }
}

fn diffuse(albedo: f32) -> MaterialKind {
    MaterialKind::Diffuse { albedo: Reflectance::flat([albedo; 3]) }
}

fn shape(kind: ShapeKind, material: &str, interior: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: interior.into(), exterior: String::new() }
}

fn camera(position: [f32; 3], fov_x_deg: f32, side: u32) -> CameraDesc {
    CameraDesc {
        position,
        look_at: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        fov_x_deg,
        resolution: [side, side],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: String::new(),
    }
}

/// Mean of all pixels, per channel, and its standard error: as many samples as it takes for this to be small enough.
fn reading(what: &str, desc: &SceneDesc, method: Method, within: f64) -> ([f64; 3], [f64; 3]) {
    let (scene, report) = compile(desc).unwrap();
    assert!(report.cleanups.is_empty(), "{what}: {report:?}");
    let session = CpuBackend::new(None).unwrap().open_session(Arc::new(scene)).unwrap();
    let [width, height] = desc.camera.as_ref().unwrap().resolution;
    let (pixels, max_depth) = (width * height, u32::MAX);
    let mut job = PathJob { seed: 3, block_length: LENGTH / pixels, blocks: 0..BLOCKS_MAX, max_depth };
    let mut film = Film::new(image_film_settings(session.scene(), &job).unwrap());
    job.blocks = 0..BLOCKS / pixels;
    loop {
        match method {
            Method::Path => session.path_image(&job, &NoControl, &mut film),
            Method::Bdpt => {
                session.bidirectional_image(&BidirectionalJob::new(job.clone()), &NoControl, &mut film)
            }
        }
        .unwrap();
        assert_eq!((film.invalid(), film.saturated()), (0, 0), "{what}");
        let n = film.len() as f64;
        let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
        for i in 0..film.len() {
            let (x, v) = (film.mean(i), film.variance(i).unwrap());
            for c in 0..3 {
                mean[c] += x[c] / n;
                variance[c] += v[c].max(0.0) / (n * n);
            }
        }
        let stderr = variance.map(f64::sqrt);
        let worst = stderr.iter().fold(0.0, |a: f64, b| a.max(*b));
        let done = job.blocks.end;
        if LIMIT * worst + ROUNDING <= within || done >= BLOCKS_MAX {
            return (mean, stderr);
        }
        job.blocks = done..2 * done;
    }
}

/// Asserts that a scene reads 1 in every channel, by one method.
fn reads_one(what: &str, desc: &SceneDesc, method: Method, within: f64) {
    let (mean, stderr) = reading(what, desc, method, within);
    for c in 0..3 {
        let allowed = LIMIT * stderr[c] + ROUNDING;
        assert!((mean[c] - 1.0).abs() <= allowed, "{what}, {method:?}, channel {c}: {mean:?} +- {stderr:?}");
        assert!(allowed <= within, "{what}, {method:?}, channel {c}: known by {stderr:?} only");
    }
}

/// Surfaces that lose nothing, and whether light passes them.
fn surfaces() -> Vec<(&'static str, MaterialKind, bool)> {
    let white = || Reflectance::flat([1.0; 3]);
    let glass = |ior: [f32; 3], schlick| MaterialKind::Dielectric { ior, schlick };
    let plastic = |nonlinear| MaterialKind::Plastic { albedo: white(), ior: 1.5, roughness: None, nonlinear };
    let (reflect, transmit) = ([0.4, 0.5, 0.7], [0.6, 0.5, 0.3]);
    // As good as index-matched: what would be rough is a smooth boundary.
    let matched =
        MaterialKind::RoughDielectric { ior: [1.0005; 3], schlick: false, roughness: Roughness::Ggx(0.3) };
    vec![
        ("diffuse", diffuse(1.0), false),
        ("mirror", MaterialKind::Mirror { albedo: white() }, false),
        // 1 - 4 eta / k^2: all but 4e-9 is reflected.
        ("metal", MaterialKind::Conductor { eta: [1e-3; 3], k: [1e3; 3] }, false),
        ("plastic", plastic(false), false),
        ("nonlinear plastic", plastic(true), false),
        ("glass", glass([1.5; 3], false), true),
        ("schlick's glass", glass([1.5; 3], true), true),
        ("bubble", glass([0.7; 3], false), true),
        ("prism", glass([1.4, 1.5, 1.7], false), true),
        ("matched", matched, true),
        ("pane", MaterialKind::ThinDielectric { ior: [1.5, 1.6, 1.4], schlick: false }, true),
        ("schlick's pane", MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: true }, true),
        ("film", MaterialKind::ThinFilm { reflect, transmit }, true),
        ("film that scatters", MaterialKind::ScatteringFilm { reflect, transmit }, true),
        ("nothing", MaterialKind::Null, true),
    ]
}

/// Media that lose nothing, of this extinction.
fn media(extinction: f32) -> Vec<(&'static str, Option<MediumDesc>)> {
    let fog = |sigma_s: [f32; 3], g| MediumDesc::new("fog", [0.0; 3], sigma_s.map(|s| extinction * s), g);
    let values = (0..27).map(|i| [0.2, 1.5, 0.7, 0.0, 1.0][i % 5]).collect();
    let to_world = [[2.0, 0.0, 0.0, -1.0], [0.0, 2.0, 0.0, -1.0], [0.0, 0.0, 2.0, -1.0]];
    let density = Some(GridDesc { size: [3; 3], channels: 1, values, to_world });
    vec![
        ("no medium", None),
        ("isotropic", Some(fog([1.0; 3], 0.0))),
        ("forward", Some(fog([1.0; 3], 0.8))),
        ("backward", Some(fog([1.0; 3], -0.5))),
        ("coloured", Some(fog([0.8, 1.0, 1.3], 0.3))),
        ("grid", Some(MediumDesc { density, ..fog([1.0; 3], 0.2) })),
    ]
}

/// Where light of radiance 1 comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Light {
    /// An environment that only paths from the sensor find.
    Sky,
    /// A picture of it, which is sampled and sends light.
    Picture,
    /// The walls of a room.
    Room,
}

/// A body of a material with a medium in it, around it, or both: a ball; a disk where it is thin; and where light is refracted a crooked tetrahedron, as balls and
/// boxes hold light that is scattered within until it is scattered again, which is right but noisy.
fn body(
    kind: &MaterialKind,
    medium: Option<&MediumDesc>,
    [within, around]: [bool; 2],
    light: Light,
) -> SceneDesc {
    use MaterialKind as K;
    let name = |is| if is && medium.is_some() { "fog" } else { "" };
    let mut desc = SceneDesc {
        camera: Some(camera([1.6, -1.8, 1.7], 6.0, 4)),
        materials: vec![material("body", kind.clone(), 0.0), material("boundary", K::Null, 0.0)],
        media: medium.into_iter().cloned().collect(),
        ..SceneDesc::default()
    };
    match kind {
        K::Dielectric { .. } => desc.meshes.push(MeshDesc {
            positions: vec![[0.5, -0.1, -0.4], [-0.1, 0.6, -0.3], [-0.6, -0.5, -0.3], [0.1, -0.1, 0.6]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            material: "body".into(),
            interior: name(within).into(),
            ..MeshDesc::default()
        }),
        K::ThinDielectric { .. } | K::ThinFilm { .. } | K::ScatteringFilm { .. } => {
            let kind = ShapeKind::Disk { center: [0.0; 3], normal: [0.3, -0.5, 0.8], radius: 0.5 };
            desc.shapes.push(shape(kind, "body", ""));
        }
        _ => {
            let kind = ShapeKind::Sphere { center: [0.0; 3], radius: 0.5 };
            desc.shapes.push(shape(kind, "body", name(within)));
        }
    }
    if around && medium.is_some() {
        desc.shapes.push(shape(ShapeKind::Sphere { center: [0.0; 3], radius: 0.8 }, "boundary", "fog"));
    }
    let radiance = [1.0; 3];
    match light {
        Light::Sky => desc.lights.push(LightDesc::Environment(EnvironmentDesc::uniform(radiance))),
        Light::Picture => {
            let to_world = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let image = EnvironmentImage { width: 4, height: 2, texels: vec![[1.0; 3]; 8], to_world };
            desc.lights.push(LightDesc::Environment(EnvironmentDesc { radiance, image: Some(image) }));
        }
        Light::Room => {
            desc.materials.push(material("wall", diffuse(0.0), 1.0));
            desc.shapes.extend(room(3.2, "wall", ""));
        }
    }
    desc
}

/// Six squares that face inwards.
fn room(half: f32, material: &str, exterior: &str) -> Vec<ShapeDesc> {
    let side = |i: usize| {
        let (axis, side) = (i / 2, if i & 1 == 0 { half } else { -half });
        let along = |k: usize, x: f32| [0, 1, 2].map(|j| if j == k { x } else { 0.0 });
        let kind = ShapeKind::Rectangle {
            center: along(axis, side),
            u: along((axis + 1) % 3, -side),
            v: along((axis + 2) % 3, half),
        };
        ShapeDesc { exterior: exterior.into(), ..shape(kind, material, "") }
    };
    (0..6).map(side).collect()
}

/// Which scenes are looked at.
struct Looked<'a> {
    light: Light,
    extinction: f32,
    /// Whether this surface with this medium is.
    keeps: fn(&str, &str) -> bool,
    /// Within the body, around it.
    places: &'a [[bool; 2]],
    within: f64,
    /// By how much less closely than that bodies are looked at which hold scattered light: what roulette does to its long paths takes many samples to be forgotten.
    refracting: f64,
}

const BOTH: &[[bool; 2]] = &[[true, true]];
const EACH: &[[bool; 2]] = &[[true, true], [false, true], [true, false]];
/// How much less closely where each path is of one colour, which counts three times.
const DISPERSING: f64 = 10.0;

fn all_read_one(looked: &Looked<'_>) {
    for (surface, kind, passes) in surfaces() {
        for (name, medium) in media(looked.extinction) {
            if !(looked.keeps)(surface, name) {
                continue;
            }
            let within = looked.within
                * match kind {
                    MaterialKind::Dielectric { ior, .. } if ior[0] != ior[1] => DISPERSING,
                    MaterialKind::Dielectric { .. } if medium.is_some() => looked.refracting,
                    _ => 1.0,
                };
            for (i, place) in looked.places.iter().enumerate() {
                // There is one place for no medium, and one for all that light does not pass.
                if i > 0 && (medium.is_none() || !passes) {
                    continue;
                }
                let scene = body(&kind, medium.as_ref(), *place, looked.light);
                let what = format!("{surface}, {name} {place:?}, {:?}", looked.light);
                for method in METHODS {
                    reads_one(&what, &scene, method, within);
                }
            }
        }
    }
}

/// The extinctions of media: a ball is 0.3 mean free paths thick, or one.
const THIN: f32 = 0.3;
const THICK: f32 = 1.0;

/// By either method; where both find light by scattering alone.
#[test]
fn what_loses_nothing_is_not_seen_under_a_sky() {
    let (light, extinction, places) = (Light::Sky, THIN, BOTH);
    // Each surface with and without a medium, and each medium with some surfaces: the rest is below.
    let keeps = |surface: &str, medium: &str| {
        ["no medium", "coloured"].contains(&medium) || ["nothing", "diffuse", "glass"].contains(&surface)
    };
    all_read_one(&Looked { light, extinction, keeps, places, within: WITHIN, refracting: 5.0 });
}

/// Where light is sampled, and paths from both ends are joined.
#[test]
fn what_loses_nothing_is_not_seen_among_lights() {
    for light in [Light::Picture, Light::Room] {
        let keeps = |_: &str, medium: &str| ["no medium", "coloured"].contains(&medium);
        let (extinction, places, within) = (THIN, BOTH, WITHIN_QUICKLY);
        all_read_one(&Looked { light, extinction, keeps, places, within, refracting: 2.0 });
    }
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue-cpu --test furnaces --run-ignored only"]
fn long_what_loses_nothing_is_not_seen_under_a_sky() {
    let (light, extinction, places) = (Light::Sky, THICK, EACH);
    let keeps = |_: &str, _: &str| true;
    all_read_one(&Looked { light, extinction, keeps, places, within: WITHIN, refracting: 1.0 });
}

#[test]
#[ignore = "minutes: cargo nextest run -p etendue-cpu --test furnaces --run-ignored only"]
fn long_what_loses_nothing_is_not_seen_among_lights() {
    for light in [Light::Picture, Light::Room] {
        let (extinction, places) = (THIN, BOTH);
        let keeps = |_: &str, _: &str| true;
        all_read_one(&Looked { light, extinction, keeps, places, within: WITHIN, refracting: 2.0 });
    }
}
