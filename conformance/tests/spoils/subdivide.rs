//! Wrong `subdivide`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{Kernel, evaluate};

/// The answer to another item.
fn again(kernel: Kernel, constants: &[u32], item: &[u32], out: &mut [u32]) {
    evaluate(kernel, constants, item, out).expect("same lengths");
}

pub(crate) const MUTANTS: &[Mutant] = &[
    ("cut in three where an angle is obtuse", Kernel::SubdividePublished, |_, _, out| {
        if out[0] == 2 {
            out.copy_from_slice(&[3, 0x610, 0x621, 0x602, 0]);
        }
    }),
    ("the other half first", Kernel::SubdividePublished, |_, _, out| {
        if out[0] == 2 {
            out.swap(1, 2);
        }
    }),
    ("the centroid compared with one corner", Kernel::SubdividePublished, |constants, item, out| {
        let mut one = item.to_vec();
        (one[10], one[11]) = (item[9], item[9]);
        again(Kernel::SubdividePublished, constants, &one, out);
    }),
    ("the tolerance without the largest sample", Kernel::SubdividePublished, |constants, item, out| {
        if float(constants[0]) > 0.0 {
            again(Kernel::SubdividePublished, &[0, constants[0]], item, out);
        }
    }),
    ("the median's mend in the published rule", Kernel::SubdividePublished, |constants, item, out| {
        // (la + 2 le)/3 in place of (la + le)/2, for A the first corner: the value of le that gives it.
        let (a, e) = (float(item[9]), float(item[12]));
        let mut mended = item.to_vec();
        mended[12] = ((4.0 * e - a) / 3.0).to_bits();
        again(Kernel::SubdividePublished, constants, &mended, out);
    }),
    ("edge midpoints not looked at", Kernel::SubdivideRobust, |constants, item, out| {
        let mut blind = item.to_vec();
        for i in 0..3 {
            let ends = float(item[9 + (i + 1) % 3]) + float(item[9 + (i + 2) % 3]);
            blind[12 + i] = (0.5 * ends).to_bits();
        }
        again(Kernel::SubdivideRobust, constants, &blind, out);
    }),
    ("slim triangles cut as others are", Kernel::SubdivideRobust, |_, _, out| {
        // Of a fan the second piece ends at the midpoint opposite the first corner.
        if out[0] == 4 && (out[2] >> 8) as usize == 3 + (out[1] & 15) as usize {
            out[..5].copy_from_slice(&[4, 0x450, 0x531, 0x342, 0x435]);
        }
    }),
    ("always in four", Kernel::SubdivideRobust, |_, _, out| {
        if out[0] == 2 {
            out[..5].copy_from_slice(&[4, 0x450, 0x531, 0x342, 0x435]);
        }
    }),
    ("the error of edges added up without their product", Kernel::SubdivideRobust, |_, _, out| {
        scale(&mut out[5..6], 0.866);
    }),
    ("a smooth field's pieces no better than itself", Kernel::SubdivideRobust, |_, _, out| {
        out[6] = out[5];
    }),
    ("rough fields trusted", Kernel::SubdivideRobust, |_, _, out| {
        out[7] = out[6];
    }),
];
