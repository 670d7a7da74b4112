//! Photons as they leave a light: where, into which direction, and with how much flux.
//!
//! Quantity: flux Phi \[W\] per channel. Every light has a density of its own under which all its photons carry the same flux, its whole
//! flux: uniform over the sphere or the lit cone for lights without size (a spot's falloff is inverted, not weighted), uniform over the surface and
//! by the cosine for surface lights, uniform over the disk that the scene's bounding sphere shows for what comes from infinity.
//! (For the picture of an environment nearly so.) So a light's flux is also what its photons must add up to, and lights can be picked by it.

use super::extent;
use crate::geometry::{Ray, SurfacePoint, offset_origin};
use crate::math::{self, PI, TAU, Vec3};
use crate::sampling::warp;
use crate::scene::{CompiledScene, Glow, LightKind, LightRecord};

/// A photon on its way from a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Where and whereto; the direction is a unit vector, the origin is offset from a light's surface.
    pub ray: Ray,
    /// Flux \[W\] that photons of this light carry between them, per channel: divide by their number.
    pub flux: Vec3,
}

/// Whether a light has no size, so that its direct light is known in closed form at every point.
#[inline]
pub fn is_point_like(light: &LightRecord) -> bool {
    light.kind == LightKind::Point as u32
        || light.kind == LightKind::Spot as u32
        || light.kind == LightKind::Directional as u32
}

/// Unit direction from `p` towards a light without size, lit or not; zero at the light itself.
#[inline]
pub fn toward(light: &LightRecord, p: Vec3) -> Vec3 {
    if light.kind == LightKind::Directional as u32 {
        return -Vec3::from_array(light.normal);
    }
    math::normalize_or(Vec3::from_array(light.point) - p, Vec3::ZERO)
}

/// Emitted flux \[W\] per channel; of what comes from infinity what reaches a sphere of `radius` \[m\] around the scene.
#[inline]
pub fn flux(light: &LightRecord, radius: f32) -> Vec3 {
    let radiance = Vec3::from_array(light.radiance);
    if light.kind == LightKind::Point as u32 {
        radiance * (2.0 * TAU)
    } else if light.kind == LightKind::Spot as u32 {
        radiance * spot_solid_angle(light.params)
    } else if light.kind == LightKind::Directional as u32 {
        radiance * (PI * radius * radius)
    } else if light.kind == LightKind::Environment as u32 {
        Vec3::from_array(light.edge1) * (PI * radius * radius)
    } else {
        radiance * (PI * light.area)
    }
}

/// Flux \[W\] per channel of a constant environment of `radiance` into a sphere of `radius` \[m\]: pi L through each part of its surface.
#[inline]
pub fn environment_flux(radiance: Vec3, radius: f32) -> Vec3 {
    radiance * (PI * (2.0 * TAU * radius * radius))
}

/// Solid angle \[sr\] that gives a spot's flux with its axial intensity: the smoothstep's mean over its range of cosines is one half.
///
/// `1 - (cone + full) / 2` loses digits for narrow spots, as the cosines themselves do; the density below is the same one.
#[inline]
fn spot_solid_angle([cone, full]: [f32; 2]) -> f32 {
    TAU * ((1.0 - full) + 0.5 * (full - cone))
}

/// The x in [0, 1] with 2 x^3 - x^4 = `y`: the inverse of the distribution of a density in proportion to the smoothstep 3 x^2 - 2 x^3.
///
/// Convex and rising, so that Newton's steps from cbrt(y), which lies above, come down monotonously; three leave 4 units of 2^-24 and small x at 93 of their
/// own, four leave 2 of either (measured over 3 10^5 values down to 1e-30).
#[inline]
fn invert_smoothstep(y: f32) -> f32 {
    let mut x = math::cbrt(y);
    for _ in 0..4 {
        let x2 = x * x;
        let slope = x2 * (6.0 - 4.0 * x);
        let over = x2 * x * (2.0 - x) - y;
        // At x = 0 the answer is 0.
        if slope > 0.0 {
            x -= over / slope;
        }
    }
    x.clamp(0.0, 1.0)
}

/// Direction about a spot's axis with density in proportion to its intensity.
#[inline]
fn sample_spot(axis: Vec3, [cone, full]: [f32; 2], u: [f32; 2]) -> Vec3 {
    // Parts of the solid angle: the full cone, and half of the ring in which light falls off.
    let (inner, ring) = (1.0 - full, 0.5 * (full - cone));
    let at = u[0] * (inner + ring);
    let one_minus_cos = if at < inner || ring <= 0.0 {
        at.min(inner)
    } else {
        // From the rim inwards the intensity rises by the smoothstep.
        let rest = ((inner + ring) - at) / ring;
        (1.0 - cone) - (full - cone) * invert_smoothstep(rest.clamp(0.0, 1.0))
    };
    let sin = math::sqrt((one_minus_cos * (2.0 - one_minus_cos)).max(0.0));
    let (s, c) = math::sin_cos(TAU * u[1]);
    let (t, b) = math::orthonormal_basis(axis);
    t * (sin * c) + b * (sin * s) + axis * (1.0 - one_minus_cos)
}

/// Density per solid angle of the directions that [`emit`] draws at a place of a light that is near; `out`: unit direction away from it, `normal`: its own there.
#[inline]
pub fn pdf_direction(light: &LightRecord, out: Vec3, normal: Vec3) -> f32 {
    if light.kind == LightKind::Point as u32 {
        1.0 / (2.0 * TAU)
    } else if light.kind == LightKind::Spot as u32 {
        let axis = Vec3::from_array(light.edge1);
        super::spot_falloff(out.dot(axis), light.params) / spot_solid_angle(light.params)
    } else {
        out.dot(normal).max(0.0) * (1.0 / PI)
    }
}

/// A ray from far away through the disk that a bounding sphere shows.
#[inline]
fn from_infinity(travel: Vec3, (centre, radius): (Vec3, f32), u: [f32; 2]) -> Ray {
    let [x, y] = warp::sample_disk(u);
    let (t, b) = math::orthonormal_basis(travel);
    // A little outside, so that what touches the sphere is not behind the origin.
    let origin = centre + (t * x + b * y) * radius - travel * (radius * (1.0 + 1.0 / 1024.0));
    Ray { origin, direction: travel, t_max: f32::MAX }
}

/// A photon from a place on a surface light, by the cosine.
#[inline]
fn from_surface(light: &LightRecord, position: Vec3, normal: Vec3, u: [f32; 2]) -> Ray {
    let local = warp::sample_cosine_hemisphere(u);
    let (t, b) = math::orthonormal_basis(normal);
    let direction = t * local.x + b * local.y + normal * local.z;
    let start = SurfacePoint { position, extent: extent(light) };
    Ray { origin: offset_origin(&start, normal, direction), direction, t_max: f32::MAX }
}

/// A photon of one light, from four numbers in [0, 1); `sphere` is the scene's bounding sphere \[m\].
#[inline]
pub fn emit(light: &LightRecord, sphere: (Vec3, f32), u: [f32; 4]) -> Emission {
    let at = Vec3::from_array(light.point);
    let normal = Vec3::from_array(light.normal);
    let (e1, e2) = (Vec3::from_array(light.edge1), Vec3::from_array(light.edge2));
    let (place, way) = ([u[0], u[1]], [u[2], u[3]]);
    let ray = if light.kind == LightKind::Point as u32 {
        Ray { origin: at, direction: warp::sample_sphere(place), t_max: f32::MAX }
    } else if light.kind == LightKind::Spot as u32 {
        Ray { origin: at, direction: sample_spot(e1, light.params, place), t_max: f32::MAX }
    } else if light.kind == LightKind::Directional as u32 {
        from_infinity(normal, sphere, place)
    } else if light.kind == LightKind::Environment as u32 {
        // All directions alike; its picture is the scene's: see `emit_entry`.
        from_infinity(warp::sample_sphere(place), sphere, way)
    } else if light.kind == LightKind::Triangle as u32 {
        let [_, b1, b2] = warp::sample_triangle(place);
        from_surface(light, at + e1 * b1 + e2 * b2, normal, way)
    } else if light.kind == LightKind::Parallelogram as u32 {
        from_surface(light, at + e1 * place[0] + e2 * place[1], normal, way)
    } else if light.kind == LightKind::Disk as u32 {
        let [x, y] = warp::sample_disk(place);
        let (t, b) = math::orthonormal_basis(normal);
        from_surface(light, at + (t * x + b * y) * light.params[0], normal, way)
    } else {
        let out = warp::sample_sphere(place);
        from_surface(light, at + out * light.params[0], out, way)
    };
    Emission { ray, flux: flux(light, sphere.1) }
}

/// A photon of a constant environment, from four numbers in [0, 1).
#[inline]
pub fn emit_environment(radiance: Vec3, sphere: (Vec3, f32), u: [f32; 4]) -> Emission {
    let travel = warp::sample_sphere([u[0], u[1]]);
    Emission { ray: from_infinity(travel, sphere, [u[2], u[3]]), flux: environment_flux(radiance, sphere.1) }
}

/// A photon of the picture of an environment: by its density, and uniform over the disk. Unlike those of other lights its flux, L pi R^2 / density, is not the same for all: radiance is bilinear
/// where the density is constant.
#[inline(never)]
fn emit_picture(scene: &CompiledScene, sphere: (Vec3, f32), u: [f32; 4]) -> Emission {
    let way = [u[2], u[3]];
    let Some(map) = &scene.environment_map else {
        return emit_environment(Vec3::ZERO, sphere, u);
    };
    let s = map.sample_units([u[0], u[1]], way);
    let flux = if s.pdf > 0.0 { s.radiance * (PI * sphere.1 * sphere.1 / s.pdf) } else { Vec3::ZERO };
    Emission { ray: from_infinity(-s.wi, sphere, way), flux }
}

/// A photon of the environment that is the same all round, or of a medium that emits.
#[inline(never)]
fn emit_beyond(scene: &CompiledScene, index: usize, sphere: (Vec3, f32), u: [f32; 4]) -> Emission {
    let Some(Glow { bounds, .. }) = glow(scene, index) else {
        return emit_environment(Vec3::from_array(scene.environment), sphere, u);
    };
    let origin = bounds.lo + (bounds.hi - bounds.lo) * Vec3::new(u[0], u[1], u[2]);
    let ray = Ray { origin, direction: Vec3::ZERO, t_max: f32::MAX };
    Emission { ray, flux: entry_flux(scene, index) }
}

/// Mean flux \[W\] of entry `index` of what emits in a scene: its lights, after them the environment, then the media that emit. 0 beyond that.
pub fn mean_flux(scene: &CompiledScene, index: usize) -> f32 {
    math::mean(entry_flux(scene, index))
}

/// How many entries there are.
pub fn entries(scene: &CompiledScene) -> usize {
    scene.lights.len() + 1 + scene.glows.len()
}

/// The medium of an entry that is one.
#[inline]
pub fn glow(scene: &CompiledScene, index: usize) -> Option<&Glow> {
    scene.glows.get(index.checked_sub(scene.lights.len() + 1)?)
}

/// Flux \[W\] per channel of entry `index` of what emits in a scene; see [`mean_flux`]. Of a medium what would be sent if it filled its box: 4 pi j V, j the radiance that it emits per metre.
pub fn entry_flux(scene: &CompiledScene, index: usize) -> Vec3 {
    let radius = scene.bounding_sphere().1;
    if let Some(light) = scene.lights.get(index) {
        return flux(light, radius);
    }
    let Some(glow) = glow(scene, index) else {
        let environment = index == scene.lights.len();
        let radiance = if environment { Vec3::from_array(scene.environment) } else { Vec3::ZERO };
        return environment_flux(radiance, radius);
    };
    let size = glow.bounds.hi - glow.bounds.lo;
    let radiance = scene.media.get(usize::from(glow.medium) - 1).map_or([0.0; 3], |m| m.emission);
    Vec3::from_array(radiance) * (2.0 * TAU * (size.x * size.y * size.z))
}

/// A photon of entry `index` of what emits in a scene, and whether that is a light without size; see [`mean_flux`]. In the box of a medium it has a place and no direction yet: whoever knows what lies there gives it
/// one, or ends it.
#[inline]
pub fn emit_entry(scene: &CompiledScene, index: usize, sphere: (Vec3, f32), u: [f32; 4]) -> (Emission, bool) {
    match scene.lights.get(index) {
        Some(light) if light.kind == LightKind::Environment as u32 => (emit_picture(scene, sphere, u), false),
        Some(light) => (emit(light, sphere, u), is_point_like(light)),
        None => (emit_beyond(scene, index, sphere, u), false),
    }
}
