//! Scenes in code: a few words instead of files, so that the suite needs none.

pub mod cases;
pub mod closed;
pub mod direct;
pub mod media;
pub mod open;

use etendue_core::backend::Probe;
use etendue_core::scene::{
    CameraDesc, EnvironmentDesc, LightDesc, MaterialDesc, MaterialKind, MeshDesc, Reflectance, SceneDesc,
    ShapeDesc, ShapeKind,
};

/// A material.
pub fn material(name: &str, kind: MaterialKind, emission: f32) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [emission; 3] }
}

/// A grey diffuse material that may emit.
pub fn diffuse(name: &str, albedo: f32, emission: f32) -> MaterialDesc {
    material(name, MaterialKind::Diffuse { albedo: Reflectance::flat([albedo; 3]) }, emission)
}

/// An analytic shape of a material.
pub fn shape(kind: ShapeKind, material: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: String::new(), exterior: String::new() }
}

/// A sphere.
pub fn sphere(center: [f32; 3], radius: f32, material: &str) -> ShapeDesc {
    shape(ShapeKind::Sphere { center, radius }, material)
}

/// A horizontal square with its front up (+z), `half` to each side.
pub fn floor(z: f32, half: f32, material: &str) -> ShapeDesc {
    shape(ShapeKind::Rectangle { center: [0.0, 0.0, z], u: [half, 0.0, 0.0], v: [0.0, half, 0.0] }, material)
}

/// A mesh of one material.
pub fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, material: &str) -> MeshDesc {
    MeshDesc { positions, triangles, material: material.into(), textures: true, ..MeshDesc::default() }
}

/// A cube with its front inside, as a mesh of twelve triangles: corners at +-`half` about `center`.
pub fn room(center: [f32; 3], half: f32, material: &str) -> MeshDesc {
    let corner = |i: usize| [0, 1, 2].map(|k| center[k] + if (i >> k) & 1 == 1 { half } else { -half });
    // Each face counter-clockwise seen from inside; corner i has bit k set where axis k is high.
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3_u32]];
    let triangles = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    mesh((0..8).map(corner).collect(), triangles, material)
}

/// An octahedron split `levels` times and pushed out to the unit sphere times `radius`, front inside: closed, 8 * 4^levels
/// triangles of different sizes.
pub fn round_room(radius: f32, levels: usize, material: &str) -> MeshDesc {
    let mut faces: Vec<[[f64; 3]; 3]> = Vec::new();
    for i in 0..8 {
        let s = |k: usize| if (i >> k) & 1 == 1 { 1.0 } else { -1.0 };
        let v = [[s(0), 0.0, 0.0], [0.0, s(1), 0.0], [0.0, 0.0, s(2)]];
        // Even numbers of flips keep the turning sense; the front is to be inside.
        faces.push(if s(0) * s(1) * s(2) > 0.0 { [v[0], v[2], v[1]] } else { v });
    }
    let unit = |a: [f64; 3], b: [f64; 3]| {
        let m = [0, 1, 2].map(|k| a[k] + b[k]);
        let l = m.iter().map(|x| x * x).sum::<f64>().sqrt();
        m.map(|x| x / l)
    };
    for _ in 0..levels {
        faces = faces
            .iter()
            .flat_map(|[a, b, c]| {
                let (d, e, f) = (unit(*a, *b), unit(*b, *c), unit(*c, *a));
                [[*a, d, f], [d, *b, e], [f, e, *c], [d, e, f]]
            })
            .collect();
    }
    let positions: Vec<[f32; 3]> =
        faces.iter().flatten().map(|v| v.map(|x| (x * f64::from(radius)) as f32)).collect();
    let triangles = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(positions, triangles, material)
}

/// A pinhole camera that looks at the origin's surroundings.
pub fn camera(position: [f32; 3], look_at: [f32; 3], fov_x_deg: f32, resolution: [u32; 2]) -> CameraDesc {
    CameraDesc {
        position,
        look_at,
        up: [0.0, 0.0, 1.0],
        fov_x_deg,
        resolution,
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: String::new(),
    }
}

/// A constant environment.
pub fn environment(radiance: f32) -> LightDesc {
    LightDesc::Environment(EnvironmentDesc::uniform([radiance; 3]))
}

/// An isotropic point light.
pub fn point_light(position: [f32; 3], intensity: f32) -> LightDesc {
    LightDesc::Point { position, intensity: [intensity; 3] }
}

/// A probe.
pub fn probe(position: [f32; 3], normal: [f32; 3]) -> Probe {
    Probe { position, normal }
}

/// The scene scaled about the origin and then moved: lengths times `scale`, intensities so that radiances stay.
pub fn transformed(desc: &SceneDesc, scale: f32, shift: [f32; 3]) -> SceneDesc {
    let point = |p: [f32; 3]| [0, 1, 2].map(|k| p[k] * scale + shift[k]);
    let length = |v: [f32; 3]| v.map(|x| x * scale);
    let mut out = desc.clone();
    for m in &mut out.meshes {
        m.positions = m.positions.iter().map(|p| point(*p)).collect();
    }
    for s in &mut out.shapes {
        match &mut s.kind {
            ShapeKind::Sphere { center, radius } | ShapeKind::Disk { center, radius, .. } => {
                *center = point(*center);
                *radius *= scale;
            }
            ShapeKind::Rectangle { center, u, v } => {
                (*center, *u, *v) = (point(*center), length(*u), length(*v));
            }
            ShapeKind::Box { min, max } => (*min, *max) = (point(*min), point(*max)),
        }
    }
    for l in &mut out.lights {
        match l {
            LightDesc::Point { position, intensity } | LightDesc::Spot { position, intensity, .. } => {
                *position = point(*position);
                *intensity = intensity.map(|x| x * scale * scale);
            }
            _ => {}
        }
    }
    if let Some(c) = &mut out.camera {
        c.position = point(c.position);
        c.look_at = point(c.look_at);
        c.lens_radius *= scale;
        c.focus_distance *= scale;
    }
    out
}
