//! An order of patches in which neighbours see alike: then their rows are alike, and tiles of the matrix are smooth or empty.

use super::patches::Patch;
use alloc::vec::Vec;

/// Dimensions: place, and normal.
const D: usize = 6;
/// Steps of the power iteration: the axis need not be exact.
const STEPS: usize = 24;

/// Patches split again and again at the median along the axis of their greatest spread, in six dimensions: place, and normal times the scene's extent. Parts hold whole groups of `leaf` patches but for
/// the last, so that each run of `leaf` in the order is one cell of the tree. The result is a permutation: position -> patch.
pub fn kd(patches: &[Patch], leaf: usize) -> Vec<u32> {
    let leaf = leaf.max(1);
    let points = points(patches);
    let mut order: Vec<u32> = (0..patches.len() as u32).collect();
    let mut stack = alloc::vec![0..patches.len()];
    while let Some(range) = stack.pop() {
        if range.len() <= leaf {
            continue;
        }
        let part = &mut order[range.clone()];
        let axis = axis(&points, part);
        let along = |p: &u32| (0..D).map(|k| axis[k] * points[*p as usize][k]).sum::<f64>();
        let groups = part.len().div_ceil(leaf);
        let middle = groups / 2 * leaf;
        let compare = |a: &u32, b: &u32| along(a).total_cmp(&along(b)).then(a.cmp(b));
        part.select_nth_unstable_by(middle, compare);
        // The halves' own order is that of the selection: make it one of the numbers alone.
        let (low, high) = part.split_at_mut(middle);
        low.sort_unstable();
        high.sort_unstable();
        stack.push(range.start..range.start + middle);
        stack.push(range.start + middle..range.end);
    }
    order
}

/// Place and scaled normal of each patch; what is not finite counts as 0.
fn points(patches: &[Patch]) -> Vec<[f64; D]> {
    let finite = |x: f32| if x.is_finite() { f64::from(x) } else { 0.0 };
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for patch in patches {
        for k in 0..3 {
            let x = finite(patch.position[k]);
            (low[k], high[k]) = (low[k].min(x), high[k].max(x));
        }
    }
    let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let of = |p: &Patch| {
        let ([x, y, z], [u, v, w]) = (p.position.map(finite), p.normal.map(|n| finite(n) * extent));
        [x, y, z, u, v, w]
    };
    patches.iter().map(of).collect()
}

/// About the first principal axis of some points, by power iteration; any axis where they are all one.
fn axis(points: &[[f64; D]], of: &[u32]) -> [f64; D] {
    let mut mean = [0.0; D];
    for p in of {
        for (m, x) in mean.iter_mut().zip(points[*p as usize]) {
            *m += x / of.len() as f64;
        }
    }
    let mut covariance = [[0.0; D]; D];
    for p in of {
        let d: [f64; D] = core::array::from_fn(|k| points[*p as usize][k] - mean[k]);
        for (row, a) in covariance.iter_mut().zip(d) {
            for (c, b) in row.iter_mut().zip(d) {
                *c += a * b;
            }
        }
    }
    // From the row of greatest spread, which is not across the axis unless all is 0.
    let widest = (0..D).fold(0, |best, k| if covariance[k][k] > covariance[best][best] { k } else { best });
    let mut axis = covariance[widest];
    for _ in 0..STEPS {
        let scale = axis.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if scale <= 0.0 {
            break;
        }
        let unit = axis.map(|x| x / scale);
        axis = core::array::from_fn(|k| (0..D).map(|l| covariance[k][l] * unit[l]).sum());
    }
    if axis.iter().all(|x| *x == 0.0) {
        axis[0] = 1.0;
    }
    axis
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patches() -> Vec<Patch> {
        // The six sides of a cube, 13 x 13 each.
        let mut list = Vec::new();
        for side in 0..6 {
            for i in 0..13 * 13 {
                let (a, b) = ((i % 13) as f32 / 13.0, (i / 13) as f32 / 13.0);
                let mut position = [0.0; 3];
                let mut normal = [0.0; 3];
                (position[side % 3], normal[side % 3]) = if side < 3 { (0.0, 1.0) } else { (1.0, -1.0) };
                (position[(side + 1) % 3], position[(side + 2) % 3]) = (a, b);
                list.push(Patch { area: 1.0, position, normal, ..Patch::default() });
            }
        }
        list
    }

    #[test]
    fn it_is_a_permutation_for_any_input() {
        let odd =
            Patch { position: [f32::NAN, f32::INFINITY, 0.0], normal: [f32::NAN; 3], ..Patch::default() };
        for (list, leaf) in [
            (patches(), 8),
            (alloc::vec![Patch::default(); 50], 8),
            (alloc::vec![odd; 9], 4),
            (Vec::new(), 8),
            (patches(), 0),
        ] {
            let mut order = kd(&list, leaf);
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(i, o)| i == *o as usize) && order.len() == list.len());
        }
    }

    #[test]
    fn runs_of_a_leaf_are_near_and_face_alike() {
        let list = patches();
        let order = kd(&list, 8);
        let spread = |order: &[u32]| -> f64 {
            order
                .chunks(8)
                .map(|run| {
                    let first = &list[run[0] as usize];
                    run.iter()
                        .map(|p| {
                            let p = &list[*p as usize];
                            let apart: f32 = (0..3)
                                .map(|k| {
                                    (p.position[k] - first.position[k]).abs()
                                        + (p.normal[k] - first.normal[k]).abs()
                                })
                                .sum();
                            f64::from(apart)
                        })
                        .sum::<f64>()
                })
                .sum()
        };
        let plain: Vec<u32> = (0..list.len() as u32).collect();
        // Rows of 13 are long and thin; an eighth of them crosses to the next row.
        assert!(spread(&order) < 0.75 * spread(&plain), "{} {}", spread(&order), spread(&plain));
    }
}
