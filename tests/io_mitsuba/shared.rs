//! Loads the shared Mitsuba scenes, where `ETENDUE_SCENES` names their folder.

use std::path::Path;

use crate::common::shared_scenes;
use etendue::io::{self, LoadedScene};
use etendue_core::scene::{LightDesc, MaterialKind, Roughness, SceneDesc, ShapeKind};

fn load(root: &Path, name: &str) -> LoadedScene {
    let scene = io::load_scene(&root.join(name)).unwrap_or_else(|e| panic!("{e}"));
    println!("{name}: {} meshes, {} shapes", scene.desc.meshes.len(), scene.desc.shapes.len());
    for note in &scene.notes {
        println!("    {}", note.to_string().replace(root.to_str().unwrap(), ""));
    }
    scene
}

/// Meshes, shapes, lights, materials and media.
fn counts(d: &SceneDesc) -> [usize; 5] {
    [d.meshes.len(), d.shapes.len(), d.lights.len(), d.materials.len(), d.media.len()]
}

fn kind<'a>(d: &'a SceneDesc, name: &str) -> &'a MaterialKind {
    &d.materials.iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no {name}")).kind
}

#[test]
fn shared_media_scenes_load() {
    let Some(root) = shared_scenes() else { return };
    for (name, expected) in [
        ("test_hetero_sigmat_volpath", [3, 0, 1, 3, 1]),
        ("test_hetero_spectral_sigmat_volpathmis", [3, 0, 1, 3, 1]),
        ("test_homo_area_light_volpath", [4, 0, 0, 4, 1]),
        ("test_homo_null_envmap_volpath", [3, 0, 1, 3, 1]),
        ("test_homo_obj_inside_medium_volpath", [5, 0, 1, 5, 1]),
        ("test_surf_area_light_volpath", [4, 0, 1, 4, 0]),
    ] {
        let scene = load(&root, &format!("mitsuba_media/{name}.xml"));
        let d = &scene.desc;
        assert_eq!(counts(d), expected, "{name}");
        assert_eq!(scene.max_depth, Some(6));
        let camera = d.camera.as_ref().unwrap();
        assert_eq!((camera.position, camera.resolution), ([0.0, 0.5, 4.0], [48, 48]));
        let background = d.meshes.iter().find(|m| m.name == "background.obj").unwrap();
        let MaterialKind::Diffuse { albedo } = kind(d, &background.material) else { panic!("{name}") };
        let checker = albedo.checker.unwrap();
        assert_eq!((checker.colors, checker.repeat), ([[0.2; 3], [0.4; 3]], [16.0; 2]));
        if let Some(LightDesc::Environment(sky)) = d.lights.first() {
            let image = sky.image.as_ref().unwrap();
            assert_eq!(image.texels.len(), (image.width * image.height) as usize);
            assert_eq!(image.to_world, [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        }
    }
}

#[test]
fn shared_media_on_grids_are_as_the_files_say() {
    let Some(root) = shared_scenes() else { return };
    for (name, channels, scale, albedo) in [
        ("test_hetero_sigmat_volpath", 1, 5.0, [0.99, 0.5, 0.5]),
        ("test_hetero_spectral_sigmat_volpathmis", 3, 2.0, [0.99; 3]),
    ] {
        let scene = load(&root, &format!("mitsuba_media/{name}.xml"));
        let medium = &scene.desc.media[0];
        let grid = medium.density.as_ref().unwrap();
        assert_eq!((grid.size, grid.channels), ([16; 3], channels));
        assert_eq!(grid.values.len(), 4096 * channels as usize);
        // Scaled by 1.5, then moved by -0.5: not the other way round.
        let row = |i: usize| {
            let mut row = [0.0, 0.0, 0.0, -0.5];
            row[i] = 1.5;
            row
        };
        assert_eq!(grid.to_world, [row(0), row(1), row(2)]);
        for (k, albedo) in albedo.into_iter().enumerate() {
            assert!((medium.sigma_s[k] - scale * albedo).abs() < 1e-6);
            assert!((medium.sigma_a[k] + medium.sigma_s[k] - scale).abs() < 1e-6);
        }
        let inside = scene.desc.meshes.iter().find(|m| m.interior == medium.name).unwrap();
        assert_eq!(kind(&scene.desc, &inside.material), &MaterialKind::Null);
    }
    let scene = load(&root, "smoke_hetvol/hetvol.xml");
    let d = &scene.desc;
    assert_eq!(counts(d), [2, 1, 0, 3, 1]);
    let grid = d.media[0].density.as_ref().unwrap();
    assert_eq!((grid.size, d.media[0].sigma_s), ([128, 128, 50], [90.0; 3]));
    assert_eq!(grid.to_world[2], [0.0, 0.0, 0.390_625, -0.195_312_5]);
    assert_eq!(kind(d, &d.meshes[0].material), &MaterialKind::Null);
    assert_eq!(d.camera.as_ref().unwrap().resolution, [768, 576]);
}

#[test]
fn shared_cornell_box_has_its_red_wall_on_the_left() {
    let Some(root) = shared_scenes() else { return };
    let scene = load(&root, "bitterli/cornell-box/scene.xml");
    let d = &scene.desc;
    assert_eq!(counts(d), [2, 6, 0, 8, 0]);
    assert_eq!(scene.max_depth, Some(65));
    assert!(d.materials.iter().all(|m| m.two_sided));
    let camera = d.camera.as_ref().unwrap();
    assert_eq!((camera.position, camera.fov_x_deg), ([0.0, 1.0, 6.8], 19.5));
    let [right, _, _] = right_up_forward(camera);
    let left = d.shapes.iter().find(|s| s.material == "LeftWallBSDF").unwrap();
    let ShapeKind::Rectangle { center, .. } = &left.kind else { panic!() };
    let MaterialKind::Diffuse { albedo } = kind(d, "LeftWallBSDF") else { panic!() };
    assert_eq!(albedo.color, [0.63, 0.065, 0.05]);
    // Where the camera's right is negative, that is on the left of the picture; and there the picture is red.
    let side: f32 = (0..3).map(|k| right[k] * (center[k] - camera.position[k])).sum();
    assert!(side < -0.9, "{side}");
    let image = io::read_exr(&root.join("bitterli/cornell-box/TungstenRender.exr")).unwrap();
    let mean = |columns: std::ops::Range<u32>| {
        let mut sum = [0.0f64; 3];
        for y in image.height / 4..image.height * 3 / 4 {
            for x in columns.clone() {
                let pixel = image.radiance[(y * image.width + x) as usize];
                sum.iter_mut().zip(pixel).for_each(|(s, p)| *s += f64::from(p));
            }
        }
        sum
    };
    let (l, r) = (mean(0..100), mean(image.width - 100..image.width));
    assert!(l[0] > 2.0 * l[1] && r[1] > 1.5 * r[0], "{l:?} {r:?}");
    // The light faces down.
    let light = d.shapes.iter().find(|s| s.material == "LightBSDF (light)").unwrap();
    let ShapeKind::Rectangle { u, v, .. } = &light.kind else { panic!() };
    assert!(cross(*u, *v)[1] < 0.0);
}

#[test]
fn shared_veach_bidir_loads() {
    let Some(root) = shared_scenes() else { return };
    let d = load(&root, "bitterli/veach-bidir/scene.xml").desc;
    assert_eq!(counts(&d), [12, 2, 0, 6, 0]);
    let MaterialKind::RoughConductor { eta, roughness, .. } = kind(&d, "LampBSDF") else { panic!() };
    assert_eq!((*eta, *roughness), ([2.8656, 2.11918, 1.94008], Roughness::Beckmann(0.25)));
    assert_eq!(kind(&d, "GlassBSDF"), &MaterialKind::Dielectric { ior: [1.5; 3], schlick: false });
    let wood = d.meshes.iter().find(|m| m.name == "Mesh000.obj").unwrap();
    assert!(!wood.shading_normals, "face_normals");
    let glass = d.meshes.iter().find(|m| m.name == "Mesh002.obj").unwrap();
    assert!(glass.shading_normals && glass.transform.is_none());
    // The floor lamp shines up at the ceiling, the other one down.
    let fronts: Vec<f32> = d
        .shapes
        .iter()
        .map(|s| match &s.kind {
            ShapeKind::Rectangle { u, v, .. } => cross(*u, *v)[1],
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(fronts[0] > 0.0 && fronts[1] < 0.0, "{fronts:?}");
}

#[test]
fn shared_cornell_boxes_in_rgb_load_and_in_spectra_do_not() {
    let Some(root) = shared_scenes() else { return };
    let scene = load(&root, "mitsuba_cbox/cbox-rgb.xml");
    let d = &scene.desc;
    assert_eq!(counts(d), [8, 0, 0, 5, 0]);
    assert_eq!(scene.max_depth, Some(6));
    let camera = d.camera.as_ref().unwrap();
    assert_eq!((camera.position, camera.fov_x_deg), ([278.0, 273.0, -800.0], 39.3077));
    assert_eq!(right_up_forward(camera), [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let light = d.materials.iter().find(|m| m.emission != [0.0; 3]).unwrap();
    assert_eq!((light.name.as_str(), light.emission), ("light (light)", [18.387, 10.9873, 2.75357]));
    assert!(d.materials.iter().all(|m| !m.two_sided));
    for name in ["cbox-spectral", "cbox"] {
        let e = io::load_scene(&root.join(format!("mitsuba_cbox/{name}.xml"))).unwrap_err();
        println!("{e}");
        assert!(e.line.is_some() && e.to_string().contains("three colours"), "{e}");
    }
}

#[test]
fn shared_volumetric_caustic_loads() {
    let Some(root) = shared_scenes() else { return };
    let d = load(&root, "bitterli/volumetric-caustic/scene_mitsuba05.xml").desc;
    assert_eq!(counts(&d), [0, 8, 0, 8, 1]);
    assert_eq!((d.media[0].sigma_a, d.media[0].sigma_s), ([0.0; 3], [1.0; 3]));
    assert!(d.shapes.iter().any(|s| matches!(s.kind, ShapeKind::Sphere { radius: 0.3, .. })));
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The axes of a camera whose `up` is square to its view.
fn right_up_forward(camera: &etendue_core::scene::CameraDesc) -> [[f32; 3]; 3] {
    let f = [0, 1, 2].map(|k| camera.look_at[k] - camera.position[k]);
    let l = f.iter().fold(0.0f32, |m, x| m.max(x.abs()));
    let f = f.map(|x| x / l);
    [cross(f, camera.up), camera.up, f]
}
