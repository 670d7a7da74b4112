//! The mended rule on hard cases: what is found, what is finite, what ends.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "subdivide_support.rs"]
mod support;

use etendue_core::direct::subdivide::{
    CENTROID, Criterion, End, LARGEST, Limits, MIDPOINT, Node, POINTS, Piece, Probes, Robust, Samples, Shape,
    Split, Verdict, WHOLE_AREA, Workspace, refine, signed_area,
};
use etendue_core::math::Vec3;
use support::{point, spot};

const RIGHT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

/// Position on [`RIGHT`] in f64.
fn at(b: [f32; 3]) -> [f64; 3] {
    [f64::from(b[1]), f64::from(b[2]), 0.0]
}

/// Pieces of both walks, checked for what always holds.
fn pieces(
    corners: [Vec3; 3],
    rule: &Robust,
    limits: &Limits,
    light: impl Fn([f32; 3]) -> f32 + Copy,
) -> [Vec<Piece<f32>>; 2] {
    let mut work = Workspace::new();
    let mut first = Vec::new();
    let _ = work.subdivide(corners, rule, limits, light, |p| first.push(p));
    let mut nodes = vec![Node::default(); limits.budget as usize];
    let n = refine(corners, rule, limits, &mut work, &mut nodes, light).pieces as usize;
    let second: Vec<_> = nodes[..n].iter().map(Node::piece).collect();
    for list in [&first, &second] {
        assert!(list.len() <= limits.budget as usize);
        assert!(list.iter().flat_map(|p| p.irradiance).all(|l| l.is_finite() && l >= 0.0));
        assert_eq!(list.iter().map(|p| signed_area(p.corners)).sum::<i64>(), WHOLE_AREA);
    }
    [first, second]
}

/// Mean over the parent of the pieces' linear irradiance.
fn mean(list: &[Piece<f32>]) -> f64 {
    list.iter()
        .map(|p| f64::from(p.fraction) * p.irradiance.iter().map(|l| f64::from(*l)).sum::<f64>() / 3.0)
        .sum()
}

/// Mean of a function over [`RIGHT`], by 4 n^2 points.
fn truth(light: impl Fn([f64; 3]) -> f64, n: usize) -> f64 {
    let mut sum = 0.0;
    for j in 0..2 * n {
        for i in 0..2 * n - j {
            let (x, y) = ((i as f64 + 0.33) / (2 * n) as f64, (j as f64 + 0.33) / (2 * n) as f64);
            sum += light([x, y, 0.0]);
            if i + j + 1 < 2 * n {
                sum += light([x + 0.34 / (2 * n) as f64, y + 0.34 / (2 * n) as f64, 0.0]);
            }
        }
    }
    sum / (4 * n * n) as f64
}

#[test]
fn a_linear_field_is_one_piece_and_a_bent_one_is_not() {
    let limits = Limits::default();
    let rule = Robust { relative: 1e-6, absolute: 0.0, share: 0.0 };
    for list in pieces(RIGHT, &rule, &limits, |b| 1.0 + 2.0 * b[1] + 0.5 * b[2]) {
        assert_eq!(list.len(), 1);
        assert_eq!(list[0].end, End::Linear);
    }
    for list in pieces(RIGHT, &rule, &limits, |b| 1.0 + b[1] * b[2]) {
        assert!(list.len() > 16);
    }
}

#[test]
fn uniform_light_takes_seven_samples() {
    for l in [0.0_f32, 1.0, 11_184_814.0, 1e-40, f32::MAX] {
        let mut work = Workspace::new();
        let rule = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
        let summary = work.subdivide(
            RIGHT,
            &rule,
            &Limits::default(),
            |_| l,
            |p| {
                assert_eq!((p.end, p.irradiance), (End::Linear, [l.min(LARGEST); 3]));
            },
        );
        assert_eq!((summary.pieces, summary.samples), (1, 7));
    }
}

#[test]
fn a_field_bent_along_the_longest_edge_is_halved_there() {
    // The median's mend: with D = (la + 2 le)/3 both halves are linear.
    let shape = Shape::new([Vec3::ZERO, Vec3::new(3.0, 1.0, 0.0), Vec3::new(-3.0, 1.0, 0.0)], 1.0);
    let mut l = [1.0, 1.0, 1.0, 1.3, 1.0, 1.0, 1.0];
    l[CENTROID] = (1.0 + 2.0 * 1.3) / 3.0;
    let rule = Robust { relative: 0.01, absolute: 0.0, share: 0.0 };
    let verdict = rule.examine(&shape, &Samples::all(l), 0.0);
    assert!(matches!(verdict, Verdict::Cut { split: Split::Two { corner: 0 }, .. }), "{verdict:?}");
}

#[test]
fn asking_step_by_step_ends_as_knowing_everything() {
    let mut state = 9_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    let mut asked = [0_u32; POINTS + 1];
    for k in 0..100_000 {
        let shape = Shape::new([0; 3].map(|_| Vec3::new(unit(), unit(), unit())), unit());
        let dark = if k % 2 == 0 { 0.4 } else { -1.0 };
        let (spread, base) = ([0.01, 0.1, 1.0][k % 3], if k % 3 == 2 { 0.0 } else { 0.5 });
        let l = [0; POINTS].map(|_| if unit() < dark { 0.0 } else { base + spread * unit() });
        let rule = Robust { relative: [0.0, 0.05][k / 2 % 2], absolute: 0.0, share: [0.0, 0.02][k / 4 % 2] };
        let rest = [0.0, 0.1, 1.0, f32::INFINITY][k / 8 % 4];
        let mut samples = Samples::corners([l[0], l[1], l[2]]);
        let mut rounds = 0;
        let verdict = loop {
            match rule.examine(&shape, &samples, rest) {
                Verdict::Probe(p) => {
                    assert!(!p.without(samples.known()).is_empty() && rounds < POINTS);
                    for i in (0..POINTS).filter(|i| p.has(*i)) {
                        samples.set(i, l[i]);
                    }
                    rounds += 1;
                }
                other => break other,
            }
        };
        assert_eq!(verdict, rule.examine(&shape, &Samples::all(l), rest), "{l:?}");
        asked[(0..POINTS).filter(|i| samples.known().has(*i)).count()] += 1;
        // Accepting takes all seven.
        assert!(verdict != Verdict::Accept || samples.known().has(CENTROID));
    }
    assert!(asked[4] > 1000 && asked[7] > 1000, "{asked:?}");
}

#[test]
fn a_shadow_edge_through_a_corner_is_followed() {
    // Dark where y > x / 2: the edge starts at the first corner, which is lit itself.
    let lit = |p: [f64; 3]| if p[1] > 0.5 * p[0] { 0.0 } else { point([0.3, 0.1, 1.0], p) };
    let want = truth(lit, 400);
    // Depth first is led by a tolerance on each piece's part in the error, best first by the budget.
    let (by_share, limits) = (
        Robust { relative: 0.0, absolute: 0.0, share: 0.003 },
        Limits { budget: 20_000, ..Limits::default() },
    );
    let [first, _] = pieces(RIGHT, &by_share, &limits, |b| lit(at(b)) as f32);
    assert!(first.len() < 900 && first.iter().all(|p| p.end != End::Budget), "{}", first.len());
    let limits = Limits { budget: 600, ..Limits::default() };
    let rule = Robust { relative: 0.02, absolute: 0.0, share: 0.0 };
    let [_, best] = pieces(RIGHT, &rule, &limits, |b| lit(at(b)) as f32);
    for (list, name, tolerance) in [(first, "depth first", 0.005), (best, "best first", 0.005)] {
        let got = mean(&list);
        assert!((got / want - 1.0).abs() <= tolerance, "{name}: {got} for {want}");
    }
}

#[test]
fn a_spot_inside_is_found_by_size_and_its_rim_followed() {
    // A spot of 4 cm radius around (0.28, 0.23): none of the parent's seven points is lit.
    let light = |p: [f64; 3]| spot([0.28, 0.23, 1.0], [0.9997, 0.9992], p);
    for b in [[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0], [1.0 / 3.0; 3_usize]] {
        assert_eq!(light(at(b)), 0.0);
    }
    let rule = Robust { relative: 0.02, absolute: 0.0, share: 0.0 };
    let limits = Limits { budget: 1000, ..Limits::default() };
    let missed = pieces(RIGHT, &rule, &limits, |b| light(at(b)) as f32);
    assert!(missed.iter().all(|l| l.len() == 1), "seven dark points look like darkness");
    // Parts larger than the spot must be cut.
    let limits = Limits { largest: 0.06, budget: 4000, ..Limits::default() };
    let want = truth(light, 1000);
    for list in pieces(RIGHT, &rule, &limits, |b| light(at(b)) as f32) {
        assert!((mean(&list) / want - 1.0).abs() <= 0.01, "{} for {want}", mean(&list));
    }
}

#[test]
fn a_light_in_the_plane_lights_nothing() {
    for light in [[0.2, 0.2, 0.0], [2.0, 0.3, 0.0], [0.0, 0.0, 0.0], [0.2, 0.2, -1.0]] {
        for list in pieces(RIGHT, &Robust::default(), &Limits::default(), |b| point(light, at(b)) as f32) {
            assert_eq!(list.len(), 1);
            assert_eq!(list[0].irradiance, [0.0; 3]);
        }
    }
}

#[test]
fn a_light_a_micrometre_from_a_corner_is_resolved() {
    // 1e-6 m above the corner, within the solid angle of which the flux is spread over nine decades of irradiance: of the flux through the
    // plane, 2 pi I, the triangle's right angle takes a quarter (but for what passes over its far edge).
    let light = [0.0, 0.0, 1e-6];
    let limits = Limits { budget: 2000, ..Limits::default() };
    let rule = Robust { relative: 0.01, absolute: 0.0, share: 0.0 };
    let [first, best] = pieces(RIGHT, &rule, &limits, |b| point(light, at(b)) as f32);
    let want = 2.0 * (std::f64::consts::FRAC_PI_2 - 1e-6 * 2.0);
    for (list, name) in [(&first, "depth first"), (&best, "best first")] {
        assert!((mean(list) / want - 1.0).abs() <= 0.02, "{name} {} for {want}", mean(list));
    }
    assert!(best.iter().any(|p| p.depth >= 30));
    // On the corner itself the sample is whatever the light says of a distance of 0; here darkness.
    for list in pieces(RIGHT, &rule, &limits, |b| point([0.0; 3], at(b)) as f32) {
        assert_eq!(list.len(), 1);
    }
}

#[test]
fn samples_that_are_no_irradiance_have_a_value() {
    let rule = Robust { relative: 0.0, absolute: 0.0, share: 0.0 };
    let limits = Limits { budget: 200, ..Limits::default() };
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, -0.0, f32::MAX, 1e-45];
    for k in 0..7 {
        let light = |b: [f32; 3]| odd[(b[1].to_bits() as usize % 7 + b[2].to_bits() as usize % 5 + k) % 7];
        for list in pieces(RIGHT, &rule, &limits, light) {
            assert!(list.iter().flat_map(|p| p.irradiance).all(|l| (0.0..=LARGEST).contains(&l)));
        }
    }
    for list in pieces(RIGHT, &rule, &limits, |_| f32::NAN) {
        assert_eq!((list.len(), list[0].irradiance), (1, [0.0; 3]));
    }
    for list in pieces(RIGHT, &rule, &limits, |_| f32::INFINITY) {
        assert_eq!((list.len(), list[0].irradiance), (1, [LARGEST; 3]));
    }
}

#[test]
fn triangles_without_area_are_one_piece() {
    let [o, x, inf] = [Vec3::ZERO, Vec3::X, Vec3::new(f32::INFINITY, 0.0, 0.0)];
    let nan = Vec3::splat(f32::NAN);
    let far = Vec3::splat(f32::MAX);
    for corners in [
        [o; 3],
        [o, x, x],
        [x, x, o],
        [o, x, 3.0 * x],
        [-x, x, o],
        [o, x, inf],
        [o, nan, x],
        [nan; 3],
        [far, -far, o],
        [far; 3],
    ] {
        for list in pieces(corners, &Robust::default(), &Limits::default(), |b| b[0] * b[0]) {
            assert_eq!(list.len(), 1, "{corners:?}");
            assert_eq!(list[0].end, End::Degenerate, "{corners:?}");
            assert_eq!(list[0].irradiance, [1.0, 0.0, 0.0]);
        }
    }
}

#[test]
fn size_does_not_matter() {
    // The same triangle in other units, to the ends of f32: the same pieces.
    let corners = [Vec3::new(0.0, 0.25, 0.5), Vec3::new(1.0, 0.5, 0.0), Vec3::new(-0.5, 1.0, 0.25)];
    let light = |b: [f32; 3]| 1.0 / (0.01 + (b[0] - 0.2).abs());
    let limits = Limits { budget: 300, ..Limits::default() };
    let want = pieces(corners, &Robust::default(), &limits, light);
    for k in [-120, -60, 60, 120] {
        let scale = 2.0_f32.powi(k);
        assert_eq!(pieces(corners.map(|c| c * scale), &Robust::default(), &limits, light), want, "2^{k}");
    }
}

#[test]
fn needles_are_shortened_and_end() {
    // Aspect 1e6, light near the tip, a shadow across.
    for (name, corners) in [
        ("sharp", [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1e-6, 0.0)]),
        ("flat", [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-6, 0.0)]),
        (
            "far from the origin",
            [Vec3::new(1e3, 0.0, 0.0), Vec3::new(1e3 + 1.0, 0.0, 0.0), Vec3::new(1e3, 1e-3, 0.0)],
        ),
    ] {
        let x = |b: [f32; 3]| {
            f64::from(b[0]) * f64::from(corners[0].x - corners[0].x)
                + f64::from(b[1]) * f64::from(corners[1].x - corners[0].x)
                + f64::from(b[2]) * f64::from(corners[2].x - corners[0].x)
        };
        let light = |b: [f32; 3]| {
            let x = x(b);
            if (0.4..0.5).contains(&x) { 0.0 } else { point([0.7, 0.0, 0.1], [x, 0.0, 0.0]) as f32 }
        };
        let limits = Limits { budget: 1024, ..Limits::default() };
        let rule = Robust { relative: 0.01, absolute: 0.0, share: 0.0 };
        for list in pieces(corners, &rule, &limits, light) {
            // Cut across, not along: where the light is, which is 0.1 away, pieces are a fraction of that long.
            assert!(list.len() > 20, "{name}: {}", list.len());
            let length = |p: &Piece<f32>| {
                let x = p.corners.map(|c| x(c.to_f32()));
                x.iter().fold(f64::MIN, |m, v| m.max(*v)) - x.iter().fold(f64::MAX, |m, v| m.min(*v))
            };
            let brightest = list.iter().flat_map(|p| p.irradiance).fold(0.0, f32::max);
            let bright = list.iter().filter(|p| p.irradiance.iter().any(|l| *l > 0.25 * brightest));
            let longest = bright.map(length).fold(0.0, f64::max);
            assert!(brightest > 95.0 && longest <= 0.0625, "{name}: {longest} long, of {brightest}");
        }
    }
}

#[test]
fn channels_are_kept_apart_and_compared_by_their_mean() {
    let colour = |b: [f32; 3]| Vec3::new(3.0 * b[0], 1.0, b[1] * b[1]);
    let mut work = Workspace::new();
    let rule = Robust { relative: 0.002, absolute: 0.0, share: 0.0 };
    let (mut rgb, mut grey) = (Vec::new(), Vec::new());
    let _ = work.subdivide(RIGHT, &rule, &Limits::default(), colour, |p| rgb.push(p));
    let mean = |b: [f32; 3]| etendue_core::math::mean(colour(b));
    let _ = Workspace::new().subdivide(RIGHT, &rule, &Limits::default(), mean, |p| grey.push(p));
    assert!(rgb.len() > 4);
    assert_eq!(rgb.len(), grey.len());
    for (p, q) in rgb.iter().zip(&grey) {
        assert_eq!((p.corners, p.end), (q.corners, q.end));
        for (l, corner) in p.irradiance.iter().zip(p.corners) {
            assert_eq!(*l, colour(corner.to_f32()));
        }
    }
}

#[test]
fn a_rule_that_never_makes_up_its_mind_ends() {
    struct Asks;
    impl Criterion for Asks {
        fn examine(&self, _: &Shape, _: &Samples, _: f32) -> Verdict {
            Verdict::Probe(Probes::midpoint(MIDPOINT))
        }
        fn demanded(&self, _: &Shape) -> Split {
            Split::Two { corner: 200 }
        }
    }
    let mut n = 0;
    let limits = Limits { least_depth: 5, ..Limits::default() };
    let summary = Workspace::new().subdivide(RIGHT, &Asks, &limits, |_| 1.0_f32, |_| n += 1);
    assert_eq!((summary.pieces, n), (32, 32));
}
