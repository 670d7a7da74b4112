//! Random bits: published vectors, and tests against dependence between neighbouring addresses.
//!
//! Joint level of the statistical tests of this file: alpha = 0.001, seeds fixed.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

#[path = "sampling_support.rs"]
mod support;

use etendue_core::sampling::counter::{Counter, counter_u32, hash_combine, hash_u32, philox4x32_10};
use etendue_core::sampling::{ONE_MINUS_EPSILON, u32_to_unit};
use support::{assert_random, chi2_uniform_p, sidak};

const ALPHA: f64 = 0.001;
const TESTS: usize = 40;
const SEED: u64 = 0x0123_4567_89AB_CDEF;

#[test]
fn philox_gives_the_published_answers() {
    // Random123, tests/kat_vectors, the lines `philox4x32 10`.
    let kat = [
        ([0; 4], [0; 2], [0x6627_E8D5, 0xE169_C58D, 0xBC57_AC4C, 0x9B00_DBD8]),
        ([u32::MAX; 4], [u32::MAX; 2], [0x408F_276D, 0x41C8_3B0E, 0xA20B_C7C6, 0x6D54_51FD]),
        (
            [0x243F_6A88, 0x85A3_08D3, 0x1319_8A2E, 0x0370_7344],
            [0xA409_3822, 0x299F_31D0],
            [0xD16C_FE09, 0x94FD_CCEB, 0x5001_E420, 0x2412_6EA1],
        ),
    ];
    for (counter, key, answer) in kat {
        assert_eq!(philox4x32_10(counter, key), answer);
    }
}

/// The high word of a product from 16-bit halves, as a shader forms it.
fn high_word(a: u32, b: u32) -> u32 {
    let (a0, a1, b0, b1) = (a & 0xFFFF, a >> 16, b & 0xFFFF, b >> 16);
    let low = a0 * b0;
    let mid = a1 * b0 + (low >> 16);
    let mid2 = a0 * b1 + (mid & 0xFFFF);
    a1 * b1 + (mid >> 16) + (mid2 >> 16)
}

#[test]
fn philox_needs_no_64_bit_integers() {
    for i in 0..10_000_u32 {
        let (c, k) = ([i, hash_u32(i ^ 1), 2, 3], [hash_u32(i), i]);
        let mut x = c;
        for r in 0..10 {
            let (k0, k1) = (
                k[0].wrapping_add(0x9E37_79B9_u32.wrapping_mul(r)),
                k[1].wrapping_add(0xBB67_AE85_u32.wrapping_mul(r)),
            );
            let (m0, m1) = (0xD251_1F53, 0xCD9E_8D57_u32);
            x = [
                high_word(m1, x[2]) ^ x[1] ^ k0,
                x[2].wrapping_mul(m1),
                high_word(m0, x[0]) ^ x[3] ^ k1,
                x[0].wrapping_mul(m0),
            ];
        }
        assert_eq!(x, philox4x32_10(c, k));
    }
}

#[test]
fn addresses_agree() {
    let g = Counter::new(SEED);
    for d in 0..12 {
        assert_eq!(g.bits(5, 7, d), g.bits4(5, 7, d / 4)[d as usize % 4]);
        assert_eq!(g.bits(5, 7, d), counter_u32(SEED, 5, 7, d));
        assert_eq!(g.unit(5, 7, d), u32_to_unit(g.bits(5, 7, d)));
    }
    assert_eq!(u32_to_unit(u32::MAX), ONE_MINUS_EPSILON);
    assert_eq!(u32_to_unit(255), 0.0);
    assert_eq!(u32_to_unit(256), 1.0 / 16_777_216.0);
}

/// 256 x 256 cells of a pair of words, by high or low byte.
fn pair_p(n: u32, shift: u32, pair: impl Fn(u32) -> (u32, u32)) -> f64 {
    let mut cells = vec![0_u64; 65_536];
    for i in 0..n {
        let (a, b) = pair(i);
        cells[((((a >> shift) & 255) << 8) | ((b >> shift) & 255)) as usize] += 1;
    }
    chi2_uniform_p(&cells)
}

#[test]
fn neighbouring_addresses_are_independent() {
    let level = sidak(ALPHA, TESTS);
    let n = 1 << 20;
    for shift in [0, 24] {
        let g = Counter::new(SEED);
        assert_random(pair_p(n, shift, |i| (g.bits(i, 3, 5), g.bits(i + 1, 3, 5))), level, "streams");
        assert_random(pair_p(n, shift, |i| (g.bits(9, i, 5), g.bits(9, i + 1, 5))), level, "samples");
        assert_random(pair_p(n, shift, |i| (g.bits(9, 3, i), g.bits(9, 3, i + 1))), level, "dimensions");
        assert_random(
            pair_p(n, shift, |i| (g.bits(i, 0, 0), g.bits(0, i, 0))),
            level,
            "stream against sample",
        );
        let seeds = |i: u32| (counter_u32(u64::from(i), 0, 0, 0), counter_u32(u64::from(i) + 1, 0, 0, 0));
        assert_random(pair_p(n, shift, seeds), level, "seeds");
        let hashes = |i: u32| (hash_combine(1, i), hash_combine(1, i + 1));
        assert_random(pair_p(n, shift, hashes), level, "hash_combine values");
        assert_random(
            pair_p(n, shift, |i| (hash_combine(i, 1), hash_combine(i + 1, 1))),
            level,
            "hash_combine seeds",
        );
    }
}

#[test]
fn each_bit_is_even_and_each_value_uniform() {
    let level = sidak(ALPHA, TESTS);
    let g = Counter::new(SEED);
    let n = 1 << 21;
    let mut cells = vec![0_u64; 4096];
    let mut ones = [0_i64; 32];
    for i in 0..n {
        let x = g.bits(i & 1023, i >> 10, i % 7);
        cells[(x >> 20) as usize] += 1;
        for (b, o) in ones.iter_mut().enumerate() {
            *o += i64::from((x >> b) & 1);
        }
    }
    assert_random(chi2_uniform_p(&cells), level, "values");
    // One chi-square over the 32 bits' deviations, each of variance n/4.
    let statistic: f64 =
        ones.iter().map(|&o| (o as f64 - f64::from(n) / 2.0).powi(2) / (f64::from(n) / 4.0)).sum();
    assert_random(support::chi2_survival(statistic, 32), level, "bits");
}

/// Share of trials in which output bit `o` flips with input bit `i`, its largest distance from 1/2 over all pairs, in standard deviations.
fn avalanche(n: u32, f: impl Fn(u32) -> u32) -> f64 {
    let mut worst = 0.0_f64;
    for bit in 0..32 {
        let mut flips = [0_u32; 32];
        for k in 0..n {
            let x = philox4x32_10([k, bit, 0, 9], [1, 2])[0];
            let d = f(x) ^ f(x ^ (1 << bit));
            for (b, c) in flips.iter_mut().enumerate() {
                *c += (d >> b) & 1;
            }
        }
        for c in flips {
            worst = worst.max((f64::from(c) - f64::from(n) / 2.0).abs() / (f64::from(n) / 4.0).sqrt());
        }
    }
    worst
}

#[test]
fn every_input_bit_flips_half_of_the_output() {
    // Normal tails over 1024 pairs and 4 functions: 5.6 sigma has 2e-8 each, 9e-5 jointly.
    assert!(avalanche(1 << 13, |x| counter_u32(SEED, x, 1, 2)) <= 5.6);
    assert!(avalanche(1 << 13, |x| counter_u32(SEED, 1, x, 2)) <= 5.6);
    // A two-round hash is biased a little: 10 sigma of 8192 trials is 5.5 %.
    assert!(avalanche(1 << 13, hash_u32) <= 10.0);
    assert!(avalanche(1 << 13, |x| hash_combine(x, 7)) <= 5.6);
}

#[test]
fn hashes_are_bijections_where_they_say_so() {
    // Inverses of the two multipliers modulo 2^32 undo the hash.
    let inverse = |m: u32| (0..5).fold(m, |x, _| x.wrapping_mul(2_u32.wrapping_sub(m.wrapping_mul(x))));
    let (i1, i2) = (inverse(0x7FEB_352D), inverse(0x846C_A68B));
    for k in 0..100_000_u32 {
        let x = k.wrapping_mul(0x9E37_79B9);
        let h = hash_u32(x);
        let h = (h ^ (h >> 16)).wrapping_mul(i2);
        let h = (h ^ (h >> 15) ^ (h >> 30)).wrapping_mul(i1);
        assert_eq!(h ^ (h >> 16), x);
    }
    assert_ne!(hash_combine(1, 2), hash_combine(2, 1));
}
