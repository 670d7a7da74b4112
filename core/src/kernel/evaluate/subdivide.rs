//! Kernels of `subdivide`.

use super::{Reader, Shared, Writer};
use crate::direct::subdivide::{Criterion, Published, Robust, Samples, Shape, Split, Verdict};
use crate::kernel::Kernel;

pub(super) fn one(kernel: Kernel, shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    let mut c = Reader(shared.constants);
    let (relative, absolute) = (c.float(), c.float());
    let corners = [r.vec3(), r.vec3(), r.vec3()];
    let samples = Samples::all(core::array::from_fn(|_| r.float()));
    match kernel {
        Kernel::SubdividePublished => {
            let criterion = Published { relative, absolute };
            write(criterion.examine(&Shape::new(corners, 1.0), &samples, 0.0), w);
        }
        Kernel::SubdivideRobust => {
            let criterion = Robust { relative, absolute, share: c.float() };
            let verdict = criterion.examine(&Shape::new(corners, r.float()), &samples, r.float());
            write(verdict, w);
            // An accepted triangle has no errors to state: zeros.
            if let Verdict::Cut { error, rest, bend, .. } = verdict {
                w.floats([error, rest, bend]);
            }
        }
        _ => {}
    }
}

fn write(verdict: Verdict, w: &mut Writer<'_>) {
    let Verdict::Cut { split, .. } = verdict else {
        w.words([1, 0, 0, 0, 0]);
        return;
    };
    w.word(split.count() as u32);
    w.words(packed(split));
}

/// Each piece's corners, four bits each.
fn packed(split: Split) -> [u32; 4] {
    split.pieces().map(|[a, b, c]| (a | b << 4 | c << 8) as u32)
}
