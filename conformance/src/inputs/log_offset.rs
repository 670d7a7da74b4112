//! Inputs of the kernels of `log_offset`.

use super::{Batch, put};
use crate::statistics::Random;
use etendue_core::codec::log_offset::{LogOffset, MAX_WIDTH, MIN_WIDTH};
use etendue_core::kernel::Kernel;

/// Width and largest number: the published map, fitted ones, the narrowest, the widest, a matrix of zeros.
const PARAMETERS: [(f32, f32); 7] = [
    (25.0, 1.0),
    (25.0, 0.218_37),
    (11.5, 0.731),
    (1.0, 1.999_999_9),
    (MIN_WIDTH, 3.0),
    (MAX_WIDTH, 3.0e38),
    (25.0, 0.0),
];

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    let each = count / PARAMETERS.len();
    let map = |width, max| LogOffset::try_new(width, max).expect("the parameters are valid");
    PARAMETERS
        .iter()
        .map(|&(width, max)| match kernel {
            Kernel::LogOffsetEncode => encode(&map(width, max), each, r),
            Kernel::LogOffsetLookUp => look_up(&map(width, max), each, r),
            _ => levels(width, max, each, r),
        })
        .collect()
}

/// Each threshold and its neighbours; what lies outside the range; numbers spread evenly in the logarithm.
fn encode(map: &LogOffset, count: usize, r: &mut Random) -> Batch {
    let mut batch = Batch::default();
    put(&mut batch.constants, map.thresholds());
    let max = map.max();
    put(&mut batch.items, &[0.0, -0.0, -1.0, -max, f32::MIN, f32::MAX, f32::MIN_POSITIVE, f32::from_bits(1)]);
    put(&mut batch.items, &[max, max.next_up(), 2.0, 1e30]);
    for t in map.thresholds() {
        put(&mut batch.items, &[t.next_down(), *t, -*t]);
        if *t < f32::MAX {
            put(&mut batch.items, &[t.next_up()]);
        }
    }
    for _ in 0..count {
        let x = f64::from(max) * (-r.range(-0.01, 1.05) * f64::from(map.width())).exp();
        put(&mut batch.items, &[x.min(f64::from(f32::MAX)) as f32]);
    }
    batch
}

fn look_up(map: &LogOffset, count: usize, r: &mut Random) -> Batch {
    let mut batch = Batch::default();
    put(&mut batch.constants, map.clone().mean_preserving().values());
    batch.items.extend(0..=255);
    batch.items.extend((0..count).map(|_| r.word()));
    batch
}

/// All codes, the edges of cells and of the range, and levels between.
fn levels(width: f32, max: f32, count: usize, r: &mut Random) -> Batch {
    let mut batch = Batch::default();
    put(&mut batch.constants, &[width, max]);
    for code in 0..=255_u8 {
        put(&mut batch.items, &[f32::from(code), f32::from(code) + 0.5]);
    }
    let half = 0.5_f32;
    put(&mut batch.items, &[half.next_down(), half, half.next_up(), -0.0, -3.0, 254.5_f32.next_up(), 1e30]);
    for _ in 0..count {
        put(&mut batch.items, &[r.range(0.0, 256.0) as f32]);
    }
    batch
}
