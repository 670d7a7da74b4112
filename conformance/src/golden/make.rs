//! The golden scenes.

use super::GoldenScene;
use crate::scenes::{camera, diffuse, environment, floor, material, mesh, point_light, room, shape, sphere};
use crate::statistics::Random;
use etendue_core::scene::{
    LightDesc, MaterialDesc, MaterialKind, MediumDesc, MeshDesc, Reflectance, SceneDesc, ShapeDesc,
    ShapeKind, TextureDesc, Wrap,
};

/// 640 pixels: one may miss by chance, as heavy tails have it, and 99.75 % still agree.
const RESOLUTION: [u32; 2] = [32, 20];

/// Every golden scene with its stored image.
pub fn scenes() -> Vec<GoldenScene> {
    vec![
        GoldenScene { name: "room", scene: closed_room(), text: include_str!("../../goldens/room.txt") },
        GoldenScene { name: "gloss", scene: gloss(), text: include_str!("../../goldens/gloss.txt") },
        GoldenScene { name: "stage", scene: stage(), text: include_str!("../../goldens/stage.txt") },
        GoldenScene { name: "terrace", scene: terrace(), text: include_str!("../../goldens/terrace.txt") },
        GoldenScene { name: "mist", scene: mist(), text: include_str!("../../goldens/mist.txt") },
    ]
}

fn coloured(name: &str, albedo: [f32; 3]) -> MaterialDesc {
    material(name, MaterialKind::Diffuse { albedo: Reflectance::flat(albedo) }, 0.0)
}

fn cuboid(min: [f32; 3], max: [f32; 3], material: &str) -> etendue_core::scene::ShapeDesc {
    shape(ShapeKind::Box { min, max }, material)
}

/// Diffuse, closed, one lamp under the ceiling, two boxes, coloured walls.
fn closed_room() -> SceneDesc {
    let mut walls: MeshDesc = room([0.0, 0.0, 1.0], 1.0, "");
    walls.material_names = vec!["white".into(), "red".into(), "green".into()];
    // Faces come in pairs: floor, ceiling, -y, +y, -x, +x.
    walls.face_materials = vec![0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 2, 2];
    let mut scene = SceneDesc {
        meshes: vec![walls],
        shapes: vec![
            cuboid([-0.6, 0.1, 0.0], [-0.1, 0.6, 1.2], "white"),
            cuboid([0.1, -0.4, 0.0], [0.6, 0.1, 0.5], "white"),
            shape(
                ShapeKind::Rectangle { center: [0.0, 0.0, 1.99], u: [0.0, 0.3, 0.0], v: [0.3, 0.0, 0.0] },
                "lamp",
            ),
        ],
        materials: vec![
            coloured("white", [0.75; 3]),
            coloured("red", [0.6, 0.1, 0.1]),
            coloured("green", [0.1, 0.5, 0.1]),
            MaterialDesc { emission: [15.0, 12.0, 8.0], ..diffuse("lamp", 0.0, 0.0) },
        ],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.0, -0.95, 1.0], [0.0, 1.0, 0.9], 85.0, RESOLUTION));
    scene
}

/// Phong lobes, a mirror, spheres, sphere and triangle lights.
fn gloss() -> SceneDesc {
    let both = MaterialKind::DiffusePhong {
        albedo: Reflectance::flat([0.3, 0.4, 0.5]),
        specular: [0.4, 0.4, 0.3],
        exponent: 40.0,
    };
    let mut scene = SceneDesc {
        meshes: vec![mesh(
            vec![[-2.0, 1.5, 0.5], [2.0, 1.5, 0.5], [0.0, 1.0, 2.5]],
            vec![[0, 1, 2]],
            "panel",
        )],
        shapes: vec![
            floor(0.0, 4.0, "both"),
            sphere([-0.8, 0.0, 0.5], 0.5, "mirror"),
            sphere([0.6, -0.3, 0.6], 0.6, "phong"),
            sphere([0.0, -0.5, 3.4], 0.8, "bulb"),
        ],
        materials: vec![
            material("both", both, 0.0),
            material("mirror", MaterialKind::Mirror { albedo: Reflectance::flat([0.9, 0.85, 0.8]) }, 0.0),
            material("phong", MaterialKind::Phong { specular: [0.8, 0.6, 0.4], exponent: 8.0 }, 0.0),
            MaterialDesc { two_sided: false, ..diffuse("bulb", 0.2, 3.0) },
            MaterialDesc { emission: [0.5, 1.0, 1.5], ..diffuse("panel", 0.5, 0.0) },
        ],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.3, -4.0, 1.8], [0.0, 0.0, 0.6], 50.0, RESOLUTION));
    scene
}

/// Point, spot and directional light on one-sided walls and a smoothly shaded ball, through a lens.
fn stage() -> SceneDesc {
    let mut ball = crate::scenes::round_room(0.6, 2, "ball");
    // Turned inside out, with the normals of the sphere.
    for t in &mut ball.triangles {
        t.swap(1, 2);
    }
    ball.normals = ball.positions.clone();
    for p in &mut ball.positions {
        p[2] += 0.6;
    }
    ball.shading_normals = true;
    let mut scene = SceneDesc {
        meshes: vec![ball],
        shapes: vec![
            floor(0.0, 3.0, "stone"),
            shape(
                ShapeKind::Rectangle { center: [0.0, 2.0, 1.0], u: [3.0, 0.0, 0.0], v: [0.0, 0.0, 1.0] },
                "curtain",
            ),
        ],
        materials: vec![
            coloured("stone", [0.5, 0.5, 0.45]),
            MaterialDesc { two_sided: false, ..coloured("curtain", [0.6, 0.1, 0.15]) },
            coloured("ball", [0.7, 0.7, 0.8]),
        ],
        lights: vec![
            point_light([-2.0, -1.0, 2.5], 6.0),
            LightDesc::Spot {
                position: [1.5, -2.0, 3.0],
                direction: [-0.4, 0.6, -0.8],
                intensity: [30.0, 25.0, 15.0],
                cone_deg: 30.0,
                falloff_deg: 15.0,
            },
            LightDesc::Directional { direction: [0.3, 1.0, -1.0], irradiance: [0.3, 0.3, 0.5] },
        ],
        ..SceneDesc::default()
    };
    let mut view = camera([0.0, -4.0, 1.5], [0.0, 0.0, 0.7], 50.0, RESOLUTION);
    (view.lens_radius, view.focus_distance) = (0.08, 3.5);
    scene.camera = Some(view);
    scene
}

/// An open sky, a disk lamp, a printed floor and a sheet of paper.
fn terrace() -> SceneDesc {
    let mut r = Random::new(0x7e22);
    let texels = (0..64).map(|_| [0; 3].map(|_| r.below(256) as u8)).collect();
    let printed = |name: &str, color: [f32; 3]| {
        material(
            name,
            MaterialKind::Diffuse { albedo: Reflectance { color, texture: "print".into(), checker: None } },
            0.0,
        )
    };
    let mut ground = mesh(
        vec![[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]],
        vec![[0, 1, 2], [0, 2, 3]],
        "printed",
    );
    ground.texcoords = vec![[0.0, 0.0], [1.5, 0.0], [1.5, 1.5], [0.0, 1.5]];
    let mut scene = SceneDesc {
        meshes: vec![ground],
        shapes: vec![
            cuboid([-1.5, -0.2, 0.0], [-0.7, 0.8, 0.8], "white"),
            sphere([0.7, 0.2, 0.5], 0.5, "white"),
            shape(ShapeKind::Disk { center: [0.0, 0.0, 2.0], normal: [0.2, 0.0, -1.0], radius: 0.4 }, "lamp"),
        ],
        materials: vec![
            printed("printed", [0.9, 0.8, 0.7]),
            coloured("white", [0.8; 3]),
            MaterialDesc { emission: [6.0, 5.0, 4.0], ..diffuse("lamp", 0.3, 0.0) },
        ],
        lights: vec![environment(0.6)],
        textures: vec![TextureDesc { name: "print".into(), width: 8, height: 8, texels, wrap: Wrap::Repeat }],
        ..SceneDesc::default()
    };
    scene.camera = Some(camera([0.5, -4.0, 2.2], [0.0, 0.0, 0.5], 55.0, RESOLUTION));
    scene
}

/// Fog with a ball of another colour in it, glass, metal, a plate and a film, under the sky and a lamp; the camera stands in a thin haze that is everywhere.
fn mist() -> SceneDesc {
    let mut glowing = MediumDesc::new("ember", [2.0, 4.0, 6.0], [1.0, 0.5, 0.2], -0.3);
    glowing.emission = [3.0, 1.0, 0.2];
    let filled = |kind: ShapeKind, material: &str, interior: &str| ShapeDesc {
        interior: interior.into(),
        ..shape(kind, material)
    };
    let ball = |center: [f32; 3], radius: f32| ShapeKind::Sphere { center, radius };
    let pane = |center: [f32; 3], u: [f32; 3], v: [f32; 3]| ShapeKind::Rectangle { center, u, v };
    let mut scene = SceneDesc {
        materials: vec![
            coloured("ground", [0.5, 0.4, 0.3]),
            MaterialDesc { emission: [8.0, 7.0, 6.0], ..diffuse("lamp", 0.0, 0.0) },
            material("boundary", MaterialKind::Null, 0.0),
            material("glass", MaterialKind::Dielectric { ior: [1.5; 3], schlick: false }, 0.0),
            material("prism", MaterialKind::Dielectric { ior: [1.45, 1.5, 1.6], schlick: true }, 0.0),
            material("copper", MaterialKind::Conductor { eta: [0.2, 0.9, 1.1], k: [3.9, 2.4, 2.2] }, 0.0),
            material("plate", MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: false }, 0.0),
            material(
                "film",
                MaterialKind::ThinFilm { reflect: [0.1, 0.1, 0.3], transmit: [0.8, 0.6, 0.2] },
                0.0,
            ),
        ],
        media: vec![
            MediumDesc::new("haze", [0.002; 3], [0.01, 0.015, 0.02], 0.2),
            MediumDesc::new("fog", [0.1, 0.1, 0.2], [1.5, 1.0, 0.8], 0.7),
            glowing,
        ],
        shapes: vec![
            floor(0.0, 6.0, "ground"),
            shape(pane([1.0, 0.5, 4.0], [0.0, 0.8, 0.0], [0.8, 0.0, 0.0]), "lamp"),
            filled(ShapeKind::Box { min: [-1.8, -0.6, 0.01], max: [-0.2, 1.0, 1.6] }, "boundary", "fog"),
            filled(ball([-1.0, 0.2, 0.7], 0.4), "boundary", "ember"),
            shape(ball([0.6, 0.0, 0.5], 0.5), "glass"),
            filled(ball([1.5, 0.9, 0.45], 0.45), "prism", "fog"),
            shape(ball([0.9, -1.0, 0.3], 0.3), "copper"),
            shape(pane([0.0, -1.2, 0.5], [0.4, 0.1, 0.0], [0.0, 0.0, 0.5]), "plate"),
            shape(pane([-1.2, -1.2, 0.5], [0.3, 0.0, 0.0], [0.0, 0.0, 0.5]), "film"),
        ],
        lights: vec![environment(0.4)],
        ..SceneDesc::default()
    };
    let mut eye = camera([0.2, -4.0, 1.4], [0.0, 0.2, 0.6], 50.0, RESOLUTION);
    eye.medium = "haze".into();
    scene.camera = Some(eye);
    scene
}
