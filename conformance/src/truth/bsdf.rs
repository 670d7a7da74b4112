//! Scattering from its definitions.

use super::vec::{self, V};
use super::{Answer, Expect, Words, nothing, ulp, warp};
use etendue_core::kernel::Kernel;
use std::f64::consts::PI;

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;
/// Cosines within this of zero may fall on either side of the horizon.
const HORIZON: f64 = 8.0 * U;

/// A frame about n as core's convention has it (Duff et al. 2017): the truth of samples depends on it.
pub(super) fn to_world(local: V, n: V) -> V {
    let sign = 1.0_f64.copysign(n[2]);
    let a = 1.0 / (1.0 + n[2].abs());
    let b = [-sign * n[0] * n[1] * a, sign * (1.0 - n[1] * n[1] * a), -n[1]];
    let t = [1.0 - n[0] * n[0] * a, sign * b[0], -sign * n[0]];
    vec::add(vec::add(vec::mul(t, local[0]), vec::mul(b, local[1])), vec::mul(n, local[2]))
}

fn mirror(n: V, wo: V) -> V {
    vec::sub(vec::mul(n, 2.0 * vec::dot(wo, n)), wo)
}

/// Value and error scale of the Phong density: the power amplifies the rounding of its base by the exponent.
fn phong_pdf(n: V, wo: V, wi: V, exponent: f64) -> (f64, f64) {
    let cos = vec::dot(wi, mirror(n, wo)).clamp(0.0, 1.0);
    let front = (exponent + 1.0) / (2.0 * PI);
    // The base is a dot product of vectors rounded to f32: it may be off by a few U, also across 0 and 1.
    let value = if cos > 0.0 { front * cos.powf(exponent) } else { 0.0 };
    let slope = front * exponent * (cos + 4.0 * U).min(1.0).powf((exponent - 1.0).max(0.0));
    let step = if exponent < 1.0 && cos < HORIZON { front / U } else { 0.0 };
    (value, value + 4.0 * slope + step)
}

struct Lobes {
    albedo: V,
    specular: V,
    exponent: f64,
    mirror: bool,
}

impl Lobes {
    fn share(&self) -> f64 {
        let (d, s) = (self.albedo.iter().sum::<f64>(), self.specular.iter().sum::<f64>());
        if d + s > 0.0 { d / (d + s) } else { 1.0 }
    }

    fn eval(&self, n: V, wo: V, wi: V) -> [(f64, f64); 3] {
        if self.mirror || vec::dot(wi, n) <= 0.0 {
            return [(0.0, 1e-30); 3];
        }
        let (p, error) = phong_pdf(n, wo, wi, self.exponent);
        [0, 1, 2].map(|c| {
            let d = self.albedo[c] / PI;
            (d + self.specular[c] * p, d + self.specular[c] * error)
        })
    }

    fn pdf(&self, n: V, wo: V, wi: V) -> (f64, f64) {
        if self.mirror {
            return (0.0, 1e-30);
        }
        let share = if self.specular == [0.0; 3] { 1.0 } else { self.share() };
        let d = vec::dot(wi, n).max(0.0) / PI;
        let (p, error) = if share < 1.0 { phong_pdf(n, wo, wi, self.exponent) } else { (0.0, 0.0) };
        (share * d + (1.0 - share) * p, share + (1.0 - share) * error)
    }
}

fn lobes(r: &mut Words<'_>) -> Lobes {
    Lobes { albedo: r.vec3(), specular: r.vec3(), exponent: r.real(), mirror: r.word() != 0 }
}

fn pairs(list: &[(f64, f64)]) -> Answer {
    Answer::Is(list.iter().map(|(x, s)| Expect::Scaled(*x, s.max(1e-30))).collect())
}

/// The side of the horizon that f32 sees is not decided.
fn grazing(n: V, w: V) -> bool {
    let cos = vec::dot(n, w);
    cos != 0.0 && cos.abs() <= HORIZON
}

pub(super) fn truth(kernel: Kernel, r: &mut Words<'_>) -> Answer {
    use Kernel as K;
    match kernel {
        K::EvalDiffuse => {
            let (albedo, n, wi) = (r.vec3(), r.vec3(), r.vec3());
            if grazing(n, wi) {
                return Answer::Undecided;
            }
            let up = if vec::dot(n, wi) > 0.0 { 1.0 } else { 0.0 };
            Answer::Is(albedo.map(|a| Expect::Ulp(up * a / PI)).to_vec())
        }
        K::PdfDiffuse => {
            let (n, wi) = (r.vec3(), r.vec3());
            pairs(&[(vec::dot(n, wi).max(0.0) / PI, 1.0)])
        }
        K::SampleDiffuse => {
            let n = r.vec3();
            let local = warp::cosine_hemisphere([r.real(), r.real()]);
            Answer::Is(to_world(local, n).map(|x| Expect::Scaled(x, 1.0)).to_vec())
        }
        K::EvalPhong => {
            let (specular, exponent, n, wo, wi) = (r.vec3(), r.real(), r.vec3(), r.vec3(), r.vec3());
            if grazing(n, wi) {
                return Answer::Undecided;
            }
            let l = Lobes { albedo: [0.0; 3], specular, exponent, mirror: false };
            pairs(&l.eval(n, wo, wi))
        }
        K::PdfPhong => {
            let (exponent, n, wo, wi) = (r.real(), r.vec3(), r.vec3(), r.vec3());
            pairs(&[phong_pdf(n, wo, wi, exponent)])
        }
        K::SamplePhong => {
            let (exponent, n, wo) = (r.real(), r.vec3(), r.vec3());
            let axis = mirror(n, wo);
            if axis[2].abs() <= HORIZON && axis[2] != 0.0 {
                // The frame jumps across z = 0.
                return Answer::Undecided;
            }
            let w = to_world(warp::power_cosine([r.real(), r.real()], exponent), axis);
            Answer::Is(w.map(|x| Expect::Scaled(x, 1.0)).to_vec())
        }
        K::EvalLobes => {
            let (l, n, wo, wi) = (lobes(r), r.vec3(), r.vec3(), r.vec3());
            if grazing(n, wi) {
                return Answer::Undecided;
            }
            pairs(&l.eval(n, wo, wi))
        }
        K::PdfLobes => {
            let (l, n, wo, wi) = (lobes(r), r.vec3(), r.vec3(), r.vec3());
            pairs(&[l.pdf(n, wo, wi)])
        }
        K::SampleLobes => sample_lobes(&lobes(r), r),
        _ => ulp(f64::NAN),
    }
}

fn sample_lobes(l: &Lobes, r: &mut Words<'_>) -> Answer {
    let (n, wo, u, lobe) = (r.vec3(), r.vec3(), [r.real(), r.real()], r.real());
    let axis = mirror(n, wo);
    if l.mirror {
        if grazing(n, axis) {
            return Answer::Undecided;
        }
        if vec::dot(n, axis) <= 0.0 {
            return nothing(8);
        }
        let mut out = vec![Expect::Word(1)];
        out.extend(axis.map(|x| Expect::Scaled(x, 1.0)));
        out.extend(l.albedo.map(Expect::Ulp));
        out.push(Expect::Word(0));
        return Answer::Is(out);
    }
    let share = if l.specular == [0.0; 3] { 1.0 } else { l.share() };
    if (lobe - share).abs() <= 4.0 * U && share < 1.0 {
        return Answer::Undecided;
    }
    let wi = if lobe < share {
        to_world(warp::cosine_hemisphere(u), n)
    } else {
        if axis[2].abs() <= HORIZON && axis[2] != 0.0 {
            return Answer::Undecided;
        }
        to_world(warp::power_cosine(u, l.exponent), axis)
    };
    let cos = vec::dot(n, wi);
    if grazing(n, wi) {
        return Answer::Undecided;
    }
    if cos <= 0.0 {
        return nothing(8);
    }
    let (pdf, pdf_error) = l.pdf(n, wo, wi);
    let f = l.eval(n, wo, wi);
    let mut out = vec![Expect::Word(1)];
    out.extend(wi.map(|x| Expect::Scaled(x, 1.0)));
    for (value, error) in f {
        let weight = value * cos / pdf;
        // Relative errors of f, of the cosine and of the density add.
        let relative = error / value.max(1e-30) + 1.0 / cos + pdf_error / pdf;
        out.push(Expect::Scaled(weight, (weight * relative).max(1e-30)));
    }
    out.push(Expect::Scaled(pdf, pdf_error));
    Answer::Is(out)
}
