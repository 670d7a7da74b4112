//! What estimators that trace back from the sensor share: the first ray, the probe's surface, emission that is met, roulette, and sums of blocks.

use super::{Surface, mis};
use crate::bsdf::{Interface, Lobes};
use crate::geometry::{Ray, SurfacePoint};
use crate::light;
use crate::math::{self, Vec3};
use crate::sampling::sobol::BlockSampler;
use crate::scene::{CompiledScene, NO_INDEX};
use crate::sensor::Camera;

/// Number of edges after which roulette begins.
const ROULETTE_FROM: u32 = 5;
/// Largest probability of surviving the roulette.
const SURVIVAL_MAX: f32 = 0.95;
/// Group of sample dimensions for the pixel and the lens.
const SENSOR_GROUP: u32 = 0;

/// No ray: one of no direction.
pub(super) const NO_RAY: Ray = Ray { origin: Vec3::ZERO, direction: Vec3::ZERO, t_max: 0.0 };

/// A ray of the camera through pixel (x, y).
#[inline(always)]
pub(super) fn camera_ray(camera: &Camera, x: u32, y: u32, sampler: &BlockSampler) -> Ray {
    let [u, v, lens_u, lens_v] = if camera.lens_radius > 0.0 {
        sampler.group4(SENSOR_GROUP)
    } else {
        let [u, v] = sampler.group2(SENSOR_GROUP);
        [u, v, 0.0, 0.0]
    };
    camera.sample_ray(x, y, [u, v], [lens_u, lens_v])
}

/// A white Lambert surface at a point with unit normal `n`: pi times what it reflects is the irradiance there.
#[inline(always)]
pub(super) fn white_surface(point: SurfacePoint, n: Vec3) -> Surface {
    Surface {
        point,
        front: n,
        geometric: n,
        shading: n,
        interpolated: n,
        wo: n,
        lobes: Lobes::diffuse(Vec3::ONE),
        interface: Interface::Opaque,
        light: NO_INDEX,
        from_front: true,
    }
}

/// Radiance that a surface sends back along `ray` itself, and its weight against light sampling at `vertex`, where the ray's direction was drawn with density
/// `pdf` per solid angle (0: nothing competed with it). `share`: what the density of light sampling is multiplied by.
#[inline(always)]
pub(super) fn emission(
    scene: &CompiledScene,
    surface: &Surface,
    (ray, t): (&Ray, f32),
    (vertex, pdf): (Vec3, f32),
    share: f32,
) -> (Vec3, f32) {
    if surface.light == NO_INDEX || !surface.from_front {
        return (Vec3::ZERO, 0.0);
    }
    let Some(light) = scene.lights.get(surface.light as usize) else { return (Vec3::ZERO, 0.0) };
    let weight = if pdf > 0.0 {
        let other = light::pdf_solid_angle(light, vertex, ray.direction, t, surface.front);
        mis::power_heuristic(pdf, other * share)
    } else {
        1.0
    };
    (Vec3::from_array(light.radiance), weight)
}

/// Whether paths end by chance. They always do but for tests, which compare that with paths that end by absorption and depth alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Roulette {
    /// Number of edges after which it begins.
    from: u32,
}

impl Roulette {
    pub(crate) const ON: Self = Self { from: ROULETTE_FROM };
    #[cfg(test)]
    pub(crate) const OFF: Self = Self { from: u32::MAX };

    /// Anything is left to chance.
    #[inline(always)]
    pub(super) fn is_on(self) -> bool {
        self.from != u32::MAX
    }

    /// Throughput after a scattering that multiplies it by `weight`, if the path survives: from the fifth edge on with the chance of the weight's largest channel, at
    /// most 0.95. `depth`: edges before it.
    #[inline(always)]
    pub(super) fn play(self, throughput: Vec3, weight: Vec3, depth: u32, survive: f32) -> Option<Vec3> {
        let after = throughput * weight;
        if depth + 1 < self.from {
            return (after != Vec3::ZERO).then_some(after);
        }
        let q = math::max_component(weight).min(SURVIVAL_MAX);
        (survive < q).then(|| after / q)
    }
}

/// The channel of a path whose colours part: the one `chosen` already, or one drawn by `u` in [0, 1), which from here on stands for all three that are `carried`.
#[inline]
pub(super) fn choose_colour(chosen: &mut Option<u8>, carried: &mut Vec3, u: f32) -> usize {
    if let Some(channel) = *chosen {
        return usize::from(channel);
    }
    let channel = ((3.0 * u) as usize).min(2);
    *chosen = Some(channel as u8);
    *carried = one_colour(*carried, channel);
    channel
}

/// What a path or walk carries from where its colours part: one of them, which stands for all three.
#[inline]
pub(super) fn one_colour(carried: Vec3, channel: usize) -> Vec3 {
    let mut kept = Vec3::ZERO;
    kept[channel] = 3.0 * carried[channel];
    kept
}

/// Sum of samples in their order, and of their rays.
#[derive(Default)]
pub(super) struct BlockSum {
    sum: [f64; 3],
    rays: u64,
}

impl BlockSum {
    #[inline(always)]
    pub(super) fn add(&mut self, (value, rays): (Vec3, u32)) {
        self.rays += u64::from(rays);
        for (s, x) in self.sum.iter_mut().zip(value.to_array()) {
            *s += f64::from(x);
        }
    }

    /// Mean of `length` samples (a power of two, so that the division is exact), and the sum of their rays.
    #[inline(always)]
    pub(super) fn mean(&self, length: u32) -> ([f64; 3], u64) {
        (self.sum.map(|s| s / f64::from(length.max(1))), self.rays)
    }
}
