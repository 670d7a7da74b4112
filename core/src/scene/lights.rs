//! Collecting lights: their flux, their records, and the integer CDF that picks one.

use super::check::{finite, not_negative, out_of_range, unit};
use super::compiled::{CompiledScene, LightKind, LightRecord, NO_INDEX, bounding_sphere};
use super::desc::LightDesc;
use super::error::{Cleanup, CompileReport, SceneError};
use crate::geometry::{self, Aabb, RoundShape, geometric_normal};
use crate::math::{self, PI, Vec3};
use crate::sampling::discrete::IntegerCdf;
use alloc::format;
use alloc::vec::Vec;

/// A light before its probability is known.
pub(super) struct LightDraft {
    record: LightRecord,
    /// Emitted flux, mean of the channels \[W\]; the importance by which lights are picked.
    flux: f64,
}

const EMPTY: LightRecord = LightRecord {
    kind: 0,
    primitive: NO_INDEX,
    pmf: 0.0,
    area: 0.0,
    point: [0.0; 3],
    params: [0.0; 2],
    pad: [0.0; 3],
    radiance: [0.0; 3],
    edge1: [0.0; 3],
    edge2: [0.0; 3],
    normal: [0.0; 3],
};

/// Area of a sphere or a disk \[m^2\].
pub(super) fn shape_area(shape: &RoundShape) -> f32 {
    let disk = PI * shape.radius * shape.radius;
    if shape.kind == geometry::SPHERE { 4.0 * disk } else { disk }
}

fn mean(rgb: [f32; 3]) -> f64 {
    (f64::from(rgb[0]) + f64::from(rgb[1]) + f64::from(rgb[2])) / 3.0
}

impl LightDraft {
    fn surface(kind: LightKind, primitive: u32, area: f32, radiance: [f32; 3], record: LightRecord) -> Self {
        // A Lambertian emitter of radiance L sends pi L per area.
        let flux = f64::from(PI) * f64::from(area) * mean(radiance);
        Self { record: LightRecord { kind: kind as u32, primitive, area, radiance, ..record }, flux }
    }

    fn edges(
        kind: LightKind,
        primitive: u32,
        corner: Vec3,
        edges: [Vec3; 2],
        area: f32,
        radiance: [f32; 3],
    ) -> Self {
        let normal = geometric_normal([corner, corner + edges[0], corner + edges[1]]).unwrap_or(Vec3::ZERO);
        let record = LightRecord {
            point: corner.to_array(),
            edge1: edges[0].to_array(),
            edge2: edges[1].to_array(),
            normal: normal.to_array(),
            ..EMPTY
        };
        Self::surface(kind, primitive, area, radiance, record)
    }

    /// A triangle with one corner and two edges.
    pub(super) fn triangle(primitive: u32, corner: Vec3, e1: Vec3, e2: Vec3, radiance: [f32; 3]) -> Self {
        let area = geometry::triangle_area([corner, corner + e1, corner + e2]);
        Self::edges(LightKind::Triangle, primitive, corner, [e1, e2], area, radiance)
    }

    /// A parallelogram with one corner and two edges.
    pub(super) fn parallelogram(
        primitive: u32,
        corner: Vec3,
        e1: Vec3,
        e2: Vec3,
        radiance: [f32; 3],
    ) -> Self {
        let area = 2.0 * geometry::triangle_area([corner, corner + e1, corner + e2]);
        Self::edges(LightKind::Parallelogram, primitive, corner, [e1, e2], area, radiance)
    }

    /// The picture of an environment: the largest radiance, and the integral over all directions.
    pub(super) fn environment(largest: [f32; 3], integral: [f32; 3], radius: f32) -> Self {
        let record =
            LightRecord { kind: LightKind::Environment as u32, radiance: largest, edge1: integral, ..EMPTY };
        let flux = f64::from(PI) * f64::from(radius) * f64::from(radius) * mean(integral);
        Self { record, flux }
    }

    /// A sphere or a disk.
    pub(super) fn round(primitive: u32, shape: &RoundShape, radiance: [f32; 3]) -> Self {
        let r = shape.radius;
        let kind = if shape.kind == geometry::SPHERE { LightKind::Sphere } else { LightKind::Disk };
        let area = shape_area(shape);
        let record = LightRecord { point: shape.center, params: [r, 0.0], normal: shape.normal, ..EMPTY };
        Self::surface(kind, primitive, area, radiance, record)
    }
}

/// Checks a light that is not a surface. `bounds` encloses the scene: a directional light's flux is what reaches it.
pub(super) fn draft(index: usize, light: &LightDesc, bounds: &Aabb) -> Result<LightDraft, SceneError> {
    let pi = f64::from(PI);
    match light {
        LightDesc::Point { position, intensity } => {
            let place = format!("light {index} (point)");
            finite(&place, "position", position)?;
            not_negative(&place, "intensity", intensity)?;
            let record = LightRecord {
                kind: LightKind::Point as u32,
                point: *position,
                radiance: *intensity,
                ..EMPTY
            };
            Ok(LightDraft { record, flux: 4.0 * pi * mean(*intensity) })
        }
        LightDesc::Spot { position, direction, intensity, cone_deg, falloff_deg } => {
            let place = format!("light {index} (spot)");
            finite(&place, "position", position)?;
            not_negative(&place, "intensity", intensity)?;
            let axis = unit(&place, "direction", *direction)?;
            finite(&place, "cone_deg", &[*cone_deg])?;
            finite(&place, "falloff_deg", &[*falloff_deg])?;
            if *cone_deg <= 0.0 || *cone_deg > 180.0 {
                return out_of_range(&place, "cone_deg", *cone_deg, "a half-angle in (0, 180]");
            }
            if *falloff_deg < 0.0 || falloff_deg > cone_deg {
                return out_of_range(&place, "falloff_deg", *falloff_deg, "a half-angle in [0, cone_deg]");
            }
            let cos_cone = math::sin_cos(cone_deg * (PI / 180.0)).1;
            let cos_falloff = math::sin_cos(falloff_deg * (PI / 180.0)).1;
            let record = LightRecord {
                kind: LightKind::Spot as u32,
                point: *position,
                params: [cos_cone, cos_falloff],
                radiance: *intensity,
                edge1: axis.to_array(),
                ..EMPTY
            };
            // The mean of the smoothstep over its range is one half, and solid angle is linear in the cosine.
            let solid_angle = 2.0 * pi * (1.0 - 0.5 * (f64::from(cos_cone) + f64::from(cos_falloff)));
            Ok(LightDraft { record, flux: solid_angle * mean(*intensity) })
        }
        LightDesc::Directional { direction, irradiance } => {
            let place = format!("light {index} (directional)");
            not_negative(&place, "irradiance", irradiance)?;
            let travel = unit(&place, "direction", *direction)?;
            let (_, radius) = bounding_sphere(bounds);
            let record = LightRecord {
                kind: LightKind::Directional as u32,
                normal: travel.to_array(),
                radiance: *irradiance,
                ..EMPTY
            };
            Ok(LightDraft { record, flux: pi * f64::from(radius) * f64::from(radius) * mean(*irradiance) })
        }
        LightDesc::Environment(_) => {
            // The builder adds environments up before it comes here; a dark one is equivalent and harmless.
            Ok(LightDraft { record: EMPTY, flux: 0.0 })
        }
    }
}

/// Drops lights without power, numbers the rest, and links emissive primitives to their lights.
pub(super) fn finish(
    out: &mut CompiledScene,
    drafts: Vec<LightDraft>,
    report: &mut CompileReport,
) -> Result<(), SceneError> {
    let before = drafts.len();
    if drafts
        .iter()
        .all(|d| d.record.kind != LightKind::Environment as u32 || !(d.flux > 0.0 && d.flux.is_finite()))
    {
        out.environment_map = None;
    }
    let lit: Vec<LightDraft> = drafts.into_iter().filter(|d| d.flux > 0.0 && d.flux.is_finite()).collect();
    report.count(Cleanup::DarkLights, (before - lit.len()) as u64);
    if lit.is_empty() {
        return Ok(());
    }
    // Scaled to the brightest, so that no flux is too large or too small for f32.
    let brightest = lit.iter().fold(0.0_f64, |m, d| m.max(d.flux));
    let weights: Vec<f32> =
        lit.iter().map(|d| ((d.flux / brightest) as f32).max(f32::MIN_POSITIVE)).collect();
    let cdf = IntegerCdf::try_new(&weights)
        .map_err(|_| SceneError::TooLarge { what: "lights", found: weights.len() })?;
    for (i, d) in lit.into_iter().enumerate() {
        let record = LightRecord { pmf: cdf.pmf(i as u32), ..d.record };
        if record.kind == LightKind::Environment as u32
            && let Some(map) = &mut out.environment_map
        {
            (map.light, map.light_pmf) = (i as u32, record.pmf);
        }
        if record.primitive != NO_INDEX {
            out.surfaces[record.primitive as usize].light = i as u32;
            if record.kind == LightKind::Parallelogram as u32 {
                out.surfaces[record.primitive as usize + 1].light = i as u32;
            }
        }
        out.lights.push(record);
    }
    out.light_cumulative = cdf.cumulative().to_vec();
    Ok(())
}
