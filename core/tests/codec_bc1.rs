//! BC1: decoders against exact fractions, encoders against brute force and against each other.
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use etendue_core::codec::bc1::{
    ALIKE, Black, Block, Encode, LengthError, Quality, Rule, Texels, decode, decode_rgba, decode_with,
    encode, encode_blocks, encode_proved, encode_range_fit, encode_with, error,
};
use proptest::prelude::*;

/// Weyl sequence with the finaliser of splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }

    /// Noise of one of several widths about a colour; every fourth block has a few black texels.
    fn texels(&mut self) -> Texels {
        let spread = 1 << (1 + self.below(8));
        let base = [0; 3].map(|_: u64| self.below(256));
        let dark = self.below(4) == 0;
        [(); 16].map(|()| {
            if dark && self.below(3) == 0 {
                [0; 3]
            } else {
                base.map(|b| (b + self.below(spread)).min(255) as u8)
            }
        })
    }
}

fn block(first: u32, second: u32, indices: u32) -> Block {
    (u64::from(first | second << 16) | u64::from(indices) << 32).to_le_bytes()
}

/// Error from the decoded texels, counted in integers.
fn squared(texels: &Texels, block: Block) -> u64 {
    let pairs = texels.iter().zip(decode(block));
    pairs.flat_map(|(x, y)| (0..3).map(move |c| u64::from(x[c].abs_diff(y[c])).pow(2))).sum()
}

#[test]
fn every_pair_of_codes_decodes_to_the_nearest_integer() {
    for (shift, bits) in [(11, 5), (5, 6), (0, 5)] {
        let channel = 2 - (shift + 1) / 6;
        for a in 0..1_u32 << bits {
            for b in 0..1_u32 << bits {
                // Bit replication, written as a repeated string of bits.
                let wide = |x: u32| ((x << bits | x) >> (2 * bits - 8)) as i32;
                let (x, y) = (wide(a), wide(b));
                // Other channels decide the mode where they differ.
                for (first, second) in [(a << shift, b << shift), (b << shift, a << shift)] {
                    let got = decode(block(first, second, 0xe4)).map(|t| i32::from(t[channel]));
                    let (p, q) = if first == a << shift { (x, y) } else { (y, x) };
                    assert_eq!(got[..2], [p, q]);
                    if first > second {
                        assert!(
                            (3 * got[2] - (2 * p + q)).abs() <= 1 && (3 * got[3] - (p + 2 * q)).abs() <= 1
                        );
                    } else {
                        assert_eq!((got[2], got[3]), ((p + q + 1).div_euclid(2), 0));
                    }
                }
            }
        }
    }
}

#[test]
fn the_rules_stay_near_each_other_and_agree_on_alpha() {
    let mut random = Random(1);
    let mut worst = [0; 5];
    for _ in 0..20_000 {
        let any = random.below(u64::MAX).to_le_bytes();
        let reference = decode_rgba(any);
        for (k, rule) in Rule::ALL.into_iter().enumerate() {
            for (x, y) in reference.iter().zip(decode_with(any, rule)) {
                assert_eq!(x[3], y[3]);
                assert!(x[3] == 255 || (x[3] == 0 && *x == [0; 4]));
                for c in 0..3 {
                    worst[k] = worst[k].max(x[c].abs_diff(y[c]));
                }
            }
        }
        assert_eq!(decode(any), reference.map(|[r, g, b, _]| [r, g, b]));
    }
    // As the module's doc states.
    assert_eq!(worst, [0, 1, 1, 2, 5]);
}

#[test]
fn published_values_of_the_rules() {
    // White to black: the vendors' thirds.
    let at = |rule| decode_with(block(0xffff, 0, 0xe4), rule).map(|t| [t[0], t[1]]);
    assert_eq!(at(Rule::Nearest)[2..4], [[170, 170], [85, 85]]);
    assert_eq!(at(Rule::Truncated)[2..4], [[170, 170], [85, 85]]);
    assert_eq!(at(Rule::Mesa)[2..4], [[170, 170], [85, 85]]);
    assert_eq!(at(Rule::Amd)[2..4], [[171, 171], [84, 84]]);
    assert_eq!(at(Rule::Nvidia)[2..4], [[170, 175], [85, 80]]);
}

#[test]
fn constant_blocks_of_every_565_colour_are_exact() {
    for word in 0..65_536_u32 {
        let colour = decode(block(word, word, 0))[0];
        let texels = [colour; 16];
        for quality in Quality::ALL {
            // The searches stop at error 0: a sample of them.
            if quality <= Quality::LeastSquares || word % 97 == 0 {
                assert_eq!(decode(encode(&texels, &ALIKE, quality)), texels, "{word:#x} {quality:?}");
            }
        }
    }
}

#[test]
fn constant_blocks_of_any_colour_reach_the_best_there_is() {
    let mut random = Random(2);
    for _ in 0..200 {
        let colour = [0; 3].map(|_: u8| random.below(256) as u8);
        let texels = [colour; 16];
        // The best over both modes, channel by channel, by brute force.
        let mut best = u64::MAX;
        for thirds in [true, false] {
            let mut sum = 0;
            for (c, value) in colour.into_iter().enumerate() {
                let last: u32 = if c == 1 { 63 } else { 31 };
                let wide = |x: u32| if c == 1 { x << 2 | x >> 4 } else { x << 3 | x >> 2 };
                let entry = |a, b| {
                    if thirds { (2 * wide(a) + wide(b) + 1) / 3 } else { (wide(a) + wide(b)).div_ceil(2) }
                };
                let all = (0..=last).flat_map(|a| (0..=last).map(move |b| entry(a, b)));
                sum += all.map(|e| u64::from(e.abs_diff(u32::from(value))).pow(2)).min().unwrap();
            }
            best = best.min(16 * sum);
        }
        let got = squared(&texels, encode(&texels, &ALIKE, Quality::Cluster));
        assert!(got <= best, "{colour:?}: {got} > {best}");
    }
}

#[test]
fn qualities_rise_block_by_block() {
    let mut random = Random(3);
    let mut totals = [0; 5];
    for _ in 0..150 {
        let texels = random.texels();
        let errors = Quality::ALL.map(|q| squared(&texels, q.encode(&texels, &ALIKE)));
        let [range, _, cluster, refined, exhaustive] = errors;
        assert!(cluster <= range && refined <= cluster && exhaustive <= refined, "{errors:?}");
        for (total, error) in totals.iter_mut().zip(errors) {
            *total += error;
        }
        for (quality, e) in Quality::ALL.iter().zip(errors) {
            assert_eq!(error(&texels, &ALIKE, encode(&texels, &ALIKE, *quality)), e as f64);
        }
    }
    assert!(totals.is_sorted_by(|a, b| a > b), "{totals:?}");
}

#[test]
fn range_fit_takes_the_outermost_texels() {
    // Along a falling diagonal: red up, blue down.
    let texels: Texels = core::array::from_fn(|i| [(17 * i) as u8, 128, (255 - 17 * i) as u8]);
    let [a, b, c, d, ..] = encode_range_fit(&texels, 0xffff);
    let ends = [u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])];
    assert_eq!(ends, [31 << 11 | 32 << 5, 32 << 5 | 31]);
    assert_eq!(encode_range_fit(&texels, 0), [0; 8]);
    // Only the texels that count.
    let [_, _, c, d, ..] = encode_range_fit(&texels, 0xfff0);
    assert!(u16::from_le_bytes([c, d]) >> 11 >= 7);
}

#[test]
fn branch_and_bound_finds_what_brute_force_finds() {
    let mut random = Random(5);
    for round in 0..12 {
        // Green alone: endpoints with other channels are worse, or the same.
        let spread = [256, 90, 30, 8][round % 4];
        let base = random.below(256 - spread + 1);
        let texels: Texels = [(); 16].map(|()| [0, (base + random.below(spread)) as u8, 0]);
        for black in [Black::Allowed, Black::Avoided] {
            let mut best = u64::MAX;
            for a in 0..64_u32 {
                for b in 0..64_u32 {
                    let palette = decode(block(a << 5, b << 5, 0xe4));
                    let entries = if a <= b && black == Black::Avoided { 3 } else { 4 };
                    let nearest =
                        |x: u8| palette[..entries].iter().map(|p| u64::from(p[1].abs_diff(x)).pow(2)).min();
                    best = best.min(texels.iter().map(|t| nearest(t[1]).unwrap()).sum());
                }
            }
            let proof = encode_proved(&texels, &ALIKE, black, 2_000_000).unwrap();
            assert_eq!(proof.error, proof.bound, "proved");
            assert_eq!(f64::from(proof.error), best as f64);
            assert_eq!(squared(&texels, proof.block), best);
        }
    }
}

#[test]
fn branch_and_bound_in_two_channels() {
    let mut random = Random(6);
    for round in 0..6 {
        let spread = [40, 12, 100][round % 3];
        let texels: Texels =
            [(); 16].map(|()| [100 + random.below(spread) as u8, 0, 60 + random.below(spread) as u8]);
        let mut best = u64::MAX;
        for ends in 0..1_u32 << 20 {
            let word = |x: u32| (x >> 5 & 31) << 11 | x & 31;
            let palette = decode(block(word(ends), word(ends >> 10), 0xe4));
            let mut sum = 0;
            for t in texels {
                let d = |p: &[u8; 3]| {
                    u64::from(p[0].abs_diff(t[0])).pow(2) + u64::from(p[2].abs_diff(t[2])).pow(2)
                };
                sum += palette[..4].iter().map(d).min().unwrap();
                if sum >= best {
                    break;
                }
            }
            best = best.min(sum);
        }
        let proof = encode_proved(&texels, &ALIKE, Black::Allowed, 50_000_000).unwrap();
        assert_eq!(proof.error, proof.bound, "proved");
        assert_eq!(squared(&texels, proof.block), best);
    }
}

#[test]
fn a_bound_is_a_bound() {
    let mut random = Random(7);
    for _ in 0..20 {
        let texels = random.texels();
        let short = encode_proved(&texels, &ALIKE, Black::Allowed, 50).unwrap();
        let long = encode_proved(&texels, &ALIKE, Black::Allowed, 5_000).unwrap();
        assert!(short.bound <= long.error && long.bound <= long.error && short.bound <= long.bound);
        assert!(long.error <= short.error);
    }
}

#[test]
fn blocks_at_once_are_blocks_one_by_one() {
    let mut random = Random(8);
    let texels: Vec<Texels> = (0..100).map(|_| random.texels()).collect();
    for quality in [Quality::RangeFit, Quality::LeastSquares, Quality::Cluster, Quality::Refined] {
        for n in [0, 1, 7, 8, 100] {
            let mut out = vec![[0; 8]; n];
            encode_blocks(&texels[..n], quality, Black::Avoided, &mut out).unwrap();
            for (t, o) in texels.iter().zip(out) {
                assert_eq!(o, encode_with(t, &ALIKE, quality, Black::Avoided));
            }
        }
    }
    let wrong = encode_blocks(&texels, Quality::RangeFit, Black::Allowed, &mut [[0; 8]; 3]);
    assert_eq!(wrong, Err(LengthError { texels: 100, blocks: 3 }));
}

#[test]
fn no_weight_and_strange_weights() {
    let texels = Random(9).texels();
    for quality in Quality::ALL {
        for w in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(encode(&texels, &[w; 16], quality), [0; 8]);
        }
        for w in [f32::INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-45] {
            assert_eq!(encode(&texels, &[w; 16], quality), encode(&texels, &ALIKE, quality));
        }
    }
}

fn any_texels() -> impl Strategy<Value = Texels> {
    (any::<[u8; 3]>(), 0..8_u32, any::<[[u8; 3]; 16]>()).prop_map(|(base, bits, noise)| {
        noise.map(|n| core::array::from_fn(|c| base[c].saturating_add(n[c] >> bits)))
    })
}

fn any_weights() -> impl Strategy<Value = [f32; 16]> {
    prop::array::uniform16(prop_oneof![Just(0.0_f32), Just(1.0), 0.01..100.0_f32])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_does_not_count_does_not_matter(texels in any_texels(), weights in any_weights(), junk in any::<[u8; 3]>()) {
        let mut other = texels;
        for (t, w) in other.iter_mut().zip(weights) {
            if w <= 0.0 {
                *t = junk;
            }
        }
        for quality in [Quality::RangeFit, Quality::LeastSquares, Quality::Cluster, Quality::Refined] {
            prop_assert_eq!(encode(&texels, &weights, quality), encode(&other, &weights, quality));
        }
    }

    #[test]
    fn weights_matter_by_their_ratios(texels in any_texels(), weights in any_weights(), k in -100..100_i32) {
        let scaled = weights.map(|w| (f64::from(w) * 2.0_f64.powi(k)) as f32);
        prop_assert_eq!(encode(&texels, &weights, Quality::Refined), encode(&texels, &scaled, Quality::Refined));
    }

    #[test]
    fn weighted_searches_beat_the_range_fit(texels in any_texels(), weights in any_weights()) {
        let e = |q| error(&texels, &weights, encode(&texels, &weights, q));
        let slack = 1.0 + 1e-5;
        let (range, cluster, refined) = (e(Quality::RangeFit), e(Quality::Cluster), e(Quality::Refined));
        prop_assert!(cluster <= range * slack && refined <= cluster * slack, "{} {} {}", range, cluster, refined);
        prop_assert!(e(Quality::LeastSquares) <= range * slack || weights.iter().all(|w| *w == weights[0]));
    }

    #[test]
    fn avoided_black_is_never_there(texels in any_texels(), weights in any_weights()) {
        prop_assume!(weights.iter().any(|w| *w > 0.0));
        for quality in Quality::ALL {
            let block = encode_with(&texels, &weights, quality, Black::Avoided);
            prop_assert!(decode_rgba(block).iter().all(|t| t[3] == 255));
        }
    }
}
