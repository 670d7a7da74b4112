//! Inputs of the kernels of `bc1` and `bc4`.

use super::{Batch, single};
use crate::statistics::Random;
use etendue_core::codec::bc1::Rule;
use etendue_core::kernel::Kernel;

/// Endpoints that matter: equal, next to each other, the ends of each channel, either order.
const ENDS: [u32; 12] =
    [0, 1, 0x001f, 0x0020, 0x07e0, 0x0800, 0x8410, 0x8411, 0xf800, 0xffdf, 0xfffe, 0xffff];

/// Every pair of the endpoints above with every index in use, then random blocks; a third of them with near endpoints.
fn blocks(count: usize, r: &mut Random) -> Vec<u32> {
    let mut items = Vec::new();
    for a in ENDS {
        for b in ENDS {
            items.extend([a | b << 16, 0x1b1b_e4e4]);
        }
    }
    for _ in 0..count {
        let ends = r.word();
        let near = r.below(4) << 11 | r.below(4) << 5 | r.below(4);
        let ends = if r.below(3) == 0 { ends << 16 | (ends.wrapping_add(near) & 0xffff) } else { ends };
        items.extend([ends, r.word()]);
    }
    items
}

/// Sixteen texels of `channels` bytes and what counts: ramps, two values, constants, extremes, noise around a colour.
fn texels(count: usize, r: &mut Random, channels: usize) -> Vec<u32> {
    let mut items = Vec::new();
    let mask = if channels == 3 { 0x00ff_ffff } else { 0xff };
    let gray = 0x0001_0101;
    let mut put = |texel: &mut dyn FnMut(u32) -> u32, counts: u32| {
        items.extend((0..16).map(|i| texel(i) & mask));
        items.push(counts);
    };
    for counts in [0xffff, 0, 1, 0x8000, 0x5a5a] {
        put(&mut |i| 17 * i * gray, counts);
        put(&mut |i| ((255 - 17 * i) << 8) | (17 * i), counts);
        put(&mut |i| i % 2 * 0x00ff_ffff, counts);
        put(&mut |i| (i / 8 * 0x00ff_00ff) | 0x8000, counts);
        put(&mut |_| 0x0047_8bc3, counts);
        put(&mut |i| 0x0080_8080 + i % 3, counts);
    }
    for k in 0..count {
        let (base, spread) = (r.word(), 1 << r.below(8));
        let counts = if k % 4 == 0 { r.word() & 0xffff } else { 0xffff };
        put(
            &mut |_| {
                (0..3).fold(0, |word, c| {
                    let x = (base >> (8 * c) & 255) + r.below(spread);
                    word | x.min(255) << (8 * c)
                })
            },
            counts,
        );
    }
    items
}

pub(super) fn inputs(kernel: Kernel, count: usize, r: &mut Random) -> Vec<Batch> {
    match kernel {
        Kernel::Bc1Decode | Kernel::Bc4Decode => single(blocks(count, r)),
        Kernel::Bc1DecodeWith => (0..=Rule::ALL.len() as u32)
            .map(|rule| Batch { constants: vec![rule], items: blocks(count / 6, r) })
            .collect(),
        Kernel::Bc1EncodeRangeFit => single(texels(count, r, 3)),
        Kernel::Bc4EncodeRangeFit => single(texels(count, r, 1)),
        _ => Vec::new(),
    }
}
