//! Direct irradiance of lights without size, in closed form but for the shadow ray.
//!
//! E = I(w) |cos| / d^2 V for a point light or a spot of intensity I, E0 |cos| V for a directional one \[W/m^2\]. Both sides of a surface count, as
//! photons count on both: what is asked for is the light that arrives at the place, from either side.

use crate::geometry::{Intersector, Ray, SPHERE, SurfacePoint, hit_point_with, shape_normal, shape_point};
use crate::light::{self, emit};
use crate::math::{self, Vec3};
use crate::sampling::sobol::BlockSampler;
use crate::sampling::warp;
use crate::scene::{CompiledScene, LightRecord};

/// Unshadowed irradiance \[W/m^2\] of a light without size at a point with unit normal `n`, and the ray that must be free. `None` where nothing
/// arrives, and for lights with size.
#[inline]
pub fn from_light(light: &LightRecord, point: &SurfacePoint, n: Vec3) -> Option<(Vec3, Ray)> {
    if !emit::is_point_like(light) {
        return None;
    }
    let s = light::sample(light, point.position, [0.0; 2])?;
    let cos = s.wi.dot(n);
    let side = if cos < 0.0 { -n } else { n };
    // The sample is divided by the chance of the light to be picked, of which there is none here.
    let irradiance = s.contribution * (light.pmf * cos.abs());
    (irradiance != Vec3::ZERO).then(|| (irradiance, light::shadow_ray(&s, point, side)))
}

/// A point uniform over a primitive, with its unit normal; `None` for what has no area.
#[inline]
fn point_on(scene: &CompiledScene, element: u32, u: [f32; 2]) -> Option<(SurfacePoint, Vec3)> {
    let primitives = scene.primitives();
    if let Some(v) = primitives.vertices(element) {
        let surface = scene.surfaces.get(element as usize)?;
        let [_, b1, b2] = warp::sample_triangle(u);
        return Some((hit_point_with(v, b1, b2, surface.sliver), Vec3::from_array(surface.normal)));
    }
    let shape = primitives.shape(element)?;
    let centre = Vec3::from_array(shape.center);
    let near = if shape.kind == SPHERE {
        centre + warp::sample_sphere(u) * shape.radius
    } else {
        let (t, b) = math::orthonormal_basis(Vec3::from_array(shape.normal));
        let [x, y] = warp::sample_disk(u);
        centre + (t * x + b * y) * shape.radius
    };
    let point = shape_point(shape, near);
    Some((point, shape_normal(shape, point.position)?))
}

/// Mean direct irradiance \[W/m^2\] of all lights without size over a primitive, from one block of uniform points on it; and the shadow rays it took.
pub fn element_block<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    element: u32,
    seed: u64,
    block: u32,
    block_length: u32,
) -> ([f64; 3], u64) {
    let (mut sum, mut rays) = ([0.0_f64; 3], 0);
    for i in 0..block_length {
        let u = BlockSampler::new(seed, element, block, i).group2(0);
        let Some((point, n)) = point_on(scene, element, u) else { continue };
        for light in &scene.lights {
            let Some((irradiance, ray)) = from_light(light, &point, n) else { continue };
            rays += 1;
            if !intersector.occluded(&ray) {
                for (s, x) in sum.iter_mut().zip(irradiance.to_array()) {
                    *s += f64::from(x);
                }
            }
        }
    }
    (sum.map(|s| s / f64::from(block_length.max(1))), rays)
}
