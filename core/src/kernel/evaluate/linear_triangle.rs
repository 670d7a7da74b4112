//! Kernels of `linear_triangle`.

use super::{Reader, Shared, Writer};
use crate::kernel::Kernel;
use crate::sampling::linear_triangle;

pub(super) fn one(kernel: Kernel, _shared: &Shared<'_>, mut r: Reader<'_>, w: &mut Writer<'_>) {
    let weights = r.vec3().to_array();
    match kernel {
        Kernel::SampleLinearTriangle => w.floats(linear_triangle::sample(weights, r.pair())),
        Kernel::PdfLinearTriangle => w.float(linear_triangle::pdf(weights, r.vec3().to_array())),
        Kernel::InvertLinearTriangle => w.floats(linear_triangle::invert(weights, r.vec3().to_array())),
        Kernel::LinearTriangleDistance => {
            let d = linear_triangle::apex_distance(weights, r.float());
            w.word(d.apex as u32);
            w.floats([d.distance, d.complement]);
        }
        _ => {}
    }
}
