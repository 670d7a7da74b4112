//! What the box convention means for rays along an axis, as documented at `slab_entry`: stated here so that a change shows.

use etendue_core::kernel::{Kernel, evaluate};

fn hits(origin: [f32; 3], direction: [f32; 3]) -> bool {
    let words = origin.into_iter().chain(direction).chain([f32::MAX]);
    let triangle = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 4.0, 0.0_f32];
    let item: Vec<u32> = words.chain(triangle).map(f32::to_bits).collect();
    let mut out = [0; 4];
    evaluate(Kernel::Triangle, &[], &item, &mut out).unwrap();
    out[0] == 1
}

#[test]
fn a_ray_along_an_axis_meets_the_low_edge_of_a_triangle_and_the_high_one_by_its_zeros_sign() {
    assert!(hits([1.0, 0.0, 1.0], [0.0, 0.0, -1.0]), "inside the low edge");
    assert!(hits([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]), "the low corner");
    // The vertex at x = 4: +0 points away from the box, -0 into it; a tilted ray meets it.
    assert!(!hits([4.0, 0.0, 1.0], [0.0, 0.0, -1.0]));
    assert!(hits([4.0, 0.0, 1.0], [-0.0, 0.0, -1.0]));
    assert!(hits([3.5, 0.0, 1.0], [0.5, 0.0, -1.0]));
}
