//! Algorithm 1 against its text, and against a second transcription of it in f64.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::direct::subdivide::{
    CENTROID, Criterion, End, LARGEST, Limits, MIDPOINT, Probes, Published, Samples, Shape, Split, Verdict,
    Workspace,
};
use etendue_core::math::Vec3;

const ACUTE: [Vec3; 3] = [Vec3::ZERO, Vec3::new(8.0, 0.0, 0.0), Vec3::new(3.0, 7.0, 0.0)];
const RIGHT: [Vec3; 3] = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 2.0)];

/// Obtuse at the corner named.
fn obtuse(at: usize) -> [Vec3; 3] {
    let mut c = [Vec3::ZERO, Vec3::new(4.0, 1.0, 0.0), Vec3::new(-4.0, 2.0, 0.0)];
    c.rotate_right(at);
    c
}

/// la, lb, lc, le, ld for the obtuse corner A, as the seven samples.
fn around(at: usize, [la, lb, lc, le, ld]: [f32; 5]) -> Samples {
    let mut l = [0.0; 7];
    (l[at], l[(at + 1) % 3], l[(at + 2) % 3]) = (la, lb, lc);
    l[MIDPOINT + at] = le;
    l[CENTROID] = ld;
    Samples::all(l)
}

fn split(corners: [Vec3; 3], samples: &Samples) -> Option<Split> {
    match Published::default().examine(&Shape::new(corners, 1.0), samples, 0.0) {
        Verdict::Cut { split, .. } => Some(split),
        Verdict::Accept => None,
        Verdict::Probe(p) => panic!("asks for {p:?}, which it has"),
    }
}

#[test]
fn first_outcome_an_equal_centroid_is_accepted() {
    for corners in [ACUTE, RIGHT, obtuse(0), obtuse(1), obtuse(2)] {
        assert_eq!(split(corners, &around(0, [3.0, 6.0, 9.0, 100.0, 6.0])), None);
    }
}

#[test]
fn second_outcome_no_obtuse_angle_is_cut_in_three() {
    for corners in [ACUTE, RIGHT] {
        assert_eq!(split(corners, &around(0, [1.0, 1.0, 1.0, 9.0, 2.0])), Some(Split::Three));
    }
    // ABD, BCD, CAD.
    assert_eq!(Split::Three.pieces()[..3], [[0, 1, CENTROID], [1, 2, CENTROID], [2, 0, CENTROID]]);
}

#[test]
fn third_outcome_the_steepest_change_along_edges_is_cut_in_four() {
    for at in 0..3 {
        // |le - 1| = 8 > |ld - lm| = 1 and |ld - (la + le)/2| = |2 - 5| = 3 > 1.
        let corner = at as u8;
        let found = split(obtuse(at), &around(at, [1.0, 1.0, 1.0, 9.0, 2.0]));
        assert_eq!(found, Some(Split::Four { corner }));
        let [a, b, c] = [at, (at + 1) % 3, (at + 2) % 3];
        // E halves BC, F halves AB, G halves AC.
        let [e, f, g] = [MIDPOINT + a, MIDPOINT + c, MIDPOINT + b];
        assert_eq!(Split::Four { corner }.pieces(), [[a, f, g], [b, e, f], [c, g, e], [f, e, g]]);
    }
}

#[test]
fn fourth_outcome_else_an_obtuse_triangle_is_cut_in_two() {
    for at in 0..3 {
        let corner = at as u8;
        // |le - (lb + lc)/2| = 1/2 is not above |ld - lm| = 1.
        assert_eq!(split(obtuse(at), &around(at, [1.0, 1.0, 1.0, 1.5, 2.0])), Some(Split::Two { corner }));
        // It is (2), but |ld - (la + le)/2| = 0 is not: the median is linear, by the printed weights.
        assert_eq!(split(obtuse(at), &around(at, [1.0, 1.0, 1.0, 3.0, 2.0])), Some(Split::Two { corner }));
        let [a, b, c] = [at, (at + 1) % 3, (at + 2) % 3];
        assert_eq!(Split::Two { corner }.pieces()[..2], [[a, b, MIDPOINT + a], [a, MIDPOINT + a, c]]);
    }
}

#[test]
fn the_printed_weights_are_kept_and_are_not_those_of_a_linear_field() {
    // On each half the field is linear and E is a crease: (la + 2 le)/3 = ld exactly, so that in two would be perfect. By the
    // printed weights |ld - (la + le)/2| = |3 - 2.5| is compared with |ld - lm| = 2, and in two it is, here by luck.
    assert_eq!(split(obtuse(0), &around(0, [1.0, 1.0, 1.0, 4.0, 3.0])), Some(Split::Two { corner: 0 }));
    // A field linear on the whole, (la + 2 le)/3 = ld: by the printed weights it looks bent along the median, and only the equal
    // centroid saves it.
    assert_eq!(split(obtuse(0), &around(0, [0.0, 3.0, 3.0, 3.0, 2.0])), None);
}

#[test]
fn uniform_light_is_accepted_to_the_letter() {
    // (l + l + l)/3 rounds away from l for some l, 11184814 among them: the mean is formed so that it does not.
    let mut bits = 0x0080_0000_u32;
    let naive = |l: f32| (l + l + l) / 3.0 == l;
    let mut differ = 0;
    while f32::from_bits(bits) <= LARGEST {
        let l = f32::from_bits(bits);
        differ += u32::from(!naive(l));
        let samples = Samples::all([l; 7]);
        assert_eq!(
            Published::default().examine(&Shape::new(ACUTE, 1.0), &samples, 0.0),
            Verdict::Accept,
            "{l}"
        );
        bits += 14_983;
    }
    assert!(differ > 1000 && !naive(11_184_814.0), "{differ}");
}

#[test]
fn samples_are_asked_for_only_when_the_text_does() {
    let l = |b: [f32; 3]| 1.0 + b[0] * b[1];
    for (corners, first, second) in
        [(ACUTE, Probes::CENTROID, None), (obtuse(1), Probes::CENTROID, Some(Probes::midpoint(1)))]
    {
        let shape = Shape::new(corners, 1.0);
        let mut samples = Samples::corners([1.0; 3]);
        let rule = Published::default();
        assert_eq!(rule.examine(&shape, &samples, 0.0), Verdict::Probe(first));
        samples.set(CENTROID, l([1.0 / 3.0; 3]));
        match second {
            Some(p) => {
                assert_eq!(rule.examine(&shape, &samples, 0.0), Verdict::Probe(p));
                samples.set(MIDPOINT + 1, 2.0);
            }
            None => assert!(matches!(rule.examine(&shape, &samples, 0.0), Verdict::Cut { .. })),
        }
        assert!(matches!(rule.examine(&shape, &samples, 0.0), Verdict::Cut { .. }));
    }
    // Below the size nothing is asked at all but the corners.
    let limits = Limits { size: 100.0, ..Limits::default() };
    let mut ends = Vec::new();
    let summary = Workspace::new().subdivide(ACUTE, &Published::default(), &limits, l, |p| ends.push(p.end));
    assert_eq!((summary.samples, ends), (3, vec![End::Size]));
}

#[test]
fn pieces_come_in_the_texts_order_but_for_the_largest_difference() {
    // Lit at the third corner alone and cut once: BCD and CAD differ, ABD does not; the first that differs comes first.
    let limits = Limits { depth: 1, ..Limits::default() };
    let mut pieces = Vec::new();
    let light = |b: [f32; 3]| if b[2] == 1.0 { 3.0 } else { 0.0 };
    let _ = Workspace::new().subdivide(ACUTE, &Published::default(), &limits, light, |p| pieces.push(p));
    let lit: Vec<[f32; 3]> = pieces.iter().map(|p| p.irradiance).collect();
    assert_eq!(lit, [[0.0, 3.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    assert!(pieces.iter().all(|p| p.end == End::Depth));
}

/// The text once more, line by line, in f64; none where a comparison is within rounding.
fn transcribed(corners: [Vec3; 3], l: [f32; 7]) -> Option<Option<Split>> {
    let p = corners.map(|v| v.to_array().map(f64::from));
    let l = l.map(f64::from);
    let differ = |a: f64, b: f64| if (a - b).abs() <= 1e-5 { None } else { Some(a > b) };
    let (ld, lm) = (l[6], (l[0] + l[1] + l[2]) / 3.0);
    let off = (ld - lm).abs();
    differ(off, 0.0)?;
    for a in 0..3 {
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        // By the law of cosines, so that nothing is shared with the other.
        let square = |i: usize, j: usize| (0..3).map(|k| (p[i][k] - p[j][k]).powi(2)).sum::<f64>();
        if differ(square(b, c), square(a, b) + square(a, c))? {
            let le = l[3 + a];
            let edge = differ((le - (l[b] + l[c]) / 2.0).abs(), off)?;
            let median = differ((ld - (l[a] + le) / 2.0).abs(), off)?;
            let corner = a as u8;
            return Some(Some(if edge && median { Split::Four { corner } } else { Split::Two { corner } }));
        }
    }
    Some(Some(Split::Three))
}

#[test]
fn agrees_with_the_transcription() {
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0
    };
    let (mut seen, mut ties) = ([0; 5], 0);
    for _ in 0..200_000 {
        let corners = [0; 3].map(|_| Vec3::new(unit(), unit(), unit()));
        let l = [0; 7].map(|_| unit());
        match transcribed(corners, l) {
            Some(expected) => {
                assert_eq!(split(corners, &Samples::all(l)), expected, "{corners:?} {l:?}");
                seen[expected.map_or(1, Split::count)] += 1;
            }
            None => ties += 1,
        }
    }
    assert!(seen[2] > 20_000 && seen[3] > 20_000 && seen[4] > 5_000 && ties < 200, "{seen:?} {ties}");
}

#[test]
fn a_tolerance_is_relative_to_the_largest_of_the_four() {
    let shape = Shape::new(ACUTE, 1.0);
    let samples = |ld: f32| Samples::all([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, ld]);
    let rule = Published { relative: 0.25, absolute: 0.0 };
    assert_eq!(rule.examine(&shape, &samples(1.25), 0.0), Verdict::Accept);
    assert_eq!(rule.examine(&shape, &samples(0.75), 0.0), Verdict::Accept);
    assert!(matches!(rule.examine(&shape, &samples(1.5), 0.0), Verdict::Cut { .. }));
    let rule = Published { relative: f32::NAN, absolute: 0.5 };
    assert_eq!(rule.examine(&shape, &samples(1.5), 0.0), Verdict::Accept);
    assert!(matches!(rule.examine(&shape, &samples(1.75), 0.0), Verdict::Cut { .. }));
}
