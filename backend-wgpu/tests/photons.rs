//! Illumination maps by photons on a device against the CPU: where the device's arithmetic is exact, films are equal to the last bit.

mod adapter;
mod photon;

use etendue_core::backend::{Backend, NoControl, PhotonJob, PhotonStart};
use etendue_core::transport::photon::Sequence;
use etendue_cpu::CpuBackend;
use etendue_wgpu::Options;
use photon::{film, job, scenes};

/// The maps of every scene by both backends; what differs.
fn differing(sequence: Sequence, change: impl Fn(PhotonJob) -> PhotonJob) -> Option<Vec<String>> {
    let device = adapter::exact_with(Options::default())?;
    let cpu = CpuBackend::new(None).unwrap();
    let (mut lit, mut wrong) = (0, Vec::new());
    for (name, scene) in scenes() {
        let job = change(job(&scene, sequence, 3..5));
        if scene.needs.volume() {
            continue;
        }
        let (ours, theirs) = (device.open(scene.clone()).unwrap(), cpu.open(scene.clone()).unwrap());
        let (mut a, mut b) = (film(&scene, &job), film(&scene, &job));
        let t = std::time::Instant::now();
        let found = ours.illumination(&job, &NoControl, &mut a).unwrap();
        println!("{name} {:?}", t.elapsed());
        let expected = theirs.illumination(&job, &NoControl, &mut b).unwrap();
        lit += (0..a.len()).filter(|i| a.mean(*i) != [0.0; 3]).count();
        if a != b || found != expected {
            let differs: Vec<usize> = (0..a.len()).filter(|i| a.mean(*i) != b.mean(*i)).collect();
            let at = differs.first().map(|i| (i, a.mean(*i), b.mean(*i)));
            let needs = &scene.needs;
            wrong.push(format!("{name} ({needs}): {found:?} {expected:?}; {} differ, {at:?}", differs.len()));
        }
    }
    assert!(lit > 1000, "{lit}");
    Some(wrong)
}

#[test]
fn photons_that_walk_one_by_one_have_the_bits_of_the_cpu() {
    let Some(wrong) = differing(Sequence::Sobol, |job| job) else { return };
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn random_photons_have_the_bits_of_the_cpu() {
    let start = PhotonStart::Lights { registers_direct: false, survives_first: true };
    let change = |job| PhotonJob { max_hits: 5, start, ..job };
    let Some(wrong) = differing(Sequence::Random, change) else { return };
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn photons_in_order_have_the_bits_of_the_cpu() {
    let start = PhotonStart::Lights { registers_direct: false, survives_first: true };
    let Some(wrong) = differing(Sequence::Sorted, |job| PhotonJob { start, ..job }) else { return };
    assert!(wrong.is_empty(), "{wrong:#?}");
}
