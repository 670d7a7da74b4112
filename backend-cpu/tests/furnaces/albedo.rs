//! Surfaces whose model loses energy: in a furnace a flat piece reads its directional albedo, here by sums over facets and lobes in f64.
//!
//! With slopes drawn as the distribution has them, D cos dm = du dphi / (2 pi), and from wo the share
//! (wo m) G1(wo) G1(wi) / (wo n cos m) of each facet's light is sent on by a single scattering: what is missing to 1 would need a second one.
//! (B. Walter et al. 2007; E. Heitz 2014, "Understanding the Masking-Shadowing Function".)

use super::{LIMIT, METHODS, WITHIN, camera, material, reading, shape};
use etendue_core::scene::{
    EnvironmentDesc, LightDesc, MaterialKind, Reflectance, Roughness, SceneDesc, ShapeKind,
};
use std::f64::consts::PI;

type V = [f64; 3];

/// Steps of either sum.
const STEPS: u32 = 256;
/// What sums may be off; of coats, what their table of 16 transmittances may.
const SUMS: f64 = 1e-4;
const TABLES: f64 = 1e-3;

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Midpoints of two numbers in (0, 1).
fn mean(value: impl Fn(f64, f64) -> f64) -> f64 {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            sum += value(at(i), at(j));
        }
    }
    sum / f64::from(STEPS * STEPS)
}

/// Towards the sensor, n = +z.
fn towards(cos: f64) -> V {
    [(1.0 - cos * cos).sqrt(), 0.0, cos]
}

fn fresnel(cos: f64, ratio: f64) -> f64 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt() / ratio;
    if sin >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin * sin).sqrt();
    let (s, p) = ((cos - ratio * t) / (cos + ratio * t), (ratio * cos - t) / (ratio * cos + t));
    0.5 * (s * s + p * p)
}

/// Below the facet `m` by Snell's law.
fn refract(wo: V, m: V, ratio: f64) -> Option<V> {
    let cos = dot(wo, m);
    let t = 1.0 - (1.0 - cos * cos) / (ratio * ratio);
    (t > 0.0).then(|| [0, 1, 2].map(|k| (m[k] * cos - wo[k]) / ratio - m[k] * t.sqrt()))
}

fn reflect(wo: V, m: V) -> V {
    [0, 1, 2].map(|k| 2.0 * dot(wo, m) * m[k] - wo[k])
}

/// A distribution of facets.
#[derive(Clone, Copy)]
struct Facets {
    alpha: f64,
    beckmann: bool,
}

impl Facets {
    fn of(roughness: Roughness) -> Option<Self> {
        match roughness {
            Roughness::Ggx(alpha) => Some(Self { alpha: alpha.into(), beckmann: false }),
            Roughness::Beckmann(alpha) => Some(Self { alpha: alpha.into(), beckmann: true }),
            Roughness::Phong(_) => None,
        }
    }

    fn masking(&self, cos: f64) -> f64 {
        let a = cos.abs() / (1.0 - cos * cos).max(1e-300).sqrt() / self.alpha;
        if !self.beckmann {
            2.0 / (1.0 + (1.0 + 1.0 / (a * a)).sqrt())
        } else if a < 1.6 {
            (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
        } else {
            1.0
        }
    }

    /// Share of what comes from `wo` that single facets send on: `sent` says where, and how much of it.
    fn send(&self, cos: f64, sent: impl Fn(V, V) -> Option<(V, f64)>) -> f64 {
        let wo = towards(cos);
        mean(|x, turn| {
            // u = 1 - (1 - x)^2: few are steep, and count by 1 / cos.
            let rest = (1.0 - x) * (1.0 - x);
            let tan2 = if self.beckmann { -rest.ln() } else { (1.0 - rest) / rest };
            let cos_m = 1.0 / (1.0 + self.alpha * self.alpha * tan2).sqrt();
            let sin_m = (1.0 - cos_m * cos_m).sqrt();
            // The other half of the azimuths is the mirror image of this one.
            let m = [sin_m * (PI * turn).cos(), sin_m * (PI * turn).sin(), cos_m];
            let facing = dot(wo, m);
            match sent(wo, m) {
                Some((wi, share)) if facing > 0.0 => {
                    let g = self.masking(cos) * self.masking(wi[2]);
                    2.0 * (1.0 - x) * share * facing * g / (cos * cos_m)
                }
                _ => 0.0,
            }
        })
    }

    fn reflected(&self, cos: f64, reflectance: impl Fn(f64) -> f64) -> f64 {
        self.send(cos, |wo, m| {
            let wi = reflect(wo, m);
            (wi[2] > 0.0).then(|| (wi, reflectance(dot(wo, m))))
        })
    }

    /// Flux, not radiance.
    fn refracted(&self, cos: f64, ratio: f64) -> f64 {
        self.send(cos, |wo, m| {
            let wi = refract(wo, m, ratio)?;
            (wi[2] < 0.0).then(|| (wi, 1.0 - fresnel(dot(wo, m), ratio)))
        })
    }
}

/// What a lobe (n+1) / (2 pi) cos^n about a direction at this cosine to the normal reflects, each direction by `share`.
fn lobe(exponent: f64, axis: f64, share: impl Fn(V) -> f64) -> f64 {
    let (z, x) = (towards(axis), [axis, 0.0, -(1.0 - axis * axis).sqrt()]);
    mean(|u, turn| {
        let cos = u.powf(1.0 / (exponent + 1.0));
        let sin = (1.0 - cos * cos).sqrt();
        let (a, b) = (sin * (PI * turn).cos(), sin * (PI * turn).sin());
        let w = [a * x[0] + cos * z[0], b, a * x[2] + cos * z[2]];
        if w[2] > 0.0 { w[2] * share(w) } else { 0.0 }
    })
}

/// A lobe about the mirror direction whose light is reflected as a dielectric does at the half vector.
fn glossy_coat(exponent: f64, cos: f64, ratio: f64) -> f64 {
    lobe(exponent, cos, |w| {
        // The lobe was turned to the side of wo.
        let (wo, wi) = (towards(cos), [-w[0], -w[1], w[2]]);
        fresnel(((1.0 + dot(wo, wi)) / 2.0).sqrt(), ratio)
    })
}

/// Twice the mean over cosines, each weighted by itself.
fn diffusely(steps: u32, value: impl Fn(f64) -> f64) -> f64 {
    (0..steps)
        .map(|i| {
            let cos = (f64::from(i) + 0.5) / f64::from(steps);
            2.0 * cos * value(cos) / f64::from(steps)
        })
        .sum()
}

const INDEX: f64 = 1.5;

/// Plastic: what the coat reflects, and what comes back from the body.
fn plastic(roughness: Roughness, albedo: f64, nonlinear: bool) -> impl Fn(f64) -> f64 {
    let facets = Facets::of(roughness);
    let passes = move |c: f64| match &facets {
        Some(facets) => facets.refracted(c, INDEX),
        None => 1.0 - fresnel(c, INDEX),
    };
    let internal = match &facets {
        // The mean that the model has: over the cosines i / 63.
        Some(facets) => (1..64)
            .map(|i| f64::from(i) / 63.0)
            .map(|c| facets.reflected(c, |x| fresnel(x, 1.0 / INDEX)) * c / 32.0)
            .sum(),
        None => diffusely(8192, |c| fresnel(c, 1.0 / INDEX)),
    };
    let kept = if nonlinear { albedo * internal } else { internal };
    let body = diffusely(64, passes) * albedo / ((1.0 - kept) * INDEX * INDEX);
    move |cos| {
        let coat = match (&facets, roughness) {
            (None, Roughness::Phong(n)) => glossy_coat(n.into(), cos, INDEX),
            (facets, _) => facets.map_or(0.0, |f| f.reflected(cos, |x| fresnel(x, INDEX))),
        };
        coat + passes(cos) * body
    }
}

/// A boundary of glass seen from outside (the ratio of indices above 1) or inside.
fn boundary(roughness: Roughness, cos: f64, ratio: f64) -> f64 {
    let square = ratio * ratio;
    match (Facets::of(roughness), roughness) {
        (Some(facets), _) => {
            facets.reflected(cos, |x| fresnel(x, ratio)) + facets.refracted(cos, ratio) / square
        }
        (None, Roughness::Phong(n)) => {
            let r = fresnel(cos, ratio);
            let beyond = (1.0 - (1.0 - cos * cos) / square).max(0.0).sqrt();
            r * lobe(n.into(), cos, |_| 1.0) + (1.0 - r) * lobe(n.into(), beyond, |_| 1.0) / square
        }
        _ => unreachable!(),
    }
}

/// A flat piece in y = 0 under a sky, seen from above or below under an angle.
fn piece(kind: &MaterialKind, cos: f64, above: bool) -> SceneDesc {
    let square = ShapeKind::Rectangle { center: [0.0; 3], u: [0.0, 0.0, 1.0], v: [1.0, 0.0, 0.0] };
    let (x, y) = ((1.0 - cos * cos).sqrt() as f32, cos as f32);
    SceneDesc {
        camera: Some(camera([-5.0 * x, if above { 5.0 * y } else { -5.0 * y }, 0.0], 0.02, 1)),
        materials: vec![material("piece", kind.clone(), 0.0)],
        shapes: vec![shape(square, "piece", "")],
        lights: vec![LightDesc::Environment(EnvironmentDesc::uniform([1.0; 3]))],
        ..SceneDesc::default()
    }
}

const COSINES: [f64; 2] = [0.9, 0.3];

/// Asserts what a piece reads, by either method.
fn reads_albedo(what: &str, kind: &MaterialKind, above: bool, sums: f64, truth: impl Fn(f64) -> f64) {
    for (i, cos) in COSINES.into_iter().enumerate() {
        let truth = truth(cos);
        // Under a sky either method takes the same steps.
        for method in METHODS.into_iter().take(if i == 0 { 2 } else { 1 }) {
            let (mean, stderr) = reading(what, &piece(kind, cos, above), method, WITHIN * truth.max(1.0));
            for c in 0..3 {
                let error = (mean[c] - truth).abs();
                let allowed = LIMIT * stderr[c] + sums * truth;
                assert!(error <= allowed, "{what} at {cos}, {method:?}: {mean:?} +- {stderr:?}, not {truth}");
                let statistics = LIMIT * stderr[c];
                assert!(statistics <= WITHIN * truth.max(1.0), "{what} at {cos}, {method:?}: {stderr:?}");
            }
        }
    }
}

#[test]
fn rough_metals_that_reflect_all_read_what_single_facets_reflect() {
    for scale in [0.1, 0.3, 0.6] {
        for roughness in [Roughness::Ggx(scale), Roughness::Beckmann(scale)] {
            let kind = MaterialKind::RoughConductor { eta: [1e-3; 3], k: [1e3; 3], roughness };
            let facets = Facets::of(roughness).unwrap();
            let what = format!("metal {roughness:?}");
            reads_albedo(&what, &kind, true, SUMS, |cos| facets.reflected(cos, |_| 1.0));
        }
    }
}

#[test]
fn rough_glass_reads_what_single_facets_reflect_and_refract() {
    for roughness in [Roughness::Ggx(0.3), Roughness::Beckmann(0.3), Roughness::Phong(12.0)] {
        let kind = MaterialKind::RoughDielectric { ior: [INDEX as f32; 3], schlick: false, roughness };
        for (above, ratio) in [(true, INDEX), (false, 1.0 / INDEX)] {
            let what = format!("glass {roughness:?}, from above {above}");
            reads_albedo(&what, &kind, above, SUMS, |cos| boundary(roughness, cos, ratio));
        }
    }
}

#[test]
fn phong_lobes_read_their_integral() {
    for exponent in [3.0, 40.0_f32] {
        let truth = |cos| lobe(exponent.into(), cos, |_| 1.0);
        let kind = MaterialKind::Phong { specular: [1.0; 3], exponent };
        reads_albedo(&format!("phong {exponent}"), &kind, true, SUMS, truth);
        let albedo = Reflectance::flat([0.25; 3]);
        let kind = MaterialKind::DiffusePhong { albedo, specular: [0.75; 3], exponent };
        reads_albedo(&format!("both {exponent}"), &kind, true, SUMS, |cos| 0.25 + 0.75 * truth(cos));
    }
    let kind =
        MaterialKind::RoughConductor { eta: [1e-3; 3], k: [1e3; 3], roughness: Roughness::Phong(10.0) };
    reads_albedo("phong metal", &kind, true, SUMS, |cos| lobe(10.0, cos, |_| 1.0));
    // In closed form along the normal.
    for n in [1.0, 10.0, 80.0] {
        assert!((lobe(n, 1.0, |_| 1.0) - (n + 1.0) / (n + 2.0)).abs() < 1e-4);
    }
}

#[test]
fn rough_plastic_reads_its_coat_and_its_body() {
    for (roughness, nonlinear) in [
        (Roughness::Ggx(0.3), true),
        (Roughness::Ggx(0.1), false),
        (Roughness::Beckmann(0.3), false),
        (Roughness::Phong(12.0), false),
    ] {
        let albedo = 0.75_f32;
        let kind = MaterialKind::Plastic {
            albedo: Reflectance::flat([albedo; 3]),
            ior: INDEX as f32,
            roughness: Some(roughness),
            nonlinear,
        };
        let what = format!("plastic {roughness:?}");
        reads_albedo(&what, &kind, true, TABLES, plastic(roughness, albedo.into(), nonlinear));
    }
}
