//! How surfaces scatter: `bsdf` and `texture`.

use etendue_core::scene::{Checker, MaterialKind, Reflectance, Roughness};

use super::Builder;
use super::names;
use super::values::Object;
use crate::io::error::{LoadError, quoted};

const KINDS: &str = "diffuse, dielectric, roughdielectric, thindielectric, conductor, roughconductor, plastic, \
                     roughplastic, null, twosided";

/// A metal that reflects everything: with these the reflectance differs from 1 by less than f32 can say.
const PERFECT: ([f32; 3], [f32; 3]) = ([1e-3; 3], [1e3; 3]);

/// From the texture coordinates of a shape to those of its mesh here: two rows, for u, v and 1.
pub(super) type UvMap = [[f64; 3]; 2];

/// A surface without its name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surface {
    pub(super) kind: MaterialKind,
    pub(super) two_sided: bool,
    /// Where a texture lies; absent where there is none.
    pub(super) uv: Option<UvMap>,
}

impl Surface {
    fn new(kind: MaterialKind, two_sided: bool) -> Self {
        Self { kind, two_sided, uv: None }
    }

    /// A diffuse surface of one side and one grey.
    pub(super) fn diffuse(albedo: f32) -> Self {
        Self::new(MaterialKind::Diffuse { albedo: Reflectance::flat([albedo; 3]) }, false)
    }

    pub(super) fn null() -> Self {
        Self::new(MaterialKind::Null, true)
    }
}

impl Builder<'_, '_> {
    /// Reads a `bsdf`.
    pub(super) fn surface(&mut self, o: &Object<'_>) -> Result<Surface, LoadError> {
        let surface = match o.kind() {
            "diffuse" => {
                let old = if o.old() { "diffuse_reflectance" } else { "reflectance" };
                let (albedo, uv) = match self.reflectance(o, "reflectance")? {
                    Some(found) => found,
                    None => self.reflectance(o, old)?.unwrap_or((Reflectance::flat([0.5; 3]), None)),
                };
                Surface { uv, ..Surface::new(MaterialKind::Diffuse { albedo }, false) }
            }
            kind @ ("dielectric" | "thindielectric" | "roughdielectric") => {
                let ior = [self.relative_index(o, "bk7")? as f32; 3];
                o.only_one("specular_reflectance")?;
                o.only_one("specular_transmittance")?;
                let kind = match kind {
                    "dielectric" => MaterialKind::Dielectric { ior, schlick: false },
                    "thindielectric" => MaterialKind::ThinDielectric { ior, schlick: false },
                    _ => MaterialKind::RoughDielectric { ior, schlick: false, roughness: roughness(o)? },
                };
                Surface::new(kind, true)
            }
            kind @ ("conductor" | "roughconductor") => {
                Surface::new(conductor(o, kind != "conductor")?, false)
            }
            kind @ ("plastic" | "roughplastic") => {
                let ior = self.relative_index(o, "polypropylene")? as f32;
                o.only_one("specular_reflectance")?;
                let (albedo, uv) = self
                    .reflectance(o, "diffuse_reflectance")?
                    .unwrap_or((Reflectance::flat([0.5; 3]), None));
                let nonlinear = o.flag("nonlinear")?.unwrap_or(false);
                let roughness = if kind == "plastic" { None } else { Some(roughness(o)?) };
                let kind = MaterialKind::Plastic { albedo, ior, roughness, nonlinear };
                Surface { uv, ..Surface::new(kind, false) }
            }
            "null" => Surface::null(),
            "twosided" => {
                let mut inner = o.objects("bsdf")?;
                let (Some(one), true) = (inner.pop(), inner.is_empty()) else {
                    return Err(o.error("no <bsdf>, or several", "one <bsdf> for both sides"));
                };
                let inner = self.surface(&one)?;
                let opaque = matches!(
                    inner.kind,
                    MaterialKind::Diffuse { .. }
                        | MaterialKind::Mirror { .. }
                        | MaterialKind::Conductor { .. }
                        | MaterialKind::RoughConductor { .. }
                        | MaterialKind::Plastic { .. }
                );
                if !opaque {
                    return Err(one.error("a surface that light passes", "an opaque one within twosided"));
                }
                Surface { two_sided: true, ..inner }
            }
            _ => return Err(o.unknown_kind(KINDS)),
        };
        o.finish()?;
        Ok(surface)
    }

    /// The index behind the surface over that in front of it.
    fn relative_index(&mut self, o: &Object<'_>, interior: &str) -> Result<f64, LoadError> {
        let inside = index(o, "int_ior", interior)?;
        let outside = index(o, "ext_ior", "air")?;
        Ok(inside / outside)
    }

    /// A colour or a texture of reflectances, and where it lies.
    fn reflectance(
        &mut self,
        o: &Object<'_>,
        name: &'static str,
    ) -> Result<Option<(Reflectance, Option<UvMap>)>, LoadError> {
        let color = o.color(name)?;
        let texture = o.object("texture", name)?;
        match (color, texture) {
            (None, None) => Ok(None),
            (Some(color), None) => Ok(Some((Reflectance::flat(color), None))),
            (None, Some(texture)) => self.texture(&texture).map(|(r, uv)| Some((r, Some(uv)))),
            (Some(_), Some(texture)) => Err(texture.error("a texture beside a colour", "one of them")),
        }
    }

    fn texture(&mut self, o: &Object<'_>) -> Result<(Reflectance, UvMap), LoadError> {
        let old = |name| if o.old() { o.float(name) } else { Ok(None) };
        let mut uv = {
            let t = o.transform("to_uv")?;
            let scale = [old("uscale")?.unwrap_or(1.0), old("vscale")?.unwrap_or(1.0)];
            let offset = [old("uoffset")?.unwrap_or(0.0), old("voffset")?.unwrap_or(0.0)];
            [0, 1].map(|i| [t.0[i][0] * scale[i], t.0[i][1] * scale[i], t.0[i][3] * scale[i] + offset[i]])
        };
        let reflectance = match o.kind() {
            "bitmap" => {
                o.ignore(&["format", "accel", "id", "max_anisotropy", "cache"]);
                o.word(
                    "filter_type",
                    if o.old() { &["ewa", "trilinear", "bilinear"] } else { &["bilinear"] },
                )?;
                o.word("wrap_mode", &["repeat"])?;
                if o.flag("raw")? == Some(true) {
                    return Err(o.error("raw = true", "colours in sRGB: raw bitmaps are not supported"));
                }
                let (name, element) = o.filename()?;
                let Some(path) = self.find(o, element, name) else {
                    return Err(o.error_at(element, quoted(name), "a PNG or JPEG beside the scene"));
                };
                let texture = self.loader.texture(&path)?;
                // The top row of a bitmap lies at v = 0 there, and at v = 1 here.
                uv[1] = [-uv[1][0], -uv[1][1], 1.0 - uv[1][2]];
                Reflectance { color: [1.0; 3], texture, checker: None }
            }
            "checkerboard" => {
                let colors = [o.color("color0")?.unwrap_or([0.4; 3]), o.color("color1")?.unwrap_or([0.2; 3])];
                let mut repeat = [1.0; 2];
                // A plain scale is a matter of the pattern; all else moves texture coordinates.
                if uv[0][1] == 0.0 && uv[1][0] == 0.0 && uv[0][2] == 0.0 && uv[1][2] == 0.0 {
                    repeat = [uv[0][0] as f32, uv[1][1] as f32];
                    uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
                }
                Reflectance {
                    color: [1.0; 3],
                    texture: String::new(),
                    checker: Some(Checker { colors, repeat }),
                }
            }
            _ => return Err(o.unknown_kind("bitmap, checkerboard")),
        };
        o.finish()?;
        Ok((reflectance, uv))
    }
}

/// An index of refraction: a number, or the name of a substance.
fn index(o: &Object<'_>, key: &'static str, default: &str) -> Result<f64, LoadError> {
    let expected = "an index of refraction above 0";
    let Some(element) = o.value(key, &["float", "integer", "string"])? else {
        return names::index_of(default).ok_or_else(|| o.error(default, expected));
    };
    let text = element.attribute("value").unwrap_or_default();
    if element.tag == "string" {
        return names::index_of(text).ok_or_else(|| {
            o.error_at(element, quoted(text), format!("a number or one of {}", names::substances()))
        });
    }
    match o.numbers(element, text)?[..] {
        [n] if n > 0.0 => Ok(n),
        _ => Err(o.error_at(element, quoted(text), expected)),
    }
}

/// The distribution of microfacets and its scale.
fn roughness(o: &Object<'_>) -> Result<Roughness, LoadError> {
    o.ignore(&["sample_visible"]);
    let distribution = o.word("distribution", &["beckmann", "ggx"])?;
    let whole = o.float_at("alpha")?;
    let (u, v) = (o.float_at("alpha_u")?, o.float_at("alpha_v")?);
    let alpha = match (whole, u, v) {
        (Some((alpha, _)), None, None) => alpha,
        (None, Some((u, _)), Some((v, _))) if u == v => u,
        (None, None, None) => 0.1,
        (_, Some((_, element)), _) | (_, None, Some((_, element))) => {
            let expected = "the same roughness in both directions (alpha)";
            return Err(o.error_at(element, "an anisotropic roughness", expected));
        }
    } as f32;
    Ok(if distribution == "ggx" { Roughness::Ggx(alpha) } else { Roughness::Beckmann(alpha) })
}

fn conductor(o: &Object<'_>, rough: bool) -> Result<MaterialKind, LoadError> {
    let roughness = if rough { Some(roughness(o)?) } else { None };
    let material = o.string("material")?;
    let (eta, k) = (o.color_at("eta")?, o.color_at("k")?);
    let reflectance = o.color_at("specular_reflectance")?;
    // Where nothing is said, versions before 2 mean copper.
    let name = material.map_or(if o.old() && eta.is_none() { "Cu" } else { "none" }, |m| m.0.trim());
    let (eta, k) = match (name, eta, k) {
        ("none", None, None) => {
            let albedo = reflectance.map_or([1.0; 3], |r| r.0);
            match roughness {
                None => return Ok(MaterialKind::Mirror { albedo: Reflectance::flat(albedo) }),
                Some(_) => PERFECT,
            }
        }
        ("none", eta, k) => {
            let (eta, k) = (eta.map_or([0.0; 3], |v| v.0), k.map_or([1.0; 3], |v| v.0));
            // An index of i reflects everything.
            if eta == [0.0; 3] && k == [1.0; 3] { PERFECT } else { (eta, k) }
        }
        (name, None, None) => match names::metal(name) {
            Some((_, eta, k)) => (*eta, *k),
            None => {
                let at = material.map_or(o.element(), |m| m.1);
                let expected = format!("eta and k as colours, or one of none, {}", names::metals());
                return Err(o.error_at(at, quoted(name), expected));
            }
        },
        _ => return Err(o.error("a material beside eta and k", "one or the other")),
    };
    o.only_one("specular_reflectance")?;
    // Versions before 2 say what is outside, which divides both parts.
    let outside = if o.old() { index(o, "ext_eta", "air")? as f32 } else { 1.0 };
    let (eta, k) = (eta.map(|x| x / outside), k.map(|x| x / outside));
    Ok(match roughness {
        None => MaterialKind::Conductor { eta, k },
        Some(roughness) => MaterialKind::RoughConductor { eta, k, roughness },
    })
}
