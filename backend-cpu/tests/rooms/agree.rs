//! Images and probes from maps against paths.

use super::{gather_image, gather_probes, image_blocks, on_walls, path_probes, results, session, tiles};
use etendue_core::backend::{GatherJob, NoControl, PathJob, Probe, Session, image_film_settings};
use etendue_core::film::Film;
use etendue_core::scene::SceneDesc;
use etendue_cpu::CpuSession;

/// Asserts that two results agree: within z combined standard errors and a part of the second.
#[track_caller]
pub fn assert_agree(what: &str, a: &[[(f64, f64); 3]], b: &[[(f64, f64); 3]], z: f64, part: f64) {
    assert_eq!(a.len(), b.len());
    let (mut signed, mut all, mut worst) = (0.0, 0.0, 0.0_f64);
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        for c in 0..3 {
            let ((x, dx), (y, dy)) = (a[c], b[c]);
            let allowed = z * dx.hypot(dy) + part * y + 1e-7;
            assert!(
                (x - y).abs() <= allowed,
                "{what}: element {i}, channel {c}: {x} +- {dx} against {y} +- {dy}, {allowed} allowed"
            );
            worst = worst.max((x - y).abs() / allowed);
            signed += x - y;
            all += y;
        }
    }
    // What each may be off by chance or element is not what they may be off together.
    assert!(f64::abs(signed) <= 0.02 * all + 1e-7, "{what}: {signed} of {all}");
    println!(
        "{what}: worst {worst:.2} of what is allowed, difference of the sums {:.3} %",
        100.0 * signed / f64::max(all, 1e-9)
    );
}

/// Student's t of 16 blocks against 64: 5.5 is passed by chance once in 10^4 by each, and there are some hundred in a test of fixed seeds.
pub const Z: f64 = 6.5;

pub fn truth(session: &CpuSession, probes: &[Probe]) -> Vec<[(f64, f64); 3]> {
    let job = PathJob { seed: 11, block_length: 256, blocks: 0..64, max_depth: u32::MAX };
    results(&path_probes(session, &job, probes))
}

/// Probes and image by gathering against the path tracer: elements of a tenth of the room are at second hand, 1 % is allowed for them.
#[track_caller]
pub fn check(what: &str, desc: &SceneDesc, job: &GatherJob) {
    let session = session(desc, None);
    let probes = on_walls();
    let truth = truth(&session, &probes);
    let found = results(&gather_probes(&session, job, &probes));
    assert_agree(&format!("{what}, probes"), &found, &truth, Z, 0.01);
    check_image(what, &session, job, 0.01);
}

#[track_caller]
pub fn check_image(what: &str, session: &CpuSession, job: &GatherJob, part: f64) {
    let paths = PathJob { seed: 12, block_length: 64, blocks: 0..16, max_depth: job.path.max_depth };
    let truth = tiles(&image_blocks(&paths, |path| {
        let mut film = Film::new(image_film_settings(session.scene(), path).unwrap());
        session.path_image(path, &NoControl, &mut film).unwrap();
        film
    }));
    let found = tiles(&image_blocks(&job.path, |path| {
        gather_image(session, &GatherJob { path: path.clone(), ..job.clone() })
    }));
    assert_agree(&format!("{what}, image, gather {}", job.gather), &found, &truth, Z, part);
}
