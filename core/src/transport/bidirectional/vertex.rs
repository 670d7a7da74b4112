//! A place where a walk was scattered: on a surface or in a medium.

use super::weight::Chain;
use crate::bsdf::{BsdfSample, Lobes, diffuse};
use crate::geometry::{SurfacePoint, offset_origin};
use crate::math::{self, Vec3};
use crate::medium::{Inside, phase};
use crate::transport::Surface;
use crate::transport::volume::lead;

/// From which end of a path a walk comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum From {
    Light,
    Sensor,
}

/// What scatters there.
#[derive(Clone, Copy, Debug)]
pub(super) enum Scatterer {
    Surface {
        lobes: Lobes,
        /// Unit geometric normal on the side of `wo`.
        geometric: Vec3,
        /// Unit normal that lobes are evaluated about, on the same side of the surface; interpolated ones need not be on the side of `wo` itself.
        shading: Vec3,
    },
    Medium {
        /// Henyey-Greenstein mean cosine.
        g: f32,
        /// Mean extinction \[1/m\]: what turns a density of directions into one per volume.
        extinction: f32,
    },
}

/// A vertex that the other walk can be connected to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub point: SurfacePoint,
    /// Unit direction back to where the walk came from.
    pub wo: Vec3,
    pub scatterer: Scatterer,
    /// What the walk carries on arriving here; in a medium times its scattering coefficient.
    pub carried: Vec3,
    /// The media on the side of `wo`, and beyond the surface.
    pub inside: Inside,
    pub beyond: Inside,
    pub chain: Chain,
    /// Edges up to here.
    pub edges: u32,
    /// Number in its walk.
    pub index: u32,
    /// The walk is of one colour.
    pub coloured: bool,
}

impl Vertex {
    #[inline]
    pub(super) fn at_surface(surface: &Surface, chain: Chain) -> Self {
        let scatterer = Scatterer::Surface {
            lobes: surface.lobes,
            geometric: surface.geometric,
            shading: surface.interpolated,
        };
        Self { point: surface.point, wo: surface.wo, scatterer, ..Self::nowhere(chain) }
    }

    /// To be filled in.
    #[inline]
    pub(super) fn nowhere(chain: Chain) -> Self {
        Self {
            point: SurfacePoint { position: Vec3::ZERO, extent: 0.0 },
            wo: Vec3::ZERO,
            scatterer: Scatterer::Medium { g: 0.0, extinction: 0.0 },
            carried: Vec3::ZERO,
            inside: Inside::NOTHING,
            beyond: Inside::NOTHING,
            chain,
            edges: 0,
            index: 0,
            coloured: false,
        }
    }

    #[inline]
    pub(super) fn position(&self) -> Vec3 {
        self.point.position
    }

    /// Some way to scatter has a density.
    #[inline]
    pub(super) fn connects(&self) -> bool {
        match &self.scatterer {
            Scatterer::Surface { lobes, .. } => lobes.has_density(),
            Scatterer::Medium { .. } => true,
        }
    }

    /// What turns a density of directions at a point in direction `wi`, at the squared distance `d2`, into one of this vertex: cosine or extinction over that.
    #[inline]
    pub(super) fn facing(&self, wi: Vec3, d2: f32) -> f32 {
        (match &self.scatterer {
            Scatterer::Surface { geometric, .. } => math::abs(geometric.dot(wi)),
            Scatterer::Medium { extinction, .. } => *extinction,
        }) / d2
    }

    /// Geometric normal; zero in a medium.
    #[inline]
    pub(super) fn normal(&self) -> Vec3 {
        match &self.scatterer {
            Scatterer::Surface { geometric, .. } => *geometric,
            Scatterer::Medium { .. } => Vec3::ZERO,
        }
    }

    /// f cos for light that goes on to `wi`, per channel: for a walk from the sensor by the shading normal, for one from a light by what makes it the same path (Veach 1997, section 5.3).
    /// In a medium the phase function. And the densities of `wi`, and of the way back if light came from there.
    #[inline]
    pub(super) fn scattering<const LOBES: bool, const SHADING: bool>(
        &self,
        from: From,
        wi: Vec3,
    ) -> (Vec3, [f32; 2]) {
        match &self.scatterer {
            Scatterer::Medium { g, .. } => {
                let p = phase::eval(*g, self.wo, wi);
                (Vec3::splat(p), [p; 2])
            }
            Scatterer::Surface { lobes, geometric, shading } => {
                let (there, here) = (wi.dot(*geometric), self.wo.dot(*geometric));
                if there <= 0.0 && !(LOBES && lobes.transmits()) {
                    return (Vec3::ZERO, [0.0; 2]);
                }
                // The normal that lobes are seen about from a direction: an interpolated one that points away from it does not count.
                let about = |w: Vec3| {
                    let side = if w.dot(*geometric) < 0.0 { -1.0 } else { 1.0 };
                    if !SHADING || side * w.dot(*shading) > 0.0 { *shading } else { *geometric }
                };
                let (sensor, light) = match from {
                    From::Sensor => (self.wo, wi),
                    From::Light => (wi, self.wo),
                };
                let n = about(sensor);
                let f =
                    if LOBES { lobes.eval(n, sensor, light) } else { diffuse::eval(lobes.albedo, n, light) };
                let f = match from {
                    _ if !SHADING => f * math::abs(there),
                    From::Sensor => f * math::abs(light.dot(n)),
                    From::Light => f * math::abs(light.dot(n) * there / here),
                };
                let pdf = |from: Vec3, to: Vec3| {
                    let n = about(from);
                    if LOBES { lobes.pdf_solid_angle(n, from, to) } else { diffuse::pdf_solid_angle(n, to) }
                };
                (f, [pdf(self.wo, wi), pdf(wi, self.wo)])
            }
        }
    }

    /// A direction with what the walk is multiplied by; its density is 0 where it has none.
    #[inline]
    pub(super) fn sample<const LOBES: bool, const SHADING: bool>(
        &self,
        from: From,
        u: [f32; 2],
        lobe: f32,
    ) -> Option<(BsdfSample, Option<[f32; 2]>)> {
        match &self.scatterer {
            Scatterer::Medium { g, .. } => {
                let wi = phase::sample(*g, self.wo, u);
                let pdf = phase::eval(*g, self.wo, wi);
                Some((BsdfSample { wi, weight: Vec3::ONE, pdf }, Some([pdf; 2])))
            }
            Scatterer::Surface { lobes, geometric, shading } => {
                let n = if !SHADING || self.wo.dot(*shading) > 0.0 { *shading } else { *geometric };
                let mut s = lobes.sample(n, self.wo, u, lobe)?;
                let (there, here) = (s.wi.dot(*geometric), self.wo.dot(*geometric));
                // An interpolated normal can send light to the wrong side.
                if SHADING && (there > 0.0) != (s.wi.dot(n) > 0.0) {
                    return None;
                }
                if s.pdf <= 0.0 {
                    if SHADING && from == From::Light {
                        s.weight *= math::abs(self.wo.dot(n) * there / (here * s.wi.dot(n)));
                    }
                    return Some((s, None));
                }
                if !(SHADING || LOBES && lobes.transmits()) {
                    return Some((s, Some([s.pdf, lobes.pdf_solid_angle(n, s.wi, self.wo)])));
                }
                let (f, pdf) = self.scattering::<LOBES, SHADING>(from, s.wi);
                s.weight = f / s.pdf;
                Some((s, Some([s.pdf, pdf[1]])))
            }
        }
    }

    /// What radiance is divided by where the sensor's walk goes on to `wi` in another medium, which the index squeezes; importance keeps its measure.
    #[inline]
    pub(super) fn index_ratio_squared(&self, from: From, wi: Vec3) -> f32 {
        match &self.scatterer {
            Scatterer::Surface { lobes, shading, .. } if from == From::Sensor => {
                lobes.index_ratio_squared(*shading, self.wo, wi)
            }
            _ => 1.0,
        }
    }

    /// Start of a ray into a direction.
    #[inline]
    pub(super) fn leave(&self, wi: Vec3) -> Vec3 {
        match &self.scatterer {
            Scatterer::Surface { geometric, .. } => offset_origin(&self.point, *geometric, wi),
            Scatterer::Medium { .. } => self.point.position,
        }
    }

    /// What lies between the vertex and the start of a ray from it \[m\]; see [`crate::transport::volume`].
    #[inline]
    pub(super) fn lead(&self, origin: Vec3, wi: Vec3) -> f32 {
        match &self.scatterer {
            Scatterer::Surface { geometric, .. } => lead((self.point.position, *geometric), origin, wi),
            Scatterer::Medium { .. } => 0.0,
        }
    }

    /// The media on the side of a direction.
    #[inline]
    pub(super) fn media(&self, wi: Vec3) -> Inside {
        match &self.scatterer {
            Scatterer::Surface { geometric, .. } if wi.dot(*geometric) < 0.0 => self.beyond,
            _ => self.inside,
        }
    }
}
