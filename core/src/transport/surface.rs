//! What a ray finds at a hit: point, normals, lobes, emission.

use super::gather::ProbePlace;
use super::volume::{boundaries::resolve, lead};
use crate::bsdf::plastic::{Coat, CoatTable};
use crate::bsdf::{Boundary, Finish, Interface, Lobes, Metal, Passage, fresnel};
use crate::geometry::{
    Hit, Intersector, PrimitiveId, Ray, SurfacePoint, hit_point_with, offset_origin, shape_normal,
    shape_point,
};
use crate::math::{self, Vec3};
use crate::medium::Inside;
use crate::scene::{CompiledScene, MaterialRecord, SceneNeeds, material_flags, sample_bitmap};

/// Which code a scene needs at a hit; each combination is an instance of its own, so that what is absent costs
/// nothing. Three flags make the eight instances that are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportCode {
    /// Anything but two-sided diffuse surfaces.
    pub lobes: bool,
    /// Bitmaps and checkers.
    pub textures: bool,
    /// Interpolated normals.
    pub shading_normals: bool,
}

impl TransportCode {
    /// The code that a scene needs.
    pub fn of(needs: &SceneNeeds) -> Self {
        Self { lobes: needs.lobes(), textures: needs.textures, shading_normals: needs.shading_normals }
    }

    /// All of it: what a scene costs that is not asked what it needs.
    pub const FULL: Self = Self { lobes: true, textures: true, shading_normals: true };
}

/// Runs `$body` with `$tracer` bound to the instance of `$kind` that has just the code that `$code` names.
#[doc(hidden)]
#[macro_export]
macro_rules! with_transport_code {
    ($code:expr, |$tracer:ident = $kind:ident($($argument:expr),*)| $body:expr) => {{
        let code: $crate::transport::TransportCode = $code;
        macro_rules! instance {
            ($l:literal, $t:literal, $s:literal) => {{
                let $tracer = $kind::<$l, $t, $s>::new($($argument),*);
                $body
            }};
        }
        // Fuzzers' instruments make each instance slow to compile, and none differs by a bit: they have the one with everything.
        match (code.lobes, code.textures, code.shading_normals) {
            #[cfg(not(fuzzing))]
            (false, false, false) => instance!(false, false, false),
            #[cfg(not(fuzzing))]
            (false, false, true) => instance!(false, false, true),
            #[cfg(not(fuzzing))]
            (false, true, false) => instance!(false, true, false),
            #[cfg(not(fuzzing))]
            (false, true, true) => instance!(false, true, true),
            #[cfg(not(fuzzing))]
            (true, false, false) => instance!(true, false, false),
            #[cfg(not(fuzzing))]
            (true, false, true) => instance!(true, false, true),
            #[cfg(not(fuzzing))]
            (true, true, false) => instance!(true, true, false),
            _ => instance!(true, true, true),
        }
    }};
}

/// A surface point as a path sees it.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where, with the extent that scales its rounding.
    pub point: SurfacePoint,
    /// Unit geometric normal of the front.
    pub front: Vec3,
    /// Unit geometric normal on the side of `wo`.
    pub geometric: Vec3,
    /// Unit normal that lobes are evaluated about, on the side of `wo`.
    pub shading: Vec3,
    /// Unit interpolated normal on the side of `geometric`, whether or not it points away from `wo`.
    pub interpolated: Vec3,
    /// Unit direction back along the ray.
    pub wo: Vec3,
    /// What is reflected; black from behind a one-sided surface.
    pub lobes: Lobes,
    /// What passes, and is reflected with it.
    pub interface: Interface,
    /// Index of the light that the primitive is, or [`NO_INDEX`](crate::scene::NO_INDEX).
    pub light: u32,
    /// The ray met the front.
    pub from_front: bool,
}

impl Surface {
    /// What depends on the angle: metals, plates and films, and on the side: dielectrics; and what has a finish.
    #[inline(always)]
    fn refine(&mut self, scene: &CompiledScene, material: &MaterialRecord) {
        const FINISHED: u32 = material_flags::ROUGH | material_flags::PLASTIC | material_flags::SCATTERS;
        const ANY: u32 =
            material_flags::CONDUCTOR | material_flags::DIELECTRIC | material_flags::FILM | FINISHED;
        if material.flags & ANY == 0 {
            return;
        }
        if material.flags & FINISHED == 0 {
            self.refine_smooth(material);
        } else {
            self.finish(scene, material);
        }
    }

    #[inline(never)]
    fn finish(&mut self, scene: &CompiledScene, material: &MaterialRecord) {
        let has = |flag: u32| material.flags & flag != 0;
        let (ior, second) = (Vec3::from_array(material.ior), Vec3::from_array(material.specular));
        let albedo = self.lobes.albedo;
        self.lobes = Lobes::diffuse(Vec3::ZERO);
        if has(material_flags::SCATTERS) {
            // Both sides, whatever the material says of them.
            let albedo = Vec3::from_array(material.albedo);
            self.lobes = Lobes::finished(albedo, Finish::Film { transmit: second });
            return;
        }
        if has(material_flags::DIELECTRIC) {
            let ratio = if self.from_front { ior } else { Vec3::ONE / ior };
            if let Some(rough) = material.rough() {
                let boundary = Boundary { rough, ratio, schlick: has(material_flags::SCHLICK) };
                self.lobes = Lobes::finished(Vec3::ZERO, Finish::Boundary(boundary));
            }
            return;
        }
        // Black from behind where it has one side.
        if !has(material_flags::TWO_SIDED) && !self.from_front {
            return;
        }
        if has(material_flags::PLASTIC) {
            let Some(coat) = scene.coats.get(material.coat as usize) else { return };
            let body = CoatTable::body(coat.internal, ior.x, albedo, has(material_flags::NONLINEAR));
            let (mean, transmittance) = (coat.mean, coat.transmittance);
            let coat = Coat { ior: ior.x, rough: material.rough(), mean, transmittance };
            self.lobes = Lobes::finished(body, Finish::Plastic(coat));
        } else if let Some(rough) = material.rough() {
            let metal = Metal { rough, eta: ior, k: second };
            self.lobes = Lobes::finished(Vec3::ZERO, Finish::Metal(metal));
        }
    }

    fn refine_smooth(&mut self, material: &MaterialRecord) {
        let has = |flag: u32| material.flags & flag != 0;
        let (ior, second) = (Vec3::from_array(material.ior), Vec3::from_array(material.specular));
        let cos = self.wo.dot(self.shading).clamp(0.0, 1.0);
        if has(material_flags::CONDUCTOR) {
            // Black from behind where it has one side.
            if self.lobes.mirror {
                self.lobes.albedo = fresnel::conductor_rgb(cos, ior, second);
            }
            self.lobes.specular = Vec3::ZERO;
            return;
        }
        self.lobes = Lobes::diffuse(Vec3::ZERO);
        let schlick = has(material_flags::SCHLICK);
        self.interface = if has(material_flags::FILM) {
            Interface::Pane { reflect: Vec3::from_array(material.albedo), transmit: second }
        } else if has(material_flags::THIN) {
            Interface::plate(cos, ior, schlick)
        } else {
            let ratio = if self.from_front { ior } else { Vec3::ONE / ior };
            Interface::Dielectric { ratio, schlick }
        };
    }

    /// Where light goes on at a smooth boundary, for one channel; u in [0, 1). `None` where all is absorbed, or an interpolated normal would send it to the wrong side.
    #[inline(always)]
    pub(in crate::transport) fn passage<const SHADING: bool>(
        &self,
        channel: usize,
        u: f32,
    ) -> Option<Passage> {
        let passage = self.interface.pass(self.shading, self.wo, channel, u)?;
        let wrong = SHADING && (passage.wi.dot(self.geometric) < 0.0) != passage.through;
        (!wrong).then_some(passage)
    }

    /// What lies between the surface and the start of a ray that leaves it \[m\].
    #[inline(always)]
    pub(in crate::transport) fn lead(&self, origin: Vec3, direction: Vec3) -> f32 {
        lead((self.point.position, self.geometric), origin, direction)
    }

    /// Start of a ray into direction `wi`.
    #[inline(always)]
    pub fn leave(&self, wi: Vec3) -> Vec3 {
        offset_origin(&self.point, self.geometric, wi)
    }
}

/// Evaluates the surface at a hit. `None` where the hit names no usable surface (never for hits of this scene).
#[inline(always)]
pub fn surface_at<const LOBES: bool, const TEXTURES: bool, const SHADING: bool>(
    scene: &CompiledScene,
    ray: &Ray,
    hit: &Hit,
) -> Option<Surface> {
    let record = scene.surfaces.get(hit.primitive as usize)?;
    let material = scene.materials.get(record.material as usize)?;
    let wo = -ray.direction;
    let mut vertex = None;
    let (point, front) = match scene.triangles.get(hit.primitive as usize) {
        Some(t) => {
            vertex = Some(*t);
            let v = t.map(|i| Vec3::from_array(scene.positions[i as usize]));
            (hit_point_with(v, hit.b1, hit.b2, record.sliver), Vec3::from_array(record.normal))
        }
        None => {
            let shape = scene.shapes.get(hit.primitive as usize - scene.triangles.len())?;
            let point = shape_point(shape, ray.origin + ray.direction * hit.t);
            (point, shape_normal(shape, point.position)?)
        }
    };
    let from_front = wo.dot(front) >= 0.0;
    let geometric = if from_front { front } else { -front };
    let mut albedo = Vec3::from_array(material.albedo);
    if TEXTURES && material.is_textured() {
        albedo *= textured(scene, material, vertex, hit);
    }
    let lobes = if LOBES {
        if material.flags & material_flags::TWO_SIDED == 0 && !from_front {
            Lobes::diffuse(Vec3::ZERO)
        } else {
            Lobes {
                albedo,
                specular: Vec3::from_array(material.specular),
                exponent: material.exponent,
                mirror: material.flags & material_flags::MIRROR != 0,
                finish: Finish::Plain,
            }
        }
    } else {
        Lobes::diffuse(albedo)
    };
    let (mut shading, mut interpolated) = (geometric, geometric);
    if SHADING && record.flags & material_flags::SHADING_NORMALS != 0 {
        interpolated = interpolated_normal(scene, vertex, hit, from_front).unwrap_or(geometric);
        if interpolated.dot(wo) > 0.0 {
            shading = interpolated;
        }
    }
    let mut surface = Surface {
        point,
        front,
        geometric,
        shading,
        interpolated,
        wo,
        lobes,
        interface: Interface::Opaque,
        light: record.light,
        from_front,
    };
    if LOBES {
        surface.refine(scene, material);
    }
    Some(surface)
}

/// Albedo per channel at a hit, bitmaps and patterns included; black for an unknown primitive. Sides are not asked for.
pub(crate) fn albedo_at(scene: &CompiledScene, hit: &Hit) -> Vec3 {
    let Some(record) = scene.surfaces.get(hit.primitive as usize) else { return Vec3::ZERO };
    let Some(material) = scene.materials.get(record.material as usize) else { return Vec3::ZERO };
    let albedo = Vec3::from_array(material.albedo);
    if !material.is_textured() {
        return albedo;
    }
    albedo * textured(scene, material, scene.triangles.get(hit.primitive as usize).copied(), hit)
}

/// What the bitmap and the pattern of a material multiply its albedo by; 1 on round shapes, which have no texture coordinates.
#[inline]
fn textured(scene: &CompiledScene, material: &MaterialRecord, vertex: Option<[u32; 3]>, hit: &Hit) -> Vec3 {
    let Some(t) = vertex else { return Vec3::ONE };
    let at = |i: u32| scene.texcoords.get(i as usize).copied().unwrap_or([0.0; 2]);
    let [a, b, c] = t.map(at);
    let b0 = 1.0 - hit.b1 - hit.b2;
    let uv = [0, 1].map(|k| b0 * a[k] + hit.b1 * b[k] + hit.b2 * c[k]);
    let mut color = Vec3::ONE;
    if let Some(record) = scene.textures.get(material.texture as usize) {
        color *= sample_bitmap(record, &scene.texels, &scene.srgb_decode, uv);
    }
    if let Some(checker) = scene.checkers.get(material.checker as usize) {
        color *= checker.color(uv);
    }
    color
}

/// The unit interpolated normal on the side of the surface that was met, or `None` where it is missing.
#[inline]
fn interpolated_normal(
    scene: &CompiledScene,
    vertex: Option<[u32; 3]>,
    hit: &Hit,
    from_front: bool,
) -> Option<Vec3> {
    let normal = |i: u32| Vec3::from_array(scene.normals.get(i as usize).copied().unwrap_or([0.0; 3]));
    let [a, b, c] = vertex?.map(normal);
    let sum = a * (1.0 - hit.b1 - hit.b2) + b * hit.b1 + c * hit.b2;
    let n = math::normalize_or(sum, Vec3::ZERO);
    let n = if from_front { n } else { -n };
    (n != Vec3::ZERO).then_some(n)
}

/// A probe as a surface point; see [`place_probe`].
pub fn resolve_probe<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    position: Vec3,
    normal: Vec3,
) -> SurfacePoint {
    place_probe(scene, intersector, position, normal).point
}

/// How far beneath a probe the surface may lie that it is meant for, in radii of the scene.
const PROBE_REACH: f32 = 1e-3;

/// A probe on the surface on which it lies, found by one short ray; in no medium. Its extent is that of the surface, so that rays leave it as they would leave the
/// surface itself. A probe in mid-air has no extent; what lies beneath it within a thousandth of the scene's radius is still its surface for a map.
pub fn place_probe<I: Intersector + ?Sized>(
    scene: &CompiledScene,
    intersector: &I,
    position: Vec3,
    normal: Vec3,
) -> ProbePlace {
    let (_, radius) = scene.bounding_sphere();
    // Twice what the largest conceivable surface of the scene would ask for.
    let widest = SurfacePoint { position, extent: 4.0 * radius };
    let start = offset_origin(&widest, normal, normal);
    let ray = Ray { origin: start, direction: (position - start) * 2.0, t_max: 1.0 };
    let side = |ray: &Ray, hit: &Hit| front_of(scene, ray, hit).is_none_or(|front| normal.dot(front) >= 0.0);
    // Where boundaries of media lie upon a surface it is that which is meant; one alone holds nothing to be read.
    let found = |ray: &Ray, hit: Hit| {
        let hit = resolve(scene, ray, hit, Inside::NOTHING).0;
        let is_null = scene.material_of(hit.primitive).flags & material_flags::NULL != 0;
        (!is_null).then(|| (hit, side(ray, &hit)))
    };
    let inside = Inside::NOTHING;
    if let Some(hit) = intersector.closest_hit(&ray) {
        let point = SurfacePoint { position, extent: extent_of(scene, hit.primitive, position) };
        return ProbePlace { point, normal, hit: found(&ray, hit), inside };
    }
    let down = Ray { origin: position, direction: -normal, t_max: PROBE_REACH * radius };
    let hit = intersector.closest_hit(&down).and_then(|hit| found(&down, hit));
    ProbePlace { point: SurfacePoint { position, extent: 0.0 }, normal, hit, inside }
}

/// Unit geometric normal of the front at a hit.
fn front_of(scene: &CompiledScene, ray: &Ray, hit: &Hit) -> Option<Vec3> {
    if scene.triangles.get(hit.primitive as usize).is_some() {
        return scene.surfaces.get(hit.primitive as usize).map(|s| Vec3::from_array(s.normal));
    }
    let primitives = scene.primitives();
    let shape = primitives.shape(hit.primitive)?;
    shape_normal(shape, shape_point(shape, ray.origin + ray.direction * hit.t).position)
}

fn extent_of(scene: &CompiledScene, primitive: PrimitiveId, p: Vec3) -> f32 {
    let primitives = scene.primitives();
    if let Some(v) = primitives.vertices(primitive) {
        return v.iter().fold(0.0_f32, |m, q| m.max((*q - p).length()));
    }
    primitives.shape(primitive).map_or(0.0, |s| 2.0 * s.radius)
}
