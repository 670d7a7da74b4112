//! Sobol' points: an independent construction, net properties, independence of what is scrambled apart, and convergence.
//!
//! Joint level of the statistical tests of this file: alpha = 0.001, seeds fixed.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "sampling_support.rs"]
mod support;

use etendue_core::sampling::sobol::{BlockSampler, DIMENSIONS, Set, nested_uniform_scramble, sobol};
use support::{assert_random, chi2_uniform_p, sidak};

const ALPHA: f64 = 0.001;
const TESTS: usize = 40;
const SEED: u64 = 0xFEED_0123_4567_89AB;

/// The published rows (s, a, m) of dimensions 2 to 16 of `new-joe-kuo-6`, typed apart from the library's table.
const ROWS: [(u32, u32, &[u64]); 15] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
];

/// A point by the textbook: whole numbers m_k in 64 bits from the recurrence, then one bit of the index at a time, as an exact f64.
fn textbook(index: u32, d: usize) -> f64 {
    let m: Vec<u64> = if d == 0 {
        vec![1; 33]
    } else {
        let (s, a, initial) = ROWS[d - 1];
        let mut m = vec![0];
        m.extend_from_slice(initial);
        for k in m.len()..=32 {
            let s = s as usize;
            let mut next = m[k - s] ^ (m[k - s] << s);
            for i in 1..s {
                if (a >> (s - 1 - i)) & 1 == 1 {
                    next ^= m[k - i] << i;
                }
            }
            m.push(next);
        }
        m
    };
    let mut numerator = 0_u64;
    for (k, number) in m.iter().enumerate().take(33).skip(1) {
        if (index >> (k - 1)) & 1 == 1 {
            numerator ^= number << (32 - k);
        }
    }
    numerator as f64 / 4_294_967_296.0
}

#[test]
fn points_match_the_recurrence() {
    for d in 0..16 {
        for i in (0..2000_u32).chain((0..2000).map(|k| k * 2_147_483 + 1)).chain([u32::MAX, 1 << 31]) {
            assert_eq!(
                f64::from(sobol(i, d as u32)) / 4_294_967_296.0,
                textbook(i, d),
                "index {i} dimension {d}"
            );
        }
    }
}

#[test]
fn first_points_are_the_known_ones() {
    // The authors' sobol.cc lists points in Gray-code order; these are the same eight in index order, in eighths.
    let known = [[0, 0, 0], [4, 4, 4], [2, 6, 6], [6, 2, 2], [1, 5, 3], [5, 1, 7], [3, 3, 5], [7, 7, 1]];
    for (i, point) in known.iter().enumerate() {
        for (d, &eighths) in point.iter().enumerate() {
            assert_eq!(sobol(i as u32, d as u32), eighths << 29, "point {i} dimension {d}");
        }
    }
}

#[test]
fn every_dimension_is_a_permutation_of_strata() {
    for d in 0..DIMENSIONS {
        for (start, k) in [(0, 10), (7 << 10, 10), (3 << 16, 16), (0xFFFF_FC00, 10)] {
            assert!(stratified((0..1 << k).map(|i| sobol(start + i, d)), k), "dimension {d} from {start}");
        }
    }
    let set = Set::new(SEED);
    for d in [0, 1, 2, 17, 63, 64, 65, 200] {
        assert!(stratified((0..1 << 12).map(|i| set.dimension(i, d)), 12), "scrambled dimension {d}");
        assert!(
            stratified((0..1 << 12).map(|i| set.dimension((5 << 12) + i, d)), 12),
            "scrambled dimension {d}"
        );
    }
}

/// Whether 2^k fractions fall one to each interval of length 2^-k.
fn stratified(points: impl Iterator<Item = u32>, k: u32) -> bool {
    let mut seen = vec![false; 1 << k];
    points.fold(true, |fine, x| fine & !core::mem::replace(&mut seen[(x >> (32 - k)) as usize], true))
}

#[test]
fn first_two_dimensions_are_nets_after_scrambling() {
    for (stream, group) in [(0, 0), (1, 5), (99, 1)] {
        for m in 0..=10_u32 {
            for run in [0, 1, 5] {
                let points: Vec<[u32; 2]> = (0..1 << m)
                    .map(|i| BlockSampler::new(SEED, stream, 3, (run << m) + i).bits2(group))
                    .collect();
                for a in 0..=m {
                    let cell = |[x, y]: [u32; 2]| {
                        ((u64::from(x) >> (32 - a)) << (m - a)) | (u64::from(y) >> (32 - (m - a)))
                    };
                    let mut seen = vec![false; 1 << m];
                    for &p in &points {
                        assert!(
                            !core::mem::replace(&mut seen[cell(p) as usize], true),
                            "m {m}, a {a}, run {run}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn groups_agree_with_one_another_and_with_the_plain_scramble() {
    for i in 0..200 {
        let s = BlockSampler::new(SEED, 4, 2, i);
        let (four, two) = (s.bits4(6), s.bits2(6));
        assert_eq!(four[..2], two);
        assert_eq!(BlockSampler::new(SEED, 4, 2, 0).with_index(i), s);
        for (b, f) in four.iter().zip(s.group4(6)) {
            assert_eq!(f, (b >> 8) as f32 / 16_777_216.0);
        }
    }
    // A scrambled group is a scramble of a shuffle: equal prefixes of unscrambled points stay equal prefixes. Find the shuffle through
    // dimension 0, which is a scramble of the reversed index alone, and check the net of all four dimensions against that of plain points.
    let points: Vec<[u32; 4]> = (0..256).map(|i| BlockSampler::new(SEED, 4, 2, i).bits4(6)).collect();
    let plain: Vec<[u32; 4]> = (0..256).map(|i| [0, 1, 2, 3].map(|d| sobol(i, d))).collect();
    let worst = |points: &[[u32; 4]]| {
        // The fullest box of 2^-2 in each dimension: the same for a scrambled net.
        let mut boxes = vec![0; 256];
        for p in points {
            boxes[p.iter().fold(0, |b, x| (b << 2) | (x >> 30)) as usize] += 1;
        }
        boxes.sort_unstable();
        boxes
    };
    assert_eq!(worst(&points), worst(&plain));
}

#[test]
fn scramble_keeps_prefixes_and_randomises_the_rest() {
    let level = sidak(ALPHA, TESTS);
    for k in 0..2000_u32 {
        let (x, seed) = (k.wrapping_mul(0x9E37_79B9), k.wrapping_mul(0x85EB_CA6B) ^ 77);
        for bits in [1, 5, 13, 31] {
            let y = x ^ (1 << (31 - bits));
            let (a, b) = (nested_uniform_scramble(x, seed), nested_uniform_scramble(y, seed));
            assert_eq!(a >> (32 - bits), b >> (32 - bits));
            assert_ne!((a >> (31 - bits)) & 1, (b >> (31 - bits)) & 1);
        }
    }
    // One point over many blocks is uniform, and any two dimensions of it independent.
    for (a, b) in [(0, 1), (0, 2), (1, 3), (2, 3)] {
        let mut cells = vec![0_u64; 4096];
        for block in 0..1 << 18 {
            let p = BlockSampler::new(SEED, 0, block, 5).bits4(1);
            cells[((p[a] >> 26 << 6) | (p[b] >> 26)) as usize] += 1;
        }
        assert_random(chi2_uniform_p(&cells), level, "dimensions of one point over blocks");
    }
}

#[test]
fn blocks_streams_seeds_and_groups_are_independent() {
    let level = sidak(ALPHA, TESTS);
    let first = |s: BlockSampler, group| s.bits4(group);
    for d in [0, 1, 2, 3] {
        let pair = |f: &dyn Fn(u32, u32) -> (u32, u32)| {
            let mut cells = vec![0_u64; 256];
            for i in 0..1 << 18 {
                let (a, b) = f(i, i & 15);
                cells[((a >> 28 << 4) | (b >> 28)) as usize] += 1;
            }
            chi2_uniform_p(&cells)
        };
        let blocks = |i, k| {
            (
                first(BlockSampler::new(SEED, 0, 2 * i, k), 0)[d],
                first(BlockSampler::new(SEED, 0, 2 * i + 1, k), 0)[d],
            )
        };
        let streams = |i, k| {
            (
                first(BlockSampler::new(SEED, 2 * i, 0, k), 0)[d],
                first(BlockSampler::new(SEED, 2 * i + 1, 0, k), 0)[d],
            )
        };
        let seeds = |i: u32, k| {
            let at = |j| first(BlockSampler::new(u64::from(j), 0, 0, k), 0)[d];
            (at(2 * i), at(2 * i + 1))
        };
        let groups = |i, k| {
            let s = BlockSampler::new(SEED, i, 1, k);
            (s.bits4(0)[d], s.bits4(1)[d])
        };
        assert_random(pair(&blocks), level, "blocks");
        assert_random(pair(&streams), level, "streams");
        assert_random(pair(&seeds), level, "seeds");
        assert_random(pair(&groups), level, "groups");
    }
}

/// Mean square error of the mean of `f` (of integral 0) over `n` points, from 256 independent replicates.
fn mean_square(n: u32, f: impl Fn(u32, u32) -> f64) -> f64 {
    let replicates = 256;
    (0..replicates).map(|r| ((0..n).map(|i| f(r, i)).sum::<f64>() / f64::from(n)).powi(2)).sum::<f64>()
        / f64::from(replicates)
}

/// A smooth function of one variable with integral 0 and variance 1.
fn wave(x: f32) -> f64 {
    let x = f64::from(x) + 0.5 / 16_777_216.0;
    (2.0 * x - 1.0) * 3.0_f64.sqrt()
}

#[test]
fn smooth_integrands_converge_fast_within_a_block() {
    // Owen's nets: variance O(N^-3 log N) for smooth functions of two variables; plain Monte Carlo has 1/N.
    for group in [0, 3] {
        let f = |r, i| {
            let [x, y] = BlockSampler::new(SEED, r, 0, i).group2(group);
            (wave(x) + 1.0) * (wave(y) + 1.0) - 1.0
        };
        let (v16, v256, v1024) = (mean_square(16, f), mean_square(256, f), mean_square(1024, f));
        assert!(v256 <= v16 / 16.0_f64.powf(2.5), "{v16:e} -> {v256:e}");
        assert!(v1024 <= v16 / 64.0_f64.powf(2.5), "{v16:e} -> {v1024:e}");
        assert!(v1024 <= 3.0 / 1024.0 / 1e4);
    }
    // A discontinuity: still better than 1/N by far.
    let f = |r, i| {
        let [x, y] = BlockSampler::new(SEED, r, 0, i).group2(0);
        if x + y < 1.0 { 1.0 } else { -1.0 }
    };
    assert!(mean_square(1024, f) <= 0.1 / 1024.0);
}

/// Variance times N of a product of linear functions of two padded groups, were the scrambles ideal.
///
/// The points 2j and 2j + 1 differ in the first digit of *every* dimension of *every* group, so the product of the first digits of two groups
/// is the same for both: its variance, (3/4)^2 of the whole, counts twice; later digits add (1/32)^k of that. 1 + 9/16 * 32/31.
const IDEAL: f64 = 1.580_645;
/// Largest ratio of a mean square to its expectation, and of the inverse, over 256 replicates: five sigma of sqrt(2 / 256).
const EXCESS: f64 = 1.45;

#[test]
fn functions_across_groups_converge_as_random_ones() {
    // The trap: with two groups that share their index shuffle the variance of a product stops falling.
    for n in [16, 64, 256, 1024] {
        for (da, db) in [(0, 0), (1, 1), (2, 3), (3, 3)] {
            let product = |r, i| {
                let s = BlockSampler::new(SEED, r, 9, i);
                wave(s.group4(0)[da]) * wave(s.group4(1)[db])
            };
            let v = mean_square(n, product) * f64::from(n);
            assert!(
                (IDEAL / EXCESS..=IDEAL * EXCESS).contains(&v),
                "groups, n {n}, dimensions {da} {db}: {v} times 1/N"
            );
        }
        let four = |r, i| {
            let s = BlockSampler::new(SEED, r, 9, i);
            let ([a, b], [c, d]) = (s.group2(0), s.group2(1));
            wave(a) * wave(b) * wave(c) * wave(d)
        };
        assert!(mean_square(n, four) * f64::from(n) <= IDEAL * EXCESS);
        let sets = |r: u32, i| {
            let (a, b) = (Set::new(u64::from(2 * r)), Set::new(u64::from(2 * r + 1)));
            wave(a.point(i).unit(4)) * wave(b.point(i).unit(4))
        };
        assert!(mean_square(n, sets) * f64::from(n) <= IDEAL * EXCESS, "two sets");
        let padded = |r: u32, i| {
            let p = Set::new(u64::from(r)).point(i);
            wave(p.unit(4)) * wave(p.unit(68))
        };
        assert!(mean_square(n, padded) * f64::from(n) <= IDEAL * EXCESS, "padding of one set");
    }
}

#[test]
fn the_trap_is_real_where_the_shuffle_is_left_out() {
    // Negative control: dimension 0 of two sets at one index, scrambled apart but not shuffled apart.
    let n = 1024;
    let f = |r: u32, i| {
        let seeds = [2, 3].map(|k| etendue_core::sampling::counter::counter_u32(SEED, r, 0, k));
        let [a, b] = seeds.map(|s| nested_uniform_scramble(sobol(i, 0), s));
        wave((a >> 8) as f32 / 16_777_216.0) * wave((b >> 8) as f32 / 16_777_216.0)
    };
    assert!(mean_square(n, f) * f64::from(n) >= 20.0);
}

#[test]
fn many_dimensions_of_one_set_converge() {
    // A sum of products of neighbouring dimensions: one net of many dimensions keeps every pair stratified.
    let f = |r: u32, i| {
        let p = Set::new(u64::from(r) + 1000).point(i);
        (0..15).map(|d| wave(p.unit(d)) * wave(p.unit(d + 1))).sum::<f64>()
    };
    let v = mean_square(4096, f);
    assert!(v <= 0.05 * 15.0 / 4096.0, "{v:e}");
}
