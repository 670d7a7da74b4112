//! A scene with all that scenes with media can have.

use etendue_conformance::scenes::{diffuse, material, point_light, room, round_room, shape};
use etendue_core::scene::{
    CameraDesc, Checker, GridDesc, MaterialKind, MediumDesc, Reflectance, Roughness, SceneDesc, ShapeDesc,
    ShapeKind, TextureDesc,
};

/// A grid of this box whose values are any.
fn grid(size: [u32; 3], channels: u32, [lo, hi]: [[f32; 3]; 2], largest: f32) -> GridDesc {
    let count = size.iter().product::<u32>() * channels;
    // A few layers of nothing, so that blocks are left in one step.
    let value = |i: u32| {
        let x = i.wrapping_mul(0x9e37_79b9) >> 8;
        if i < count / 4 { 0.0 } else { largest * x as f32 / (1 << 24) as f32 }
    };
    let row = |k: usize| {
        let mut row = [0.0; 4];
        row[k] = hi[k] - lo[k];
        row[3] = lo[k];
        row
    };
    GridDesc { size, channels, values: (0..count).map(value).collect(), to_world: [row(0), row(1), row(2)] }
}

fn media(coloured: bool) -> Vec<MediumDesc> {
    let channels = if coloured { 3 } else { 1 };
    let cloud_box = [[-0.9, -0.2, -0.6], [-0.1, 0.6, 0.3]];
    let mut cloud = MediumDesc::new("cloud", [1.0, 1.5, 0.5], [8.0, 7.0, 6.0], 0.6);
    cloud.density = Some(grid([20, 11, 9], channels, cloud_box, 2.0));
    cloud.albedo = Some(grid([3, 2, 4], channels, cloud_box, 1.0));
    cloud.emission = [0.1, 0.0, 0.3];
    let mut smoke = MediumDesc::new("smoke", [0.5, 0.6, 0.7], [2.0, 1.0, 3.0], -0.5);
    smoke.density = Some(grid([5, 9, 17], 1, [[0.2, 0.2, -0.9], [0.8, 0.9, 0.2]], 3.0));
    smoke.priority = 1;
    let mut ember = MediumDesc::new("ember", [2.0, 0.0, 0.3], [0.0, 1.0, 0.5], 0.0);
    ember.emission = [3.0, 1.0, 0.2];
    ember.priority = -1;
    vec![MediumDesc::new("fog", [0.02, 0.05, 0.1], [0.3, 0.2, 0.4], 0.3), cloud, smoke, ember]
}

/// A room filled with fog up to its walls: clouds, overlapping media, glass of colours, rough glass, plastic, metal, panes that lie upon
/// boundaries, paper, a ball with interpolated normals full of smoke, a picture on the floor, and three kinds of light.
pub(crate) fn all_at_once(coloured: bool) -> SceneDesc {
    let filled = |kind, material: &str, interior: &str| ShapeDesc {
        interior: interior.into(),
        ..shape(kind, material)
    };
    let ball = |center, radius| ShapeKind::Sphere { center, radius };
    let quad = |center, u, v| ShapeKind::Rectangle { center, u, v };
    let checker = Checker { colors: [[0.9, 0.5, 0.2], [0.2, 0.3, 0.8]], repeat: [2.0, 3.0] };
    let print = Reflectance { color: [0.9; 3], texture: "print".into(), checker: Some(checker) };
    let mut walls = room([0.0; 3], 1.0, "wall");
    walls.texcoords = (0..8).map(|i| [0.3 * (i % 3) as f32, 0.2 * i as f32]).collect();
    let mut shaded = round_room(0.25, 1, "rough glass");
    for t in &mut shaded.triangles {
        t.swap(1, 2);
    }
    shaded.normals = shaded.positions.clone();
    shaded.shading_normals = true;
    shaded.interior = "smoke".into();
    for p in &mut shaded.positions {
        *p = [p[0] + 0.5, p[1] - 0.5, p[2] + 0.4];
    }
    let ggx = Roughness::Ggx(0.3);
    let glass = |ior| MaterialKind::Dielectric { ior, schlick: false };
    SceneDesc {
        meshes: vec![walls, shaded],
        materials: vec![
            material("wall", MaterialKind::Diffuse { albedo: print }, 0.0),
            diffuse("lamp", 0.2, 6.0),
            material("none", MaterialKind::Null, 0.0),
            material("glass", glass([1.5; 3]), 0.0),
            material("prism", glass([1.4, 1.5, 1.7]), 0.0),
            material(
                "rough glass",
                MaterialKind::RoughDielectric { ior: [1.45, 1.5, 1.6], schlick: false, roughness: ggx },
                0.0,
            ),
            material(
                "plastic",
                MaterialKind::Plastic {
                    albedo: Reflectance::flat([0.6, 0.3, 0.2]),
                    ior: 1.5,
                    roughness: None,
                    nonlinear: true,
                },
                0.0,
            ),
            material(
                "metal",
                MaterialKind::RoughConductor { eta: [0.2, 0.9, 1.1], k: [3.9, 2.4, 2.2], roughness: ggx },
                0.0,
            ),
            material("plate", MaterialKind::ThinDielectric { ior: [1.5, 1.6, 1.4], schlick: true }, 0.0),
            material(
                "film",
                MaterialKind::ThinFilm { reflect: [0.1, 0.1, 0.3], transmit: [0.8, 0.6, 0.2] },
                0.0,
            ),
            material(
                "paper",
                MaterialKind::ScatteringFilm { reflect: [0.6, 0.5, 0.3], transmit: [0.3, 0.4, 0.7] },
                0.0,
            ),
        ],
        media: media(coloured),
        shapes: vec![
            // Boundaries upon the walls, and upon each other.
            filled(ShapeKind::Box { min: [-1.0; 3], max: [1.0; 3] }, "none", "fog"),
            filled(ShapeKind::Box { min: [-0.9, -0.2, -0.6], max: [-0.1, 0.6, 0.3] }, "none", "cloud"),
            filled(ShapeKind::Box { min: [-0.1, -0.2, -0.6], max: [0.2, 0.6, 0.3] }, "film", "ember"),
            filled(ball([0.3, 0.5, -0.3], 0.4), "none", "smoke"),
            filled(ball([-0.5, -0.6, 0.2], 0.2), "glass", "ember"),
            filled(ball([-0.5, -0.6, -0.5], 0.3), "prism", ""),
            shape(ball([0.6, -0.6, -0.6], 0.3), "plastic"),
            shape(ball([0.0, -0.4, -0.8], 0.2), "metal"),
            shape(quad([-0.5, 0.2, 0.3], [0.4, 0.0, 0.0], [0.0, 0.4, 0.0]), "plate"),
            shape(quad([0.1, 0.0, 0.5], [0.2, 0.1, 0.0], [0.0, 0.2, 0.1]), "paper"),
            shape(ShapeKind::Disk { center: [0.4, 0.6, 0.5], normal: [0.3, 0.2, 0.9], radius: 0.3 }, "plate"),
            shape(quad([0.0, 0.0, 0.98], [0.0, 0.3, 0.0], [0.3, 0.0, 0.0]), "lamp"),
            shape(ball([0.7, 0.7, 0.8], 0.1), "lamp"),
        ],
        lights: vec![point_light([-0.5, -0.9, 0.7], 0.7)],
        textures: vec![TextureDesc {
            name: "print".into(),
            width: 2,
            height: 2,
            texels: vec![[250, 200, 90], [30, 220, 180], [128; 3], [200, 40, 240]],
            wrap: Default::default(),
        }],
        camera: Some(CameraDesc {
            lens_radius: 0.02,
            focus_distance: 1.2,
            ..etendue_conformance::scenes::camera([0.1, -0.95, 0.1], [0.0, 0.2, -0.1], 90.0, [24, 18])
        }),
    }
}
