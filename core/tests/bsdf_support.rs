//! The scattering functions of rough surfaces from their definitions, in f64 and by angles.
#![allow(dead_code, reason = "each test crate includes this file and uses a part of it")]
#![allow(clippy::disallowed_methods, reason = "truth in f64")]

use core::f64::consts::PI;
use etendue_core::bsdf::plastic::{Coat, CoatTable};
use etendue_core::bsdf::{Boundary, Facets, Finish, Lobes, Metal, Rough};
use etendue_core::math::Vec3;

pub(crate) type V = [f64; 3];

pub(crate) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn unit(v: V) -> V {
    let l = dot(v, v).sqrt();
    v.map(|x| x / l)
}

pub(crate) fn f64s(v: Vec3) -> V {
    v.to_array().map(f64::from)
}

/// A direction by its angles to +z and +x.
pub(crate) fn at(theta: f64, phi: f64) -> V {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

pub(crate) fn f32s(v: V) -> Vec3 {
    Vec3::from_array(v.map(|x| x as f32)).normalize()
}

/// A distribution of microfacets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) alpha: f64,
    pub(crate) beckmann: bool,
}

impl Truth {
    pub(crate) fn facets(&self) -> Facets {
        if self.beckmann { Facets::beckmann(self.alpha as f32) } else { Facets::ggx(self.alpha as f32) }
    }

    /// D of a normal at this angle.
    pub(crate) fn density(&self, theta: f64) -> f64 {
        if theta >= PI / 2.0 {
            return 0.0;
        }
        let (a2, t2, c) = (self.alpha * self.alpha, theta.tan().powi(2), theta.cos());
        if self.beckmann {
            (-t2 / a2).exp() / (PI * a2 * c.powi(4))
        } else {
            1.0 / (PI * a2 * c.powi(4) * (1.0 + t2 / a2).powi(2))
        }
    }

    /// G1 of a direction at this angle.
    pub(crate) fn masking(&self, theta: f64) -> f64 {
        let tan = theta.tan().abs();
        if !self.beckmann {
            return 2.0 / (1.0 + (1.0 + (self.alpha * tan).powi(2)).sqrt());
        }
        let a = 1.0 / (self.alpha * tan);
        if a < 1.6 { (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a) } else { 1.0 }
    }

    fn angle(v: V) -> f64 {
        dot([v[0], v[1], 0.0], v).sqrt().atan2(v[2])
    }

    /// f of perfect reflectors.
    pub(crate) fn reflect(&self, wo: V, wi: V) -> f64 {
        let h = unit([0, 1, 2].map(|k| wo[k] + wi[k]));
        let g = self.masking(Self::angle(wo)) * self.masking(Self::angle(wi));
        self.density(Self::angle(h)) * g / (4.0 * wo[2] * wi[2])
    }

    /// f of a boundary of this index ratio (beyond over before), radiance arriving from wi below.
    pub(crate) fn pass(&self, wo: V, wi: V, eta: f64) -> f64 {
        let h = unit([0, 1, 2].map(|k| wo[k] + eta * wi[k]));
        let h = if h[2] < 0.0 { h.map(|x| -x) } else { h };
        let (co, ci) = (dot(wo, h), dot(wi, h));
        if co <= 0.0 || ci >= 0.0 {
            return 0.0;
        }
        let g = self.masking(Self::angle(wo)) * self.masking(PI - Self::angle(wi));
        let walter = (co * ci / (wo[2] * wi[2])).abs()
            * eta
            * eta
            * (1.0 - fresnel(co, eta))
            * g
            * self.density(Self::angle(h))
            / (co + eta * ci).powi(2);
        walter / (eta * eta)
    }
}

/// Reflectance of a dielectric.
pub(crate) fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt() / eta;
    if sin >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin * sin).sqrt();
    let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
    0.5 * (s * s + p * p)
}

pub(crate) fn facets(alpha: f32, beckmann: bool) -> Rough {
    Rough::Facets(if beckmann { Facets::beckmann(alpha) } else { Facets::ggx(alpha) })
}

pub(crate) fn metal(rough: Rough) -> Lobes {
    let (eta, k) = (Vec3::new(0.2, 0.4, 1.3), Vec3::new(3.9, 2.4, 1.8));
    Lobes::finished(Vec3::ZERO, Finish::Metal(Metal { rough, eta, k }))
}

/// A metal that reflects nearly all at every angle.
pub(crate) fn silver(rough: Rough) -> Lobes {
    let (eta, k) = (Vec3::splat(1e-3), Vec3::splat(1e3));
    Lobes::finished(Vec3::ZERO, Finish::Metal(Metal { rough, eta, k }))
}

pub(crate) fn glass(rough: Rough, ratio: f32) -> Lobes {
    let boundary = Boundary { rough, ratio: Vec3::splat(ratio), schlick: false };
    Lobes::finished(Vec3::ZERO, Finish::Boundary(boundary))
}

pub(crate) fn plastic(rough: Option<Rough>, albedo: Vec3, nonlinear: bool) -> Lobes {
    let ior = 1.5;
    let table = CoatTable::new(ior, rough);
    let body = CoatTable::body(table.internal, ior, albedo, nonlinear);
    let coat = Coat { ior, rough, mean: table.mean, transmittance: table.transmittance };
    Lobes::finished(body, Finish::Plastic(coat))
}

pub(crate) fn film() -> Lobes {
    Lobes::finished(Vec3::new(0.3, 0.2, 0.1), Finish::Film { transmit: Vec3::new(0.1, 0.5, 0.6) })
}

/// All kinds of lobes, each with its name.
pub(crate) fn all() -> Vec<(String, Lobes)> {
    let mut list: Vec<(String, Lobes)> = Vec::new();
    for alpha in [0.15, 0.5, 1.0] {
        for beckmann in [false, true] {
            let rough = facets(alpha, beckmann);
            let which = if beckmann { "beckmann" } else { "ggx" };
            list.push((format!("metal {which} {alpha}"), metal(rough)));
            list.push((format!("glass {which} {alpha}"), glass(rough, 1.5)));
            list.push((format!("from glass {which} {alpha}"), glass(rough, 1.0 / 1.5)));
        }
    }
    for exponent in [1.0, 30.0] {
        let rough = Rough::Phong(exponent);
        list.push((format!("metal phong {exponent}"), metal(rough)));
        list.push((format!("glass phong {exponent}"), glass(rough, 1.5)));
        list.push((format!("from glass phong {exponent}"), glass(rough, 1.0 / 1.5)));
    }
    let red = Vec3::new(0.7, 0.2, 0.1);
    list.push(("plastic smooth".into(), plastic(None, red, false)));
    list.push(("plastic ggx".into(), plastic(Some(facets(0.2, false)), red, true)));
    list.push(("plastic beckmann".into(), plastic(Some(facets(0.3, true)), red, false)));
    list.push(("plastic phong".into(), plastic(Some(Rough::Phong(20.0)), red, true)));
    list.push(("film".into(), film()));
    list
}
