//! Error of the piecewise-linear irradiance over the number of pieces and of samples: the published rule, the mended one, none.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "subdivide_support.rs"]
mod support;

use etendue_core::direct::subdivide::Workspace;
use support::{Point, SCENES, Scene, Truth, contest};

/// The least error of a method with at most so many pieces (or samples); infinite where it needs more.
fn least(points: &[Point], most: usize, cost: fn(&Point) -> usize) -> f64 {
    points.iter().filter(|p| cost(p) <= most).fold(f64::INFINITY, |m, p| m.min(p.error))
}

const METHODS: [&str; 4] = ["uniform", "published", "robust depth first", "robust best first"];

fn curves(scene: &Scene, lattice: usize, work: &mut Workspace<f32>) -> [Vec<Point>; 4] {
    let truth = Truth::new(scene, lattice);
    let mut all: [Vec<Point>; 4] = Default::default();
    for p in contest(scene, &truth, work) {
        let i = METHODS.iter().position(|m| *m == p.method).expect("a known method");
        all[i].push(p);
    }
    all
}

#[test]
fn robust_takes_fewer_pieces_than_published_for_any_of_its_settings() {
    let mut work = Workspace::new();
    for scene in &SCENES {
        let [uniform, published, first, best] = curves(scene, 192, &mut work);
        for n in [256, 1024] {
            let [u, p, f, b] = [&uniform, &published, &first, &best].map(|c| least(c, n, |p| p.pieces));
            assert!(b <= p, "{}: {n} pieces: best first {b}, published {p}", scene.name);
            // Where both are uniform they differ in the order of a sum.
            assert!(b <= u * (1.0 + 1e-9), "{}: {n} pieces: best first {b}, uniform {u}", scene.name);
            assert!(f <= 1.6 * p, "{}: {n} pieces: depth first {f}, published {p}", scene.name);
        }
    }
}

#[test]
#[ignore = "20 s, prints tables: cargo test --release -p etendue-core --test subdivide_error -- --ignored --nocapture"]
fn tables() {
    let mut work = Workspace::new();
    for (title, cost) in
        [("pieces", (|p| p.pieces) as fn(&Point) -> usize), ("samples", |p: &Point| p.samples)]
    {
        println!("\nLeast relative L2 error with at most so many {title}\n");
        println!("| scene | {title} | {} |", METHODS.join(" | "));
        println!("|---|---:|---:|---:|---:|---:|");
        for scene in &SCENES {
            let all = curves(scene, 1024, &mut work);
            for n in [64, 256, 1024] {
                let row: Vec<String> = all.iter().map(|c| format!("{:.4}", least(c, n, cost))).collect();
                println!("| {} | {n} | {} |", scene.name, row.join(" | "));
            }
        }
    }
}
