//! Wrong `log_offset`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{self, Kernel};

pub(crate) const MUTANTS: &[Mutant] = &[
    ("x > threshold for x >= threshold", Kernel::LogOffsetEncode, |constants, item, out| {
        if constants.contains(&item[0]) {
            out[0] -= 1;
        }
    }),
    ("a logarithm good to 1e-4 only", Kernel::LogOffsetEncode, |constants, item, out| {
        let off = [(float(item[0]) * 0.9999).to_bits()];
        kernel::evaluate(Kernel::LogOffsetEncode, constants, &off, out).expect("same lengths");
    }),
    ("the search ends a step early", Kernel::LogOffsetEncode, |_, _, out| out[0] &= !1),
    ("a sign ignored", Kernel::LogOffsetEncode, |constants, item, out| {
        kernel::evaluate(Kernel::LogOffsetEncode, constants, &[item[0] & 0x7fff_ffff], out)
            .expect("same lengths");
    }),
    ("seven bits of the code", Kernel::LogOffsetLookUp, |constants, item, out| {
        out[0] = constants[(item[0] & 127) as usize];
    }),
    ("256 steps instead of 255", Kernel::LogOffsetDecode, |constants, item, out| {
        let narrower = [(float(constants[0]) * 255.0 / 256.0).to_bits(), constants[1]];
        kernel::evaluate(Kernel::LogOffsetDecode, &narrower, item, out).expect("same lengths");
    }),
    ("code 0 decodes to the least number", Kernel::LogOffsetDecode, |constants, item, out| {
        if float(item[0]) < 0.5 {
            let one = [1.0_f32.to_bits()];
            kernel::evaluate(Kernel::LogOffsetDecode, constants, &one, out).expect("same lengths");
        }
    }),
    ("sinh(h)/h with the whole step for h", Kernel::LogOffsetDecodeMean, |constants, _, out| {
        let h = float(constants[0]) / 510.0;
        scale(out, 1.0 + 0.5 * h * h);
    }),
    ("the plain decode for the mean", Kernel::LogOffsetDecodeMean, |constants, item, out| {
        kernel::evaluate(Kernel::LogOffsetDecode, constants, item, out).expect("same lengths");
    }),
    ("a whole cell at code 255", Kernel::LogOffsetDecodeMean, |constants, item, out| {
        if float(item[0]) >= 255.0 {
            kernel::evaluate(Kernel::LogOffsetDecode, constants, item, out).expect("same lengths");
            let h = float(constants[0]) / 510.0;
            scale(out, 1.0 + h * h / 6.0);
        }
    }),
];
