//! The path tracer's own rays, and the path tracer.

use super::{TURNS, median, seconds};
use etendue::core::geometry::{Hit, Intersector, Ray};
use etendue::core::medium::Inside;
use etendue::core::scene::CompiledScene;
use etendue::core::transport::Paths;
use etendue::core::transport::TransportCode;
use etendue::core::with_tracer;
use etendue::cpu::tree::{CwbvhTree, Isa, WalkTree, WideTree};
use std::cell::RefCell;
use std::path::Path;

/// Camera paths whose rays are recorded.
const WIDTH: u32 = 256;
const HEIGHT: u32 = 192;
const SAMPLES: u32 = 2;

enum Kind {
    Closest,
    Shadow,
}

/// Answers through a tree and notes every question.
struct Recorder<'a> {
    tree: &'a WideTree,
    rays: RefCell<Vec<(Kind, Ray)>>,
}

impl Intersector for Recorder<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.rays.borrow_mut().push((Kind::Closest, *ray));
        self.tree.closest_hit(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.rays.borrow_mut().push((Kind::Shadow, *ray));
        self.tree.occluded(ray)
    }
}

fn paths<I: Intersector>(scene: &CompiledScene, intersector: &I, code: TransportCode) -> (f64, u64) {
    with_tracer!(code, (scene, u32::MAX, Inside::NOTHING), |tracer| {
        let (mut sum, mut rays) = (0.0, 0);
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let (mean, n) = tracer.pixel_block(intersector, [x, y], 1, 0, SAMPLES);
                sum += mean[0];
                rays += n;
            }
        }
        (sum, rays)
    })
}

/// Asks every recorded ray; the sum keeps the work from being optimised away.
fn trace<I: Intersector>(tree: &I, rays: &[(Kind, Ray)]) -> f64 {
    let mut sum = 0.0;
    for (kind, ray) in rays {
        sum += match kind {
            Kind::Closest => tree.closest_hit(ray).map_or(0.0, |h| f64::from(h.t.min(1e3))),
            Kind::Shadow => f64::from(u8::from(tree.occluded(ray))),
        };
    }
    sum
}

/// The whole path tracer on a scene, as a ratio to bare loops over its own rays.
pub(crate) fn table(file: &Path) {
    let mut scene = super::load(file);
    scene.camera = Some(scene.camera.expect("the bench needs a camera").with_resolution(WIDTH, HEIGHT));
    let primitives = scene.primitives();
    println!("\npaths on {}: {} primitives", file.display(), primitives.count());
    let cwbvh = CwbvhTree::build(&primitives);
    let walk = WalkTree::build(&primitives);
    let wide = WideTree::build(&primitives);
    let portable = wide.clone().with_isa(Isa::Portable);
    let recorder = Recorder { tree: &wide, rays: RefCell::new(Vec::new()) };
    let code = TransportCode::of(&scene.needs);
    paths(&scene, &recorder, code);
    let rays = recorder.rays.into_inner();
    let shadow = rays.iter().filter(|r| matches!(r.0, Kind::Shadow)).count();
    println!("  {} rays of paths, {shadow} of them shadow rays", rays.len());
    let contenders: [(&str, &dyn Fn() -> f64); 7] = [
        ("obvhs cwbvh, bare", &|| trace(&cwbvh, &rays)),
        ("binary walk, bare", &|| trace(&walk, &rays)),
        ("wide, portable, bare", &|| trace(&portable, &rays)),
        ("wide, bare", &|| trace(&wide, &rays)),
        ("path tracer, binary walk", &|| paths(&scene, &walk, code).0),
        ("path tracer", &|| paths(&scene, &wide, code).0),
        ("path tracer, all code", &|| paths(&scene, &wide, TransportCode::FULL).0),
    ];
    let mut turns: Vec<Vec<f64>> = Vec::new();
    for turn in 0..=TURNS {
        let row = contenders.iter().map(|c| seconds(c.1)).collect();
        // The first turn warms the caches.
        if turn > 0 {
            turns.push(row);
        }
    }
    println!("  contender                     M rays/s   ratio to the first");
    for (i, (name, _)) in contenders.iter().enumerate() {
        let rate = median(turns.iter().map(|r| rays.len() as f64 / r[i] * 1e-6));
        let ratio = median(turns.iter().map(|r| r[0] / r[i]));
        println!("  {name:<28} {rate:>9.3}   {ratio:.3}");
    }
}
