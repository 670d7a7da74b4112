//! scratch
#![allow(missing_docs)]
#[path = "subdivide_support.rs"]
mod support;
use etendue_core::direct::subdivide::{Limits, Published, Robust, Workspace};
use support::{SCENES, Truth};
#[test]
#[ignore = "scratch"]
fn tune() {
    let mut work = Workspace::new();
    let unlimited = Limits { budget: u32::MAX, ..Limits::default() };
    for scene in &SCENES {
        let truth = Truth::new(scene, 1024);
        print!("{:28}", scene.name);
        for n in [64, 256, 1024] {
            let (p, s) = scene.refine(&Published::default(), &unlimited, n, &mut work);
            print!(" | pub {:.4} {:4}", truth.error(&p).0, s);
            let r = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
            let (p, s) = scene.refine(&r, &unlimited, n, &mut work);
            print!(" rob {:.4} {:4}", truth.error(&p).0, s);
        }
        println!();
    }
}
