//! Ray tests from their definitions: signed volumes, slabs, quadratic roots.

use super::vec::{self, V};
use super::{Answer, Expect, Words, nothing};
use etendue_core::kernel::Kernel;

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;
/// Roundoffs within which f32 may decide either way.
const MARGIN: f64 = 32.0 * U;

struct Ray {
    o: V,
    d: V,
    t_max: f64,
}

fn ray(r: &mut Words<'_>) -> Ray {
    Ray { o: r.vec3(), d: r.vec3(), t_max: r.real() }
}

fn hit(values: &[(f64, f64)]) -> Answer {
    let mut out = vec![Expect::Word(1)];
    out.extend(values.iter().map(|(x, scale)| Expect::Scaled(*x, *scale)));
    Answer::Is(out)
}

pub(super) fn truth(kernel: Kernel, r: &mut Words<'_>) -> Answer {
    match kernel {
        Kernel::Triangle => {
            let ray = ray(r);
            triangle(&ray, [r.vec3(), r.vec3(), r.vec3()])
        }
        Kernel::Slab => {
            let ray = ray(r);
            slab(&ray, r.vec3(), r.vec3())
        }
        Kernel::RoundShape => {
            let ray = ray(r);
            let (kind, radius, center, normal) = (r.word(), r.real(), r.vec3(), r.vec3());
            let f = vec::sub(ray.o, center);
            if kind == 0 { sphere(&ray, f, radius) } else { disk(&ray, f, normal, radius) }
        }
        _ => {
            let (p, extent, n, toward) = (r.vec3(), r.real(), r.vec3(), r.vec3());
            let cos = vec::dot(n, toward);
            if cos != 0.0 && cos.abs() <= MARGIN * vec::length(toward) {
                return Answer::Undecided;
            }
            // Six roundoffs per coordinate and eight per extent: the margin that core::geometry measured and states.
            let side = if cos < 0.0 { -1.0 } else { 1.0 };
            let height = U * (6.0 * (0..3).map(|i| (n[i] * p[i]).abs()).sum::<f64>() + 8.0 * extent);
            let q = vec::add(p, vec::mul(n, side * height));
            let scale = vec::largest(p) + height;
            Answer::Is(q.map(|x| Expect::Scaled(x, scale)).to_vec())
        }
    }
}

/// Both ends of the interval are hits; a crossing is undecided within the error of the numbers that it compares.
fn triangle(ray: &Ray, v: [V; 3]) -> Answer {
    let [a, b, c] = v.map(|p| vec::sub(p, ray.o));
    // Signed volumes of the ray's direction with each edge (Möller 1997's determinants, without a division).
    let e = [
        vec::dot(ray.d, vec::cross(b, c)),
        vec::dot(ray.d, vec::cross(c, a)),
        vec::dot(ray.d, vec::cross(a, b)),
    ];
    let far = [a, b, c].iter().map(|p| vec::length(*p)).fold(0.0, f64::max);
    let coordinate = vec::largest(ray.o).max(v.iter().map(|p| vec::largest(*p)).fold(0.0, f64::max));
    // Differences of coordinates round by U times the coordinates' size; edge functions by their products.
    let reach = far + coordinate * U;
    let edge_error = 16.0 * U * vec::length(ray.d) * reach * reach;
    if ray.d == [0.0; 3] || ray.t_max < 0.0 {
        return nothing(4);
    }
    for i in 0..3 {
        // The documented convention of the box test: a component of zero points to the side of its sign, so the high
        // face of the triangle's own box is not touched by a ray that runs in its plane with +0 (the low one with -0).
        let (low, high) = v.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[i]), h.max(p[i])));
        if ray.d[i].abs() < 1e-18 && low < high {
            let outside = if ray.d[i].is_sign_positive() { high } else { low };
            if ray.o[i] == outside {
                return Answer::Undecided;
            }
        }
    }
    let det: f64 = e.iter().sum();
    let signs = |s: f64| e.iter().any(|x| s * x < 0.0);
    let near = e.iter().any(|x| *x != 0.0 && x.abs() <= edge_error);
    if near {
        return Answer::Undecided;
    }
    if det == 0.0 || (signs(1.0) && signs(-1.0)) {
        return nothing(4);
    }
    let n = vec::cross(vec::sub(v[1], v[0]), vec::sub(v[2], v[0]));
    let cosine = vec::dot(n, ray.d);
    let t = vec::dot(n, a) / cosine;
    let length = vec::length(ray.d);
    // The error of the distance over the cosine of incidence.
    let slant = vec::length(n) * length / cosine.abs();
    let t_scale = reach / length * slant.min(1e6);
    let t_error = MARGIN * t_scale;
    if (t != 0.0 && t.abs() <= t_error) || (t != ray.t_max && (t - ray.t_max).abs() <= t_error) {
        return Answer::Undecided;
    }
    if t < 0.0 || t > ray.t_max {
        return nothing(4);
    }
    let b_scale = 1.0 + edge_error / U / det.abs();
    hit(&[(t, t_scale), (e[1] / det, b_scale), (e[2] / det, b_scale)])
}

/// Conservative: entry never later than the true one, no touched box missed; within a few roundings.
fn slab(ray: &Ray, low: V, high: V) -> Answer {
    let (mut enter, mut leave) = (0.0_f64, ray.t_max);
    let mut scale = 0.0_f64;
    for i in 0..3 {
        // Core's convention: a component of zero counts as 1e-18 with its sign.
        let d = if ray.d[i].abs() < 1e-18 { 1e-18_f64.copysign(ray.d[i]) } else { ray.d[i] };
        let (a, b) = ((low[i] - ray.o[i]) / d, (high[i] - ray.o[i]) / d);
        let (near, far) = if d > 0.0 { (a, b) } else { (b, a) };
        enter = enter.max(near);
        leave = leave.min(far);
        if near.abs() < 1e12 {
            scale = scale.max(near.abs());
        }
    }
    let slack = MARGIN * (enter.abs().max(leave.abs()).max(scale)).min(1e30);
    if enter != leave && (enter - leave).abs() <= slack {
        return Answer::Undecided;
    }
    if enter > leave {
        return nothing(2);
    }
    Answer::Is(vec![Expect::Word(1), Expect::AtMost(enter, enter.abs().max(1e-30))])
}

fn sphere(ray: &Ray, f: V, r: f64) -> Answer {
    if r <= 0.0 || ray.t_max < 0.0 || ray.d == [0.0; 3] {
        return nothing(2);
    }
    let a = vec::dot(ray.d, ray.d);
    let b = -vec::dot(f, ray.d);
    let foot = vec::add(f, vec::mul(ray.d, b / a));
    let miss = vec::length(foot);
    let reach = vec::length(f).max(r);
    if miss != r && (miss - r).abs() <= MARGIN * reach {
        return Answer::Undecided;
    }
    if miss > r {
        return nothing(2);
    }
    let half = ((r - miss) * (r + miss) / a).sqrt();
    let (t0, t1) = (b / a - half, b / a + half);
    let length = a.sqrt();
    // A root moves by the error of the miss over the sine at which the line meets the sphere.
    let slant = r / (half * length).max(1e-6 * r);
    let scale = reach / length * slant.min(1e3);
    for (t, last) in [(t0, false), (t1, true)] {
        if t != 0.0 && t.abs() <= MARGIN * scale {
            return Answer::Undecided;
        }
        if t >= 0.0 {
            if t != ray.t_max && (t - ray.t_max).abs() <= MARGIN * scale {
                return Answer::Undecided;
            }
            return if t <= ray.t_max { hit(&[(t, scale)]) } else { nothing(2) };
        }
        if last {
            break;
        }
    }
    nothing(2)
}

fn disk(ray: &Ray, f: V, n: V, r: f64) -> Answer {
    let cosine = vec::dot(n, ray.d);
    if r <= 0.0 || n == [0.0; 3] || ray.d == [0.0; 3] || cosine == 0.0 || ray.t_max < 0.0 {
        return nothing(2);
    }
    let t = -vec::dot(n, f) / cosine;
    let length = vec::length(ray.d);
    let slant = vec::length(n) * length / cosine.abs();
    if slant > 1e4 {
        return Answer::Undecided;
    }
    let reach = vec::length(f).max(r);
    let scale = reach / length * slant;
    let q = vec::length(vec::add(f, vec::mul(ray.d, t)));
    let near = |x: f64, y: f64, error: f64| x != y && (x - y).abs() <= error;
    if near(q, r, MARGIN * reach * slant)
        || near(t, 0.0, MARGIN * scale)
        || near(t, ray.t_max, MARGIN * scale)
    {
        return Answer::Undecided;
    }
    if q > r || t < 0.0 || t > ray.t_max {
        return nothing(2);
    }
    hit(&[(t, scale)])
}
