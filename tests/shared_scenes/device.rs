//! The same on a device: Sponza's probes there and on the CPU, and the films of all scenes, small, whose bits are the CPU's. What the CPU's films are held to, the device's are.

use super::media::{Method, caustic_file, render_on};
use super::{Effort, UNIT_SKY, check_probes, open_mesh_on, settings};
use crate::common::shared_scenes;
use etendue::core::backend::{Arithmetic, Backend, Probe};
use etendue::driver::{self, Silent};
use etendue::engine::{BackendKind, open_backend};
use etendue::io::read_points;

/// Few samples, as a device may be played by the processor.
const SAMPLES: u64 = 1 << 12;

/// The best device. `None` where there is none: the test has said so.
fn device() -> Option<Box<dyn Backend>> {
    match open_backend(BackendKind::Wgpu, None) {
        Ok(device) => Some(device),
        Err(e) if std::env::var_os("ETENDUE_REQUIRE_WGPU").is_none() => {
            println!("SKIPPED: {e}");
            None
        }
        Err(e) => panic!("{e}"),
    }
}

/// Films of a few pixels and samples of these scenes by both backends, by their methods: equal bits.
fn same_films(scenes: &[(&str, &[Method])]) {
    let Some(root) = shared_scenes() else { return };
    let Some(device) = device() else { return };
    if device.arithmetic() == Arithmetic::Loose {
        return println!("SKIPPED: {} is {}", device.info().adapter, device.arithmetic().describe());
    }
    let cpu = open_backend(BackendKind::Cpu, None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (mut lit, mut wrong) = (0, Vec::new());
    for (name, methods) in scenes {
        let file = match *name {
            "caustic" => caustic_file(&root, folder.path(), 20),
            name => root.join(name),
        };
        for method in *methods {
            let films =
                [&device, &cpu].map(|b| render_on(&**b, &file, *method, Some([20, 16]), 16, None).film);
            lit += usize::from((0..films[1].len()).any(|i| films[1].mean(i) != [0.0; 3]));
            wrong.extend((films[0] != films[1]).then(|| format!("{name} {method:?}")));
        }
    }
    assert_eq!(lit, scenes.iter().map(|s| s.1.len()).sum::<usize>());
    assert!(wrong.is_empty(), "{wrong:?}");
}

const BOTH: &[Method] = &[Method::Path, Method::Bdpt];

#[test]
fn shared_closed_boxes_on_a_device() {
    same_films(&[
        ("closed_cornell/area.toml", BOTH),
        ("closed_cornell/point.toml", &[Method::Path]),
        ("closed_cornell/fog.toml", &[Method::Path]),
    ]);
}

#[test]
fn shared_media_and_glass_on_a_device() {
    same_films(&[
        ("mitsuba_media/test_hetero_spectral_sigmat_volpathmis.xml", &[Method::Path]),
        ("caustic", &[Method::Bdpt]),
    ]);
}

/// Every scene that has a reference, from one end and from both.
#[test]
#[ignore = "minutes: ETENDUE_SCENES=../shared/scenes cargo nextest run -p etendue -E 'test(shared_full_films_on_a_device)' --run-ignored only"]
fn shared_full_films_on_a_device() {
    same_films(&[
        ("closed_cornell/area.toml", BOTH),
        ("closed_cornell/point.toml", BOTH),
        ("closed_cornell/fog.toml", BOTH),
        ("mitsuba_media/test_hetero_sigmat_volpath.xml", BOTH),
        ("mitsuba_media/test_hetero_spectral_sigmat_volpathmis.xml", BOTH),
        ("mitsuba_media/test_homo_area_light_volpath.xml", BOTH),
        ("mitsuba_media/test_homo_null_envmap_volpath.xml", BOTH),
        ("mitsuba_media/test_homo_obj_inside_medium_volpath.xml", BOTH),
        ("mitsuba_media/test_surf_area_light_volpath.xml", BOTH),
        ("bitterli/cornell-box/scene.xml", BOTH),
        ("bitterli/veach-bidir/scene.xml", BOTH),
        ("caustic", BOTH),
    ]);
}

#[test]
fn shared_sponza_sky_probes_on_a_device() {
    let Some(root) = shared_scenes() else { return };
    let Some(device) = device() else { return };
    let cpu = open_backend(BackendKind::Cpu, None).unwrap();
    let mesh = root.join("sponza_dabrovic/sponza.obj");
    let reference = root.join("probes/sponza_sky_probes.json");
    let sessions = [&device, &cpu].map(|b| open_mesh_on(&**b, &mesh, UNIT_SKY));
    check_probes(&*sessions[0], &reference, Effort::Samples(SAMPLES));
    if device.arithmetic() == Arithmetic::Ieee {
        let points = read_points(&reference).unwrap();
        let probes: Vec<Probe> =
            points.iter().map(|p| Probe { position: p.position, normal: p.normal }).collect();
        let films = sessions
            .each_ref()
            .map(|s| driver::probes(&**s, &probes, &settings(SAMPLES), &Silent).unwrap().film);
        assert!(films[0] == films[1], "films differ in bits");
    }
}
