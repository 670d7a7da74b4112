//! Participating media, dielectrics and thin plates.

use super::cases::{Case, Measure, ROUNDING};
use super::{camera, diffuse, environment, material, probe, shape, sphere};
use etendue_core::scene::{
    CameraDesc, GridDesc, LightDesc, MaterialKind, MediumDesc, Reflectance, SceneDesc, ShapeDesc, ShapeKind,
};
use std::f64::consts::PI;

const DOWN: [f32; 3] = [0.0, 0.0, -1.0];
const UP: [f32; 3] = [0.0, 0.0, 1.0];
/// Half the width of slabs whose thickness is 1: without end for all that matters.
const WIDE: f32 = 300.0;
/// Scattered light is noisy: standard errors stay below this share.
const POWER: f64 = 0.01;

pub(super) fn cases() -> Vec<Case> {
    let mut all = slabs();
    all.extend(half_spaces());
    all.extend(single_scattering());
    all.extend(fresnel_slabs());
    all.extend(plates());
    all.extend(lossless());
    all.push(glow());
    all.push(glowing_fog());
    all.extend(grids());
    all
}

/// A shape whose inside is a medium.
fn filled(kind: ShapeKind, material: &str, interior: &str) -> ShapeDesc {
    ShapeDesc { interior: interior.into(), ..shape(kind, material) }
}

fn ball(center: [f32; 3], radius: f32, material: &str, interior: &str) -> ShapeDesc {
    filled(ShapeKind::Sphere { center, radius }, material, interior)
}

fn case(
    name: String,
    source: &'static str,
    scene: SceneDesc,
    measure: Measure,
    truth: [f64; 3],
    samples: u32,
) -> Case {
    let elements = match &measure {
        Measure::Probes(list) => list.len(),
        Measure::Pixels => scene.camera.as_ref().map_or(0, |c| (c.resolution[0] * c.resolution[1]) as usize),
        _ => 1,
    };
    Case {
        name,
        source,
        scene,
        measure,
        max_depth: u32::MAX,
        truth: vec![truth; elements],
        samples,
        rounding: ROUNDING,
        power: POWER,
    }
}

/// A slab from z = 0 to 1 of this extinction and albedo, its faces of a material.
fn slab(tau: f32, albedo: f32, g: f32, face: MaterialKind) -> SceneDesc {
    let kind = ShapeKind::Box { min: [-WIDE, -WIDE, 0.0], max: [WIDE, WIDE, 1.0] };
    SceneDesc {
        materials: vec![material("face", face, 0.0), diffuse("lamp", 0.0, 1.0)],
        media: vec![MediumDesc::new("slab", [tau * (1.0 - albedo); 3], [tau * albedo; 3], g)],
        shapes: vec![filled(kind, "face", "slab")],
        ..SceneDesc::default()
    }
}

fn beam(mu0: f32) -> LightDesc {
    let sin = (1.0 - mu0 * mu0).max(0.0).sqrt();
    LightDesc::Directional { direction: [sin, 0.0, -mu0], irradiance: [1.0; 3] }
}

/// Light of radiance 1 from above alone.
fn under_lamp(mut scene: SceneDesc) -> SceneDesc {
    let lamp = ShapeKind::Rectangle { center: [0.0, 0.0, 3.0], u: [0.0, WIDE, 0.0], v: [WIDE, 0.0, 0.0] };
    scene.shapes.push(shape(lamp, "lamp"));
    scene
}

/// One narrow pixel.
fn eye(mut scene: SceneDesc, from: [f32; 3], to: [f32; 3]) -> SceneDesc {
    let up = [0.0, 1.0, 0.0];
    scene.camera = Some(CameraDesc { up, ..camera(from, to, 0.05, [1, 1]) });
    scene
}

/// Reflectance and transmittance (what is not scattered included) of slabs, by the irradiance in front of and behind them.
fn slabs() -> Vec<Case> {
    let table: [(f32, f32, f32, [f64; 4], &str); 4] = [
        (
            1.0,
            1.0,
            0.0,
            [0.341_328_759_80, 0.658_671_240_20, 0.446_594_006_69, 0.553_405_993_31],
            "Heaslet and Warming 1965; M. Modest, Radiative Heat Transfer, table 14.1",
        ),
        (
            0.5,
            0.9,
            0.0,
            [0.169_039_466_24, 0.765_383_002_86, 0.247_494_160_26, 0.659_919_532_92],
            "discrete ordinates, 40 Radau points",
        ),
        (
            2.0,
            0.9,
            0.75,
            [0.097_394_638_66, 0.660_957_700_15, 0.191_090_226_67, 0.501_816_058_35],
            "H. van de Hulst, Multiple Light Scattering, 1980; Wang, Jacques and Zheng 1995",
        ),
        (
            5.0,
            0.99,
            0.0,
            [0.680_078_115_40, 0.220_627_796_02, 0.737_506_992_48, 0.173_152_245_37],
            "discrete ordinates, 40 Radau points",
        ),
    ];
    let mut all = Vec::new();
    for (tau, albedo, g, truth, source) in table {
        let scene = slab(tau, albedo, g, MaterialKind::Null);
        let (above, below) = (probe([0.3, -0.2, 1.2], DOWN), probe([0.3, -0.2, -0.2], UP));
        let mut add = |what: &str, scene: SceneDesc, truth: [f64; 2], samples: u32| {
            let mut made = case(
                format!("media/slab_{tau}_{albedo}_{g}_{what}"),
                source,
                scene,
                Measure::Probes(vec![above, below]),
                [0.0; 3],
                samples,
            );
            made.truth = truth.map(|t| [t; 3]).to_vec();
            all.push(made);
        };
        let lit = SceneDesc { lights: vec![beam(1.0)], ..scene.clone() };
        add("beam", lit, [truth[0], truth[1]], 12_288);
        add("diffuse", under_lamp(scene), [PI * truth[2], PI * truth[3]], 16_384);
    }
    all
}

/// Media on grids: what depends on the optical thickness alone does not know how it is distributed.
fn grids() -> Vec<Case> {
    let mut all = Vec::new();
    // The slab of the table above, its density from layer to layer; the mean of the layers is 1.
    let layers = |values: Vec<f32>, channels: u32| GridDesc {
        size: [1, 1, values.len() as u32 / channels],
        channels,
        values,
        to_world: [[2.0 * WIDE, 0.0, 0.0, -WIDE], [0.0, 2.0 * WIDE, 0.0, -WIDE], [0.0, 0.0, 1.0, 0.0]],
    };
    let mut scene = SceneDesc { lights: vec![beam(1.0)], ..slab(1.0, 1.0, 0.0, MaterialKind::Null) };
    scene.media[0].density = Some(layers(vec![0.0, 2.5, 0.25, 0.75, 1.5], 1));
    let measure = Measure::Probes(vec![probe([0.3, -0.2, 1.2], DOWN), probe([0.3, -0.2, -0.2], UP)]);
    let source = "Heaslet and Warming 1965; M. Modest, Radiative Heat Transfer, table 14.1";
    let made = case("media/grid_slab".into(), source, scene, measure, [0.0; 3], 12_288);
    all.push(Case { truth: vec![[0.341_328_759_80; 3], [0.658_671_240_20; 3]], ..made });
    // A lamp through sigma(x) = 0.2 + 0.5 x on [0, 3]; in the other channels through 0 and through 0.1 + 0.2 x.
    let kind = ShapeKind::Box { min: [0.0, -1.0, -1.0], max: [3.0, 1.0, 1.0] };
    let lamp = ShapeKind::Rectangle { center: [4.0, 0.0, 0.0], u: [0.0, 0.0, 2.0], v: [0.0, 2.0, 0.0] };
    let ramp = GridDesc {
        size: [2, 1, 1],
        channels: 3,
        values: vec![0.2, 0.0, 0.1, 1.7, 0.0, 0.7],
        // Cells centred on both ends.
        to_world: [[6.0, 0.0, 0.0, -1.5], [0.0, 2.0, 0.0, -1.0], [0.0, 0.0, 2.0, -1.0]],
    };
    let scene = SceneDesc {
        materials: vec![material("face", MaterialKind::Null, 0.0), diffuse("lamp", 0.0, 1.0)],
        media: vec![MediumDesc { density: Some(ramp), ..MediumDesc::new("ramp", [1.0; 3], [0.0; 3], 0.0) }],
        shapes: vec![filled(kind, "face", "ramp"), shape(lamp, "lamp")],
        ..SceneDesc::default()
    };
    let scene = eye(scene, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let truth = [0.057_844_320_87, 1.0, (-1.2_f64).exp()];
    let source = "exp of minus the integral of the ramp";
    all.push(case("media/grid_ramp".into(), source, scene, Measure::Pixels, truth, 32_768));
    all
}

/// Half-spaces that scatter alike to all sides: L = w / (4 pi) mu0 / (mu0 + mu) H(mu) H(mu0), plane albedo 1 - H(mu0) sqrt(1 - w).
fn half_spaces() -> Vec<Case> {
    let source = "S. Chandrasekhar, Radiative Transfer, 1960, ch. V";
    let mut all = Vec::new();
    for (albedo, mu0, mu, l, plane) in [
        (0.5, 1.0, 1.0, 0.031_147_626_93, 0.115_225_877_71),
        (0.9, 0.5, 0.8, 0.074_898_146_21, 0.507_938_906_94),
        (0.99, 1.0, 1.0, 0.240_863_393_03, 0.752_720_717_16),
    ] {
        let scene = SceneDesc { lights: vec![beam(mu0)], ..slab(1000.0, albedo, 0.0, MaterialKind::Null) };
        let sin = (1.0_f32 - mu * mu).max(0.0).sqrt();
        let seen = eye(scene.clone(), [2.0 * sin, 0.3, 1.0 + 2.0 * mu], [0.0, 0.3, 1.0]);
        let name = format!("media/half_space_{albedo}");
        all.push(case(format!("{name}_radiance"), source, seen, Measure::Pixels, [l; 3], 12_288));
        let measure = Measure::Probes(vec![probe([0.0, 0.0, 1.1], DOWN)]);
        all.push(case(format!("{name}_albedo"), source, scene, measure, [plane * f64::from(mu0); 3], 12_288));
    }
    all
}

/// Just one scattering: two edges.
fn single_scattering() -> Vec<Case> {
    let mut all = Vec::new();
    for (tau, albedo, mu0, mu, reflected, transmitted) in [
        (1.0, 0.5, 1.0, 1.0_f32, 0.017_201_957_974, 0.014_637_457_881),
        (0.3, 0.9, 0.5, 0.7, 0.019_172_679_748, 0.018_375_369_096),
    ] {
        let scene = SceneDesc { lights: vec![beam(mu0)], ..slab(tau, albedo, 0.0, MaterialKind::Null) };
        let sin = (1.0 - mu * mu).max(0.0).sqrt();
        let above = eye(scene.clone(), [sin, 0.0, 1.0 + mu], [0.0, 0.0, 1.0]);
        let below = eye(scene, [sin, 0.0, -mu], [0.0; 3]);
        for (what, scene, truth) in [("reflected", above, reflected), ("transmitted", below, transmitted)] {
            let name = format!("media/single_{tau}_{what}");
            let source = "integral of the once scattered beam along the ray";
            let made = case(name, source, scene, Measure::Pixels, [truth; 3], 2048);
            all.push(Case { max_depth: 2, ..made });
        }
    }
    all
}

/// Slabs behind smooth boundaries, light of one side from everywhere: what a ray at normal incidence sees is what a beam along it would have reflected or let through.
fn fresnel_slabs() -> Vec<Case> {
    let source = "discrete ordinates with Fresnel boundaries; Giovanelli 1955 (0.2600)";
    let glass = || MaterialKind::Dielectric { ior: [1.5; 3], schlick: false };
    let deep = eye(under_lamp(slab(1000.0, 0.9, 0.0, glass())), [0.0, 0.0, 2.0], [0.0; 3]);
    let thin = under_lamp(slab(2.0, 0.9, 0.75, glass()));
    let (above, below) =
        (eye(thin.clone(), [0.0, 0.0, 2.0], [0.0; 3]), eye(thin, [0.0, 0.0, -2.0], [0.0; 3]));
    [("deep", deep, 0.259_921_3), ("reflected", above, 0.126_823_4), ("transmitted", below, 0.493_152_0)]
        .map(|(what, scene, truth)| {
            let name = format!("media/fresnel_slab_{what}");
            let made = case(name, source, scene, Measure::Pixels, [truth; 3], 4096);
            // The tables are known to 2e-5.
            Case { rounding: 2e-4, ..made }
        })
        .into()
}

/// A lamp seen through a plate at an angle: (1 - R) / (1 + R), and R by Fresnel's equations; and by a beam on what is behind the plate.
fn plates() -> Vec<Case> {
    let mut all = Vec::new();
    for (n, degrees, truth) in
        [(1.5, 0.0, 0.923_076_923), (1.5, 60.0, 0.836_232_463), (1.33, 60.0, 0.888_350_165)]
    {
        let pane = ShapeKind::Rectangle { center: [0.0; 3], u: [2.0, 0.0, 0.0], v: [0.0, 2.0, 0.0] };
        let plate = SceneDesc {
            materials: vec![
                material("plate", MaterialKind::ThinDielectric { ior: [n; 3], schlick: false }, 0.0),
                diffuse("lamp", 0.0, 1.0),
            ],
            shapes: vec![shape(pane, "plate")],
            ..SceneDesc::default()
        };
        let angle = f64::to_radians(degrees);
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        let source = "Fresnel's equations, all reflections in the plate without polarisation";
        let seen = eye(under_lamp(plate.clone()), [-sin, 0.0, -cos], [0.0; 3]);
        let name = format!("media/plate_{n}_{degrees}");
        all.push(case(format!("{name}_seen"), source, seen, Measure::Pixels, [truth; 3], 16_384));
        let lit = SceneDesc { lights: vec![beam(cos)], ..plate };
        let measure = Measure::Probes(vec![probe([0.0, 0.0, -0.2], UP)]);
        all.push(case(format!("{name}_lit"), source, lit, measure, [truth * f64::from(cos); 3], 64));
    }
    all
}

/// What loses nothing cannot be seen in light that is the same from everywhere.
fn lossless() -> Vec<Case> {
    let source = "white furnace";
    let mut thick = MediumDesc::new("thick", [0.0; 3], [1.0, 8.0, 3.0], -0.4);
    thick.priority = 1;
    let mirror = MaterialKind::Mirror { albedo: Reflectance::flat([1.0; 3]) };
    let scene = SceneDesc {
        materials: vec![
            material("boundary", MaterialKind::Null, 0.0),
            material("mirror", mirror, 0.0),
            diffuse("white", 1.0, 0.0),
            material("glass", MaterialKind::Dielectric { ior: [1.5; 3], schlick: false }, 0.0),
            material("prism", MaterialKind::Dielectric { ior: [1.4, 1.5, 1.7], schlick: true }, 0.0),
            material("plate", MaterialKind::ThinDielectric { ior: [1.5, 1.6, 1.4], schlick: false }, 0.0),
            material(
                "film",
                MaterialKind::ThinFilm { reflect: [0.2, 0.5, 0.9], transmit: [0.8, 0.5, 0.1] },
                0.0,
            ),
        ],
        media: vec![MediumDesc::new("fog", [0.0; 3], [0.5, 1.0, 4.0], 0.8), thick],
        shapes: vec![
            ball([0.0, 0.0, 0.0], 1.0, "boundary", "fog"),
            // Within it, across it, a mirror in it and a white ball half in it.
            ball([0.2, 0.0, 0.0], 0.3, "boundary", "thick"),
            ball([0.9, 0.2, 0.0], 0.5, "boundary", "thick"),
            sphere([-0.4, 0.3, 0.1], 0.2, "mirror"),
            sphere([-0.9, -0.3, 0.0], 0.3, "white"),
            // Glass with and without fog in it, half in the fog too; a plate and a film.
            ball([0.0, 1.2, 0.0], 0.5, "glass", ""),
            ball([0.0, -1.2, 0.2], 0.4, "prism", "thick"),
            shape(
                ShapeKind::Disk { center: [0.0, 0.0, 0.7], normal: [0.3, -0.2, 0.9], radius: 0.8 },
                "plate",
            ),
            shape(
                ShapeKind::Disk { center: [0.0, 0.0, -0.7], normal: [0.1, -0.2, 0.9], radius: 0.8 },
                "film",
            ),
        ],
        lights: vec![environment(1.0)],
        camera: Some(camera([0.1, -3.5, 0.3], [0.0; 3], 50.0, [6, 6])),
        ..SceneDesc::default()
    };
    let within =
        SceneDesc { camera: Some(camera([0.2, 0.0, 0.0], [0.8, 0.3, 0.1], 80.0, [3, 3])), ..scene.clone() };
    [("from_outside", scene), ("from_inside", within)]
        .map(|(what, scene)| {
            let made = case(format!("media/lossless_{what}"), source, scene, Measure::Pixels, [1.0; 3], 6144);
            Case { rounding: 2e-5, power: 0.02, ..made }
        })
        .into()
}

/// Emission along a ray in closed form, with and without absorption.
fn glow() -> Case {
    let mut scene = slab(0.0, 0.0, 0.0, MaterialKind::Null);
    scene.media[0].sigma_a = [0.7, 0.07, 0.0];
    scene.media[0].emission = [1.4; 3];
    let truth = [0.7_f32, 0.07, 0.0].map(|s| {
        let s = f64::from(s);
        if s > 0.0 { f64::from(1.4_f32) * -(-s).exp_m1() / s } else { f64::from(1.4_f32) }
    });
    let scene = eye(scene, [0.0, 0.0, 3.0], [0.0; 3]);
    case("media/glow".into(), "(1 - exp(-tau)) j / sigma", scene, Measure::Pixels, truth, 64)
}

/// A closed room of radiance 1 in equilibrium with the medium in it, which emits what it absorbs.
fn glowing_fog() -> Case {
    let mut fog = MediumDesc::new("fog", [0.5, 0.25, 1.0], [2.0, 1.0, 0.2], 0.6);
    fog.emission = fog.sigma_a;
    let scene = SceneDesc {
        materials: vec![diffuse("wall", 0.0, 1.0)],
        media: vec![fog],
        // Emission is from the front alone: the room is of squares that face inward.
        shapes: (0..6)
            .map(|i| {
                let (axis, side) = (i / 2, if i % 2 == 0 { 1.0 } else { -1.0_f32 });
                let along = |k: usize, x: f32| [0, 1, 2].map(|j| if j == k { x } else { 0.0 });
                let kind = ShapeKind::Rectangle {
                    center: along(axis, side),
                    u: along((axis + 1) % 3, -side),
                    v: along((axis + 2) % 3, 1.0),
                };
                ShapeDesc { exterior: "fog".into(), ..shape(kind, "wall") }
            })
            .collect(),
        camera: Some(camera([0.1, 0.2, -0.3], [1.0, 0.0, 0.4], 90.0, [4, 4])),
        ..SceneDesc::default()
    };
    case("media/glowing_fog".into(), "equilibrium", scene, Measure::Pixels, [1.0; 3], 512)
}
