//! Images and probes from maps of photons: closed forms, and the path tracer on everything that surfaces do.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{GatherJob, PathJob, PhotonStart, Probe};
use etendue_core::illumination::{Basis, ElementSettings};
use etendue_core::scene::{
    LightDesc, MaterialKind, MeshDesc, Reflectance, Roughness, SceneDesc, ShapeKind, TextureDesc, Wrap,
};
use etendue_core::transport::first_shot::{Subdivision, Weights};
use etendue_core::transport::photon::Sequence;
use rooms::agree::{Z, assert_agree, check, check_image, truth};
use rooms::{
    JOB, diffuse, furniture, gather_probes, lamp, made_of, on_walls, path_probes, point, results, room,
    session, shape, spot, wall,
};

#[test]
fn a_glowing_room_has_the_same_irradiance_everywhere() {
    let probes = on_walls();
    for rho in [0.0_f32, 0.5, 0.9] {
        let session = session(&room([rho; 3], [1.0, 2.0, 0.5]), None);
        for (gather, sequence) in
            [(true, Sequence::Sorted), (false, Sequence::Sorted), (true, Sequence::Random)]
        {
            let elements = ElementSettings { largest: 0.5, ..JOB.elements };
            let film = gather_probes(&session, &GatherJob { gather, sequence, elements, ..JOB }, &probes);
            let truth = std::f64::consts::PI / (1.0 - f64::from(rho));
            let truth = vec![[1.0, 2.0, 0.5].map(|x| (x * truth, 0.0)); probes.len()];
            assert_agree(&format!("rho {rho}, gather {gather}"), &results(&film), &truth, 7.3, 2e-6);
        }
    }
}

#[test]
fn a_black_room_has_the_direct_light_alone() {
    let mut desc = room([0.0; 3], [0.0; 3]);
    point(&mut desc);
    spot(&mut desc);
    let session = session(&desc, None);
    let probes = on_walls();
    let paths = path_probes(&session, &PathJob { block_length: 1024, blocks: 0..16, ..JOB.path }, &probes);
    for gather in [true, false] {
        let film = gather_probes(&session, &GatherJob { gather, ..JOB }, &probes);
        // One light in two is drawn by paths, by flux; here both are looked at, and nothing is left to chance.
        assert!(results(&film).iter().flatten().all(|(x, s)| *s <= 1e-6 * x), "gather {gather}");
        assert_agree(&format!("gather {gather}"), &results(&film), &results(&paths), 5.0, 1e-6);
    }
}

#[test]
fn a_room_with_a_point_light() {
    let mut desc = room([0.7, 0.5, 0.3], [0.0; 3]);
    point(&mut desc);
    check("point", &desc, &JOB);
}

#[test]
fn a_furnished_room_with_lights_of_all_kinds() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    spot(&mut desc);
    furniture(&mut desc);
    check("furnished", &desc, &JOB);
    let linear = ElementSettings { basis: Basis::Linear, ..JOB.elements };
    check("furnished, linear", &desc, &GatherJob { elements: linear, sequence: Sequence::Sobol, ..JOB });
    desc.shapes.retain(|s| !matches!(s.kind, ShapeKind::Sphere { .. }));
    let start =
        PhotonStart::Surfaces { subdivision: Subdivision::robust(Weights::EXACT), weights: Weights::EXACT };
    check("furnished, from surfaces", &desc, &GatherJob { start, ..JOB });
}

#[test]
fn a_lamp_alone() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    check("lamp", &desc, &JOB);
}

/// A box on a floor under the sky; probes on the floor.
#[test]
fn the_open_sky() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    desc.shapes.retain(|s| s.material == "y-" || s.material == "x+");
    furniture(&mut desc);
    desc.lights.push(LightDesc::Environment(etendue_core::scene::EnvironmentDesc::uniform([1.0, 2.0, 3.0])));
    desc.lights.push(LightDesc::Directional { direction: [1.0, -2.0, 0.5], irradiance: [3.0, 2.0, 1.0] });
    let session = session(&desc, None);
    let probes: Vec<Probe> =
        on_walls().into_iter().filter(|p| p.normal[1] > 0.0 || p.normal[0] < 0.0).collect();
    assert_eq!(probes.len(), 8);
    let found = results(&gather_probes(&session, &JOB, &probes));
    assert_agree("sky, probes", &found, &truth(&session, &probes), Z, 0.01);
    check_image("sky", &session, &JOB, 0.01);
}

#[test]
fn a_mirror_and_a_lamp() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    furniture(&mut desc);
    wall(&mut desc, "z+", MaterialKind::Mirror { albedo: Reflectance::flat([0.9, 0.8, 0.7]) });
    check("mirror", &desc, &JOB);
    // Read at once, the mirror shows elements as well: 4 % of a tile's light for what they smear over the edges of shadows.
    let fine = ElementSettings { largest: 0.05, ..JOB.elements };
    let job = GatherJob { gather: false, photons: 1 << 16, elements: fine, ..JOB };
    check_image("mirror", &session(&desc, None), &job, 0.04);
}

#[test]
fn phong_lobes() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    furniture(&mut desc);
    let albedo = Reflectance::flat([0.3, 0.2, 0.4]);
    wall(&mut desc, "y-", MaterialKind::DiffusePhong { albedo, specular: [0.5, 0.4, 0.3], exponent: 20.0 });
    wall(&mut desc, "x+", MaterialKind::Phong { specular: [0.7; 3], exponent: 5.0 });
    check("Phong", &desc, &JOB);
    let fine = ElementSettings { largest: 0.05, ..JOB.elements };
    let job = GatherJob { gather: false, photons: 1 << 16, elements: fine, ..JOB };
    check_image("Phong", &session(&desc, None), &job, 0.04);
}

#[test]
fn rough_metals_and_plastic() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    furniture(&mut desc);
    let plastic = |color, roughness| MaterialKind::Plastic {
        albedo: Reflectance::flat(color),
        ior: 1.5,
        roughness,
        nonlinear: true,
    };
    wall(&mut desc, "y-", plastic([0.7, 0.2, 0.4], Some(Roughness::Beckmann(0.3))));
    let (eta, k) = ([0.2, 0.4, 1.3], [3.9, 2.4, 1.8]);
    wall(&mut desc, "x+", MaterialKind::RoughConductor { eta, k, roughness: Roughness::Ggx(0.4) });
    check("rough", &desc, &JOB);
    // A smooth coat reflects a point light to where paths do not find it.
    desc.lights.clear();
    wall(&mut desc, "z+", plastic([0.2, 0.6, 0.7], None));
    check("smooth", &desc, &JOB);
    let fine = ElementSettings { largest: 0.05, ..JOB.elements };
    let job = GatherJob { gather: false, photons: 1 << 16, elements: fine, ..JOB };
    check_image("smooth", &session(&desc, None), &job, 0.04);
}

#[test]
fn a_point_light_in_a_mirror_is_seen_and_gathered() {
    // A black box with a mirror for a wall: direct light, and that of the light's image.
    let mut desc = room([0.0; 3], [0.0; 3]);
    let rho = [0.9_f32, 0.5, 0.2];
    wall(&mut desc, "x+", MaterialKind::Mirror { albedo: Reflectance::flat(rho) });
    point(&mut desc);
    let session = session(&desc, None);
    let probes: Vec<Probe> = on_walls().into_iter().filter(|p| p.normal[1] > 0.0).collect();
    let truth: Vec<[(f64, f64); 3]> = probes
        .iter()
        .map(|p| {
            let arriving = |x: f64| {
                let d = [x - f64::from(p.position[0]), 1.5, 0.5 - f64::from(p.position[2])];
                1.5 / d.iter().map(|x| x * x).sum::<f64>().powf(1.5)
            };
            [0, 1, 2].map(|c| {
                let i = [1.0, 0.8, 0.6][c];
                (i * (arriving(-0.4) + f64::from(rho[c]) * arriving(2.4)), 0.0)
            })
        })
        .collect();
    for gather in [true, false] {
        let job = GatherJob { gather, photons: 1 << 16, ..JOB };
        let film = gather_probes(&session, &job, &probes);
        // Elements of 0.1 at 3.7 m from the image: less than 3 % from their middle.
        assert_agree(&format!("gather {gather}"), &results(&film), &truth, 7.3, 0.03);
    }
}

#[test]
fn caustics_count_once() {
    // What is read and what is gathered must be the same light, where paths miss some.
    let mut desc = room([0.5, 0.4, 0.3], [0.0; 3]);
    wall(&mut desc, "x+", MaterialKind::Mirror { albedo: Reflectance::flat([0.9; 3]) });
    point(&mut desc);
    let session = session(&desc, None);
    let probes: Vec<Probe> = on_walls().into_iter().filter(|p| p.normal[0] >= 0.0).collect();
    let job =
        GatherJob { photons: 1 << 17, elements: ElementSettings { largest: 0.05, ..JOB.elements }, ..JOB };
    let gathered = results(&gather_probes(&session, &job, &probes));
    let read = results(&gather_probes(&session, &GatherJob { gather: false, ..job.clone() }, &probes));
    assert_agree("caustics", &gathered, &read, Z, 0.01);
    let paths = truth(&session, &probes);
    let less = paths.iter().zip(&gathered).filter(|(p, g)| p[1].0 < 0.98 * g[1].0).count();
    assert!(less >= 16, "{less} of {}: the mirrored light is missing", probes.len());
}

/// A floor of 2 x 2 with a chessboard, two triangles.
fn chessboard(desc: &mut SceneDesc) {
    let texels =
        (0..64).map(|i| if (i / 8 + i % 8) % 2 == 0 { [250, 200, 150] } else { [20, 40, 60] }).collect();
    desc.textures.push(TextureDesc { name: "chess".into(), width: 8, height: 8, texels, wrap: Wrap::Repeat });
    let albedo = Reflectance { color: [1.0; 3], texture: "chess".into(), checker: None };
    desc.materials.push(made_of("board", MaterialKind::Diffuse { albedo }));
    desc.shapes.retain(|s| s.material != "y-");
    desc.meshes.push(MeshDesc {
        positions: vec![[-1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]],
        texcoords: vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: "board".into(),
        textures: true,
        ..MeshDesc::default()
    });
}

#[test]
fn textures() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    chessboard(&mut desc);
    lamp(&mut desc);
    spot(&mut desc);
    check("chessboard", &desc, &JOB);
    let fine = ElementSettings { largest: 0.05, ..JOB.elements };
    let job = GatherJob { gather: false, photons: 1 << 16, elements: fine, ..JOB };
    check_image("chessboard", &session(&desc, None), &job, 0.04);
}

#[test]
fn interpolated_normals_and_black_backs() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    // A roof whose ridge is shaded round, and a sheet that is black from behind.
    desc.materials.push(diffuse("roof", [0.7, 0.6, 0.5], [0.0; 3]));
    desc.materials.push(diffuse("sheet", [0.8, 0.2, 0.2], [0.0; 3]));
    desc.materials.last_mut().unwrap().two_sided = false;
    let (up, slope) = ([0.0, 1.0, 0.0], |x: f32| [x * 0.6, 0.8, 0.0]);
    desc.meshes.push(MeshDesc {
        positions: vec![
            [-0.6, -0.8, -0.4],
            [-0.6, -0.8, 0.6],
            [0.0, -0.4, 0.6],
            [0.0, -0.4, -0.4],
            [0.6, -0.8, 0.6],
            [0.6, -0.8, -0.4],
        ],
        normals: vec![slope(-1.0), slope(-1.0), up, up, slope(1.0), slope(1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]],
        material: "roof".into(),
        shading_normals: true,
        ..MeshDesc::default()
    });
    let sheet = ShapeKind::Rectangle { center: [0.6, 0.1, 0.2], u: [0.0, 0.2, 0.0], v: [0.0, 0.0, 0.2] };
    desc.shapes.push(shape(sheet, "sheet"));
    check("normals", &desc, &JOB);
}

#[test]
fn probes_read_a_fine_map() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    furniture(&mut desc);
    let session = session(&desc, None);
    let mut probes = on_walls();
    // In the gap beneath the box light changes within an element.
    probes.remove(13);
    let truth = truth(&session, &probes);
    for basis in [Basis::Constant, Basis::Linear] {
        let elements = ElementSettings { largest: 0.06, basis, ..JOB.elements };
        let job = GatherJob { gather: false, photons: 1 << 17, elements, ..JOB };
        // The side of an element is 3 % of a wall; within it light changes by as much where it falls off fast.
        assert_agree(
            &format!("{basis:?}"),
            &results(&gather_probes(&session, &job, &probes)),
            &truth,
            Z,
            0.03,
        );
    }
}

#[test]
fn sides_of_a_thin_wall_differ() {
    // A sheet between two rooms, one of them dark: read from either side it is another place.
    let mut desc = room([0.5; 3], [0.0; 3]);
    desc.materials.push(diffuse("sheet", [0.5; 3], [0.0; 3]));
    desc.shapes.push(shape(
        ShapeKind::Rectangle { center: [0.0; 3], u: [0.0, 1.0, 0.0], v: [0.0, 0.0, 1.0] },
        "sheet",
    ));
    point(&mut desc);
    let session = session(&desc, None);
    let at = |normal: f32| Probe { position: [0.0, 0.3, 0.4], normal: [normal, 0.0, 0.0] };
    for gather in [true, false] {
        let film = gather_probes(&session, &GatherJob { gather, ..JOB }, &[at(1.0), at(-1.0)]);
        let [dark, lit] = [film.mean(0)[0], film.mean(1)[0]];
        // Elements of the walls that reach beneath the sheet are lit as a whole: a gather ray may meet them on the dark side.
        assert!(dark <= if gather { 2e-3 * lit } else { 0.0 }, "gather {gather}: {dark}");
        assert!(lit > 0.5, "gather {gather}: {lit}");
    }
}

#[test]
fn depth_counts_edges_as_paths_do() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    let session = session(&desc, None);
    let probes = on_walls();
    for max_depth in [1, 2, 3, 4] {
        let paths = PathJob { seed: 11, block_length: 256, blocks: 0..64, max_depth };
        let truth = results(&path_probes(&session, &paths, &probes));
        for gather in [true, false] {
            let path = PathJob { max_depth, ..JOB.path };
            let elements = ElementSettings { largest: 0.06, basis: Basis::Linear, ..JOB.elements };
            let job = GatherJob { gather, path, elements, photons: 1 << 16, ..JOB };
            let what = format!("depth {max_depth}, gather {gather}");
            let part = if gather { 0.01 } else { 0.03 };
            assert_agree(&what, &results(&gather_probes(&session, &job, &probes)), &truth, Z, part);
            check_image(&what, &session, &job, part);
        }
    }
}
