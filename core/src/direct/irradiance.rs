//! Direct irradiance of lights without size, in closed form but for the shadow ray.
//!
//! E = I(w) |cos| / d^2 V for a point light or a spot of intensity I, E0 |cos| V for a directional one \[W/m^2\]. Both sides of a surface count, as
//! photons count on both: what is asked for is the light that arrives at the place, from either side.

use crate::backend::PathJob;
use crate::geometry::{
    Hit, Intersector, Ray, SPHERE, SurfacePoint, hit_point_with, shape_normal, shape_point,
};
use crate::illumination::{Elements, FluxUnit};
use crate::light::{self, emit};
use crate::math::{self, Vec3};
use crate::sampling::sobol::BlockSampler;
use crate::sampling::warp;
use crate::scene::{CompiledScene, LightRecord};
use crate::transport::photon::LightPlan;
use crate::transport::volume::LightMedia;

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

/// A place on a primitive, uniform for two uniform numbers in [0, 1), and the unit normal of its front there. `None` for what has no area.
#[inline]
pub fn place_on(scene: &CompiledScene, primitive: u32, u: [f32; 2]) -> Option<(Vec3, Vec3)> {
    let (_, point, normal) = point_by(scene, primitive, u, |l| l)?;
    Some((point.position, normal))
}

/// A point of a primitive from two numbers in [0, 1), for a triangle of cell `cell` of its divisions.
#[inline]
fn point_on(
    scene: &CompiledScene,
    elements: &Elements,
    primitive: u32,
    cell: u32,
    u: [f32; 2],
) -> Option<(Hit, SurfacePoint, Vec3)> {
    point_by(scene, primitive, u, |l| elements.in_cell(primitive, cell, l))
}

/// A point of a primitive from two numbers in [0, 1), as a hit, with its unit normal; `bary` moves the second and third barycentrics. `None` for what has no area.
#[inline]
fn point_by(
    scene: &CompiledScene,
    primitive: u32,
    u: [f32; 2],
    bary: impl Fn([f32; 2]) -> [f32; 2],
) -> Option<(Hit, SurfacePoint, Vec3)> {
    let primitives = scene.primitives();
    let at = |b1, b2| Hit { t: 0.0, primitive, b1, b2 };
    if let Some(v) = primitives.vertices(primitive) {
        let surface = scene.surfaces.get(primitive as usize)?;
        let [_, l1, l2] = warp::sample_triangle(u);
        let [b1, b2] = bary([l1, l2]);
        return Some((
            at(b1, b2),
            hit_point_with(v, b1, b2, surface.sliver),
            Vec3::from_array(surface.normal),
        ));
    }
    let shape = primitives.shape(primitive)?;
    let centre = Vec3::from_array(shape.center);
    let near = if shape.kind == SPHERE {
        centre + warp::sample_sphere(u) * shape.radius
    } else {
        let (t, b) = math::orthonormal_basis(Vec3::from_array(shape.normal));
        let [x, y] = warp::sample_disk(u);
        centre + (t * x + b * y) * shape.radius
    };
    let point = shape_point(shape, near);
    Some((at(0.0, 0.0), point, shape_normal(shape, point.position)?))
}

/// The unit in which direct flux is summed: that of one photon that carries the scene's flux.
pub fn flux_unit(scene: &CompiledScene) -> FluxUnit {
    // A dark scene has no direct light, and no unit to count it in.
    FluxUnit::new(LightPlan::new(scene).map_or(1.0, |p| p.total().into_iter().fold(0.0, f64::max)), 1)
}

/// Direct flux \[W\] of all lights without size that arrives at a primitive, from one block of uniform points on each of its divisions, handed out with the
/// place and the side at which it arrives; and the shadow rays it took.
///
/// `media`: what the lights send into, by which, and by panes, light on its way is changed. Null boundaries, panes and smooth dielectrics hold no flux: all of it is sent on.
pub fn primitive_block<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    (intersector, media): (&I, &LightMedia),
    elements: &Elements,
    primitive: u32,
    job: &PathJob,
    block: u32,
    mut arrive: impl FnMut(&Hit, bool, Vec3),
) -> u64 {
    let cells = elements.cells(primitive);
    let area = scene.primitive_area(primitive) / (cells as f32 * job.block_length.max(1) as f32);
    let (mut rays, volume) = (0, scene.needs.volume());
    if volume && scene.material_of(primitive).is_passage() {
        return 0;
    }
    for cell in 0..cells {
        for i in 0..job.block_length {
            let u = BlockSampler::new(job.seed, primitive, block, i).group2(cell);
            let Some((hit, point, n)) = point_on(scene, elements, primitive, cell, u) else { continue };
            for (index, light) in scene.lights.iter().enumerate() {
                let Some((irradiance, ray)) = from_light(light, &point, n) else { continue };
                let left = if volume {
                    let (straight, took) =
                        media.straight(scene, intersector, index, &ray, (point.position, n));
                    rays += took;
                    straight.left
                } else {
                    rays += 1;
                    if intersector.occluded(&ray) { Vec3::ZERO } else { Vec3::ONE }
                };
                if left != Vec3::ZERO {
                    let from_front = emit::toward(light, point.position).dot(n) >= 0.0;
                    arrive(&hit, from_front, irradiance * left * area);
                }
            }
        }
    }
    rays
}
