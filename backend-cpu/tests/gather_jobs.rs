//! Jobs of images and probes from maps of photons: their bits, their error bars, and what is refused.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod rooms;

use etendue_core::backend::{
    BackendError, Control, GatherJob, NoControl, PathJob, PhotonStart, Probe, Session,
};
use etendue_core::film::Film;
use etendue_core::illumination::{Basis, ElementSettings, Sides};
use etendue_core::scene::{MaterialKind, MediumDesc, Reflectance, SceneDesc, ShapeDesc};
use etendue_core::transport::photon::Sequence;
use rooms::{
    JOB, furniture, gather_image, gather_probes, image_film, lamp, made_of, on_walls, point, probe_film,
    room, session, shape, spot, wall,
};
use std::ops::ControlFlow;

/// Everything at once.
fn furnished() -> SceneDesc {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    spot(&mut desc);
    furniture(&mut desc);
    wall(&mut desc, "z+", MaterialKind::Mirror { albedo: Reflectance::flat([0.9, 0.8, 0.7]) });
    let albedo = Reflectance::flat([0.3, 0.2, 0.4]);
    wall(&mut desc, "y-", MaterialKind::DiffusePhong { albedo, specular: [0.5, 0.4, 0.3], exponent: 20.0 });
    desc
}

#[test]
fn bits_depend_on_neither_threads_nor_splits() {
    let desc = furnished();
    let (one, three) = (session(&desc, Some(1)), session(&desc, Some(3)));
    let probes = on_walls();
    let of = |blocks: std::ops::Range<u32>, gather, sequence| GatherJob {
        path: PathJob { blocks, block_length: 4, ..JOB.path },
        photons: 1 << 11,
        gather,
        sequence,
        ..JOB
    };
    for (gather, sequence) in [(true, Sequence::Sorted), (false, Sequence::Sorted), (true, Sequence::Sobol)] {
        let job = |blocks| of(blocks, gather, sequence);
        let film = gather_probes(&one, &job(0..8), &probes);
        assert!(gather_probes(&three, &job(0..8), &probes) == film, "{gather} {sequence:?}");
        let mut late = gather_probes(&three, &job(4..8), &probes);
        late.merge(&gather_probes(&one, &job(0..4), &probes)).unwrap();
        assert!(late == film, "{gather} {sequence:?}");
        let image = gather_image(&one, &job(0..8));
        assert!(gather_image(&three, &job(0..8)) == image, "{gather} {sequence:?}");
        let mut late = gather_image(&three, &job(4..8));
        late.merge(&gather_image(&one, &job(0..4))).unwrap();
        assert!(late == image, "{gather} {sequence:?}");
    }
    let a = gather_probes(&one, &of(0..2, true, Sequence::Sorted), &probes);
    let other = of(0..2, true, Sequence::Sorted);
    let other = GatherJob { path: PathJob { seed: 4, ..other.path.clone() }, ..other };
    assert!(gather_probes(&one, &other, &probes) != a);
}

#[test]
fn code_that_a_scene_does_not_need_changes_nothing() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    lamp(&mut desc);
    point(&mut desc);
    let job = GatherJob { path: PathJob { blocks: 0..2, block_length: 4, ..JOB.path }, ..JOB };
    let lean = session(&desc, None);
    let full = session(&desc, None).with_code(etendue_core::transport::TransportCode::FULL);
    assert!(gather_image(&lean, &job) == gather_image(&full, &job));
    assert!(gather_probes(&lean, &job, &on_walls()) == gather_probes(&full, &job, &on_walls()));
}

/// The spread of results of many seeds must be what each result says of itself: few photons and many samples, so that nearly all of it is the maps'.
#[test]
fn error_bars_hold_the_noise_of_the_maps() {
    let mut desc = room([0.6, 0.5, 0.3], [0.0; 3]);
    point(&mut desc);
    let session = session(&desc, None);
    let probes = on_walls();
    for gather in [true, false] {
        let seeds = 48;
        let films: Vec<Film> = (0..seeds)
            .map(|seed| {
                let path = PathJob { seed, block_length: 64, blocks: 0..8, max_depth: u32::MAX };
                gather_probes(&session, &GatherJob { path, photons: 1 << 8, gather, ..JOB }, &probes)
            })
            .collect();
        let n = seeds as f64;
        let (mut spread, mut said) = (0.0, 0.0);
        for i in 0..probes.len() {
            let mean = films.iter().map(|f| f.mean(i)[0]).sum::<f64>() / n;
            spread += films.iter().map(|f| (f.mean(i)[0] - mean).powi(2)).sum::<f64>() / (n - 1.0);
            said += films.iter().map(|f| f.variance(i).unwrap()[0]).sum::<f64>() / n;
        }
        // Some 47 degrees of freedom at the least, probes sharing their maps: a standard deviation of 20 %.
        let ratio = spread / said;
        assert!((0.5..=1.8).contains(&ratio), "gather {gather}: {ratio}");
    }
}

#[test]
fn what_cannot_be_done_is_said_and_leaves_the_film() {
    let desc = furnished();
    let lit = session(&desc, None);
    let probes = on_walls();
    let empty = probe_film(&lit, &JOB, &probes);
    let mut film = empty.clone();
    let bad_job = |job: GatherJob, word: &str| {
        let mut film = probe_film(&lit, &job, &probes);
        match lit.photon_probes(&job, &probes, &NoControl, &mut film) {
            Err(BackendError::BadJob { reason }) => assert!(reason.contains(word), "{reason}"),
            other => panic!("{word}: {other:?}"),
        }
        assert_eq!(film.block_count(), 0);
    };
    bad_job(GatherJob { photons: 1000, ..JOB }, "power of two");
    bad_job(GatherJob { path: PathJob { block_length: 3, ..JOB.path }, ..JOB }, "power of two");
    bad_job(GatherJob { path: PathJob { max_depth: 4, ..JOB.path }, ..JOB }, "diffuse surfaces");
    let together = ElementSettings { sides: Sides::Together, ..JOB.elements };
    bad_job(GatherJob { elements: together, ..JOB }, "sides");
    let start = PhotonStart::Lights { registers_direct: true, survives_first: false };
    bad_job(GatherJob { start, ..JOB }, "direct light");

    let dark = session(&room([0.5; 3], [0.0; 3]), None);
    let mut black = probe_film(&dark, &JOB, &probes);
    assert_eq!(dark.photon_probes(&JOB, &probes, &NoControl, &mut black), Err(BackendError::Dark));
    let mut black = image_film(&dark, &JOB);
    assert_eq!(dark.photon_image(&JOB, &NoControl, &mut black), Err(BackendError::Dark));

    let mut blind = furnished();
    blind.camera = None;
    let mut film_of_probes = empty.clone();
    let blind = session(&blind, None);
    assert_eq!(blind.photon_image(&JOB, &NoControl, &mut film_of_probes), Err(BackendError::NoCamera));

    let mut foggy = furnished();
    foggy.materials.push(made_of("hole", MaterialKind::Null));
    foggy.media.push(MediumDesc { emission: [1.0; 3], ..MediumDesc::new("fire", [0.1; 3], [0.1; 3], 0.0) });
    let hole = etendue_core::scene::ShapeKind::Sphere { center: [0.0; 3], radius: 0.1 };
    foggy.shapes.push(ShapeDesc { exterior: "fire".into(), ..shape(hole, "hole") });
    let foggy = session(&foggy, None);
    let mut fog = probe_film(&foggy, &JOB, &probes);
    assert!(matches!(
        foggy.photon_probes(&JOB, &probes, &NoControl, &mut fog),
        Err(BackendError::SceneNeeds { method: "photon", .. })
    ));

    let other = GatherJob { path: PathJob { seed: 9, ..JOB.path }, ..JOB };
    assert!(matches!(lit.photon_probes(&other, &probes, &NoControl, &mut film), Err(BackendError::Film(_))));
    struct Stop;
    impl Control for Stop {
        fn advance(&self, done: u64, all: u64) -> ControlFlow<()> {
            assert!(done <= all);
            if 2 * done > all { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
    assert_eq!(lit.photon_probes(&JOB, &probes, &Stop, &mut film), Err(BackendError::Cancelled));
    assert!(film == empty);
}

#[test]
fn a_probe_in_mid_air_gathers_and_cannot_be_read() {
    let mut desc = room([0.5; 3], [1.0; 3]);
    point(&mut desc);
    let session = session(&desc, None);
    let probes = [on_walls()[0], Probe { position: [0.1, -0.2, 0.3], normal: [0.0, 0.0, 2.0] }];
    let gathered = gather_probes(&session, &JOB, &probes);
    assert!(gathered.mean(1)[0] > 3.0);
    let read = GatherJob { gather: false, ..JOB };
    let mut film = probe_film(&session, &read, &probes);
    assert!(matches!(
        session.photon_probes(&read, &probes, &NoControl, &mut film),
        Err(BackendError::BadProbe { index: 1, .. })
    ));
}

#[test]
fn a_linear_basis_and_single_blocks_work_in_a_scene_of_everything() {
    let session = session(&furnished(), None);
    let elements = ElementSettings { basis: Basis::Linear, largest: 0.2, ..JOB.elements };
    for gather in [true, false] {
        let path = PathJob { blocks: 5..6, block_length: 1, ..JOB.path };
        let film = gather_image(&session, &GatherJob { path, elements, gather, ..JOB });
        assert_eq!(film.block_count(), 1);
    }
}
