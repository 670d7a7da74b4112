//! Error of pieces over their number and over samples.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "subdivide_support.rs"]
mod support;

use etendue_core::direct::subdivide::{Limits, Published, Robust, Workspace};
use support::{SCENES, Truth};

#[test]
#[ignore = "table: cargo test -p etendue-core --test subdivide_error -- --ignored --nocapture"]
fn table() {
    let mut work = Workspace::new();
    let unlimited = Limits { budget: u32::MAX, ..Limits::default() };
    for scene in &SCENES {
        let truth = Truth::new(scene, 1024);
        println!("## {}", scene.name);
        let row = |name: &str, (pieces, samples): (Vec<_>, u32)| {
            let (error, wrong) = truth.error(&pieces);
            println!("{name:34} {:6} pieces {samples:6} samples {:.5} wrong {wrong}", pieces.len(), error);
        };
        for level in [2, 3, 4, 5] {
            row("uniform", scene.uniform(level, &mut work));
        }
        for size in [0.25, 0.12, 0.06, 0.03] {
            let l = Limits { size, ..unlimited };
            row(&format!("published tol 0 size {size}"), scene.subdivide(&Published::default(), &l, &mut work));
        }
        for tol in [0.1, 0.03, 0.01, 0.003] {
            let l = Limits { size: 0.03, ..unlimited };
            let p = Published { relative: tol, absolute: 0.0 };
            row(&format!("published tol {tol} size 0.03"), scene.subdivide(&p, &l, &mut work));
        }
        for n in [16, 64, 256, 1024] {
            row(&format!("published best first {n}"), scene.refine(&Published::default(), &unlimited, n, &mut work));
        }
        for tol in [0.2, 0.1, 0.05, 0.02, 0.01] {
            let l = Limits { size: 0.03, ..unlimited };
            let r = Robust { relative: tol, absolute: 0.0, share: 0.0 };
            row(&format!("robust tol {tol} size 0.03"), scene.subdivide(&r, &l, &mut work));
        }
        let mean = truth.mean_square().sqrt() as f32;
        for share in [0.02, 0.01, 0.003, 0.001, 0.0003] {
            let r = Robust { relative: 0.0, absolute: 0.0, share: share * mean };
            row(&format!("robust share {share}"), scene.subdivide(&r, &unlimited, &mut work));
        }
        for n in [16, 64, 256, 1024] {
            let r = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
            row(&format!("robust best first {n}"), scene.refine(&r, &unlimited, n, &mut work));
        }
    }
}
