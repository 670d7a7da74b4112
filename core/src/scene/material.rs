//! Materials as records: checked, and with their flags.

use super::check::{finite, not_negative, out_of_range};
use super::compiled::{CheckerRecord, CoatRecord, MaterialRecord, NO_INDEX, material_flags};
use super::desc::{MaterialDesc, MaterialKind, Reflectance, Roughness};
use super::error::SceneError;
use crate::bsdf::plastic::CoatTable;
use crate::bsdf::{Facets, Rough};
use crate::math;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;

/// Indices of refraction that a scene may have.
pub const IOR_RANGE: RangeInclusive<f32> = 1e-3..=1e3;
/// The largest scale of slopes that a scene may have.
pub const ROUGHNESS_MAX: f32 = 10.0;
/// A rough boundary between indices that differ by less than this is a smooth one: there is no density in which light passes it.
const INDEX_MATCHED: f32 = 1e-3;

fn schlick_flag(schlick: bool) -> u32 {
    if schlick { material_flags::SCHLICK } else { 0 }
}

/// Flags, scale of slopes and exponent.
fn roughness(place: &str, roughness: Roughness) -> Result<(u32, f32, f32), SceneError> {
    let (flags, alpha, exponent) = match roughness {
        Roughness::Ggx(alpha) => (material_flags::ROUGH, alpha, 0.0),
        Roughness::Beckmann(alpha) => (material_flags::ROUGH | material_flags::BECKMANN, alpha, 0.0),
        Roughness::Phong(exponent) => (material_flags::ROUGH | material_flags::PHONG, 0.0, exponent),
    };
    not_negative(place, "roughness", &[alpha])?;
    not_negative(place, "exponent", &[exponent])?;
    if alpha > ROUGHNESS_MAX {
        return out_of_range(place, "roughness", alpha, "a number from 0 to 10");
    }
    Ok((flags, alpha, exponent))
}

impl MaterialRecord {
    /// How the surface is rough; `None` where it is smooth.
    #[inline]
    pub fn rough(&self) -> Option<Rough> {
        if self.flags & material_flags::ROUGH == 0 {
            return None;
        }
        Some(if self.flags & material_flags::PHONG != 0 {
            Rough::Phong(self.exponent)
        } else if self.flags & material_flags::BECKMANN != 0 {
            Rough::Facets(Facets::beckmann(self.roughness))
        } else {
            Rough::Facets(Facets::ggx(self.roughness))
        })
    }

    /// Light is sent on by it without being scattered, or passes it: a null boundary, a pane, or a dielectric without a finish.
    #[inline]
    pub fn is_passage(&self) -> bool {
        let glass = self.flags & (material_flags::DIELECTRIC | material_flags::ROUGH);
        self.flags & material_flags::PASSES != 0 || glass == material_flags::DIELECTRIC
    }

    /// Its albedo is not the same everywhere.
    #[inline]
    pub fn is_textured(&self) -> bool {
        self.texture != NO_INDEX || self.checker != NO_INDEX
    }
}

/// The coat of a plastic.
pub(super) fn coat_record(material: &MaterialRecord) -> CoatRecord {
    let table = CoatTable::new(material.ior[0], material.rough());
    let CoatTable { internal, mean, transmittance } = table;
    CoatRecord { internal, mean, pad: [0.0; 2], transmittance }
}

/// The pattern of a material, if it has one.
pub(super) fn checker_record(m: &MaterialDesc) -> Result<Option<CheckerRecord>, SceneError> {
    let checker = match &m.kind {
        MaterialKind::Diffuse { albedo }
        | MaterialKind::Mirror { albedo }
        | MaterialKind::DiffusePhong { albedo, .. }
        | MaterialKind::Plastic { albedo, .. } => albedo.checker,
        _ => None,
    };
    let Some(checker) = checker else { return Ok(None) };
    let place = format!("material \"{}\"", m.name);
    let colors = checker.colors;
    not_negative(&place, "checker", colors.as_flattened())?;
    if let Some(&value) = colors.as_flattened().iter().find(|x| **x > 1.0) {
        return out_of_range(&place, "checker", value, "colours of at most 1");
    }
    finite(&place, "checker", &checker.repeat)?;
    Ok(Some(CheckerRecord { colors, repeat: checker.repeat }))
}

pub(super) fn material_record(
    m: &MaterialDesc,
    textures: &BTreeMap<String, u32>,
) -> Result<MaterialRecord, SceneError> {
    let place = format!("material \"{}\"", m.name);
    let black = Reflectance::flat([0.0; 3]);
    let film;
    let ior = match &m.kind {
        MaterialKind::Conductor { eta, .. } | MaterialKind::RoughConductor { eta, .. } => *eta,
        MaterialKind::Dielectric { ior, .. }
        | MaterialKind::ThinDielectric { ior, .. }
        | MaterialKind::RoughDielectric { ior, .. } => *ior,
        MaterialKind::Plastic { ior, .. } => [*ior; 3],
        _ => [1.0; 3],
    };
    finite(&place, "ior", &ior)?;
    if let Some(&value) = ior.iter().find(|n| !IOR_RANGE.contains(*n)) {
        return out_of_range(&place, "ior", value, "an index of refraction from 0.001 to 1000");
    }
    let mut alpha = 0.0;
    let mut rough = |said: Roughness| -> Result<(u32, f32), SceneError> {
        let (flags, scale, exponent) = roughness(&place, said)?;
        alpha = scale;
        Ok((flags, exponent))
    };
    let (albedo, specular, exponent, kind_flags) = match &m.kind {
        MaterialKind::Diffuse { albedo } => (albedo, [0.0; 3], 0.0, 0),
        MaterialKind::Mirror { albedo } => (albedo, [0.0; 3], 0.0, material_flags::MIRROR),
        MaterialKind::Phong { specular, exponent } => (&black, *specular, *exponent, material_flags::GLOSSY),
        MaterialKind::DiffusePhong { albedo, specular, exponent } => {
            (albedo, *specular, *exponent, material_flags::GLOSSY)
        }
        MaterialKind::Conductor { k, .. } => {
            (&black, *k, 0.0, material_flags::MIRROR | material_flags::CONDUCTOR)
        }
        MaterialKind::Dielectric { schlick, .. } => {
            (&black, [0.0; 3], 0.0, material_flags::DIELECTRIC | schlick_flag(*schlick))
        }
        MaterialKind::ThinDielectric { schlick, .. } => {
            let flags = material_flags::DIELECTRIC | material_flags::THIN | schlick_flag(*schlick);
            (&black, [0.0; 3], 0.0, flags)
        }
        MaterialKind::ThinFilm { reflect, transmit } => {
            film = Reflectance::flat(*reflect);
            (&film, *transmit, 0.0, material_flags::FILM | material_flags::THIN)
        }
        MaterialKind::Null => (&black, [0.0; 3], 0.0, material_flags::NULL),
        MaterialKind::RoughConductor { k, roughness, .. } => {
            let (flags, exponent) = rough(*roughness)?;
            (&black, *k, exponent, material_flags::CONDUCTOR | flags)
        }
        MaterialKind::RoughDielectric { schlick, roughness, .. } => {
            let (flags, exponent) = rough(*roughness)?;
            let matched = ior.iter().any(|n| math::abs(n - 1.0) < INDEX_MATCHED);
            let flags = if matched { 0 } else { flags };
            (&black, [0.0; 3], exponent, material_flags::DIELECTRIC | flags | schlick_flag(*schlick))
        }
        MaterialKind::Plastic { albedo, roughness, nonlinear, .. } => {
            let (flags, exponent) = roughness.map_or(Ok((0, 0.0)), rough)?;
            let nonlinear = if *nonlinear { material_flags::NONLINEAR } else { 0 };
            (albedo, [0.0; 3], exponent, material_flags::PLASTIC | flags | nonlinear)
        }
        MaterialKind::ScatteringFilm { reflect, transmit } => {
            film = Reflectance::flat(*reflect);
            (&film, *transmit, 0.0, material_flags::SCATTERS)
        }
        MaterialKind::Unsupported(_) => (&black, [0.0; 3], 0.0, 0),
    };
    not_negative(&place, "albedo", &albedo.color)?;
    not_negative(&place, "specular", &specular)?;
    not_negative(&place, "exponent", &[exponent])?;
    not_negative(&place, "emission", &m.emission)?;
    let metal = kind_flags & material_flags::CONDUCTOR != 0;
    for (channel, (diffuse, glossy)) in albedo.color.iter().zip(specular).enumerate().filter(|_| !metal) {
        // Decoded texels are at most 1, so the colour bounds the albedo with and without a bitmap.
        let value = diffuse + glossy;
        if value > 1.0 {
            return Err(SceneError::EnergyAboveOne { material: m.name.clone(), channel, value });
        }
    }
    let texture = if albedo.texture.is_empty() {
        NO_INDEX
    } else {
        *textures.get(&albedo.texture).ok_or_else(|| SceneError::UnknownName {
            place: place.clone(),
            kind: "texture",
            name: albedo.texture.clone(),
        })?
    };
    let sides = if m.two_sided { material_flags::TWO_SIDED } else { 0 };
    Ok(MaterialRecord {
        albedo: albedo.color,
        texture,
        specular,
        exponent,
        emission: m.emission,
        flags: kind_flags | sides,
        ior,
        roughness: alpha,
        checker: NO_INDEX,
        coat: NO_INDEX,
        pad: [0; 2],
    })
}
