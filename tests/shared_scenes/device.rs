//! The same on a device: Sponza's probes there and on the CPU.

use super::{Effort, UNIT_SKY, check_probes, open_mesh_on, settings};
use crate::common::shared_scenes;
use etendue::core::backend::{Arithmetic, Probe};
use etendue::driver::{self, Silent};
use etendue::engine::{BackendKind, open_backend};
use etendue::io::read_points;

/// Few samples, as a device may be played by the processor.
const SAMPLES: u64 = 1 << 12;

#[test]
fn shared_sponza_sky_probes_on_a_device() {
    let Some(root) = shared_scenes() else { return };
    let device = match open_backend(BackendKind::Wgpu, None) {
        Ok(device) => device,
        Err(e) if std::env::var_os("ETENDUE_REQUIRE_WGPU").is_none() => return println!("SKIPPED: {e}"),
        Err(e) => panic!("{e}"),
    };
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
