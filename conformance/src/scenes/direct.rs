//! Direct light from single sources, in closed form. Depth 1: what a probe sees without a reflection.

use super::cases::{Case, probes};
use super::{diffuse, floor, mesh, point_light, probe, shape, sphere};
use etendue_core::scene::{LightDesc, SceneDesc, ShapeKind};
use std::f64::consts::PI;

const UP: [f32; 3] = [0.0, 0.0, 1.0];

/// A black floor that keeps the scene from being empty, far below.
fn ground() -> SceneDesc {
    SceneDesc {
        shapes: vec![floor(-10.0, 1.0, "black")],
        materials: vec![diffuse("black", 0.0, 0.0), diffuse("lamp", 0.0, 1.0)],
        ..SceneDesc::default()
    }
}

pub(super) fn cases() -> Vec<Case> {
    let mut all = vec![point_over_plane(), cie_5_2(), spot(), directional(), choice(), shadow(), disk()];
    all.extend(sphere_lights());
    all.extend(polygons());
    all.push(cie_5_6());
    all
}

fn point_over_plane() -> Case {
    let mut scene = ground();
    scene.lights.push(point_light([0.0, 0.0, 3.0], 100.0));
    let list = [
        (0.0, 11.111_111_111_111_11),
        (1.0, 9.486_832_980_505_138),
        (2.0, 6.400_386_879_521_874),
        (5.0, 1.513_222_810_080_960_4),
    ]
    .map(|(r, e)| (probe([r as f32, 0.0, 0.0], UP), e))
    .to_vec();
    probes("point_over_plane", "I cos^3 / h^2", scene, list, 1, 256)
}

/// CIE 171:2006, test case 5.2: isotropic source of 10000 lm at 3 m over a 4 m square; recomputed from first principles.
fn cie_5_2() -> Case {
    let mut scene = ground();
    scene.shapes[0] = floor(0.0, 2.0, "black");
    scene.lights.push(point_light([0.0, 0.0, 3.0], (10_000.0 / (4.0 * PI)) as f32));
    let list = [
        ([0.0, 0.0], 88.419_412_828_830_74),
        ([0.5, 0.0], 84.859_172_331_727_68),
        ([1.0, 0.0], 75.493_818_156_730_55),
        ([1.5, 0.0], 63.267_781_637_082_41),
        ([0.5, 0.5], 81.531_603_310_588_11),
        ([1.0, 0.5], 72.748_759_568_277_99),
        ([1.5, 0.5], 61.215_955_150_931_435),
        ([1.0, 1.0], 65.436_846_665_229_3),
        ([1.5, 1.0], 55.681_029_653_141_23),
        ([1.5, 1.5], 48.129_432_174_918_28),
    ]
    .map(|([x, y], e)| (probe([x, y, 0.0], UP), e))
    .to_vec();
    probes("cie171_5_2", "CIE 171:2006 TC 5.2: Phi cos^3 / (4 pi h^2)", scene, list, 1, 256)
}

fn spot() -> Case {
    let mut scene = ground();
    scene.lights.push(LightDesc::Spot {
        position: [0.0, 0.0, 2.0],
        direction: [0.0, 0.0, -3.0],
        intensity: [50.0; 3],
        cone_deg: 40.0,
        falloff_deg: 20.0,
    });
    let rad = PI / 180.0;
    let (cone, full) = ((40.0 * rad).cos(), (20.0 * rad).cos());
    let list = [0.0_f64, 0.5, 0.9, 1.2, 1.5, 2.0]
        .map(|r| {
            let d2 = 4.0 + r * r;
            let cos = 2.0 / d2.sqrt();
            let x = ((cos - cone) / (full - cone)).clamp(0.0, 1.0);
            (probe([r as f32, 0.0, 0.0], UP), 50.0 * x * x * (3.0 - 2.0 * x) * cos / d2)
        })
        .to_vec();
    // The radii are rounded to f32, and the smoothstep is steep near its foot.
    let mut case = probes("spot_smoothstep", "I smoothstep(cos) cos / d^2", scene, list, 1, 256);
    case.rounding = 1e-5;
    case
}

fn directional() -> Case {
    let mut scene = ground();
    scene.lights.push(LightDesc::Directional { direction: [0.0, 3.0, -4.0], irradiance: [5.0; 3] });
    let list = vec![
        (probe([1.0, 2.0, 3.0], UP), 4.0),
        (probe([0.0, 0.0, -10.0], UP), 4.0),
        (probe([1.0, 2.0, 3.0], [0.0, -0.6, 0.8]), 5.0),
        (probe([1.0, 2.0, 3.0], [0.0, 0.0, -1.0]), 0.0),
    ];
    probes("directional", "E0 cos", scene, list, 1, 256)
}

/// Lights of very different power, picked by their flux: the sum of all.
fn choice() -> Case {
    let mut scene = ground();
    let lights = [
        ([0.0_f32, 0.0, 3.0], 100.0_f32),
        ([2.0, 0.0, 1.5], 30.0),
        ([-1.0, 1.0, 2.5], 5.0),
        ([0.0, -4.0, 8.0], 300.0),
    ];
    scene.lights.extend(lights.map(|(p, i)| point_light(p, i)));
    let at = [[0.0_f32, 0.0, 0.0], [-1.0, 1.0, 0.0], [2.0, 1.0, 0.0]];
    let list = at
        .map(|p| {
            let e = lights
                .iter()
                .map(|(q, i)| {
                    let d = [0, 1, 2].map(|k| f64::from(q[k]) - f64::from(p[k]));
                    let d2: f64 = d.iter().map(|x| x * x).sum();
                    f64::from(*i) * d[2] / (d2 * d2.sqrt())
                })
                .sum();
            (probe(p, UP), e)
        })
        .to_vec();
    probes("light_choice", "sum over point lights, I cos / d^2", scene, list, 1, 4096)
}

/// A screen in the way of one probe and not of the other, from either side.
fn shadow() -> Case {
    let mut scene = ground();
    scene.shapes.push(shape(
        ShapeKind::Rectangle { center: [1.0, 0.0, 1.0], u: [0.5, 0.0, 0.0], v: [0.0, 0.5, 0.0] },
        "black",
    ));
    scene.lights.push(point_light([1.0, 0.0, 2.0], 8.0));
    let list = vec![
        (probe([1.0, 0.0, 0.0], UP), 0.0),
        (probe([1.75, 0.25, 0.0], UP), 0.0),
        (probe([1.0, 2.0, 0.0], UP), 8.0 * 2.0 / (8.0 * 8.0_f64.sqrt())),
        (probe([1.0, 0.0, 1.0], UP), 8.0),
        (probe([1.0, 0.0, 1.0], [0.0, 0.0, -1.0]), 0.0),
    ];
    probes("shadow", "a screen hides a point light", scene, list, 1, 256)
}

/// (pi L / 2) [1 - (d^2 + h^2 - r^2) / sqrt((d^2 + h^2 + r^2)^2 - 4 r^2 d^2)].
fn disk() -> Case {
    let mut scene = ground();
    scene.shapes.push(shape(
        ShapeKind::Disk { center: [0.0, 0.0, 1.0], normal: [0.0, 0.0, -1.0], radius: 1.0 },
        "lamp",
    ));
    let list = [(0.0, PI / 2.0), (0.5, 1.375_963_021_307_188), (2.0, 0.165_833_380_586_751_37)]
        .map(|(d, e)| (probe([d, 0.0, 0.0], UP), e))
        .to_vec();
    let mut list = list;
    // Nothing leaves the back.
    list.push((probe([0.0, 0.0, 2.0], [0.0, 0.0, -1.0]), 0.0));
    probes("disk_light", "disk over a parallel plane (configuration factor tables)", scene, list, 1, 1024)
}

/// Spherical Lambertian lights, the horizon through some: Snyder, MSR-TR-96-11; Lagarde and de Rousiers 2014.
fn sphere_lights() -> Vec<Case> {
    // Radiance, distance, and per tilt the irradiance.
    let groups = [
        (
            1.0_f32,
            3.0_f32,
            vec![
                (0.0, 0.349_065_850_398_865_9),
                (0.5, 0.306_334_103_261_478_3),
                (1.2, 0.126_486_717_715_023_54),
            ],
        ),
        (
            2.0,
            1.5,
            vec![
                (1.0, 1.522_065_655_930_984_9),
                (1.5, 0.569_391_486_333_160_6),
                (2.0, 0.061_028_976_317_592_41),
            ],
        ),
    ];
    groups
        .into_iter()
        .map(|(radiance, d, list)| {
            let mut scene = ground();
            scene.materials.push(diffuse("bulb", 0.0, radiance));
            scene.shapes.push(sphere([0.0, 0.0, d], 1.0, "bulb"));
            let list = list
                .into_iter()
                .map(|(beta, e): (f64, f64)| {
                    let (s, c) = beta.sin_cos();
                    (probe([0.0; 3], [s as f32, 0.0, c as f32]), e)
                })
                .collect();
            let source = "Lagarde and de Rousiers 2014, after Snyder, MSR-TR-96-11";
            let mut case = probes(format!("sphere_light_{d}"), source, scene, list, 1, 2048);
            // The last one shows a sliver above the horizon.
            case.power = 0.02;
            case
        })
        .collect()
}

const POLYGON: &str = "E = (L/2) sum theta_i n . g_i: Lambert 1760; Baum, Rushmeier, Winget, SIGGRAPH 1989";

fn polygons() -> Vec<Case> {
    let mut square = ground();
    // Front downwards.
    square.shapes.push(shape(
        ShapeKind::Rectangle { center: [0.5, 0.5, 1.0], u: [0.0, 0.5, 0.0], v: [0.5, 0.0, 0.0] },
        "lamp",
    ));
    let tilted = [-0.700_140_04, -0.700_140_04, 0.140_028_01];
    let list = vec![
        (probe([0.0; 3], UP), 0.435_209_875_683_551_63),
        (probe([0.5, 0.5, 0.0], UP), 0.752_274_688_454_107_4),
        (probe([3.0, 0.0, 0.0], UP), 0.019_072_339_581_505_143),
        (probe([0.0; 3], [1.0, 0.0, 0.0]), 0.175_094_143_856_948_35),
        (probe([2.0, 2.0, 0.9], tilted), 0.011_285_593_332_003_37),
    ];
    let mut out = vec![probes("square_light", POLYGON, square, list, 1, 4096)];
    out[0].power = 0.02;
    let mut triangle = ground();
    let corners = vec![[1.0, 0.0, 0.5], [-1.0, -1.0, 2.0], [0.0, 1.0, 0.5]];
    triangle.meshes.push(mesh(corners, vec![[0, 1, 2]], "lamp"));
    let list = vec![
        (probe([0.0; 3], UP), 1.132_644_609_101_469_2),
        (probe([0.0; 3], [0.486_664_26, -0.811_107_1, 0.324_442_84]), 0.350_071_883_557_141_6),
        (probe([0.2, 0.1, 0.45], UP), 2.190_665_628_768_666),
    ];
    out.push(probes("triangle_light", POLYGON, triangle, list, 1, 4096));
    for case in &mut out {
        // Normals and points given to f32.
        case.rounding = 1e-5;
    }
    out
}

/// CIE 171:2006, test case 5.6, scenario 2: a uniformly lit diffuse floor of 4 x 4 m seen from walls and ceiling; in
/// percent of its radiosity, recomputed from first principles.
fn cie_5_6() -> Case {
    let mut scene = ground();
    scene.shapes.push(shape(
        ShapeKind::Rectangle { center: [2.0, 2.0, 0.0], u: [2.0, 0.0, 0.0], v: [0.0, 2.0, 0.0] },
        "lamp",
    ));
    let wall = [
        45.122_603_563_782_62,
        35.900_504_809_022_62,
        27.991_623_868_241_11,
        21.638_511_074_467_278,
        16.716_314_519_253_796,
        12.967_372_400_795_488,
    ];
    let ceiling =
        [26.795_187_506_345_208, 30.938_710_784_953_972, 33.975_718_774_532_545, 35.566_592_454_545_93];
    let mut list = Vec::new();
    for (i, percent) in wall.iter().enumerate() {
        list.push((probe([2.0, 0.0, 0.25 + 0.5 * i as f32], [0.0, 1.0, 0.0]), PI * percent / 100.0));
    }
    for (i, percent) in ceiling.iter().enumerate() {
        list.push((probe([2.0, 0.25 + 0.5 * i as f32, 3.0], [0.0, 0.0, -1.0]), PI * percent / 100.0));
    }
    probes("cie171_5_6", "CIE 171:2006 TC 5.6, scenario 2", scene, list, 1, 2048)
}
