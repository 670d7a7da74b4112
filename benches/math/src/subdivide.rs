//! Contenders for `subdivide`: the published rule, the mended one and none, over the scenes of core's own tests.

use crate::figure::{Contender, Contest, Curves, Series};
use etendue_core::direct::subdivide::{Limits, Node, Published, Robust, Workspace, refine};
use support::{Point, SCENES, Truth, contest as measure};

// One set of scenes for the figures and for the tests that hold the same claims.
#[path = "../../../core/tests/subdivide_support.rs"]
mod support;

/// Points per side of the truth's lattice.
const LATTICE: usize = 768;
const METHODS: [&str; 4] = ["uniform", "published", "robust depth first", "robust best first"];

/// Titles and files of the scenes' figures: over pieces, over samples.
const FILES: [[&str; 4]; 6] = [
    [
        "Point light 1 m away: error over pieces",
        "subdivide-far-pieces",
        "Point light 1 m away: error over samples",
        "subdivide-far-samples",
    ],
    [
        "Point light 5 cm away: error over pieces",
        "subdivide-near-pieces",
        "Point light 5 cm away: error over samples",
        "subdivide-near-samples",
    ],
    [
        "Shadow edge: error over pieces",
        "subdivide-edge-pieces",
        "Shadow edge: error over samples",
        "subdivide-edge-samples",
    ],
    [
        "Thin shadow: error over pieces",
        "subdivide-thin-pieces",
        "Thin shadow: error over samples",
        "subdivide-thin-samples",
    ],
    [
        "Spot's rim: error over pieces",
        "subdivide-spot-pieces",
        "Spot's rim: error over samples",
        "subdivide-spot-samples",
    ],
    [
        "Grazing light: error over pieces",
        "subdivide-grazing-pieces",
        "Grazing light: error over samples",
        "subdivide-grazing-samples",
    ],
];

/// The points that no other of the method beats at its cost: what its best settings give.
fn front(points: &[Point], cost: fn(&Point) -> usize) -> Vec<(f64, f64)> {
    let mut list: Vec<&Point> = points.iter().collect();
    list.sort_by(|a, b| cost(a).cmp(&cost(b)).then(a.error.total_cmp(&b.error)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for p in list {
        if front.last().is_none_or(|last| p.error < last.1) {
            front.push((cost(p) as f64, p.error));
        }
    }
    front
}

/// Relative L2 error of the piecewise-linear irradiance over pieces and over samples, of every method's best settings.
pub fn curves() -> Vec<Curves> {
    let mut work = Workspace::new();
    let mut all = Vec::new();
    for (scene, [by_pieces, pieces_file, by_samples, samples_file]) in SCENES.iter().zip(FILES) {
        let points = measure(scene, &Truth::new(scene, LATTICE), &mut work);
        let series = |cost: fn(&Point) -> usize| {
            METHODS
                .iter()
                .map(|m| {
                    let own: Vec<Point> = points.iter().filter(|p| p.method == *m).cloned().collect();
                    Series { name: (*m).to_string(), points: front(&own, cost) }
                })
                .collect()
        };
        let y_label = "relative L2 error of irradiance";
        all.push(Curves {
            title: by_pieces,
            file: pieces_file,
            x_label: "pieces",
            y_label,
            series: series(|p| p.pieces),
        });
        all.push(Curves {
            title: by_samples,
            file: samples_file,
            x_label: "samples of irradiance",
            y_label,
            series: series(|p| p.samples),
        });
    }
    all
}

/// Time of a subdivision into about 256 pieces with samples that cost next to nothing: the price of the rule itself.
pub fn contest() -> Contest {
    let scene = &SCENES[5];
    let truth = Truth::new(scene, LATTICE);
    let corners = scene.vertices();
    // z / d^3 in f32, the light at (-0.05, 0.4, 0.02).
    let light = |b: [f32; 3]| {
        let (x, y) = (b[1] + 0.05, b[2] - 0.4);
        let square = x * x + y * y + 4e-4;
        0.02 / (square * etendue_core::math::sqrt(square))
    };
    let mut contenders = Vec::new();
    let mut add = |name: &str, ours: bool, error: f64, work: Box<dyn FnMut()>| {
        contenders.push(Contender { name: name.to_string(), ours, error, work });
    };
    let mut work = Workspace::new();
    let limits = Limits { size: 0.14, budget: 100_000, ..Limits::default() };
    let rule = Published { relative: 0.01, absolute: 0.0 };
    let (error, _) = truth.error(&scene.subdivide(&rule, &limits, &mut work).0);
    let mut own = Workspace::<f32>::new();
    add(
        "published",
        false,
        error,
        Box::new(move || {
            let mut sum = 0.0;
            own.subdivide(corners, &rule, &limits, light, |p| sum += p.irradiance[0]);
            std::hint::black_box(sum);
        }),
    );
    let scale = truth.mean_square() as f32;
    let rule = Robust { relative: 0.0, absolute: 0.0, share: 0.0035 * etendue_core::math::sqrt(scale) };
    let limits = Limits { budget: 100_000, ..Limits::default() };
    let (error, _) = truth.error(&scene.subdivide(&rule, &limits, &mut work).0);
    let mut own = Workspace::<f32>::new();
    add(
        "robust depth first",
        true,
        error,
        Box::new(move || {
            let mut sum = 0.0;
            own.subdivide(corners, &rule, &limits, light, |p| sum += p.irradiance[0]);
            std::hint::black_box(sum);
        }),
    );
    let rule = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
    let (error, _) = truth.error(&scene.refine(&rule, &limits, 256, &mut work).0);
    let mut own = Workspace::<f32>::new();
    let mut buffer = vec![Node::default(); 256];
    add(
        "robust best first",
        true,
        error,
        Box::new(move || {
            std::hint::black_box(refine(corners, &rule, &limits, &mut own, &mut buffer, light));
        }),
    );
    Contest {
        title: "Subdivision of one triangle under grazing light",
        file: "subdivide-speed",
        error_label: "relative L2 error of irradiance",
        item: "triangle",
        items: 1,
        contenders,
    }
}
