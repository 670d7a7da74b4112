//! Light samples, weights, camera rays and images, from their definitions.

use super::bsdf::to_world;
use super::vec::{self, V};
use super::{Answer, Expect, Words, nothing, scaled, ulp, warp};
use etendue_core::kernel::Kernel;
use std::f64::consts::PI;

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;

/// A `LightRecord` in f64.
pub(super) struct Light {
    pub(super) kind: u32,
    pub(super) pmf: f64,
    pub(super) area: f64,
    pub(super) point: V,
    pub(super) params: [f64; 2],
    pub(super) radiance: V,
    pub(super) edge1: V,
    pub(super) edge2: V,
    pub(super) normal: V,
}

pub(super) fn record(constants: &[u32]) -> Light {
    let mut c = Words::new(constants);
    let kind = c.word();
    c.word();
    let (pmf, area, point, params) = (c.real(), c.real(), c.vec3(), [c.real(), c.real()]);
    c.vec3();
    Light {
        kind,
        pmf,
        area,
        point,
        params,
        radiance: c.vec3(),
        edge1: c.vec3(),
        edge2: c.vec3(),
        normal: c.vec3(),
    }
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    match kernel {
        Kernel::SampleLight => sample(&record(constants), r.vec3(), [r.real(), r.real()]),
        Kernel::PdfLight => {
            let light = record(constants);
            let (p, wi, distance, normal) = (r.vec3(), r.vec3(), r.real(), r.vec3());
            pdf(&light, p, wi, distance, normal)
        }
        Kernel::PowerHeuristic => {
            let (a, b) = (r.real(), r.real());
            let w = if a == 0.0 { 0.0 } else { 1.0 / (1.0 + (b / a) * (b / a)) };
            Answer::Is(vec![Expect::Scaled(w, 1.0)])
        }
        Kernel::CameraRay => camera(constants, r),
        _ => tone(constants, r.vec3()),
    }
}

fn sample(l: &Light, p: V, u: [f64; 2]) -> Answer {
    match l.kind {
        // Point, spot.
        0 | 1 => {
            let to = vec::sub(l.point, p);
            let d2 = vec::dot(to, to);
            if d2 < f64::from(f32::MIN_POSITIVE) * 4.0 {
                return if d2 == 0.0 { nothing(16) } else { Answer::Undecided };
            }
            let wi = vec::unit(to);
            let mut falloff = 1.0;
            let mut condition = reach(l, p) / d2.sqrt();
            if l.kind == 1 {
                let cos = -vec::dot(wi, l.edge1);
                let x = ((cos - l.params[0]) / (l.params[1] - l.params[0])).clamp(0.0, 1.0);
                falloff = x * x * (3.0 - 2.0 * x);
                if x < 1e-5 && cos > l.params[0] - 1e-6 || (cos - l.params[0]).abs() < 4.0 * U {
                    return Answer::Undecided;
                }
                if falloff == 0.0 {
                    return nothing(16);
                }
                condition += condition * 6.0 * x * (1.0 - x) / (l.params[1] - l.params[0]) / falloff;
            }
            let e = l.radiance.map(|i| i * falloff / (d2 * l.pmf));
            outcome(wi, condition, e, 0.0, l.point, [0.0; 3], 0.0, false)
        }
        2 => {
            let wi = vec::mul(l.normal, -1.0);
            outcome(wi, 1.0, l.radiance.map(|e| e / l.pmf), 0.0, p, [0.0; 3], 0.0, true)
        }
        3 | 4 => {
            let [s, t] = if l.kind == 4 {
                u
            } else {
                // Heitz 2019: fold the square along its diagonal.
                let b = if u[0] < u[1] {
                    [0.5 * u[0], u[1] - 0.5 * u[0]]
                } else {
                    [u[0] - 0.5 * u[1], 0.5 * u[1]]
                };
                [b[1], 1.0 - b[0] - b[1]]
            };
            let x = vec::add(l.point, vec::add(vec::mul(l.edge1, s), vec::mul(l.edge2, t)));
            flat(l, p, x, vec::largest(l.edge1).max(vec::largest(l.edge2)))
        }
        5 => sphere(l, p, u),
        _ => {
            let [dx, dy] = warp::concentric(u).0;
            let x = vec::add(l.point, vec::mul(to_world([dx, dy, 0.0], l.normal), l.params[0]));
            flat(l, p, x, l.params[0])
        }
    }
}

/// Largest coordinate that takes part.
fn reach(l: &Light, p: V) -> f64 {
    vec::largest(p)
        .max(vec::largest(l.point))
        .max(vec::largest(l.edge1))
        .max(vec::largest(l.edge2))
        .max(l.params[0].abs() * f64::from(u8::from(l.kind >= 5)))
}

fn flat(l: &Light, p: V, x: V, extent: f64) -> Answer {
    let to = vec::sub(x, p);
    let d2 = vec::dot(to, to);
    if d2 == 0.0 {
        return nothing(16);
    }
    let wi = vec::unit(to);
    let cos = -vec::dot(wi, l.normal);
    let condition = 1.0 + reach(l, p) / d2.sqrt();
    if cos.abs() <= 16.0 * U * condition {
        return Answer::Undecided;
    }
    if cos <= 0.0 {
        return nothing(16);
    }
    let pdf = l.pmf * d2 / (l.area * cos);
    let radiance = l.radiance.map(|r| r / pdf);
    outcome(wi, condition / cos, radiance, pdf, x, l.normal, extent, false)
}

fn sphere(l: &Light, p: V, u: [f64; 2]) -> Answer {
    let to = vec::sub(l.point, p);
    let (d, r) = (vec::length(to), l.params[0]);
    if (d - r).abs() <= 16.0 * U * reach(l, p) {
        return Answer::Undecided;
    }
    if d <= r {
        return nothing(16);
    }
    let axis = vec::unit(to);
    // The frame jumps across z = 0.
    if axis[2] != 0.0 && axis[2].abs() <= 16.0 * U * reach(l, p) / d {
        return Answer::Undecided;
    }
    let sin2 = (r / d) * (r / d);
    let size = sin2 / (1.0 + (1.0 - sin2).sqrt());
    let wi = to_world(warp::cone(u, size), axis);
    let foot = vec::dot(to, wi);
    let off = vec::sub(to, vec::mul(wi, foot));
    let half = (r * r - vec::dot(off, off)).max(0.0).sqrt();
    let x = vec::add(p, vec::mul(wi, foot - half));
    let pdf = l.pmf / (2.0 * PI * size);
    // Near the sphere the cone opens as the square root of the gap.
    let condition = (reach(l, p) / d + 1.0) / (1.0 - sin2).sqrt();
    let Answer::Is(mut list) =
        outcome(wi, condition, l.radiance.map(|e| e / pdf), pdf, x, [0.0; 3], r, false)
    else {
        return Answer::Undecided;
    };
    // The place on the sphere moves with the rounding of the direction over the sine at which it meets the sphere.
    let along = (d * U * 8.0 / (half / r).max((d * U * 64.0 / r).sqrt())).max(reach(l, p) * U * 8.0) / U;
    let n = vec::unit(vec::sub(x, l.point));
    for i in 0..3 {
        list[8 + i] = Expect::Scaled(x[i], along * condition);
        list[11 + i] = Expect::Scaled(n[i], (along * condition / r).max(1.0));
    }
    Answer::Is(list)
}

#[expect(clippy::too_many_arguments, reason = "the words of a light sample, in order")]
fn outcome(
    wi: V,
    condition: f64,
    contribution: V,
    pdf: f64,
    point: V,
    normal: V,
    extent: f64,
    distant: bool,
) -> Answer {
    let mut out = vec![Expect::Word(1)];
    out.extend(scaled(wi, condition));
    out.extend(contribution.map(|x| Expect::Scaled(x, (x * condition).max(1e-38))));
    out.push(Expect::Scaled(pdf, (pdf * condition).max(1e-38)));
    out.extend(scaled(point, vec::largest(point).max(extent).max(1e-30)));
    out.extend(scaled(normal, 1.0));
    out.push(Expect::Scaled(extent, extent.max(1e-30)));
    out.push(Expect::Word(u32::from(distant)));
    Answer::Is(out)
}

fn pdf(l: &Light, p: V, wi: V, distance: f64, normal: V) -> Answer {
    if l.kind == 5 {
        let (d, r) = (vec::length(vec::sub(l.point, p)), l.params[0]);
        if (d - r).abs() <= 16.0 * U * reach(l, p) {
            return Answer::Undecided;
        }
        if d <= r {
            return ulp(0.0);
        }
        let sin2 = (r / d) * (r / d);
        let size = sin2 / (1.0 + (1.0 - sin2).sqrt());
        let value = l.pmf / (2.0 * PI * size);
        let condition = (reach(l, p) / d + 1.0) / (1.0 - sin2).sqrt();
        return Answer::Is(vec![Expect::Scaled(value, value * condition)]);
    }
    let cos = -vec::dot(wi, normal);
    if cos.abs() <= 8.0 * U && cos != 0.0 {
        return Answer::Undecided;
    }
    let value = if cos > 0.0 && l.area > 0.0 { l.pmf * distance * distance / (l.area * cos) } else { 0.0 };
    let value = value.min(f64::from(f32::MAX));
    Answer::Is(vec![Expect::Scaled(value, (value / cos.abs().max(1e-9)).max(1e-38))])
}

fn camera(constants: &[u32], r: &mut Words<'_>) -> Answer {
    let mut c = Words::new(constants);
    let (position, lens_radius, forward, focus) = (c.vec3(), c.real(), c.vec3(), c.real());
    let (right, width, up, height) = (c.vec3(), c.word(), c.vec3(), c.word());
    let (x, y) = (f64::from(r.word()), f64::from(r.word()));
    let (u, lens) = ([r.real(), r.real()], [r.real(), r.real()]);
    let sx = 2.0 * (x + u[0]) / f64::from(width) - 1.0;
    let sy = 1.0 - 2.0 * (y + u[1]) / f64::from(height);
    let toward = vec::add(forward, vec::add(vec::mul(right, sx), vec::mul(up, sy)));
    let (mut origin, mut direction) = (position, vec::unit(toward));
    let mut scale = 1.0 + vec::length(right) + vec::length(up);
    if lens_radius > 0.0 {
        let [dx, dy] = warp::concentric(lens).0;
        let shift =
            vec::add(vec::mul(vec::unit(right), dx * lens_radius), vec::mul(vec::unit(up), dy * lens_radius));
        let meet = vec::mul(toward, focus);
        let aim = vec::sub(meet, shift);
        scale *= 1.0 + (vec::length(meet) + lens_radius) / vec::length(aim);
        origin = vec::add(position, shift);
        direction = vec::unit(aim);
    }
    let mut out = scaled(origin, vec::largest(position).max(lens_radius).max(1e-30));
    out.extend(scaled(direction, scale));
    Answer::Is(out)
}

/// IEC 61966-2-1, decoding.
fn decode(code: u32) -> f64 {
    let s = f64::from(code & 255) / 255.0;
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}

fn encode(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

fn tone(constants: &[u32], rgb: V) -> Answer {
    let mut c = Words::new(constants);
    let (map, exposure) = (c.word(), c.real());
    let (a, offset, gamma) = (c.real(), c.real(), c.real());
    // Infinite light is the largest number, negative light and NaN are black.
    let light = |x: f64| if x > 0.0 { x.min(f64::from(f32::MAX)) } else { 0.0 };
    let out = rgb.map(|x| {
        let e = light(light(x) * exposure.clamp(-126.0, 127.0).exp2());
        match map {
            0 => encode(e / (1.0 + e)),
            1 => {
                let v = a * light(e + offset).powf(gamma);
                light(if v.is_nan() { 0.0 } else { v }).min(1.0)
            }
            _ => encode(e),
        }
    });
    Answer::Is(scaled(out, 1.0))
}

/// Decoded texels.
pub(super) fn image(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    if kernel == Kernel::SrgbDecode {
        return ulp(decode(r.word()));
    }
    let (width, height) = (constants[0], constants[1]);
    let (u, v) = (r.real(), r.real());
    // Bilinear over texel centres, repeating; row 0 on top.
    let (s, t) = (u * f64::from(width) - 0.5, -v * f64::from(height) - 0.5);
    let (x, y) = (s.floor(), t.floor());
    let (fx, fy) = (s - x, t - y);
    let texel = |x: f64, y: f64| {
        let i = x.rem_euclid(f64::from(width)) as usize;
        let j = y.rem_euclid(f64::from(height)) as usize;
        let word = constants[2 + j * width as usize + i];
        [word, word >> 8, word >> 16].map(decode)
    };
    let mut out = [0.0; 3];
    for (dx, dy, w) in [
        (0.0, 0.0, (1.0 - fx) * (1.0 - fy)),
        (1.0, 0.0, fx * (1.0 - fy)),
        (0.0, 1.0, (1.0 - fx) * fy),
        (1.0, 1.0, fx * fy),
    ] {
        let c = texel(x + dx, y + dy);
        for i in 0..3 {
            out[i] += w * c[i];
        }
    }
    // A coordinate is known to U times its size, and a texel is 1/n of the unit wide.
    let slope = (1.0 + u.abs()) * f64::from(width) + (1.0 + v.abs()) * f64::from(height);
    Answer::Is(scaled(out, slope))
}
