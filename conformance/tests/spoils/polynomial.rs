//! Wrong `polynomial`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{self, Kernel};

/// The kernel once more, with other constants.
fn again(kernel: Kernel, constants: &[u32], item: &[u32], out: &mut [u32]) {
    kernel::evaluate(kernel, constants, item, out).expect("same lengths");
}

pub(crate) const MUTANTS: &[Mutant] = &[
    ("the last lane left out", Kernel::PolynomialDot, |_, item, out| {
        let mut short = item.to_vec();
        (short[15], short[31]) = (0, 0);
        again(Kernel::PolynomialDot, &[], &short, out);
    }),
    ("one lane of half precision", Kernel::PolynomialDot, |_, item, out| {
        let mut rough = item.to_vec();
        rough[3] &= !0x1fff;
        again(Kernel::PolynomialDot, &[], &rough, out);
    }),
    ("rows for columns", Kernel::PolynomialApply, |constants, item, out| {
        let n = constants[0].min(8) as usize;
        let mut turned = constants.to_vec();
        for i in 0..n {
            for j in 0..n {
                turned[1 + i * n + j] = constants[1 + j * n + i];
            }
        }
        again(Kernel::PolynomialApply, &turned, item, out);
    }),
    ("a patch too few", Kernel::PolynomialApply, |constants, _, out| {
        if let Some(last) = (constants[0].min(8) as usize).checked_sub(1) {
            out[last] = 0;
        }
    }),
    ("only the lower half", Kernel::PolynomialApplyHalf, |_, _, out| {
        // What patch 0 receives comes from the upper half alone.
        out[0] = 0;
    }),
    ("areas not divided by", Kernel::PolynomialApplyHalf, |constants, _, out| {
        for (out, area) in out.iter_mut().zip(&constants[1..]) {
            *out = (float(*out) * float(*area)).to_bits();
        }
    }),
    ("a bounce too few", Kernel::PolynomialSeries, |constants, item, out| {
        let mut fewer = constants.to_vec();
        fewer[1] = fewer[1].saturating_sub(1);
        again(Kernel::PolynomialSeries, &fewer, item, out);
    }),
    ("the last power alone", Kernel::PolynomialSeries, |constants, item, out| {
        let mut fewer = constants.to_vec();
        fewer[1] = fewer[1].saturating_sub(1);
        let mut before = vec![0; out.len()];
        again(Kernel::PolynomialSeries, &fewer, item, &mut before);
        for (out, before) in out.iter_mut().zip(before) {
            *out = (float(*out) - float(before)).to_bits();
        }
    }),
    ("a part in a million lost", Kernel::PolynomialSeries, |_, _, out| scale(out, 1.0 - 4e-6)),
];
