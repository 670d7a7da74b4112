//! Wrong `bc1` and `bc4`.

use super::Mutant;
use etendue_core::kernel::{Kernel, evaluate};

pub(crate) const MUTANTS: &[Mutant] = &[
    ("thirds cut off instead of rounded", Kernel::Bc1Decode, |_, item, out| {
        evaluate(Kernel::Bc1DecodeWith, &[1], item, out).expect("same lengths");
        out.iter_mut().for_each(|w| *w &= 0x00ff_ffff);
    }),
    ("equal endpoints taken for four colours", Kernel::Bc1Decode, |_, item, out| {
        if item[0] & 0xffff == item[0] >> 16 {
            out.fill(out[0]);
        }
    }),
    ("red and blue exchanged", Kernel::Bc1Decode, |_, _, out| {
        for w in out {
            *w = *w << 16 & 0x00ff_0000 | *w & 0xff00 | *w >> 16;
        }
    }),
    ("black that is opaque", Kernel::Bc1DecodeWith, |_, _, out| {
        out.iter_mut().for_each(|w| *w |= 0xff00_0000);
    }),
    ("AMD's weights for NVIDIA's", Kernel::Bc1DecodeWith, |constants, item, out| {
        if constants[0] == 4 {
            evaluate(Kernel::Bc1DecodeWith, &[3], item, out).expect("same lengths");
        }
    }),
    ("texels that do not count are counted", Kernel::Bc1EncodeRangeFit, |_, item, out| {
        let mut all = item.to_vec();
        all[16] = 0xffff;
        evaluate(Kernel::Bc1EncodeRangeFit, &[], &all, out).expect("same lengths");
    }),
    ("endpoints in the order of three colours", Kernel::Bc1EncodeRangeFit, |_, _, out| {
        out[0] = out[0].rotate_left(16);
    }),
    ("the seventh value a sixth", Kernel::Bc4Decode, |_, item, out| {
        for (i, w) in out.iter_mut().enumerate() {
            let bits = (u64::from(item[0]) | u64::from(item[1]) << 32) >> 16;
            if item[0] & 255 > item[0] >> 8 & 255 && bits >> (3 * i) & 7 == 7 {
                *w = ((item[0] & 255) + 5 * (item[0] >> 8 & 255) + 3) / 6;
            }
        }
    }),
    ("the smaller endpoint first", Kernel::Bc4EncodeRangeFit, |_, _, out| {
        out[0] = out[0] & 0xffff_0000 | out[0] >> 8 & 255 | (out[0] & 255) << 8;
    }),
];
