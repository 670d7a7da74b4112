//! Compilation: every defect is refused with its place or mended and counted; needs are what the scene holds.

use etendue_core::math::Vec3;
use etendue_core::scene::{
    CameraDesc, Cleanup, CompiledScene, EnvironmentDesc, LightDesc, LightKind, MaterialDesc, MaterialKind,
    MediumDesc, MeshDesc, NO_INDEX, Reflectance, SceneDesc, SceneError, ShapeDesc, ShapeKind, TextureDesc,
    Wrap, compile,
};

fn diffuse(name: &str, albedo: f32, emission: f32) -> MaterialDesc {
    MaterialDesc {
        name: name.into(),
        kind: MaterialKind::Diffuse { albedo: Reflectance::flat([albedo; 3]) },
        two_sided: true,
        emission: [emission; 3],
    }
}

/// One triangle in the plane z = 0 with its front towards +z.
fn triangle() -> MeshDesc {
    MeshDesc {
        name: "tri.obj".into(),
        positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..MeshDesc::default()
    }
}

fn scene(mesh: MeshDesc) -> SceneDesc {
    SceneDesc { meshes: vec![mesh], ..SceneDesc::default() }
}

fn shape(kind: ShapeKind, material: &str) -> ShapeDesc {
    ShapeDesc { kind, material: material.into(), interior: String::new(), exterior: String::new() }
}

fn refused(desc: &SceneDesc) -> SceneError {
    compile(desc).expect_err("the scene should be refused")
}

fn normal_of(scene: &CompiledScene, i: usize) -> Vec3 {
    Vec3::from_array(scene.surfaces[i].normal)
}

#[test]
fn an_empty_scene_is_refused() {
    assert_eq!(refused(&SceneDesc::default()), SceneError::Empty);
    let mut mesh = triangle();
    mesh.positions[2] = [2.0, 0.0, 0.0];
    assert_eq!(refused(&scene(mesh)), SceneError::Empty, "nothing is left after the clean-up");
}

#[test]
fn bad_meshes_are_refused_with_their_place() {
    let check = |change: fn(&mut MeshDesc)| {
        let mut mesh = triangle();
        change(&mut mesh);
        refused(&scene(mesh)).to_string()
    };
    for (message, expected) in [
        (check(|m| m.positions[1][2] = f32::NAN), "not a finite number"),
        (check(|m| m.positions[1][2] = f32::INFINITY), "not a finite number"),
        (check(|m| m.triangles[0][1] = 3), "triangle 0 refers to vertex 3, but there are only 3"),
        (check(|m| m.normals = vec![[0.0; 3]]), "normals has 1 entries, expected 3"),
        (check(|m| m.texcoords = vec![[0.0; 2]; 2]), "texcoords has 2 entries, expected 3"),
        (check(|m| m.face_materials = vec![0, 0]), "face_materials has 2 entries, expected 1"),
        (check(|m| m.face_materials = vec![1]), "refers to material 1, but there are only 1"),
        (check(|m| m.material = "gold".into()), "there is no material named \"gold\""),
        (check(|m| m.interior = "fog".into()), "there is no medium named \"fog\""),
        (check(|m| m.transform = Some([[0.0; 4]; 3])), "non-zero determinant"),
        (check(|m| m.transform = Some([[f32::NAN; 4]; 3])), "not a finite number"),
    ] {
        assert!(message.contains("tri.obj") && message.contains(expected), "{message}");
    }
}

#[test]
fn bad_materials_textures_and_media_are_refused() {
    let with_material = |m: MaterialDesc| SceneDesc { materials: vec![m], ..scene(triangle()) };
    assert_eq!(
        refused(&with_material(diffuse("a", 1.25, 0.0))),
        SceneError::EnergyAboveOne { material: "a".into(), channel: 0, value: 1.25 }
    );
    let both = MaterialKind::DiffusePhong {
        albedo: Reflectance::flat([0.5, 0.75, 0.5]),
        specular: [0.25, 0.5, 0.25],
        exponent: 10.0,
    };
    assert_eq!(
        refused(&with_material(MaterialDesc { kind: both, ..diffuse("b", 0.0, 0.0) })),
        SceneError::EnergyAboveOne { material: "b".into(), channel: 1, value: 1.25 }
    );
    assert!(matches!(refused(&with_material(diffuse("c", -0.1, 0.0))), SceneError::OutOfRange { .. }));
    assert!(matches!(refused(&with_material(diffuse("c", 0.1, f32::NAN))), SceneError::NotFinite { .. }));
    let textured =
        MaterialKind::Diffuse { albedo: Reflectance { color: [1.0; 3], texture: "t".into(), checker: None } };
    let textured = MaterialDesc { kind: textured, ..diffuse("d", 0.0, 0.0) };
    assert!(matches!(refused(&with_material(textured)), SceneError::UnknownName { kind: "texture", .. }));

    let mut twice = with_material(diffuse("a", 0.5, 0.0));
    twice.materials.push(diffuse("a", 0.6, 0.0));
    assert_eq!(refused(&twice), SceneError::DuplicateName { kind: "material", name: "a".into() });

    let texture = |texels: usize| TextureDesc {
        name: "t".into(),
        width: 2,
        height: 2,
        texels: vec![[0; 3]; texels],
        wrap: Wrap::Repeat,
    };
    let short = SceneDesc { textures: vec![texture(3)], ..scene(triangle()) };
    assert!(matches!(refused(&short), SceneError::WrongLength { found: 3, expected: 4, .. }));

    let medium = |g: f32| MediumDesc::new("fog", [0.1; 3], [0.1; 3], g);
    for g in [1.0, -1.0, f32::NAN] {
        assert!(compile(&SceneDesc { media: vec![medium(g)], ..scene(triangle()) }).is_err(), "g = {g}");
    }
}

#[test]
fn bad_lights_and_shapes_are_refused() {
    let with_light = |l: LightDesc| SceneDesc { lights: vec![l], ..scene(triangle()) };
    let spot = |cone_deg: f32, falloff_deg: f32, direction: [f32; 3]| LightDesc::Spot {
        position: [0.0; 3],
        direction,
        intensity: [1.0; 3],
        cone_deg,
        falloff_deg,
    };
    let down = [0.0, -1.0, 0.0];
    for (light, field) in [
        (spot(0.0, 0.0, down), "cone_deg"),
        (spot(181.0, 0.0, down), "cone_deg"),
        (spot(30.0, 31.0, down), "falloff_deg"),
        (spot(30.0, 20.0, [0.0; 3]), "direction"),
        (LightDesc::Point { position: [0.0; 3], intensity: [-1.0; 3] }, "intensity"),
        (LightDesc::Point { position: [f32::NAN; 3], intensity: [1.0; 3] }, "position"),
        (LightDesc::Directional { direction: [0.0; 3], irradiance: [1.0; 3] }, "direction"),
        (LightDesc::Environment(EnvironmentDesc::uniform([f32::INFINITY; 3])), "radiance"),
    ] {
        let message = refused(&with_light(light)).to_string();
        assert!(message.starts_with("light 0") && message.contains(field), "{message}");
    }
    for kind in [
        ShapeKind::Sphere { center: [0.0; 3], radius: 0.0 },
        ShapeKind::Sphere { center: [0.0; 3], radius: f32::NAN },
        ShapeKind::Disk { center: [0.0; 3], normal: [0.0; 3], radius: 1.0 },
        ShapeKind::Rectangle { center: [0.0; 3], u: [1.0, 0.0, 0.0], v: [2.0, 0.0, 0.0] },
        ShapeKind::Box { min: [0.0; 3], max: [1.0, 0.0, 1.0] },
    ] {
        let desc = SceneDesc { shapes: vec![shape(kind.clone(), "")], ..SceneDesc::default() };
        assert!(refused(&desc).to_string().starts_with("shape 0"), "{kind:?}");
    }
}

#[test]
fn degenerate_and_repeated_triangles_are_dropped_and_counted() {
    let mut mesh = triangle();
    mesh.positions.extend([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    mesh.triangles = vec![
        [0, 1, 2],
        [1, 2, 0], // the same, rotated
        [3, 4, 5], // the same, by other vertices at the same places
        [0, 2, 1], // the back: kept
        [0, 1, 4], // no area
        [0, 0, 1], // no area
    ];
    let (out, report) = compile(&scene(mesh)).unwrap();
    assert_eq!(out.triangles, vec![[0, 1, 2], [0, 2, 1]]);
    assert_eq!(report.cleanups, vec![(Cleanup::DegenerateTriangles, 2), (Cleanup::DuplicateTriangles, 2)]);
    assert_eq!(out.area(), 1.0);
}

#[test]
fn tiny_and_huge_triangles_are_not_degenerate() {
    for size in [1e-18_f32, 1e-10, 1.0, 1e10, 1e18] {
        let mut mesh = triangle();
        for p in &mut mesh.positions {
            *p = p.map(|x| x * size);
        }
        let (out, report) = compile(&scene(mesh)).unwrap();
        assert_eq!((out.triangles.len(), report.cleanups.len()), (1, 0), "size {size}");
        assert_eq!(normal_of(&out, 0), Vec3::Z);
    }
}

#[test]
fn transforms_keep_fronts_where_they_are() {
    let mut mesh = triangle();
    mesh.normals = vec![[0.0, 0.0, 2.0]; 3];
    mesh.shading_normals = true;
    // Mirrored in x, stretched in z, moved.
    mesh.transform = Some([[-2.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 3.0, 1.0]]);
    let (out, _) = compile(&scene(mesh)).unwrap();
    assert_eq!(normal_of(&out, 0), Vec3::Z, "a mirror keeps the front in front");
    assert_eq!(out.positions[1], [3.0, 0.0, 1.0]);
    assert_eq!(out.normals, vec![[0.0, 0.0, 1.0]; 3]);
    assert!(out.needs.shading_normals);

    // A shear tilts the surface; its normal follows by the inverse transpose.
    let mut mesh = triangle();
    mesh.normals = vec![[0.0, 0.0, 1.0]; 3];
    mesh.shading_normals = true;
    mesh.transform = Some([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0]]);
    let (out, _) = compile(&scene(mesh)).unwrap();
    let shading = Vec3::from_array(out.normals[0]);
    assert!((shading - normal_of(&out, 0)).length() <= 2e-7, "{shading}");
}

#[test]
fn boxes_and_rectangles_face_outward_and_along_u_cross_v() {
    let kind = ShapeKind::Box { min: [-1.0, -2.0, -3.0], max: [1.0, 2.0, 3.0] };
    let (out, _) = compile(&SceneDesc { shapes: vec![shape(kind, "")], ..SceneDesc::default() }).unwrap();
    assert_eq!(out.triangles.len(), 12);
    for (i, t) in out.triangles.iter().enumerate() {
        let centre: Vec3 = t.iter().map(|v| Vec3::from_array(out.positions[*v as usize])).sum::<Vec3>() / 3.0;
        assert!(normal_of(&out, i).dot(centre) > 0.0, "triangle {i} faces inward");
    }
    assert_eq!(out.area(), 88.0);
    let kind = ShapeKind::Rectangle { center: [0.0; 3], u: [1.0, 0.0, 0.0], v: [0.0, 2.0, 0.0] };
    let (out, _) = compile(&SceneDesc { shapes: vec![shape(kind, "")], ..SceneDesc::default() }).unwrap();
    assert_eq!((normal_of(&out, 0), normal_of(&out, 1)), (Vec3::Z, Vec3::Z));
    assert_eq!(out.area(), 8.0);
}

#[test]
fn lights_are_found_linked_and_weighed_by_flux() {
    let desc = SceneDesc {
        materials: vec![diffuse("lamp", 0.0, 2.0)],
        meshes: vec![MeshDesc { material: "lamp".into(), ..triangle() }],
        shapes: vec![
            shape(ShapeKind::Rectangle { center: [5.0; 3], u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] }, "lamp"),
            shape(ShapeKind::Sphere { center: [9.0; 3], radius: 1.0 }, "lamp"),
        ],
        lights: vec![
            LightDesc::Point { position: [0.0; 3], intensity: [1.0; 3] },
            LightDesc::Point { position: [0.0; 3], intensity: [0.0; 3] },
            LightDesc::Environment(EnvironmentDesc::uniform([0.5, 0.25, 0.0])),
            LightDesc::Environment(EnvironmentDesc::uniform([0.5; 3])),
        ],
        ..SceneDesc::default()
    };
    let (out, report) = compile(&desc).unwrap();
    assert_eq!(report.cleanups, vec![(Cleanup::DarkLights, 1)]);
    let kinds: Vec<u32> = out.lights.iter().map(|l| l.kind).collect();
    let expected = [LightKind::Triangle, LightKind::Parallelogram, LightKind::Sphere, LightKind::Point]
        .map(|k| k as u32);
    assert_eq!(kinds, expected);
    // Both triangles of the rectangle are its one light; the sphere is the last primitive.
    let links: Vec<u32> = out.surfaces.iter().map(|s| s.light).collect();
    assert_eq!(links, [0, 1, 1, 2]);
    assert_eq!(out.environment, [1.0, 0.75, 0.5], "environments add up");
    let pi = std::f64::consts::PI;
    let flux = [2.0 * pi * 0.5, 2.0 * pi * 4.0, 2.0 * pi * 4.0 * pi, 4.0 * pi];
    let total: f64 = flux.iter().sum();
    for (l, f) in out.lights.iter().zip(flux) {
        assert!((f64::from(l.pmf) - f / total).abs() <= 1e-6, "{} against {}", l.pmf, f / total);
    }
    assert!(out.needs.area_lights && out.needs.point_like_lights && out.needs.environment);
    assert!(out.needs.light_choice && out.needs.round_shapes);
}

#[test]
fn needs_name_what_is_used_and_nothing_else() {
    let mirror = MaterialDesc {
        name: "mirror".into(),
        kind: MaterialKind::Mirror { albedo: Reflectance::flat([1.0; 3]) },
        two_sided: true,
        emission: [0.0; 3],
    };
    let glass =
        MaterialDesc { kind: MaterialKind::Unsupported("dielectric".into()), ..diffuse("glass", 0.0, 0.0) };
    let unused = SceneDesc { materials: vec![mirror.clone(), glass.clone()], ..scene(triangle()) };
    let (out, _) = compile(&unused).unwrap();
    assert!(!out.needs.mirrors && out.needs.unsupported.is_empty() && out.needs.dark());
    assert_eq!(out.needs.to_string(), "diffuse surfaces only");
    assert_eq!(out.needs.beyond_surfaces(), None);

    let used = |name: &str| {
        let mesh = MeshDesc { material: name.into(), ..triangle() };
        compile(&SceneDesc { materials: vec![mirror.clone(), glass.clone()], ..scene(mesh) }).unwrap().0.needs
    };
    assert!(used("mirror").mirrors && used("mirror").lobes());
    assert!(used("glass").beyond_surfaces().unwrap().contains("dielectric"));
}

#[test]
fn what_light_passes_is_named_and_checked() {
    let of = |kind: MaterialKind| {
        let m = MaterialDesc { kind, ..diffuse("m", 0.0, 0.0) };
        let mesh = MeshDesc { material: "m".into(), ..triangle() };
        compile(&SceneDesc { materials: vec![m], ..scene(mesh) }).map(|c| c.0)
    };
    let glass = of(MaterialKind::Dielectric { ior: [1.5; 3], schlick: false }).unwrap();
    assert!(glass.needs.refraction && glass.needs.volume() && glass.needs.lobes() && !glass.needs.panes);
    assert!(glass.needs.beyond_paths().is_none() && glass.needs.beyond_surfaces().is_some());
    assert!(glass.crossings.is_empty());
    for kind in [
        MaterialKind::ThinDielectric { ior: [1.5; 3], schlick: true },
        MaterialKind::ThinFilm { reflect: [0.5; 3], transmit: [0.5; 3] },
        MaterialKind::Null,
    ] {
        let thin = of(kind.clone()).unwrap();
        assert!(!thin.needs.refraction && thin.needs.volume() && !thin.crossings.is_empty(), "{kind:?}");
    }
    let metal = of(MaterialKind::Conductor { eta: [0.2; 3], k: [3.0; 3] }).unwrap();
    assert!(metal.needs.mirrors && metal.needs.beyond_surfaces().is_none());
    for bad in [
        MaterialKind::Dielectric { ior: [1.5, 0.0, 1.5], schlick: false },
        MaterialKind::Dielectric { ior: [f32::NAN; 3], schlick: false },
        MaterialKind::ThinDielectric { ior: [1e9; 3], schlick: false },
        MaterialKind::Conductor { eta: [0.0; 3], k: [3.0; 3] },
        MaterialKind::Conductor { eta: [0.2; 3], k: [-3.0; 3] },
        MaterialKind::ThinFilm { reflect: [0.5; 3], transmit: [0.6; 3] },
        MaterialKind::ThinFilm { reflect: [-0.5; 3], transmit: [0.6; 3] },
    ] {
        assert!(of(bad.clone()).is_err(), "{bad:?}");
    }
}

#[test]
fn a_mesh_without_textures_gets_plain_colours() {
    let textured = MaterialDesc {
        name: "brick".into(),
        kind: MaterialKind::Diffuse {
            albedo: Reflectance { color: [0.5; 3], texture: "t".into(), checker: None },
        },
        two_sided: true,
        emission: [0.0; 3],
    };
    let texture =
        TextureDesc { name: "t".into(), width: 1, height: 1, texels: vec![[255, 0, 7]], wrap: Wrap::Repeat };
    let mesh = |textures: bool| MeshDesc {
        material_names: vec!["brick".into()],
        texcoords: vec![[0.0; 2]; 3],
        textures,
        ..triangle()
    };
    let desc = SceneDesc {
        materials: vec![textured],
        textures: vec![texture],
        meshes: vec![mesh(true), mesh(false)],
        ..SceneDesc::default()
    };
    let (out, _) = compile(&desc).unwrap();
    assert_eq!(out.texels, [0x0007_00ff]);
    assert_ne!(out.material_of(0).texture, NO_INDEX);
    assert_eq!(out.material_of(1).texture, NO_INDEX);
    assert_eq!(out.material_of(0).albedo, out.material_of(1).albedo);
    assert_eq!(out.texcoords.len(), out.positions.len());
}

#[test]
fn the_camera_is_checked_with_the_scene() {
    let camera = CameraDesc {
        position: [0.0; 3],
        look_at: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        fov_x_deg: 40.0,
        resolution: [4, 4],
        lens_radius: 0.0,
        focus_distance: 1.0,
        medium: String::new(),
    };
    let desc = SceneDesc { camera: Some(camera), ..scene(triangle()) };
    assert!(refused(&desc).to_string().contains("look_at"));
}
