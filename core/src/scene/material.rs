//! Materials as records: checked, and with their flags.

use super::compile::{finite, not_negative, out_of_range};
use super::compiled::{MaterialRecord, NO_INDEX, material_flags};
use super::desc::{MaterialDesc, MaterialKind, Reflectance};
use super::error::SceneError;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;

/// Indices of refraction that a scene may have.
pub const IOR_RANGE: RangeInclusive<f32> = 1e-3..=1e3;

fn schlick_flag(schlick: bool) -> u32 {
    if schlick { material_flags::SCHLICK } else { 0 }
}

pub(super) fn material_record(
    m: &MaterialDesc,
    textures: &BTreeMap<String, u32>,
) -> Result<MaterialRecord, SceneError> {
    let place = format!("material \"{}\"", m.name);
    let black = Reflectance::flat([0.0; 3]);
    let film;
    let ior = match &m.kind {
        MaterialKind::Conductor { eta, .. } => *eta,
        MaterialKind::Dielectric { ior, .. } | MaterialKind::ThinDielectric { ior, .. } => *ior,
        _ => [1.0; 3],
    };
    finite(&place, "ior", &ior)?;
    if let Some(&value) = ior.iter().find(|n| !IOR_RANGE.contains(*n)) {
        return out_of_range(&place, "ior", value, "an index of refraction from 0.001 to 1000");
    }
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
        MaterialKind::RoughConductor { .. }
        | MaterialKind::RoughDielectric { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::ScatteringFilm { .. }
        | MaterialKind::Unsupported(_) => (&black, [0.0; 3], 0.0, 0),
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
        pad: 0,
    })
}
