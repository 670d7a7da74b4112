//! Open scenes: constant environments, lobes, textures, shading normals.

use super::cases::{Case, Measure, POWER, ROUNDING, probes};
use super::{camera, diffuse, environment, floor, material, mesh, point_light, probe, shape, sphere};
use crate::statistics::Random;
use etendue_core::scene::{
    EnvironmentDesc, EnvironmentImage, LightDesc, MaterialKind, Reflectance, SceneDesc, ShapeKind,
    TextureDesc, Wrap,
};
use std::f64::consts::PI;

const UP: [f32; 3] = [0.0, 0.0, 1.0];

pub(super) fn cases() -> Vec<Case> {
    let mut all = vec![
        white_furnace(),
        tinted_mirror(),
        open_floor(),
        half_open_floor(),
        light_over_floor(),
        coincident(),
    ];
    all.extend(pictures());

    for n in [1.0, 10.0, 100.0] {
        all.push(phong_albedo(n));
    }
    all.push(texture_mean());
    all.extend(shading_normals());
    all
}

fn case(
    name: impl Into<String>,
    source: &'static str,
    scene: SceneDesc,
    measure: Measure,
    truth: Vec<[f64; 3]>,
    samples: u32,
) -> Case {
    Case {
        name: name.into(),
        source,
        scene,
        measure,
        max_depth: u32::MAX,
        truth,
        samples,
        rounding: ROUNDING,
        power: POWER,
    }
}

/// Nothing absorbs, light comes from everywhere alike: every pixel reads 1.
fn white_furnace() -> Case {
    let mut scene = SceneDesc {
        shapes: vec![
            sphere([-1.1, 0.0, 1.0], 1.0, "white"),
            sphere([1.1, 0.0, 1.0], 1.0, "mirror"),
            floor(0.0, 3.0, "white"),
        ],
        materials: vec![
            diffuse("white", 1.0, 0.0),
            material("mirror", MaterialKind::Mirror { albedo: Reflectance::flat([1.0; 3]) }, 0.0),
        ],
        lights: vec![environment(1.0)],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.5, -5.0, 2.5], [0.0, 0.0, 0.8], 60.0, [8, 6]));
    let mut c = case(
        "white_furnace",
        "conservation of energy: L = 1",
        scene,
        Measure::Pixels,
        vec![[1.0; 3]; 48],
        1024,
    );
    c.rounding = 2e-5;
    // Where the balls stand on the floor paths are long and end by roulette.
    c.power = 0.01;
    c
}

/// Irradiance under pictures of environments: of one radiance all round; linear in the angle to +y, L = 1 - theta / pi, for which a surface that faces +y receives 3 pi / 4, and one
/// that faces +x receives pi / 2; all of it turned by a quarter.
fn pictures() -> Vec<Case> {
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // +y becomes +z.
    let turned = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let sky = |texels: Vec<[f32; 3]>, width: u32, to_world| {
        let height = texels.len() as u32 / width;
        let image = Some(EnvironmentImage { width, height, texels, to_world });
        LightDesc::Environment(EnvironmentDesc { radiance: [1.0; 3], image })
    };
    let gradient = || vec![[1.0; 3], [1.0; 3], [1.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]];
    let tile = |u, v| shape(ShapeKind::Rectangle { center: [0.0; 3], u, v }, "floor");
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let one = |name: &str, light, tile, normal: [f32; 3], truth: f64| {
        let scene = SceneDesc {
            shapes: vec![tile],
            materials: vec![diffuse("floor", 0.5, 0.0)],
            lights: vec![light],
            ..SceneDesc::default()
        };
        let at = normal.map(|n| 0.0 * n);
        probes(
            name,
            "integral of L cos over the hemisphere",
            scene,
            vec![(probe(at, normal), truth)],
            1,
            1024,
        )
    };
    vec![
        one("picture_constant", sky(vec![[1.0; 3]; 12], 4, identity), tile(x, y), z, PI),
        one("picture_gradient", sky(gradient(), 3, identity), tile(z, x), y, 0.75 * PI),
        one("picture_gradient_side", sky(gradient(), 3, identity), tile(y, z), x, 0.5 * PI),
        one("picture_gradient_turned", sky(gradient(), 3, turned), tile(x, y), z, 0.75 * PI),
    ]
}

/// A mirror of reflectance r in a constant environment shows r.
fn tinted_mirror() -> Case {
    let mirror =
        material("mirror", MaterialKind::Mirror { albedo: Reflectance::flat([0.9, 0.5, 0.25]) }, 0.0);
    let mut scene = SceneDesc {
        shapes: vec![sphere([0.0; 3], 1.0, "mirror")],
        materials: vec![mirror],
        lights: vec![environment(2.0)],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.0, -5.0, 0.0], [0.0; 3], 15.0, [4, 4]));
    let truth = [0.9_f32, 0.5, 0.25].map(|r| 2.0 * f64::from(r));
    case("tinted_mirror", "L = r Le", scene, Measure::Pixels, vec![truth; 16], 64)
}

/// E = pi L under an open sky; nothing from below a floor.
fn open_floor() -> Case {
    let scene = SceneDesc {
        shapes: vec![floor(0.0, 1000.0, "black")],
        materials: vec![diffuse("black", 0.0, 0.0)],
        lights: vec![environment(3.0)],
        ..SceneDesc::default()
    };
    let list = vec![
        (probe([1.0, 2.0, 0.0], UP), 3.0 * PI),
        // A vertical receiver low above the floor sees half of the sky.
        (probe([0.0, 0.0, 1e-3], [1.0, 0.0, 0.0]), 1.5 * PI),
    ];
    let mut c = probes("open_floor", "E = pi L (1 + cos tilt) / 2", scene, list, 2, 4096);
    // A finite floor: a millimetre over a kilometre.
    c.rounding = 1e-5;
    c
}

/// A wall hides half of the sky.
fn half_open_floor() -> Case {
    let scene = SceneDesc {
        shapes: vec![
            floor(0.0, 1000.0, "grey"),
            shape(
                ShapeKind::Rectangle {
                    center: [0.0, 0.0, 1000.0],
                    u: [0.0, 1000.0, 0.0],
                    v: [0.0, 0.0, 1000.0],
                },
                "black",
            ),
        ],
        materials: vec![diffuse("black", 0.0, 0.0), diffuse("grey", 0.5, 0.0)],
        lights: vec![environment(1.0)],
        ..SceneDesc::default()
    };
    let list = vec![(probe([1e-3, 0.0, 0.0], UP), 0.5 * PI), (probe([-1e-3, 10.0, 0.0], UP), 0.5 * PI)];
    let mut c = probes("half_open_floor", "E = pi L / 2 beside a tall wall", scene, list, u32::MAX, 4096);
    c.rounding = 1e-5;
    c
}

/// Reflected radiance of a floor under a point light, rho E / pi, through a camera.
fn light_over_floor() -> Case {
    let mut scene = SceneDesc {
        shapes: vec![floor(0.0, 100.0, "grey")],
        materials: vec![diffuse("grey", 0.5, 0.0)],
        lights: vec![point_light([0.0, 0.0, 2.0], 8.0)],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.0, -3.0, 3.0], [0.0; 3], 0.01, [2, 2]));
    let mut c = case(
        "light_over_floor",
        "L = rho I / (pi h^2)",
        scene,
        Measure::Pixels,
        vec![[0.5 * 2.0 / PI; 3]; 4],
        64,
    );
    c.rounding = 1e-5;
    c
}

/// Of two surfaces in one place the first one is seen: ties go to the lower number.
fn coincident() -> Case {
    let corners = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let square = |material: &str| mesh(corners.clone(), vec![[0, 1, 2], [0, 2, 3]], material);
    let mut scene = SceneDesc {
        meshes: vec![square("first"), square("second")],
        materials: vec![diffuse("first", 0.0, 1.0), diffuse("second", 0.0, 7.0)],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.3, -2.0, 2.0], [0.0; 3], 20.0, [4, 4]));
    let mut c = case(
        "coincident_surfaces",
        "ties go to the lower primitive",
        scene,
        Measure::Pixels,
        vec![[1.0; 3]; 16],
        16,
    );
    c.max_depth = 1;
    c
}

/// At normal incidence source C's Phong lobe reflects (n+1)/(n+2).
fn phong_albedo(n: f32) -> Case {
    let phong = material("phong", MaterialKind::Phong { specular: [1.0, 0.5, 0.25], exponent: n }, 0.0);
    let mut scene = SceneDesc {
        shapes: vec![floor(0.0, 1.0, "phong")],
        materials: vec![phong],
        lights: vec![environment(1.0)],
        ..SceneDesc::default()
    };
    let mut view = camera([0.0, 0.0, 5.0], [0.0; 3], 0.01, [2, 2]);
    view.up = [0.0, 1.0, 0.0];
    scene.camera = Some(view);
    let albedo = (f64::from(n) + 1.0) / (f64::from(n) + 2.0);
    let truth = [1.0, 0.5, 0.25].map(|s| s * albedo);
    let mut c = case(
        format!("phong_albedo_{n}"),
        "closed form: (n+1)/(n+2)",
        scene,
        Measure::Pixels,
        vec![truth; 4],
        2048,
    );
    // Half an angle of 1e-4 off the normal, and the power function.
    c.rounding = 1e-5;
    c
}

/// A repeating bitmap under a constant sky: the mean of the image is the mean of the decoded texels, as bilinear
/// weights sum to one over a period.
fn texture_mean() -> Case {
    let mut r = Random::new(0x7e87);
    let texels: Vec<[u8; 3]> = (0..16).map(|_| [0; 3].map(|_| r.below(256) as u8)).collect();
    let decode = |code: u8| {
        let s = f64::from(code) / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
    };
    let truth = [0, 1, 2].map(|c| texels.iter().map(|t| decode(t[c])).sum::<f64>() / 16.0);
    let mut square = mesh(
        vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        vec![[0, 1, 2], [0, 2, 3]],
        "printed",
    );
    square.texcoords = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]];
    let printed = MaterialKind::Diffuse {
        albedo: Reflectance { color: [1.0; 3], texture: "print".into(), checker: None },
    };
    let mut scene = SceneDesc {
        meshes: vec![square],
        materials: vec![material("printed", printed, 0.0)],
        lights: vec![environment(1.0)],
        textures: vec![TextureDesc { name: "print".into(), width: 4, height: 4, texels, wrap: Wrap::Repeat }],
        ..SceneDesc::default()
    };
    // The square fills the image exactly: half-width 1 at distance 1.
    let mut view = camera([0.0, 0.0, 1.0], [0.0; 3], 90.0, [12, 12]);
    view.up = [0.0, 1.0, 0.0];
    scene.camera = Some(view);
    let mut c = case(
        "texture_mean",
        "mean of the decoded texels (IEC 61966-2-1)",
        scene,
        Measure::ImageMean,
        vec![truth],
        1024,
    );
    // Rays at the very rim may pass the square: 2^-24 of the image.
    c.rounding = 1e-5;
    c
}

/// Shading normals tilted by 30 degrees: the cosine of direct light is theirs; of a constant sky, what they send below
/// the geometric surface is lost: rho (1 + cos 30) / 2.
fn shading_normals() -> Vec<Case> {
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    let scene = |light| {
        let mut square = mesh(
            vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]],
            vec![[0, 1, 2], [0, 2, 3]],
            "grey",
        );
        square.normals = vec![[sin as f32, 0.0, cos as f32]; 4];
        square.shading_normals = true;
        let mut scene = SceneDesc {
            meshes: vec![square],
            materials: vec![diffuse("grey", 0.8, 0.0)],
            lights: vec![light],
            ..SceneDesc::default()
        };
        scene.camera = Some(camera([0.0, -3.0, 4.0], [0.0; 3], 0.01, [2, 2]));
        scene
    };
    let lit = [0.8 / PI * 8.0 * cos / 4.0; 3];
    let sky = [0.8 * (1.0 + cos) / 2.0; 3];
    let mut out = vec![
        case(
            "shading_normal_point",
            "rho I cos_s / (pi h^2)",
            scene(point_light([0.0, 0.0, 2.0], 8.0)),
            Measure::Pixels,
            vec![lit; 4],
            64,
        ),
        case(
            "shading_normal_sky",
            "rho (1 + cos) / 2",
            scene(environment(1.0)),
            Measure::Pixels,
            vec![sky; 4],
            4096,
        ),
    ];
    for c in &mut out {
        c.rounding = 1e-4;
        c.max_depth = 2;
    }
    out
}
