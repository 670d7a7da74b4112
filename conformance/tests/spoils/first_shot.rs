//! Wrong `first_shot`.

use super::{Mutant, float, scale};
use etendue_core::kernel::{Kernel, evaluate};

/// The same kernel on another item.
fn instead(kernel: Kernel, item: &[u32], out: &mut [u32]) {
    evaluate(kernel, &[], item, out).expect("same lengths");
}

/// The irradiance with the largest channel in each: what a mean taken for the maximum sees.
fn brightest(item: &[u32]) -> f32 {
    float(item[0]).max(float(item[1])).max(float(item[2]))
}

pub(crate) const MUTANTS: &[Mutant] = &[
    ("a uniform place on the piece", Kernel::StartPlace, |_, item, out| {
        let mut flat = item.to_vec();
        flat[6..9].fill(1.0_f32.to_bits());
        instead(Kernel::StartPlace, &flat, out);
    }),
    ("weights of other corners", Kernel::StartPlace, |_, item, out| {
        let mut turned = item.to_vec();
        turned[6..9].rotate_left(1);
        instead(Kernel::StartPlace, &turned, out);
    }),
    ("the piece taken for the triangle", Kernel::StartPlace, |_, item, out| {
        evaluate(Kernel::SampleLinearTriangle, &[], &item[6..], out).expect("same lengths");
    }),
    ("pieces turned over count", Kernel::StartWithin, |_, item, out| {
        if out[0] == 0 {
            let mut turned = item.to_vec();
            turned[..6].rotate_left(2);
            turned.swap(0, 2);
            turned.swap(1, 3);
            instead(Kernel::StartWithin, &turned, out);
        }
    }),
    ("corners exchanged", Kernel::StartWithin, |_, _, out| out.swap(2, 3)),
    ("the triangle's barycentrics for the piece's", Kernel::StartWithin, |_, item, out| {
        if out[0] == 1 {
            (out[2], out[3]) = (item[6], item[7]);
            out[1] = (1.0 - float(item[6]) - float(item[7])).to_bits();
        }
    }),
    ("the chance of the piece forgotten", Kernel::StartDensity, |_, item, out| {
        if float(out[0]) < 1e30 {
            scale(out, 1.0 / float(item[10]));
        }
    }),
    ("the area of the parallelogram", Kernel::StartDensity, |_, _, out| scale(out, 0.5)),
    ("the mean density of the piece", Kernel::StartDensity, |_, item, out| {
        if float(out[0]) > 0.0 {
            out[0] = (float(item[10]) / float(item[9])).to_bits();
        }
    }),
    ("no density just beyond the edge", Kernel::StartDensity, |_, item, out| {
        let mut local = [0; 4];
        evaluate(Kernel::StartWithin, &[], &[&item[..6], &item[11..]].concat(), &mut local)
            .expect("same lengths");
        if local[1..].iter().any(|l| float(*l) < 0.0) {
            out[0] = 0;
        }
    }),
    ("a density far beyond the edge", Kernel::StartDensity, |_, item, out| {
        if out[0] == 0 && float(item[9]) > 1e-6 {
            out[0] = (float(item[10]) / float(item[9])).to_bits();
        }
    }),
    ("a density of NaN without area", Kernel::StartDensity, |_, item, out| {
        if float(item[9]).is_nan() || float(item[9]) <= 0.0 {
            out[0] = f32::NAN.to_bits();
        }
    }),
    ("the brightest channel for the mean", Kernel::StartFlux, |_, item, out| {
        let all = float(item[3]) + float(item[4]) * brightest(item);
        for k in 0..3 {
            out[k] = (float(item[k]) / all).to_bits();
        }
    }),
    ("the light's own photons forgotten", Kernel::StartFlux, |_, item, out| {
        let mut alone = item.to_vec();
        alone[4] = 0;
        instead(Kernel::StartFlux, &alone, out);
    }),
    ("the chance per watt without the irradiance", Kernel::StartFlux, |_, item, out| {
        for k in 0..3 {
            out[k] = (float(item[k]) / (float(item[3]) + float(item[4]))).to_bits();
        }
    }),
    ("nothing over nothing", Kernel::StartFlux, |_, item, out| {
        if item[3] == 0 && item[4] == 0 {
            out[..3].fill(f32::NAN.to_bits());
        }
    }),
    ("the power heuristic", Kernel::LightShare, |_, item, out| {
        let share = float(out[0]);
        let (a, b) = (share * share, (1.0 - share) * (1.0 - share));
        if item[3] != 0 {
            out[0] = (a / (a + b)).to_bits();
        }
    }),
    ("the share of the pieces", Kernel::LightShare, |_, _, out| out[0] = (1.0 - float(out[0])).to_bits()),
    ("the brightest channel for the share", Kernel::LightShare, |_, item, out| {
        let light = float(item[4]) * brightest(item);
        out[0] = (light / (light + float(item[3]))).to_bits();
    }),
    ("lost where nothing else starts", Kernel::LightShare, |_, item, out| {
        if item[3] == 0 && (item[4] == 0 || item[..3] == [0; 3]) {
            out[0] = 0;
        }
    }),
    ("the sign of a hidden light's factor", Kernel::LookFactor, |_, item, out| {
        if item[1] != 0 {
            scale(out, -1.0);
        }
    }),
    ("nothing where the light is hidden", Kernel::LookFactor, |_, item, out| {
        if item[1] != 0 {
            out[0] = 0;
        }
    }),
    ("looks that saw the light count more", Kernel::LookFactor, |_, item, out| {
        if item[1] == 0 {
            out[0] = (1.0 / float(item[0])).to_bits();
        }
    }),
    ("without the chance of the piece", Kernel::PieceFlux, |_, item, out| scale(out, float(item[7]))),
    ("the sum of the corners", Kernel::PieceFlux, |_, _, out| scale(out, 3.0)),
    ("the light without its colour", Kernel::PieceFlux, |_, item, out| {
        let mut white = item.to_vec();
        white[..3].fill(1.0_f32.to_bits());
        instead(Kernel::PieceFlux, &white, out);
    }),
];
