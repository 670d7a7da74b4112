//! Codes and numbers of slices equal core's, in any registers and at any length.

use etendue_core::codec::log_offset::{LogOffset, LogOffsetError, Quantiser};
use etendue_cpu::log_offset::{decode, encode};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn slices_equal_single_calls(
        width in 0.0625_f32..87.0,
        bits in prop::collection::vec(any::<u32>(), 0..100),
        mode in 0..3_u8,
    ) {
        let map = LogOffset::try_new(width, 1.5).unwrap().mean_preserving();
        // Any floats; or thresholds and their neighbours.
        let values: Vec<f32> = bits
            .iter()
            .map(|b| match mode {
                0 => f32::from_bits(*b),
                1 => f32::from_bits(b & 0x3fff_ffff),
                _ => f32::from_bits(map.thresholds()[(b >> 8) as usize % 255].to_bits() + b % 3 - 1),
            })
            .collect();
        let (mut codes, mut back) = (vec![77; values.len()], vec![7.0; values.len()]);
        encode(&map, &values, &mut codes).unwrap();
        decode(&map, &codes, &mut back).unwrap();
        for ((x, code), y) in values.iter().zip(&codes).zip(&back) {
            prop_assert_eq!(*code, map.encode_by_search(*x), "{:e}", x);
            prop_assert_eq!(y.to_bits(), map.decode(*code).to_bits());
        }
    }
}

#[test]
fn lengths_must_agree() {
    let map = LogOffset::published(1.0).unwrap();
    let error = Err(LogOffsetError::Lengths { values: 20, codes: 19 });
    assert_eq!(encode(&map, &[1.0; 20], &mut [0; 19]), error);
    assert_eq!(decode(&map, &[1; 19], &mut [0.0; 20]), error);
}
