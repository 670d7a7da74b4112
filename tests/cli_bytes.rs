//! The same job gives the same bytes, for any number of threads and any split into sample blocks.
#![cfg(feature = "cli")]

mod common;

use common::{Folder, closed_cornell, run};
use etendue::core::backend::{NoControl, PathJob, Probe, Session, image_film_settings, probe_film_settings};
use etendue::core::film::Film;
use etendue::core::scene::compile;
use etendue::engine::{BackendKind, open_backend};
use std::ops::Range;
use std::sync::Arc;

const THREADS: [usize; 3] = [1, 2, 5];

/// Points on the floor, a wall and the ceiling of the closed Cornell box.
const PROBES: [Probe; 4] = [
    Probe { position: [1.0, 0.0, 1.0], normal: [0.0, 1.0, 0.0] },
    Probe { position: [4.5, 0.0, 0.7], normal: [0.0, 1.0, 0.0] },
    Probe { position: [2.7, 2.0, 5.592], normal: [0.0, 0.0, -1.0] },
    Probe { position: [1.0, 5.488, 1.0], normal: [0.0, -1.0, 0.0] },
];

#[test]
fn files_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new();
    let probes: Vec<_> =
        PROBES.iter().map(|p| serde_json::json!({ "position": p.position, "normal": p.normal })).collect();
    let points = folder.write("points.json", &serde_json::json!({ "probes": probes }).to_string());
    let mut first: Option<[Vec<u8>; 4]> = None;
    for threads in THREADS.map(|n| n.to_string()) {
        let (exr, png, json) = (folder.arg("out.exr"), folder.arg("out.png"), folder.arg("out.json"));
        // 28 x 21: no multiple of any tile.
        let line =
            ["render", &closed_cornell(), "-o", &exr, "--png", &png, "--size", "28x21", "--samples", "48"];
        run(&[&line[..], &["--threads", &threads, "--seed", "3", "--quiet"]].concat()).exits(0);
        let line = ["probe", &closed_cornell(), "--points", &points, "-o", &json, "--samples", "1000"];
        run(&[&line[..], &["--threads", &threads, "--seed", "3", "--quiet"]].concat()).exits(0);
        let ply = folder.arg("out.ply");
        let line = ["illuminate", &closed_cornell(), "-o", &ply, "--photons", "40000"];
        run(&[&line[..], &["--threads", &threads, "--seed", "3", "--quiet"]].concat()).exits(0);
        let bytes = [exr, png, json, ply].map(|path| std::fs::read(path).unwrap());
        match &first {
            None => first = Some(bytes),
            Some(first) => {
                for (name, (a, b)) in ["EXR", "PNG", "JSON", "PLY"].iter().zip(first.iter().zip(&bytes)) {
                    assert!(a == b, "{name} of {threads} threads differs");
                }
            }
        }
    }
}

/// The closed Cornell box at a small size on so many threads.
fn open(threads: usize) -> Box<dyn Session> {
    let loaded = etendue::io::load_scene(closed_cornell().as_ref()).unwrap();
    let (mut scene, _) = compile(&loaded.desc).unwrap();
    scene.camera = scene.camera.map(|c| c.with_resolution(19, 13));
    open_backend(BackendKind::Cpu, Some(threads)).unwrap().open(Arc::new(scene)).unwrap()
}

fn job(blocks: Range<u32>) -> PathJob {
    PathJob { seed: 11, block_length: 16, blocks, max_depth: u32::MAX }
}

/// `whole(0..8)` against every way to put it together from halves, quarters and single blocks.
fn check_splits(film_of: &dyn Fn(usize, Range<u32>) -> Film) {
    let whole = film_of(1, 0..8);
    assert_eq!(whole.block_count(), 8);
    let splits: [&[Range<u32>]; 4] = [
        &[0..4, 4..8],
        &[4..8, 0..4],
        &[6..8, 0..1, 3..6, 1..3],
        &[7..8, 5..6, 3..4, 1..2, 6..7, 4..5, 2..3, 0..1],
    ];
    for (i, split) in splits.iter().enumerate() {
        let mut parts = split.iter().map(|blocks| film_of(THREADS[i % 3], blocks.clone()));
        let mut sum = parts.next().unwrap();
        for part in parts {
            assert_ne!(sum, whole);
            sum.merge(&part).unwrap();
        }
        assert!(sum == whole, "the parts {split:?} do not make the whole");
    }
}

#[test]
fn an_image_may_be_split_into_blocks_anywhere() {
    let sessions = THREADS.map(open);
    let index = |threads| THREADS.iter().position(|n| *n == threads).unwrap();
    check_splits(&|threads, blocks| {
        let session = &sessions[index(threads)];
        let mut film = Film::new(image_film_settings(session.scene(), &job(blocks.clone())).unwrap());
        session.path_image(&job(blocks), &NoControl, &mut film).unwrap();
        film
    });
}

#[test]
fn probes_may_be_split_into_blocks_anywhere() {
    let sessions = THREADS.map(open);
    let index = |threads| THREADS.iter().position(|n| *n == threads).unwrap();
    check_splits(&|threads, blocks| {
        let session = &sessions[index(threads)];
        let mut film = Film::new(probe_film_settings(session.scene(), &job(blocks.clone()), PROBES.len()));
        session.path_probes(&job(blocks), &PROBES, &NoControl, &mut film).unwrap();
        film
    });
}

#[test]
fn blocks_added_to_one_film_equal_blocks_merged() {
    let session = open(2);
    let mut grown = Film::new(image_film_settings(session.scene(), &job(0..8)).unwrap());
    let mut whole = grown.clone();
    for blocks in [4..8, 0..4] {
        session.path_image(&job(blocks), &NoControl, &mut grown).unwrap();
    }
    session.path_image(&job(0..8), &NoControl, &mut whole).unwrap();
    assert!(grown == whole);
    // Twice the same block is refused and changes nothing.
    assert!(session.path_image(&job(3..5), &NoControl, &mut grown).is_err());
    assert!(grown == whole);
}
