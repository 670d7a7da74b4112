//! No ray from inside a closed mesh gets out of the wide tree, in any instruction set of this machine.

#[path = "../../core/tests/geometry_closed.rs"]
mod closed;

use etendue_tree::{Isa, WideTree};

fn each_set(levels: u32, grid: i32, rays: usize) {
    for isa in [Isa::Portable, Isa::Avx2].into_iter().filter(|i| i.is_here()) {
        closed::hold(levels, grid, rays, |p| Box::new(WideTree::build(&p).with_isa(isa)));
    }
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    each_set(5, 16, 3_000);
}

#[test]
#[ignore = "10 M rays a set, a minute: cargo test --release -p etendue-cpu --test wide_watertight -- --ignored --nocapture"]
fn no_ray_leaves_a_closed_mesh_long() {
    each_set(5, 40, 340_000);
}
