//! Wrong `emit`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{Kernel, evaluate};

fn vec3(w: &[u32]) -> [f32; 3] {
    [float(w[0]), float(w[1]), float(w[2])]
}

/// The kernel on a changed light or other numbers.
fn instead(constants: &[u32], item: &[u32], out: &mut [u32]) {
    evaluate(Kernel::EmitLight, constants, item, out).expect("same lengths");
}

pub(crate) const MUTANTS: &[Mutant] = &[
    ("a spot's cone all alike", Kernel::EmitLight, |constants, item, out| {
        if constants[0] == 1 {
            let mut hard = constants.to_vec();
            hard[8] = hard[7];
            let flux = [out[6], out[7], out[8]];
            instead(&hard, item, out);
            out[6..].copy_from_slice(&flux);
        }
    }),
    ("the flux of a spot's whole cone", Kernel::EmitLight, |constants, _, out| {
        if constants[0] == 1 {
            for k in 0..3 {
                out[6 + k] = (float(constants[12 + k]) * std::f32::consts::TAU * (1.0 - float(constants[7])))
                    .to_bits();
            }
        }
    }),
    ("surfaces without the cosine", Kernel::EmitLight, |constants, item, out| {
        if (3..5).contains(&constants[0]) {
            let n = &constants[21..24];
            let mut basis = [0; 6];
            evaluate(Kernel::OrthonormalBasis, &[], n, &mut basis).expect("same lengths");
            let mut w = [0; 3];
            evaluate(Kernel::SampleHemisphere, &[], &item[2..], &mut w).expect("same lengths");
            let ([t, b, n], [x, y, z]) = ([vec3(&basis), vec3(&basis[3..]), vec3(n)], vec3(&w));
            for k in 0..3 {
                out[3 + k] = (t[k] * x + b[k] * y + n[k] * z).to_bits();
            }
        }
    }),
    ("photons that start on the surface", Kernel::EmitLight, |constants, item, out| {
        // A parallelogram's place without its offset.
        if constants[0] == 4 {
            let (at, e, f) = (vec3(&constants[4..]), vec3(&constants[15..]), vec3(&constants[18..]));
            for k in 0..3 {
                out[k] = (at[k] + e[k] * float(item[0]) + f[k] * float(item[1])).to_bits();
            }
        }
    }),
    ("backs that emit", Kernel::EmitLight, |constants, _, out| {
        if constants[0] >= 3 {
            for w in &mut out[3..6] {
                *w ^= 1 << 31;
            }
        }
    }),
    ("half of a point light's sphere", Kernel::EmitLight, |constants, item, out| {
        if constants[0] == 0 {
            evaluate(Kernel::SampleHemisphere, &[], &item[..2], &mut out[3..6]).expect("same lengths");
        }
    }),
    ("rays from infinity that start behind the scene", Kernel::EmitLight, |constants, _, out| {
        if constants[0] == 2 {
            let radius = float(constants[27]);
            for k in 0..3 {
                out[k] = (float(out[k]) + 2.0 * radius * float(out[3 + k])).to_bits();
            }
        }
    }),
    ("one number for place and direction", Kernel::EmitLight, |constants, item, out| {
        if constants[0] >= 3 {
            instead(constants, &[item[0], item[1], item[0], item[1]], out);
        }
    }),
    ("through the disk for through the sphere", Kernel::EmitEnvironment, |_, _, out| {
        scale(&mut out[6..], 0.25)
    }),
    ("rays towards where they come from", Kernel::EmitEnvironment, |_, _, out| {
        for w in &mut out[3..6] {
            *w ^= 1 << 31;
        }
    }),
    ("rays through the centre alone", Kernel::EmitEnvironment, |constants, item, out| {
        let middle = [item[0], item[1], 0.5_f32.to_bits(), 0.5_f32.to_bits()];
        evaluate(Kernel::EmitEnvironment, constants, &middle, out).expect("same lengths");
    }),
];
