//! Pieces tile their parent, keep their angles and their budget, whatever the irradiance is.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "subdivide_support.rs"]
mod support;

use etendue_core::direct::subdivide::{
    Bary, Criterion, End, GRID, Limits, Node, Piece, Published, Robust, Samples, Shape, Split, Verdict,
    WHOLE_AREA, Workspace, refine, signed_area,
};
use etendue_core::math::Vec3;
use proptest::prelude::*;

/// Irradiance without any pattern: a hash of the place, dark in a third of the places.
fn noise(seed: u32, bary: [f32; 3]) -> f32 {
    let mut x = seed ^ bary[1].to_bits().wrapping_mul(0x9E37_79B1) ^ bary[2].to_bits().rotate_left(13);
    x = (x ^ x >> 16).wrapping_mul(0x85EB_CA6B);
    x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE35);
    x ^= x >> 16;
    if x.is_multiple_of(3) { 0.0 } else { x as f32 * 2.0_f32.powi(-32) }
}

/// Sorted angles of a triangle in degrees, f64.
fn angles(corners: [Vec3; 3]) -> [f64; 3] {
    let p = corners.map(|v| v.to_array().map(f64::from));
    angles_of(p)
}

fn angles_of(p: [[f64; 3]; 3]) -> [f64; 3] {
    let mut out = [0, 1, 2].map(|i| {
        let u = [0, 1, 2].map(|k| p[(i + 1) % 3][k] - p[i][k]);
        let v = [0, 1, 2].map(|k| p[(i + 2) % 3][k] - p[i][k]);
        let dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let sine = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
        sine.atan2(dot).to_degrees()
    });
    out.sort_by(f64::total_cmp);
    out
}

fn positions(corners: [Vec3; 3], piece: &Piece<f32>) -> [[f64; 3]; 3] {
    let p = corners.map(|v| v.to_array().map(f64::from));
    piece.corners.map(|b| {
        let w = b.steps().map(|x| f64::from(x) / f64::from(GRID));
        [0, 1, 2].map(|k| w[0] * p[0][k] + w[1] * p[1][k] + w[2] * p[2][k])
    })
}

/// What every list of pieces must be, whatever made it.
fn check(pieces: &[Piece<f32>], exact: bool, what: &str) {
    let mut area = 0_i64;
    let mut fractions = 0.0_f64;
    for p in pieces {
        let one = signed_area(p.corners);
        assert!(one > 0, "{what}: a piece without area or turned over: {p:?}");
        area += one;
        fractions += f64::from(p.fraction);
        let true_fraction = one as f64 / WHOLE_AREA as f64;
        let off = (f64::from(p.fraction) / true_fraction - 1.0).abs();
        if exact {
            assert!(off == 0.0, "{what}: fraction {} of {true_fraction}", p.fraction);
        }
        for corner in p.corners {
            let b = corner.to_f32();
            assert!(b[0] + b[1] + b[2] == 1.0 && b.iter().all(|x| (0.0..=1.0).contains(x)));
        }
    }
    if exact {
        assert_eq!(area, WHOLE_AREA, "{what}: areas");
        assert!((fractions - 1.0).abs() <= 1e-12, "{what}: fractions {fractions}");
    } else {
        let sum = area as f64 / WHOLE_AREA as f64;
        assert!((sum - 1.0).abs() <= 1e-6, "{what}: areas sum to {sum}");
        assert!((fractions - 1.0).abs() <= 1e-6, "{what}: fractions sum to {fractions}");
    }
}

/// No two of the pieces share an inner point, and none is missing: every random point lies in exactly one.
fn check_cover(pieces: &[Piece<f32>], points: u32, seed: u32) {
    let mut state = seed | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        i64::from(state >> 7)
    };
    let g = i64::from(GRID);
    for _ in 0..points {
        let (mut x, mut y) = (next() % g, next() % g);
        if x + y > g {
            (x, y) = (g - x, g - y);
        }
        let (mut inside, mut on_edge) = (0, 0);
        for p in pieces {
            let c = p.corners.map(|b| b.steps().map(i64::from));
            let side = [0, 1, 2].map(|i| {
                let (a, b) = (c[i], c[(i + 1) % 3]);
                (b[1] - a[1]) * (y - a[2]) - (x - a[1]) * (b[2] - a[2])
            });
            if side.iter().all(|s| *s > 0) {
                inside += 1;
            } else if side.iter().all(|s| *s >= 0) {
                on_edge += 1;
            }
        }
        assert!(
            inside == 1 && on_edge == 0 || inside == 0 && on_edge >= 1,
            "({x}, {y}): {inside}, {on_edge}"
        );
    }
}

fn run(
    corners: [Vec3; 3],
    criterion: &impl Criterion,
    limits: &Limits,
    work: &mut Workspace<f32>,
    light: impl Fn([f32; 3]) -> f32 + Copy,
) -> [Vec<Piece<f32>>; 2] {
    let mut first = Vec::new();
    let summary = work.subdivide(corners, criterion, limits, light, |p| first.push(p));
    assert_eq!(summary.pieces as usize, first.len());
    let mut nodes = vec![Node::default(); limits.budget as usize];
    let summary = refine(corners, criterion, limits, work, &mut nodes, light);
    let second: Vec<_> = nodes[..summary.pieces as usize].iter().map(Node::piece).collect();
    for list in [&first, &second] {
        assert!(!list.is_empty() && list.len() <= limits.budget as usize);
        for p in list {
            for (corner, l) in p.corners.iter().zip(p.irradiance) {
                assert_eq!(l, light(corner.to_f32()), "irradiance at a corner is the sample there");
            }
        }
    }
    [first, second]
}

fn any_corners() -> impl Strategy<Value = [Vec3; 3]> {
    let vector = || prop::array::uniform3(-1.0_f32..1.0);
    (vector(), vector(), vector(), 0..4_u8, -6.0_f32..0.0).prop_map(|(a, b, c, kind, thin)| {
        let [a, b, mut c] = [a, b, c].map(Vec3::from_array);
        if kind == 0 {
            c = b + c * 10.0_f32.powf(thin);
        }
        [a, b, c]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, rng_seed: prop::test_runner::RngSeed::Fixed(7), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pieces_of_the_robust_rule_tile_exactly(corners in any_corners(), seed: u32, budget in 1..600_u32) {
        let mut work = Workspace::new();
        let limits = Limits { budget, ..Limits::default() };
        let robust = Robust { relative: 0.02, absolute: 0.0, share: 0.0 };
        for pieces in run(corners, &robust, &limits, &mut work, |b| noise(seed, b)) {
            check(&pieces, true, "robust");
            check_cover(&pieces, 20, seed);
        }
    }

    #[test]
    fn pieces_of_the_published_rule_tile_to_1e_6(corners in any_corners(), seed: u32, budget in 1..600_u32) {
        let mut work = Workspace::new();
        let limits = Limits { budget, ..Limits::default() };
        for pieces in run(corners, &Published::default(), &limits, &mut work, |b| noise(seed, b)) {
            check(&pieces, false, "published");
        }
    }

    #[test]
    fn a_used_workspace_changes_nothing(corners in any_corners(), seed: u32) {
        let mut used = Workspace::new();
        let limits = Limits { budget: 200, ..Limits::default() };
        let robust = Robust::default();
        for other in 0..3 {
            run(corners, &robust, &limits, &mut used, |b| noise(seed ^ other, b));
        }
        let again = run(corners, &robust, &limits, &mut used, |b| noise(seed, b));
        let fresh = run(corners, &robust, &limits, &mut Workspace::new(), |b| noise(seed, b));
        prop_assert_eq!(again, fresh);
    }

    #[test]
    fn angles_of_the_robust_rule_are_at_least_half_the_parents(corners in any_corners(), seed: u32) {
        let parent = angles(corners);
        // Below a tenth of a second of arc the corners' own digits make the angle.
        prop_assume!(parent[0] > 3e-5);
        let robust = Robust { relative: 0.01, absolute: 0.0, share: 0.0 };
        let limits = Limits { budget: 600, ..Limits::default() };
        for pieces in run(corners, &robust, &limits, &mut Workspace::new(), |b| noise(seed, b)) {
            for p in &pieces {
                let least = angles_of(positions(corners, p))[0];
                // The longest edge is found in f32: of two within a rounding the other may be cut.
                prop_assert!(least >= 0.5 * parent[0] * (1.0 - 1e-3), "{least} of {parent:?}");
            }
        }
    }
}

/// Cuts whatever can be cut, towards one place, with the shapes of a rule.
struct Always<C>(C);

impl<C: Criterion> Criterion for Always<C> {
    fn examine(&self, shape: &Shape, samples: &Samples, rest: f32) -> Verdict {
        match self.0.examine(shape, samples, rest) {
            Verdict::Accept => {
                Verdict::Cut { split: self.0.demanded(shape), error: 1.0, rest: 1.0, bend: f32::INFINITY }
            }
            other => other,
        }
    }
    fn demanded(&self, shape: &Shape) -> Split {
        self.0.demanded(shape)
    }
}

/// Irradiance that is largest at one place and has all scales around it: refinement runs down to the grid there.
fn spike(at: [f32; 3], b: [f32; 3]) -> f32 {
    let d: f32 = (0..3).map(|i| (b[i] - at[i]).abs()).sum();
    1.0 / (d + 1e-7)
}

#[test]
fn any_mixture_of_the_robust_rules_cuts_keeps_half_the_least_angle() {
    // Walks down from random triangles by random cuts of the longest edge: in two, in four, in a fan where the rule would fan.
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as u32
    };
    let mut worst = f64::INFINITY;
    for _ in 0..20_000 {
        let mut p =
            [0; 3].map(|_| [0, 1, 2].map(|k| if k == 2 { 0.0 } else { f64::from(next()) / f64::from(GRID) }));
        if next() % 2 == 0 {
            p[2][1] *= 0.1;
            p[1][1] *= 0.1;
            p[0][1] *= 0.1;
        }
        let least = angles_of(p)[0];
        if least < 1e-3 {
            continue;
        }
        for _ in 0..16 {
            let shape = Shape::new(p.map(|v| Vec3::from_array(v.map(|x| x as f32))), 1.0);
            let corner = shape.opposite_longest() as u8;
            let split = match next() % 3 {
                0 => Split::Two { corner },
                1 => Split::Four { corner },
                _ if shape.is_needle() => Split::Two { corner },
                _ => Split::Fan { corner },
            };
            let halfway = |i: usize, j: usize| [0, 1, 2].map(|k| 0.5 * (p[i][k] + p[j][k]));
            let points = [p[0], p[1], p[2], halfway(1, 2), halfway(2, 0), halfway(0, 1), [0.0; 3]];
            let piece = split.pieces()[next() as usize % split.count()];
            p = piece.map(|i| points[i]);
            // Kept at size 1, so that f32 sees the same shape.
            let at = p[0];
            let scale = 1.0 / longest(p);
            p = p.map(|v| [0, 1, 2].map(|k| (v[k] - at[k]) * scale));
            worst = worst.min(angles_of(p)[0] / least);
        }
    }
    println!("least angle over the parent's: {worst}");
    assert!(worst >= 0.5 * (1.0 - 1e-3), "{worst}");
}

#[test]
fn angles_hold_down_to_the_grid() {
    let mut work = Workspace::new();
    let limits = Limits { budget: 3000, ..Limits::default() };
    let mut deepest = 0;
    for corners in [
        [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.866, 0.0)],
        [Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.1, 0.3)],
        [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1e-3, 0.0)],
        [Vec3::ZERO, Vec3::X, Vec3::new(0.4, 1e-4, 0.0)],
    ] {
        let parent = angles(corners);
        for at in [[0.3, 0.4, 0.3], [1.0, 0.0, 0.0], [0.5, 0.5, 0.0]] {
            let robust = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
            let (robust, light) = (Always(robust), |b| spike(at, b));
            for pieces in run(corners, &robust, &limits, &mut work, light) {
                check(&pieces, true, "spike");
                for p in &pieces {
                    deepest = deepest.max(p.depth);
                    let least = angles_of(positions(corners, p))[0];
                    assert!(least >= 0.5 * parent[0] * (1.0 - 1e-3), "{least} of {parent:?} at {}", p.depth);
                }
            }
        }
    }
    assert!(deepest >= 40, "the test reaches {deepest} cuts");
}

#[test]
fn the_published_rule_has_no_such_bound() {
    // Always cut, an equilateral triangle has angles between these after so many cuts, in degrees.
    let corners = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.866_025_4, 0.0)];
    let mut work = Workspace::new();
    for (depth, want_least, want_most) in
        [(1, 30.0, 120.0), (3, 13.90, 147.00), (7, 10.89, 150.00), (12, 9.25, 154.07)]
    {
        let limits = Limits { least_depth: depth, depth, budget: 100_000, ..Limits::default() };
        let mut pieces = Vec::new();
        let _ = work.subdivide(corners, &Published::default(), &limits, |_| 1.0, |p| pieces.push(p));
        let (mut least, mut most) = (180.0_f64, 0.0_f64);
        for p in &pieces {
            let a = angles_of(positions(corners, p));
            (least, most) = (least.min(a[0]), most.max(a[2]));
        }
        assert!((least - want_least).abs() <= 0.01, "{depth} cuts: {least} degrees");
        assert!((most - want_most).abs() <= 0.01, "{depth} cuts: {most} degrees");
    }
}

#[test]
fn budgets_depths_and_sizes_are_kept() {
    let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0];
    let mut work = Workspace::new();
    let light = |b| noise(3, b);
    let robust = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
    for budget in [0, 1, 2, 3, 4, 5, 17, 100, 1000] {
        let limits = Limits { budget, ..Limits::default() };
        let mut pieces = Vec::new();
        work.subdivide(corners, &robust, &limits, light, |p| pieces.push(p));
        check(&pieces, true, "budget");
        assert!(pieces.len() <= budget.max(1) as usize);
        // Noise wants more than it gets: the budget is spent but for cuts that do not fit.
        assert!(4 * pieces.len() >= 3 * budget as usize, "{} of {budget}", pieces.len());
        assert!(pieces.iter().any(|p| p.end == End::Budget));
    }
    for depth in 0..6 {
        let limits = Limits { depth, budget: 100_000, ..Limits::default() };
        let [pieces, _] = run(corners, &robust, &limits, &mut work, light);
        check(&pieces, true, "depth");
        assert!(pieces.iter().all(|p| p.depth <= depth));
    }
    for size in [3.0, 1.0, 0.3] {
        let limits = Limits { size, budget: 100_000, ..Limits::default() };
        let [pieces, best] = run(corners, &robust, &limits, &mut work, light);
        for p in pieces.iter().chain(&best) {
            let longest = longest(positions(corners, p));
            assert!(p.end != End::Size || longest <= f64::from(size) * (1.0 + 1e-6));
            assert!(longest > 0.25 * f64::from(size), "a cut part was larger than the size: {longest}");
        }
        assert!(pieces.iter().any(|p| p.end == End::Size));
    }
    // Uniform light, but no part may be larger than this.
    for largest in [5.0, 1.5, 0.5] {
        let limits = Limits { largest, ..Limits::default() };
        let [pieces, best] = run(corners, &Robust::default(), &limits, &mut work, |_| 1.0);
        assert!(pieces.iter().chain(&best).all(|p| longest(positions(corners, p)) <= f64::from(largest)));
        assert_eq!(pieces.len() == 1, largest > 4.0);
    }
    for least_depth in 0..4 {
        let limits = Limits { least_depth, ..Limits::default() };
        let [pieces, best] = run(corners, &Robust::default(), &limits, &mut work, |_| 1.0);
        assert!(pieces.iter().chain(&best).all(|p| p.depth == least_depth));
    }
}

fn longest(p: [[f64; 3]; 3]) -> f64 {
    (0..3)
        .map(|i| (0..3).map(|k| (p[i][k] - p[(i + 1) % 3][k]).powi(2)).sum::<f64>().sqrt())
        .fold(0.0, f64::max)
}

#[test]
fn limits_that_are_no_numbers_are_no_limits() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let nan = Limits { size: f32::NAN, largest: f32::NAN, budget: 64, ..Limits::default() };
    let none = Limits { budget: 64, ..Limits::default() };
    let negative = Limits { size: -1.0, ..none };
    let lists = [nan, none, negative]
        .map(|l| run(corners, &Robust::default(), &l, &mut Workspace::new(), |b| noise(1, b)));
    assert_eq!(lists[0], lists[1]);
    assert_eq!(lists[0], lists[2]);
}

#[test]
fn an_empty_buffer_takes_nothing() {
    let mut work = Workspace::new();
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let summary = refine(corners, &Robust::default(), &Limits::default(), &mut work, &mut [], |_| -> f32 {
        panic!("no piece, no sample")
    });
    assert_eq!((summary.pieces, summary.samples), (0, 0));
}

#[test]
fn points_of_the_grid() {
    assert_eq!(Bary::try_new(GRID, 1), None);
    assert_eq!(Bary::try_new(u32::MAX, u32::MAX), None);
    assert_eq!(Bary::try_new(0, GRID).map(Bary::to_f32), Some([0.0, 0.0, 1.0]));
    let [a, b, c] = Bary::CORNERS;
    assert_eq!(signed_area([a, b, c]), WHOLE_AREA);
    assert_eq!(signed_area([a, c, b]), -WHOLE_AREA);
    assert_eq!(a.midpoint(b).0.to_f32(), [0.5, 0.5, 0.0]);
    let odd = Bary::try_new(1, 0).unwrap();
    assert_eq!(a.midpoint(odd), (a, false));
    assert_eq!(Bary::centroid([a, b, c]).steps(), [5_592_406, 5_592_405, 5_592_405]);
}
