//! Boundaries that light passes: smooth dielectrics, at which it is refracted, and panes, which it passes straight on.

use super::{fresnel, phong};
use crate::math::{self, Vec3};

/// What a surface lets through.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Interface {
    /// Nothing: all is in the lobes.
    #[default]
    Opaque,
    /// A smooth boundary between dielectrics.
    Dielectric {
        /// Index beyond the boundary over that before it, per channel.
        ratio: Vec3,
        /// By Schlick's fit instead of Fresnel's equations.
        schlick: bool,
    },
    /// A thin pane or film as seen at an angle: a mirror, and a filter that is passed straight on.
    Pane {
        /// What is reflected.
        reflect: Vec3,
        /// What passes.
        transmit: Vec3,
    },
}

/// Where light went on at a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Unit direction.
    pub wi: Vec3,
    /// What the throughput is multiplied by.
    pub weight: Vec3,
    /// It is beyond the boundary now.
    pub through: bool,
}

impl Interface {
    /// A thin plate of a dielectric seen under this cosine, all reflections between its faces included: R' = 2 R / (1 + R), and the rest passes.
    #[inline]
    pub fn plate(cos: f32, ior: Vec3, schlick: bool) -> Self {
        let one = |ior: f32| {
            let r = if schlick { fresnel::schlick(cos, ior) } else { fresnel::dielectric(cos, ior) };
            2.0 * r / (1.0 + r)
        };
        let reflect = Vec3::new(one(ior.x), one(ior.y), one(ior.z));
        Self::Pane { reflect, transmit: Vec3::ONE - reflect }
    }

    /// Refracts channels differently.
    #[inline(always)]
    pub fn disperses(&self) -> bool {
        matches!(self, Self::Dielectric { ratio, .. } if ratio.x != ratio.y || ratio.x != ratio.z)
    }

    /// What passes straight on, and the chance of [`Self::pass`] to choose that; `None` where light is refracted or does not pass.
    #[inline(always)]
    pub fn straight(&self) -> Option<(Vec3, f32)> {
        let Self::Pane { reflect, transmit } = *self else { return None };
        let (r, t) = (math::mean(reflect), math::mean(transmit));
        Some((transmit, if t > 0.0 { t / (r + t) } else { 0.0 }))
    }

    /// Chooses between reflecting and passing, in proportion to what either carries; `n` on the side of `wo`, u in [0, 1). `channel`: the one whose refraction counts (0 to 2).
    /// `None` where all is absorbed.
    ///
    /// What is carried is radiance: passing a boundary it is multiplied by the square of the index before over the index beyond.
    #[inline(always)]
    pub fn pass(&self, n: Vec3, wo: Vec3, channel: usize, u: f32) -> Option<Passage> {
        match *self {
            Self::Opaque => None,
            Self::Dielectric { ratio, schlick } => {
                let ratio = ratio[channel % 3];
                let cos = wo.dot(n).clamp(0.0, 1.0);
                let r = if schlick { fresnel::schlick(cos, ratio) } else { fresnel::dielectric(cos, ratio) };
                if u < r {
                    let wi = phong::mirror_direction(n, wo);
                    return Some(Passage { wi, weight: Vec3::ONE, through: false });
                }
                let wi = fresnel::refract(n, wo, ratio)?;
                Some(Passage { wi, weight: Vec3::splat(1.0 / (ratio * ratio)), through: true })
            }
            Self::Pane { reflect, transmit } => {
                let (r, t) = (math::mean(reflect), math::mean(transmit));
                if r + t <= 0.0 {
                    return None;
                }
                let chance = r / (r + t);
                if u < chance {
                    let wi = phong::mirror_direction(n, wo);
                    return Some(Passage { wi, weight: reflect / chance, through: false });
                }
                Some(Passage { wi: -wo, weight: transmit / (1.0 - chance), through: true })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "truth in f64")]

    use super::*;

    #[test]
    fn what_is_reflected_and_what_passes_is_all_there_is() {
        for interface in [
            Interface::Dielectric { ratio: Vec3::splat(1.5), schlick: false },
            Interface::Dielectric { ratio: Vec3::splat(1.0 / 1.5), schlick: true },
            Interface::plate(0.6, Vec3::new(1.5, 1.6, 1.7), false),
            Interface::Pane { reflect: Vec3::new(0.2, 0.0, 0.5), transmit: Vec3::new(0.8, 1.0, 0.5) },
        ] {
            let wo = Vec3::new(0.8, 0.0, 0.6);
            let (mut sum, n) = (Vec3::ZERO, 4096);
            for i in 0..n {
                let p = interface.pass(Vec3::Z, wo, 0, (i as f32 + 0.5) / n as f32).unwrap();
                assert!((p.wi.length() - 1.0).abs() < 1e-6 && p.through == (p.wi.z < 0.0));
                // Flux, not radiance.
                let flux = match interface {
                    Interface::Dielectric { ratio, .. } if p.through => ratio.x * ratio.x,
                    _ => 1.0,
                };
                sum += p.weight * flux / n as f32;
            }
            assert!((sum - Vec3::ONE).abs().max_element() < 2e-3, "{interface:?}: {sum}");
        }
        assert_eq!(Interface::Opaque.pass(Vec3::Z, Vec3::Z, 0, 0.5), None);
        let black = Interface::Pane { reflect: Vec3::ZERO, transmit: Vec3::ZERO };
        assert_eq!(black.pass(Vec3::Z, Vec3::Z, 0, 0.5), None);
    }

    #[test]
    fn a_plate_transmits_what_tables_say() {
        // (1 - R) / (1 + R) of a lossless pane without polarisation.
        for (n, degrees, t) in [
            (1.5, 0.0, 0.923_076_923_1),
            (1.5, 30.0, 0.920_265_532_5),
            (1.5, 60.0, 0.836_232_462_7),
            (1.33, 60.0, 0.888_350_164_9),
        ] {
            let cos = f64::to_radians(degrees).cos() as f32;
            let Interface::Pane { transmit, .. } = Interface::plate(cos, Vec3::splat(n), false) else {
                panic!()
            };
            assert!((f64::from(transmit.x) - t).abs() < 2e-6, "{n} {degrees}: {transmit}");
        }
    }
}
