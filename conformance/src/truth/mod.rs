//! What a kernel should answer: second implementations in f64, written from the definitions and not from core.
//!
//! The truth takes the f32 inputs as exact numbers. Where an answer hangs on a comparison that f32 cannot decide (a ray
//! within rounding of an edge), the truth is [`Answer::Undecided`] and the case is counted as such; exactly
//! representable edges are decided.

#![allow(clippy::disallowed_methods, reason = "truth in f64")]

mod bc1;
mod bsdf;
pub mod emission;
mod emit;
pub mod empty_box;
mod facets;
mod first_shot;
mod geometry;
mod grid;
mod light;
mod linear_triangle;
mod log_offset;
mod media;
mod polynomial;
mod sampling;
mod subdivide;
pub(crate) mod vec;
mod warp;

use etendue_core::kernel::Kernel;

/// What one output word should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expect {
    /// Exactly this word.
    Word(u32),
    /// This number; errors count in ulp of f32 at it.
    Ulp(f64),
    /// This number; errors count in units of 2^-24 of the second one (what the input's rounding can amount to).
    Scaled(f64, f64),
    /// This number or less, never more; below it errors count in units of 2^-24 of the second one.
    AtMost(f64, f64),
    /// This number modulo 1; errors count in units of 2^-24.
    Turn(f64),
    /// Anything finite.
    Finite,
}

/// The truth for one item.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// One expectation per output word.
    Is(Vec<Expect>),
    /// f32 cannot decide; any answer without NaN will do.
    Undecided,
}

/// Reads typed numbers from words, as exact f64.
pub(crate) struct Words<'a> {
    rest: &'a [u32],
    /// One of the numbers that were read is subnormal.
    subnormal: bool,
}

impl<'a> Words<'a> {
    pub(crate) fn new(words: &'a [u32]) -> Self {
        Self { rest: words, subnormal: false }
    }
    pub(crate) fn word(&mut self) -> u32 {
        let (first, rest) = self.rest.split_first().expect("inputs are as long as the kernel's shape says");
        self.rest = rest;
        *first
    }
    pub(crate) fn real(&mut self) -> f64 {
        let x = f32::from_bits(self.word());
        self.subnormal |= x.is_subnormal();
        f64::from(x)
    }
    /// All that is left.
    pub(crate) fn rest(self) -> &'a [u32] {
        self.rest
    }
    pub(crate) fn vec3(&mut self) -> vec::V {
        [self.real(), self.real(), self.real()]
    }
}

/// A flag and zeros: "nothing".
fn nothing(words: usize) -> Answer {
    Answer::Is(vec![Expect::Word(0); words])
}

fn ulp(x: f64) -> Answer {
    Answer::Is(vec![Expect::Ulp(x)])
}

fn scaled<const N: usize>(values: [f64; N], scale: f64) -> Vec<Expect> {
    values.map(|x| Expect::Scaled(x, scale)).to_vec()
}

/// The truth of a kernel for one item, and whether a number of the item is subnormal.
pub fn truth(kernel: Kernel, constants: &[u32], item: &[u32]) -> (Answer, bool) {
    let mut r = Words::new(item);
    let answer = answer(kernel, constants, &mut r);
    (answer, r.subnormal)
}

fn answer(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    use Kernel as K;
    match kernel {
        K::Ln => ulp(r.real().ln()),
        K::Log2 => ulp(r.real().log2()),
        K::Exp => ulp(r.real().exp()),
        K::Exp2 => ulp(r.real().exp2()),
        K::Pow => ulp(r.real().powf(r.real())),
        K::SinCos => {
            let (s, c) = r.real().sin_cos();
            Answer::Is(vec![Expect::Ulp(s), Expect::Ulp(c)])
        }
        K::Acos => ulp(r.real().acos()),
        K::Asin => ulp(r.real().asin()),
        K::Atan2 => ulp(r.real().atan2(r.real())),
        K::Cbrt => ulp(r.real().cbrt()),
        K::Sqrt => ulp(r.real().sqrt()),
        K::NormalizeOr => {
            let (v, fallback) = (r.vec3(), r.vec3());
            let w = if vec::largest(v) > 0.0 { vec::unit(v) } else { fallback };
            Answer::Is(w.map(Expect::Ulp).to_vec())
        }
        K::OrthonormalBasis => basis(r.vec3()),
        K::Triangle | K::Slab | K::RoundShape | K::OffsetOrigin => geometry::truth(kernel, r),
        K::EvalDiffuse
        | K::PdfDiffuse
        | K::SampleDiffuse
        | K::EvalPhong
        | K::PdfPhong
        | K::SamplePhong
        | K::EvalLobes
        | K::PdfLobes
        | K::SampleLobes => bsdf::truth(kernel, r),
        K::FacetsDensity | K::FacetsMasking | K::PdfVisible | K::SampleVisible => facets::truth(kernel, r),
        K::EvalPhase | K::SamplePhase | K::Transmittance | K::FresnelDielectric | K::FresnelConductor => {
            media::truth(kernel, r)
        }
        K::SampleLight | K::PdfLight | K::PowerHeuristic | K::CameraRay | K::ToneDisplay => {
            light::truth(kernel, constants, r)
        }
        K::GridAt | K::GridOpticalLength => grid::truth(kernel, constants, r),
        K::SrgbDecode | K::SampleBitmap => light::image(kernel, constants, r),
        K::U32ToUnit
        | K::CounterBits4
        | K::SobolBits4
        | K::SobolSet
        | K::CdfPick
        | K::CdfPmf
        | K::EvenWord => sampling::truth(kernel, constants, r),
        _ => match kernel.module() {
            "linear_triangle" => linear_triangle::truth(kernel, constants, r),
            "emission" => emission::truth(kernel, constants, r),
            "subdivide" => subdivide::truth(kernel, constants, r),
            "log_offset" => log_offset::truth(kernel, constants, r),
            "bc1" | "bc4" => bc1::truth(kernel, constants, r),
            "polynomial" => polynomial::truth(kernel, constants, r),
            "first_shot" => first_shot::truth(kernel, constants, r),
            "emit" => emit::truth(kernel, constants, r),
            _ => warp::truth(kernel, constants, r),
        },
    }
}

/// Duff et al. 2017, from the definition: the reflection of the x and y axes that takes +-z to n.
fn basis(n: vec::V) -> Answer {
    let sign = 1.0_f64.copysign(n[2]);
    let a = 1.0 / (1.0 + n[2].abs());
    let b = [-sign * n[0] * n[1] * a, sign * (1.0 - n[1] * n[1] * a), -n[1]];
    let t = [1.0 - n[0] * n[0] * a, sign * b[0], -sign * n[0]];
    Answer::Is(t.iter().chain(&b).map(|x| Expect::Scaled(*x, 1.0)).collect())
}

/// Error of `got` against an expectation, in the expectation's unit; infinite where nothing is right about it.
pub fn error(expect: Expect, got: u32) -> f64 {
    let x = f32::from_bits(got);
    let finite = |e: f64| if e.is_nan() { f64::INFINITY } else { e };
    match expect {
        Expect::Word(w) => {
            if got == w {
                0.0
            } else {
                f64::INFINITY
            }
        }
        Expect::Ulp(t) => {
            let nearest = t as f32;
            if nearest.is_infinite() || x.is_infinite() {
                return if x == nearest { 0.0 } else { f64::INFINITY };
            }
            if t.is_nan() {
                return if x.is_nan() { 0.0 } else { f64::INFINITY };
            }
            finite((f64::from(x) - t).abs() / ulp_at(t))
        }
        Expect::Scaled(t, scale) => {
            let e = (f64::from(x) - t).abs();
            if e == 0.0 { 0.0 } else { finite(e / (scale / 16_777_216.0)) }
        }
        Expect::AtMost(t, scale) => {
            let below = t - f64::from(x);
            if below >= 0.0 { finite(below / (scale / 16_777_216.0)) } else { f64::INFINITY }
        }
        Expect::Turn(t) => {
            let e = (f64::from(x) - t).abs();
            finite(e.min((1.0 - e).abs()) * 16_777_216.0)
        }
        Expect::Finite => {
            if x.is_finite() {
                0.0
            } else {
                f64::INFINITY
            }
        }
    }
}

/// Distance of the two f32 neighbours of `t` (2^-149 below 2^-126).
pub fn ulp_at(t: f64) -> f64 {
    let exponent = ((t.abs().to_bits() >> 52) as i32 - 1023).max(-126);
    2.0_f64.powi(exponent - 23)
}
