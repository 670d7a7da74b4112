//! Cutting one triangle for one light.

use super::{StartPlan, Subdivision};
use crate::direct::emission::{VertexAlbedo, emission, emission_textured, importance};
use crate::direct::irradiance::from_light;
use crate::direct::subdivide::{Bary, Limits, Piece, Published, Robust, Workspace};
use crate::geometry::{Intersector, hit_point_with, triangle_area};
use crate::light;
use crate::math::{self, Vec3, u32_to_unit};
use crate::sampling::counter::hash_combine;
use crate::sampling::warp;
use crate::scene::{CompiledScene, LightKind, LightRecord, MaterialRecord, material_flags};

/// Least barycentric of a sample: in the corner of a room a corner would lie in the next wall. Samples further in stay where they are: all of them drawn
/// towards the centroid by 1 % moved the light of a room of large triangles by 5 cm, and cost 0.5 % of its flux.
const INSET: f32 = 1.0 / 2048.0;

/// Chance to look from a piece of which all samples saw the light.
const SURE_LOOKS: f32 = 0.25;

/// Barycentrics that are no less than [`INSET`].
fn inset(b: [f32; 3]) -> [f32; 3] {
    let b = b.map(|x| x.max(INSET));
    let sum = b[0] + b[1] + b[2];
    b.map(|x| x / sum)
}

/// A piece of a triangle as one light lights it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitPiece {
    /// The triangle.
    pub triangle: u32,
    /// The light.
    pub light: u32,
    /// Corners on the triangle.
    pub corners: [Bary; 3],
    /// Mean irradiance of the channels at the corners \[W/m^2\].
    pub weights: [f32; 3],
    /// Area \[m^2\].
    pub area: f32,
    /// Flux that it sends on \[W\], mean of the channels, as far as the corners' samples tell: its weight in the density.
    pub importance: f32,
    /// Chance with which a start here looks whether the light is hidden, for exact weights: low where all samples saw it.
    pub looks: f32,
}

/// What a material reflects at most, per channel, without its bitmap.
pub(super) fn reflectance(material: &MaterialRecord) -> Vec3 {
    // Photons do not land there, or there is all that can be sent on.
    if material.is_passage() {
        return Vec3::ZERO;
    }
    const ALL: u32 = material_flags::CONDUCTOR | material_flags::PLASTIC | material_flags::DIELECTRIC;
    if material.flags & ALL != 0 {
        return Vec3::ONE;
    }
    let albedo = Vec3::from_array(material.albedo);
    if material.flags & material_flags::MIRROR != 0 {
        return albedo;
    }
    albedo + Vec3::from_array(material.specular)
}

/// A light's colour: its radiance, intensity or irradiance over their mean.
pub(super) fn colour(light: &LightRecord) -> Vec3 {
    let brightest = Vec3::from_array(light.radiance);
    let mean = math::mean(brightest);
    if mean > 0.0 { brightest / mean } else { Vec3::ZERO }
}

/// What a light could bring to a triangle at most, as far as a few unshadowed samples tell \[W/m^2\], mean of the channels; for spots as if they had no
/// cone, unless the cone misses the triangle. `None`: nothing arrives.
fn unshadowed(light: &LightRecord, v: [Vec3; 3], n: Vec3) -> Option<f32> {
    let centroid = (v[0] + v[1] + v[2]) / 3.0;
    let mean = math::mean(Vec3::from_array(light.radiance));
    if light.kind == LightKind::Directional as u32 {
        return Some(mean * Vec3::from_array(light.normal).dot(n).abs());
    }
    let at = Vec3::from_array(light.point);
    if light.kind == LightKind::Spot as u32 && !cone_meets(light, v, centroid) {
        return None;
    }
    let irradiance = |p: Vec3| {
        let to = at - p;
        let d2 = to.dot(to).max(f32::MIN_POSITIVE);
        mean * to.dot(n).abs() / (d2 * math::sqrt(d2))
    };
    Some(v.into_iter().fold(irradiance(centroid), |m, p| m.max(irradiance(p))))
}

/// Whether the cone of a spot meets the sphere about a triangle.
fn cone_meets(light: &LightRecord, v: [Vec3; 3], centroid: Vec3) -> bool {
    let radius2 = v.iter().fold(0.0_f32, |m, p| m.max((*p - centroid).dot(*p - centroid)));
    let to = centroid - Vec3::from_array(light.point);
    let d2 = to.dot(to);
    if d2 <= radius2 {
        return true;
    }
    // cos(cone + sphere's half-angle), the sphere enlarged for rounding.
    let sin2 = (radius2 * 1.001 / d2 + 1e-6).min(1.0);
    let (sin_s, cos_s) = (math::sqrt(sin2), math::sqrt(1.0 - sin2));
    let cos_c = light.params[0];
    let sin_c = math::sqrt((1.0 - cos_c * cos_c).max(0.0));
    let limit = cos_c * cos_s - sin_c * sin_s;
    // Together more than half a turn: everything is within.
    let whole = sin_c * cos_s + cos_c * sin_s <= 0.0;
    whole || Vec3::from_array(light.edge1).dot(to) >= limit * math::sqrt(d2)
}

/// How a pair is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum How {
    /// Not: it is sampled at its corners.
    Whole,
    /// Not: it is sampled at one place, given by its barycentrics.
    Glance([f32; 3]),
    /// By the source's rule.
    Published(Published, Limits),
    /// By the mended rule.
    Robust(Robust, Limits),
}

/// A light and a triangle that may send on some of its light: how the triangle is cut, and what pieces are made of.
#[derive(Clone, Copy)]
pub struct Pair<'a> {
    plan: &'a StartPlan<'a>,
    /// The light.
    pub light: u32,
    /// The triangle.
    pub triangle: u32,
    /// How it is cut.
    pub how: How,
    corners: [Vec3; 3],
    normal: Vec3,
    sliver: f32,
    area: f32,
    reflectance: Vec3,
    colour: Vec3,
}

impl StartPlan<'_> {
    /// A pair, prepared to be cut. `None` where nothing can be sent on.
    pub fn pair(&self, pair: usize) -> Option<Pair<'_>> {
        let (light_index, triangle) = self.numbers(pair)?;
        let scene: &CompiledScene = self.scene;
        let corners = scene.primitives().vertices(triangle)?;
        let (light, material) = (&scene.lights[light_index as usize], scene.material_of(triangle));
        let (area, reflectance) = (triangle_area(corners), reflectance(material));
        let surface = scene.surfaces[triangle as usize];
        let normal = Vec3::from_array(surface.normal);
        if area.is_nan() || area <= 0.0 || reflectance == Vec3::ZERO {
            return None;
        }
        const BOTH: u32 = material_flags::TWO_SIDED | material_flags::DIELECTRIC | material_flags::SCATTERS;
        if material.flags & BOTH == 0 && light::emit::toward(light, corners[0]).dot(normal) <= 0.0 {
            // What arrives behind is not sent on. (At a corner as good as anywhere: the light is on one side of the plane.)
            return None;
        }
        let how = match &self.subdivision {
            Subdivision::None => How::Whole,
            Subdivision::Published(criterion, limits) => How::Published(*criterion, *limits),
            Subdivision::Robust(criterion, limits, care) => {
                let most = unshadowed(light, corners, normal)?;
                let share = most * area * math::max_component(reflectance) / self.flux;
                if share <= care.glance {
                    let u = [0, 1].map(|k| u32_to_unit(hash_combine(hash_combine(light_index, triangle), k)));
                    How::Glance(warp::sample_triangle(u))
                } else {
                    let least_depth = limits.least_depth.max(u8::from(share > care.doubt));
                    let error = care.error * self.flux / (area * math::max_component(reflectance));
                    let criterion = Robust { share: math::max(criterion.share, error), ..*criterion };
                    How::Robust(criterion, Limits { least_depth, ..*limits })
                }
            }
        };
        Some(Pair {
            plan: self,
            light: light_index,
            triangle,
            how,
            corners,
            normal,
            sliver: surface.sliver,
            area,
            reflectance,
            colour: colour(light),
        })
    }

    /// Cuts one pair and hands out its lit pieces; the shadow rays it took. Nothing depends on other pairs.
    pub fn pieces<I: Intersector + ?Sized>(
        &self,
        intersector: &I,
        pair: usize,
        workspace: &mut Workspace<f32>,
        mut emit: impl FnMut(LitPiece),
    ) -> u64 {
        let Some(pair) = self.pair(pair) else { return 0 };
        let mut rays = 0;
        let mut sample = |b: [f32; 3]| pair.sample(intersector, b, &mut rays);
        let mut keep = |corners: [Bary; 3], irradiance: [f32; 3], fraction: f32, sure: bool| {
            if let Some(piece) = pair.piece(corners, irradiance, fraction, sure) {
                emit(piece);
            }
        };
        let keep_piece = |p: Piece<f32>| keep(p.corners, p.irradiance, p.fraction, p.end.is_sure());
        match &pair.how {
            How::Whole => keep(Bary::CORNERS, Bary::CORNERS.map(|c| sample(c.to_f32())), 1.0, false),
            How::Glance(place) => keep(Bary::CORNERS, [sample(*place); 3], 1.0, false),
            How::Published(criterion, limits) => {
                workspace.subdivide(pair.corners, criterion, limits, sample, keep_piece);
            }
            How::Robust(criterion, limits) => {
                workspace.subdivide(pair.corners, criterion, limits, sample, keep_piece);
            }
        }
        rays
    }
}

impl Pair<'_> {
    /// Irradiance by the light at barycentrics of the triangle, mean of the channels \[W/m^2\]; `rays` counts what it took.
    pub fn sample<I: Intersector + ?Sized>(&self, intersector: &I, b: [f32; 3], rays: &mut u64) -> f32 {
        let StartPlan { scene, media, .. } = self.plan;
        let [_, b1, b2] = inset(b);
        let point = hit_point_with(self.corners, b1, b2, self.sliver);
        let Some((e, ray)) = from_light(&scene.lights[self.light as usize], &point, self.normal) else {
            return 0.0;
        };
        if let Some(media) = media {
            let place = (point.position, self.normal);
            let (straight, took) = media.straight(scene, intersector, self.light as usize, &ray, place);
            *rays += took;
            return math::mean(e * straight.left);
        }
        *rays += 1;
        if intersector.occluded(&ray) { 0.0 } else { math::mean(e) }
    }

    /// A piece with this irradiance at its corners and this share of the triangle's area. `None` where it sends nothing on. `sure`: samples have judged it.
    pub fn piece(
        &self,
        corners: [Bary; 3],
        irradiance: [f32; 3],
        fraction: f32,
        sure: bool,
    ) -> Option<LitPiece> {
        let area = self.area * fraction;
        let e = irradiance.map(|x| self.colour * x);
        let importance = match self.plan.bitmap_albedo(self.triangle, corners.map(Bary::to_f32)) {
            None => math::mean(emission(self.reflectance, area, e)),
            Some(albedo) => {
                let most = emission_textured(self.reflectance, area, e, &VertexAlbedo::uniform(albedo.most));
                let sent = importance(emission_textured(self.reflectance, area, e, &albedo.corners), most);
                math::max(sent, math::mean(most) * albedo.least_share)
            }
        };
        (importance > 0.0).then(|| {
            // What a medium leaves of the light is always asked.
            let all = !sure || irradiance.contains(&0.0) || self.plan.media.is_some();
            let looks = if all { 1.0 } else { SURE_LOOKS };
            let (triangle, light, weights) = (self.triangle, self.light, irradiance);
            LitPiece { triangle, light, corners, weights, area, importance, looks }
        })
    }
}
