//! BC4: the decoder against exact fractions, the exhaustive encoder against all pairs of endpoints.

use etendue_core::codec::bc1::ALIKE;
use etendue_core::codec::bc4::{Quality, Texels, decode, encode, encode_range_fit, error, palette};
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
}

fn squared(texels: &Texels, block: [u8; 8]) -> u64 {
    texels.iter().zip(decode(block)).map(|(x, y)| u64::from(x.abs_diff(y)).pow(2)).sum()
}

#[test]
fn every_palette_is_the_nearest_integers() {
    for a in 0..=255_u8 {
        for b in 0..=255_u8 {
            let p = palette(a, b).map(i32::from);
            let (x, y) = (i32::from(a), i32::from(b));
            assert_eq!(p[..2], [x, y]);
            if a > b {
                for k in 1..7 {
                    assert!((2 * (7 * p[k as usize + 1] - (7 - k) * x - k * y)).abs() <= 7);
                }
            } else {
                for k in 1..5 {
                    assert!((2 * (5 * p[k as usize + 1] - (5 - k) * x - k * y)).abs() <= 5);
                }
                assert_eq!(p[6..], [0, 255]);
            }
        }
    }
}

#[test]
fn indices_are_read_from_the_lowest_bits() {
    // Endpoints 200 and 60, indices 0 1 2 ... 7 0 1 ... 7.
    let indices = (0..16_u64).fold(0, |bits, i| bits | (i % 8) << (3 * i));
    let block = (200 | 60 << 8 | indices << 16_u64).to_le_bytes();
    let expected = [200, 60, 180, 160, 140, 120, 100, 80];
    assert_eq!(decode(block)[..8], expected);
    assert_eq!(decode(block)[8..], expected);
}

#[test]
fn exhaustive_is_the_optimum_over_all_pairs() {
    let mut random = Random(1);
    for round in 0..24 {
        let spread = [256, 100, 40, 12][round % 4];
        let base = random.below(256 - spread + 1);
        // Every third block has texels at the ends, which the other mode holds for nothing.
        let texels: Texels = core::array::from_fn(|i| match (round % 3, i % 5) {
            (0, 0) => 0,
            (0, 1) => 255,
            _ => (base + random.below(spread)) as u8,
        });
        let mut best = u64::MAX;
        for a in 0..=255 {
            for b in 0..=255 {
                let palette = palette(a, b);
                let mut sum = 0;
                for x in texels {
                    sum += palette.iter().map(|p| u64::from(p.abs_diff(x)).pow(2)).min().unwrap();
                    if sum >= best {
                        break;
                    }
                }
                best = best.min(sum);
            }
        }
        let [range, refined, exhaustive] = Quality::ALL.map(|q| squared(&texels, encode(&texels, &ALIKE, q)));
        assert_eq!(exhaustive, best, "{texels:?}");
        assert!(refined <= range && exhaustive <= refined);
        assert_eq!(error(&texels, &ALIKE, encode(&texels, &ALIKE, Quality::Exhaustive)), best as f64);
    }
}

#[test]
fn constants_and_nothing() {
    for x in 0..=255 {
        for quality in [Quality::RangeFit, Quality::Refined, Quality::Exhaustive] {
            assert_eq!(decode(encode(&[x; 16], &ALIKE, quality)), [x; 16]);
        }
    }
    for quality in Quality::ALL {
        assert_eq!(encode(&[7; 16], &[f32::NAN; 16], quality), [0; 8]);
        assert_eq!(encode(&[7; 16], &[0.0; 16], quality), [0; 8]);
    }
    assert_eq!(encode_range_fit(&[7; 16], 0), [0; 8]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn weights(
        texels in any::<Texels>(),
        weights in prop::array::uniform16(prop_oneof![Just(0.0_f32), Just(1.0), 0.01..100.0_f32]),
        junk: u8,
    ) {
        let mut other = texels;
        for (t, w) in other.iter_mut().zip(weights) {
            if w <= 0.0 {
                *t = junk;
            }
        }
        let [range, refined, best] = Quality::ALL.map(|q| error(&texels, &weights, encode(&texels, &weights, q)));
        let slack = 1.0 + 1e-5;
        prop_assert!(refined <= range * slack && best <= refined * slack);
        for quality in Quality::ALL {
            prop_assert_eq!(encode(&texels, &weights, quality), encode(&other, &weights, quality));
        }
    }
}
