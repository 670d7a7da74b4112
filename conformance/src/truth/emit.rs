//! Photons as they leave lights, from the densities: a spot's falloff inverted by bisection, everything else by the warps' truths.

use super::bsdf::to_world;
use super::light::{Light, record};
use super::vec::{self, V};
use super::{Answer, Expect, Words, scaled, warp};
use etendue_core::kernel::Kernel;
use std::f64::consts::PI;

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;

/// Where, with the scale of its rounding; whereto, with its own; and the flux, with its.
struct Photon {
    origin: (V, f64),
    direction: (V, f64),
    flux: (V, f64),
}

impl Photon {
    fn answer(self) -> Answer {
        let mut out = scaled(self.origin.0, self.origin.1.max(1e-30));
        out.extend(scaled(self.direction.0, self.direction.1));
        let relative = self.flux.1;
        out.extend(self.flux.0.map(|x| Expect::Scaled(x, (x * relative).max(1e-38))));
        Answer::Is(out)
    }
}

/// Uniform over the sphere.
fn sphere(u: [f64; 2]) -> V {
    let (s, c) = (2.0 * PI * u[1]).sin_cos();
    let sin = 2.0 * (u[0] * (1.0 - u[0])).sqrt();
    [sin * c, sin * s, 1.0 - 2.0 * u[0]]
}

/// Share of a spot's flux within 1 - cos = h of the axis: the full cone, then the integral of the smoothstep down to the rim.
fn spot_share(h: f64, [cone, full]: [f64; 2]) -> f64 {
    let (inner, ring) = (1.0 - full, 0.5 * (full - cone));
    if h <= inner {
        return h / (inner + ring);
    }
    let x = ((1.0 - cone) - h) / (full - cone);
    1.0 - ring * x * x * x * (2.0 - x) / (inner + ring)
}

/// 1 - cos at which the share is u, and what the roundings of u and of the cosines amount to there.
fn spot(u: f64, params: [f64; 2]) -> (f64, f64) {
    let [cone, full] = params;
    let (mut low, mut high) = (0.0, 1.0 - cone);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if spot_share(middle, params) < u { low = middle } else { high = middle }
    }
    let (inner, ring) = (1.0 - full, 0.5 * (full - cone));
    let mut scale = 1.0 - cone;
    if full > cone && high > inner {
        // Near the rim the intensity goes to 0, and a rounding of the share of the ring is far on the cosine: no further than its cube root.
        let x = ((1.0 - cone) - high) / (full - cone);
        let lost = U * (inner + ring) / ring;
        let slope = (6.0 * x * x - 4.0 * x * x * x).max(1e-300);
        scale += (full - cone) * (lost / slope).min(lost.cbrt()) / U;
    }
    (high, scale)
}

fn largest_of(l: &Light) -> f64 {
    vec::largest(l.point).max(vec::largest(l.edge1)).max(vec::largest(l.edge2))
}

/// From a place of a surface: by the cosine, moved along the normal as `geometry::offset_origin` states.
fn surface(l: &Light, at: V, n: V, u: [f64; 2], extent: f64, size: f64) -> Photon {
    let along: f64 = (0..3).map(|i| (n[i] * at[i]).abs()).sum();
    let height = U * (6.0 * along + 8.0 * extent);
    Photon {
        origin: (vec::add(at, vec::mul(n, height)), size),
        direction: (to_world(warp::cosine_hemisphere(u), n), 1.0),
        flux: (l.radiance.map(|x| x * PI * l.area), 1.0),
    }
}

/// Through the disk across a bounding sphere, from a little outside it.
fn from_infinity(travel: V, (centre, radius): (V, f64), u: [f64; 2]) -> (V, f64) {
    let [x, y] = warp::concentric(u).0;
    let local = to_world([x, y, -(1.0 + 1.0 / 1024.0)], travel);
    (vec::add(centre, vec::mul(local, radius)), vec::largest(centre) + 2.0 * radius)
}

fn emit(l: &Light, bound: (V, f64), place: [f64; 2], way: [f64; 2]) -> Photon {
    let size = largest_of(l);
    match l.kind {
        0 => Photon {
            origin: (l.point, 0.0),
            direction: (sphere(place), 1.0),
            flux: (l.radiance.map(|x| 4.0 * PI * x), 1.0),
        },
        1 => {
            let (h, scale) = spot(place[0], l.params);
            let (s, c) = (2.0 * PI * place[1]).sin_cos();
            let sin = (h * (2.0 - h)).max(0.0).sqrt();
            // sin^2 = h (2 - h).
            let spread = scale * (1.0 - h).abs() / sin.max((U * scale).sqrt()) + scale;
            let [cone, full] = l.params;
            let solid = 2.0 * PI * ((1.0 - full) + 0.5 * (full - cone));
            let lost = 2.0 * PI * (1.0 + full.abs() + 0.5 * (full - cone));
            Photon {
                origin: (l.point, 0.0),
                direction: (to_world([sin * c, sin * s, 1.0 - h], l.edge1), 1.0 + spread),
                flux: (l.radiance.map(|x| x * solid), 1.0 + if solid > 0.0 { lost / solid } else { 0.0 }),
            }
        }
        2 => Photon {
            origin: from_infinity(l.normal, bound, place),
            direction: (l.normal, 0.0),
            flux: (l.radiance.map(|x| x * PI * bound.1 * bound.1), 1.0),
        },
        3 | 4 => {
            let [s, t] = if l.kind == 4 {
                place
            } else {
                // Heitz 2019: fold the square along its diagonal.
                let b0 = if place[0] < place[1] { 0.5 * place[0] } else { place[0] - 0.5 * place[1] };
                let b1 = if place[0] < place[1] { place[1] - 0.5 * place[0] } else { 0.5 * place[1] };
                [b1, 1.0 - b0 - b1]
            };
            let at = vec::add(l.point, vec::add(vec::mul(l.edge1, s), vec::mul(l.edge2, t)));
            let extent = vec::largest(l.edge1).max(vec::largest(l.edge2));
            surface(l, at, l.normal, way, extent, size)
        }
        5 => {
            // The frame about the place's normal jumps across z = 0, on which side 1 - 2 u is without rounding.
            let out = sphere(place);
            let r = l.params[0];
            let mut photon = surface(l, vec::add(l.point, vec::mul(out, r)), out, way, r, size + r);
            photon.direction.1 = 2.0;
            photon
        }
        _ => {
            let [x, y] = warp::concentric(place).0;
            let r = l.params[0];
            let at = vec::add(l.point, vec::mul(to_world([x, y, 0.0], l.normal), r));
            surface(l, at, l.normal, way, r, size + r)
        }
    }
}

pub(super) fn truth(kernel: Kernel, constants: &[u32], r: &mut Words<'_>) -> Answer {
    let (place, way) = ([r.real(), r.real()], [r.real(), r.real()]);
    if kernel == Kernel::EmitLight {
        let mut bound = Words::new(&constants[24..]);
        return emit(&record(constants), (bound.vec3(), bound.real()), place, way).answer();
    }
    let mut c = Words::new(constants);
    let (radiance, centre, radius) = (c.vec3(), c.vec3(), c.real());
    let travel = sphere(place);
    let (origin, size) = from_infinity(travel, (centre, radius), way);
    let area = 4.0 * PI * radius * radius;
    Photon { origin: (origin, size), direction: (travel, 1.0), flux: (radiance.map(|x| PI * x * area), 1.0) }
        .answer()
}
