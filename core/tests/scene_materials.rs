//! Compilation of rough surfaces, plastic, films that scatter and patterns.

use etendue_core::scene::{
    Checker, CoatRecord, CompiledScene, MaterialDesc, MaterialKind, MeshDesc, NO_INDEX, Reflectance,
    Roughness, SceneDesc, SceneError, ShapeDesc, ShapeKind, compile, material_flags,
};

fn named(name: &str, kind: MaterialKind) -> MaterialDesc {
    MaterialDesc { name: name.into(), kind, two_sided: true, emission: [0.0; 3] }
}

fn square(material: &str) -> ShapeDesc {
    ShapeDesc {
        kind: ShapeKind::Rectangle { center: [0.0; 3], u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] },
        material: material.into(),
        interior: String::new(),
        exterior: String::new(),
    }
}

fn of(kind: MaterialKind) -> Result<CompiledScene, SceneError> {
    let desc =
        SceneDesc { materials: vec![named("m", kind)], shapes: vec![square("m")], ..SceneDesc::default() };
    compile(&desc).map(|c| c.0)
}

fn plastic(ior: f32, roughness: Option<Roughness>) -> MaterialKind {
    MaterialKind::Plastic { albedo: Reflectance::flat([0.5; 3]), ior, roughness, nonlinear: false }
}

fn glass(ior: [f32; 3], roughness: Roughness) -> MaterialKind {
    MaterialKind::RoughDielectric { ior, schlick: false, roughness }
}

fn metal(roughness: Roughness) -> MaterialKind {
    MaterialKind::RoughConductor { eta: [0.2; 3], k: [3.0; 3], roughness }
}

#[test]
fn needs_name_what_surfaces_do() {
    let rough = of(metal(Roughness::Ggx(0.2))).unwrap();
    assert!(rough.needs.rough && rough.needs.lobes() && !rough.needs.mirrors && !rough.needs.volume());
    assert!(rough.needs.beyond_paths().is_none() && rough.needs.beyond_surfaces().is_none());
    let boundary = of(glass([1.5; 3], Roughness::Phong(20.0))).unwrap();
    assert!(boundary.needs.rough && boundary.needs.refraction && boundary.needs.volume());
    assert!(boundary.needs.beyond_paths().is_none() && boundary.needs.beyond_surfaces().is_some());
    let smooth = of(plastic(1.5, None)).unwrap();
    assert!(smooth.needs.plastic && smooth.needs.mirrors && !smooth.needs.rough && !smooth.needs.volume());
    let coated = of(plastic(1.5, Some(Roughness::Beckmann(0.2)))).unwrap();
    assert!(coated.needs.plastic && !coated.needs.mirrors && coated.needs.beyond_diffuse());
    let film = of(MaterialKind::ScatteringFilm { reflect: [0.5; 3], transmit: [0.5; 3] }).unwrap();
    assert!(film.needs.scattering_films && film.needs.volume() && !film.needs.panes);
    assert!(film.crossings.is_empty() && film.needs.beyond_surfaces().unwrap().contains("films"));
    assert_eq!(film.needs.to_string(), "films that scatter");
}

#[test]
fn what_cannot_be_is_refused() {
    for bad in [
        metal(Roughness::Ggx(-0.1)),
        metal(Roughness::Ggx(11.0)),
        metal(Roughness::Beckmann(f32::NAN)),
        metal(Roughness::Phong(-1.0)),
        glass([1.5, 0.0, 1.5], Roughness::Ggx(0.1)),
        glass([1.5; 3], Roughness::Beckmann(f32::INFINITY)),
        plastic(0.0, None),
        plastic(f32::NAN, None),
        plastic(1.5, Some(Roughness::Phong(f32::NAN))),
        MaterialKind::ScatteringFilm { reflect: [0.6; 3], transmit: [0.5; 3] },
        MaterialKind::ScatteringFilm { reflect: [-0.6; 3], transmit: [0.5; 3] },
        checked([0.5; 3], [[1.5; 3], [0.0; 3]], [1.0; 2]),
        checked([0.5; 3], [[0.5; 3], [-0.1; 3]], [1.0; 2]),
        checked([0.5; 3], [[0.5; 3], [0.1; 3]], [f32::INFINITY, 1.0]),
    ] {
        assert!(of(bad.clone()).is_err(), "{bad:?}");
    }
    assert!(of(metal(Roughness::Ggx(0.0))).is_ok() && of(metal(Roughness::Ggx(10.0))).is_ok());
    // A rough boundary without a change of index is a smooth one.
    let matched = of(glass([1.0; 3], Roughness::Ggx(0.3))).unwrap();
    assert!(matched.materials[0].rough().is_none() && matched.needs.refraction && !matched.needs.rough);
}

#[test]
fn coats_are_computed_once_for_all_that_share_them() {
    let kinds = [
        plastic(1.5, None),
        plastic(1.5, None),
        plastic(1.6, None),
        plastic(1.5, Some(Roughness::Ggx(0.2))),
        plastic(1.5, Some(Roughness::Beckmann(0.2))),
        plastic(1.5, Some(Roughness::Ggx(0.2))),
        MaterialKind::Diffuse { albedo: Reflectance::flat([0.5; 3]) },
    ];
    let desc = SceneDesc {
        materials: kinds.into_iter().enumerate().map(|(i, k)| named(&i.to_string(), k)).collect(),
        shapes: vec![square("0")],
        ..SceneDesc::default()
    };
    let (out, _) = compile(&desc).unwrap();
    let coats: Vec<u32> = out.materials.iter().map(|m| m.coat).collect();
    assert_eq!(coats, [0, 0, 1, 2, 3, 2, NO_INDEX]);
    assert_eq!(out.coats.len(), 4);
    for coat in &out.coats {
        let CoatRecord { internal, mean, .. } = *coat;
        assert!(internal > 0.4 && internal < 0.7 && mean > 0.8 && mean < 0.95, "{coat:?}");
    }
    assert!(out.coats[2].transmittance.windows(2).all(|w| w[0] < w[1]), "{:?}", out.coats[2]);
    assert_eq!(out.materials[6].flags & material_flags::PLASTIC, 0);
}

fn checked(color: [f32; 3], colors: [[f32; 3]; 2], repeat: [f32; 2]) -> MaterialKind {
    let checker = Some(Checker { colors, repeat });
    MaterialKind::Diffuse { albedo: Reflectance { color, texture: String::new(), checker } }
}

#[test]
fn patterns_are_records_and_rectangles_have_coordinates() {
    let out = of(checked([0.5; 3], [[1.0; 3], [0.25; 3]], [3.0, 2.0])).unwrap();
    assert!(out.needs.textures && out.materials[0].is_textured());
    assert_eq!(out.texcoords, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    let record = &out.checkers[out.materials[0].checker as usize];
    // floor(2 u') + floor(2 v'), u' = 3 u, v' = 2 v.
    for (uv, first) in [
        ([0.0, 0.0], true),
        ([0.1, 0.1], true),
        ([0.2, 0.1], false),
        ([0.2, 0.3], true),
        ([0.4, 0.3], false),
        ([-0.1, 0.1], false),
        ([-0.1, -0.1], true),
        ([100.1, 50.1], true),
    ] {
        assert_eq!(record.color(uv).x, if first { 1.0 } else { 0.25 }, "{uv:?}");
    }
    assert!(record.color([f32::NAN, f32::INFINITY]).is_finite());
    // Meshes without textures have the plain colour.
    let mesh = MeshDesc {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        material_names: vec!["m".into()],
        textures: false,
        ..MeshDesc::default()
    };
    let desc = SceneDesc {
        materials: vec![named("m", checked([0.5; 3], [[1.0; 3]; 2], [1.0; 2]))],
        meshes: vec![mesh],
        ..SceneDesc::default()
    };
    let (plain, _) = compile(&desc).unwrap();
    assert!(!plain.needs.textures && plain.material_of(0).checker == NO_INDEX);
}
