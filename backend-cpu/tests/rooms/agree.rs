//! Images and probes from maps against paths.

use super::{gather_image, gather_probes, image_blocks, on_walls, path_probes, results, session, tiles};
use etendue_core::backend::{
    BidirectionalJob, GatherJob, NoControl, PathJob, Probe, Session, image_film_settings,
};
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

/// Blocks of samples of probes that the path tracer takes for the truth.
const PATHS: PathJob = PathJob { seed: 11, block_length: 256, blocks: 0..64, max_depth: u32::MAX };

pub fn truth(session: &CpuSession, probes: &[Probe]) -> Vec<[(f64, f64); 3]> {
    results(&path_probes(session, &PATHS, probes))
}

/// What paths say of a scene: of the probes on its walls, and of the tiles of its image.
pub struct Truth {
    session: CpuSession,
    probes: Vec<[(f64, f64); 3]>,
    tiles: Vec<[(f64, f64); 3]>,
}

impl Truth {
    /// By the path tracer.
    pub fn by_paths(desc: &SceneDesc) -> Self {
        let session = session(desc, None);
        let probes = truth(&session, &on_walls());
        let tiles = image_by_paths(&session, u32::MAX);
        Self { session, probes, tiles }
    }

    /// Probes and image by maps: elements of a tenth of the room are at second hand, so that a part of what is found is allowed for them.
    #[track_caller]
    pub fn check(&self, what: &str, job: &GatherJob, part: f64) {
        let found = results(&gather_probes(&self.session, job, &on_walls()));
        assert_agree(&format!("{what}, probes"), &found, &self.probes, Z, part);
        self.check_image(what, job, part);
    }

    /// The image alone.
    #[track_caller]
    pub fn check_image(&self, what: &str, job: &GatherJob, part: f64) {
        let found = image_by_maps(&self.session, job);
        assert_agree(&format!("{what}, image, gather {}", job.gather), &found, &self.tiles, Z, part);
    }
}

/// An image by maps against paths from both ends.
#[track_caller]
pub fn check_image_by_both_ends(what: &str, desc: &SceneDesc, job: &GatherJob, part: f64) {
    let session = session(desc, None);
    let paths = PathJob { seed: 12, block_length: 64, blocks: 0..16, max_depth: u32::MAX };
    let truth = tiles(&image_blocks(&paths, |path| {
        let mut film = Film::new(image_film_settings(session.scene(), path).unwrap());
        let job = BidirectionalJob::new(path.clone());
        session.bidirectional_image(&job, &NoControl, &mut film).unwrap();
        film
    }));
    assert_agree(&format!("{what}, image"), &image_by_maps(&session, job), &truth, Z, part);
}

fn image_by_paths(session: &CpuSession, max_depth: u32) -> Vec<[(f64, f64); 3]> {
    let paths = PathJob { seed: 12, block_length: 64, blocks: 0..16, max_depth };
    tiles(&image_blocks(&paths, |path| {
        let mut film = Film::new(image_film_settings(session.scene(), path).unwrap());
        session.path_image(path, &NoControl, &mut film).unwrap();
        film
    }))
}

fn image_by_maps(session: &CpuSession, job: &GatherJob) -> Vec<[(f64, f64); 3]> {
    tiles(&image_blocks(&job.path, |path| {
        gather_image(session, &GatherJob { path: path.clone(), ..job.clone() })
    }))
}

/// Probes and image by gathering against the path tracer; 1 % is allowed for the elements.
#[track_caller]
pub fn check(what: &str, desc: &SceneDesc, job: &GatherJob) {
    Truth::by_paths(desc).check(what, job, 0.01);
}

#[track_caller]
pub fn check_image(what: &str, session: &CpuSession, job: &GatherJob, part: f64) {
    let (found, truth) = (image_by_maps(session, job), image_by_paths(session, job.path.max_depth));
    assert_agree(&format!("{what}, image, gather {}", job.gather), &found, &truth, Z, part);
}
