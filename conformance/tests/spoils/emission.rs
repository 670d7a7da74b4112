//! Wrong `emission`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{self, Kernel};

/// The same kernel on another item.
fn instead(kernel: Kernel, constants: &[u32], item: &[u32], out: &mut [u32]) {
    kernel::evaluate(kernel, constants, item, out).expect("same lengths");
}

pub(crate) const MUTANTS: &[Mutant] = &[
    ("the area of the parallelogram", Kernel::EmissionCoefficient, |_, _, out| scale(out, 2.0)),
    ("the brightest vertex for the mean", Kernel::EmissionCoefficient, |_, item, out| {
        for c in 0..3 {
            let light = [12 + c, 15 + c, 18 + c].map(|i| float(item[i]));
            let (albedo, area) = (float(item[9 + c]), float(out[3]));
            out[c] = (albedo * area * light[0].max(light[1]).max(light[2])).to_bits();
        }
    }),
    ("a cross product of rounded edges and products", Kernel::EmissionCoefficient, |_, item, out| {
        let v = |i: usize| [0, 1, 2].map(|k| float(item[3 * i + k]));
        let [a, b, c] = [v(0), v(1), v(2)];
        let (e, f) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let x = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        out[3] = (0.5 * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt()).to_bits();
    }),
    ("the bounding box for the triangle", Kernel::EmissionOverlap, |_, item, out| {
        let side = |k: usize| {
            let x = [0, 2, 4].map(|i| float(item[i + k]));
            let (low, high) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
            if high > low { (high.min(1.0) - low.max(0.0)).max(0.0) / (high - low) } else { 1.0 }
        };
        out[0] = (side(0) * side(1)).to_bits();
    }),
    ("the middle of the triangle for the overlap's", Kernel::EmissionOverlap, |_, _, out| {
        if float(out[0]) > 0.0 {
            out[1..].fill((1.0_f32 / 3.0).to_bits());
        }
    }),
    ("constant texels for filtered ones", Kernel::EmissionScan, |constants, item, out| {
        instead(Kernel::EmissionScanTexels, constants, item, out);
    }),
    ("the means without the irradiance", Kernel::EmissionScan, |_, _, out| {
        for c in 0..3 {
            let mean = (float(out[1 + c]) + float(out[4 + c]) + float(out[7 + c])) / 3.0;
            [1, 4, 7].into_iter().for_each(|k| out[k + c] = mean.to_bits());
        }
    }),
    ("rows upwards", Kernel::EmissionScanTexels, |constants, item, out| {
        let mut turned = item.to_vec();
        [1, 3, 5].into_iter().for_each(|k| turned[k] ^= 1 << 31);
        instead(Kernel::EmissionScanTexels, constants, &turned, out);
    }),
    ("texel centres at integers", Kernel::EmissionScanTexels, |constants, item, out| {
        let mut moved = item.to_vec();
        for (i, w) in moved.iter_mut().enumerate() {
            *w = (float(*w) + 0.5 / constants[i % 2] as f32).to_bits();
        }
        instead(Kernel::EmissionScanTexels, constants, &moved, out);
    }),
    ("a bound that forgets the filter's neighbours", Kernel::EmissionBrightest, |constants, item, out| {
        // The brightest of the texels at the three vertices.
        let (w, h) = (constants[0] as i64, constants[1] as i64);
        let mut largest = [0_u32; 3];
        for p in item.chunks_exact(2) {
            let x = (float(p[0]) * w as f32).floor() as i64;
            let y = (-float(p[1]) * h as f32).floor() as i64;
            let texel = constants[2 + (y.rem_euclid(h) * w + x.rem_euclid(w)) as usize];
            for (c, l) in largest.iter_mut().enumerate() {
                *l = (*l).max(texel >> (8 * c) & 255);
            }
        }
        for (o, l) in out.iter_mut().zip(largest) {
            let mut linear = [0];
            instead(Kernel::SrgbDecode, &[], &[l], &mut linear);
            *o = linear[0];
        }
    }),
];
