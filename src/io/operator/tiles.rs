//! Sections of a transport in tiles.

use super::Wrong;
use super::container::{Section, Sections, Tag, floats, name, tag};
use crate::io::error::LoadError;
use etendue_core::radiosity::relight::{CoarseParts, Relighter};
use etendue_core::radiosity::tiles::{Kind, Rates, Tiles, tile_rows};
use serde::{Deserialize, Serialize};

/// Kinds and payload of the form factors, then of the inverse per channel.
const ALL: [[Tag; 2]; 4] = [
    [tag("kinds"), tag("tiles")],
    [tag("kinds0"), tag("tiles0")],
    [tag("kinds1"), tag("tiles1")],
    [tag("kinds2"), tag("tiles2")],
];

/// What the sections need to be understood.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct TilesHead {
    /// How the second level is stored, if there is one: what a change of albedo makes it anew with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coarse: Option<RatesJson>,
    /// What part of its change a pass makes.
    damping: f32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RatesJson {
    Cheapest { lambda: f64 },
    Uniform { kind: u8 },
}

/// What does not belong to these patches, or would not come back.
pub(super) fn check(relighter: &Relighter, areas: &[f32]) -> Result<(), Wrong> {
    if relighter.areas() != areas {
        return Err(("tiles", "transport between other areas".into(), "those of the patches".into()));
    }
    match relighter.coarse().map(|c| c.rates()) {
        Some(Rates::Cheapest { lambda }) if !(lambda.is_finite() && lambda >= 0.0) => {
            Err(("info", format!("lambda {lambda}"), "a finite number of at least 0".into()))
        }
        _ => Ok(()),
    }
}

pub(super) fn write<'a>(relighter: &'a Relighter, sections: &mut Vec<Section<'a>>) -> TilesHead {
    sections.push(Section::new(tag("albedo"), floats(relighter.albedo_list().as_flattened())));
    sections.push(Section::new(tag("factors"), floats(relighter.factors())));
    sections.push(Section::new(tag("weights"), floats(relighter.weights())));
    let coarse = relighter.coarse();
    let inverses = coarse.map_or(&[][..], |c| c.tiles());
    if let Some(parts) = relighter.coarse_parts() {
        sections.push(Section::new(tag("spread"), floats(&parts.spread)));
    }
    for ([kinds, payload], tiles) in ALL.into_iter().zip([relighter.tiles()].into_iter().chain(inverses)) {
        sections.push(Section::new(kinds, tiles.kinds()));
        sections.push(Section::new(payload, tiles.payload()));
    }
    let coarse = coarse.map(|c| match c.rates() {
        Rates::Cheapest { lambda } => RatesJson::Cheapest { lambda },
        Rates::Uniform(kind) => RatesJson::Uniform { kind: kind as u8 },
    });
    TilesHead { coarse, damping: relighter.damping() }
}

pub(super) fn read(
    head: &TilesHead,
    sections: &mut Sections<'_>,
    areas: Vec<f32>,
) -> Result<Relighter, LoadError> {
    let file = sections.file();
    let n = areas.len();
    let albedo = sections.take_floats(tag("albedo"))?;
    let (albedo, rest) = albedo.as_chunks::<3>();
    if !rest.is_empty() {
        let found = format!("{} numbers", 3 * albedo.len() + rest.len());
        return Err(LoadError::unexpected(file, found, format!("{}", 3 * n)).field("albedo"));
    }
    let factors = sections.take_floats(tag("factors"))?;
    let weights = sections.take_floats(tag("weights"))?;
    let tiles = one(sections, ALL[0], n)?;
    let refused = |e| LoadError::decode(file, "operator", e);
    let relighter = Relighter::new(tiles, areas, factors, albedo).map_err(refused)?;
    let relighter = relighter.with_weights(weights).map_err(refused)?;
    let rates = match head.coarse {
        None => return Ok(relighter),
        Some(RatesJson::Cheapest { lambda }) => Rates::Cheapest { lambda },
        Some(RatesJson::Uniform { kind }) => match Kind::from_number(kind) {
            Some(kind) => Rates::Uniform(kind),
            None => {
                let found = format!("kind {kind} of tiles");
                return Err(LoadError::unexpected(file, found, "one of 0 to 9").field("info"));
            }
        },
    };
    let m = tile_rows(n);
    let inverses = [one(sections, ALL[1], m)?, one(sections, ALL[2], m)?, one(sections, ALL[3], m)?];
    let spread = sections.take_floats(tag("spread"))?;
    let parts = CoarseParts { tiles: inverses, rates, spread, damping: head.damping };
    relighter.with_coarse_parts(parts).map_err(refused)
}

fn one(sections: &mut Sections<'_>, [kinds, payload]: [Tag; 2], n: usize) -> Result<Tiles, LoadError> {
    let file = sections.file();
    let (k, p) = (sections.take(kinds)?, sections.take(payload)?);
    Tiles::try_new(n, k.to_vec(), p.to_vec())
        .map_err(|e| LoadError::decode(file, "operator", e).field(name(&payload)))
}
