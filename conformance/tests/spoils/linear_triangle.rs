//! Wrong `linear_triangle`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{Kernel, evaluate};

pub(crate) const MUTANTS: &[Mutant] = &[
    ("a uniform point", Kernel::SampleLinearTriangle, |_, item, out| {
        evaluate(Kernel::SampleTriangle, &[], &item[3..], out).expect("same lengths");
    }),
    ("the segment uniform", Kernel::SampleLinearTriangle, |_, item, out| {
        let mut flat = item.to_vec();
        // Equal weights leave the second number as it is.
        flat[0..3].fill(1.0_f32.to_bits());
        let mut b = [0; 3];
        evaluate(Kernel::SampleLinearTriangle, &[], &flat, &mut b).expect("same lengths");
        (out[1], out[2]) = (b[1], b[2]);
    }),
    ("the other vertex of equal ones as apex", Kernel::SampleLinearTriangle, |_, item, out| {
        if item[0] == item[1] {
            out.swap(0, 1);
        }
    }),
    ("the complement as a difference", Kernel::LinearTriangleDistance, |_, _, out| {
        out[2] = (1.0 - float(out[1])).to_bits();
    }),
    ("the square root alone", Kernel::LinearTriangleDistance, |_, item, out| {
        let s = float(item[3]).sqrt();
        (out[1], out[2]) = (s.to_bits(), (1.0 - s).to_bits());
    }),
    ("the density per vertex, not per mean", Kernel::PdfLinearTriangle, |_, _, out| scale(out, 1.0 / 3.0)),
    ("a density outside", Kernel::PdfLinearTriangle, |_, _, out| {
        out[0] = (float(out[0]) + 1e-6).to_bits();
    }),
    ("the two numbers exchanged", Kernel::InvertLinearTriangle, |_, _, out| out.swap(0, 1)),
    ("the segment walked the other way", Kernel::InvertLinearTriangle, |_, _, out| {
        out[1] = (1.0 - float(out[1])).to_bits();
    }),
];
