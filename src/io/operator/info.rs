//! The section of JSON.

use super::{Wrong, quoted};
use crate::driver::radiosity::CodecError;
use etendue_core::illumination::{Basis, ElementSettings, Sides};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// More passes than any light needs.
const PASSES_MOST: u32 = 1 << 16;

/// How an operator was made. Names are for people: nothing is chosen by them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OperatorInfo {
    /// Version of the program that made it.
    pub program: String,
    /// [`transport_hash`](crate::io::transport_hash) of the scene; hexadecimal in the file.
    #[serde(with = "hexadecimal")]
    pub transport_hash: [u8; 32],
    /// How many patches were asked for.
    pub patches_asked: u32,
    /// Rays of a patch of mean area.
    pub rays_per_patch: u32,
    /// Rays of all patches.
    pub rays: u64,
    /// Seed of everything.
    pub seed: u64,
    /// Bounces that the transport is of; absent: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounces: Option<u32>,
    /// Passes of a relighting.
    pub passes: u32,
    /// Codec of the form factors.
    pub codec: String,
    /// Error that the codec was allowed; absent: it was not asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_error: Option<f64>,
    /// Error of irradiance that was measured.
    #[serde(with = "ErrorJson")]
    pub error: CodecError,
    /// The elements that patches are made of.
    #[serde(with = "ElementsJson")]
    pub elements: ElementSettings,
}

impl OperatorInfo {
    pub(super) fn check(&self) -> Result<(), Wrong> {
        let error = self.error;
        for (name, x) in [("rms", error.rms), ("worst", error.worst), ("energy", error.energy)]
            .into_iter()
            .chain(self.max_error.map(|x| ("max_error", x)))
        {
            if !(x.is_finite() && x >= 0.0) {
                return Err(("info", format!("{name} {x}"), "a finite number of at least 0".into()));
            }
        }
        if self.passes > PASSES_MOST {
            return Err(("info", format!("{} passes", self.passes), format!("at most {PASSES_MOST}")));
        }
        let largest = self.elements.largest;
        if !(largest.is_finite() && largest > 0.0) {
            return Err(("info", format!("elements of {largest} m"), "a positive number".into()));
        }
        Ok(())
    }
}

/// All of the section.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) info: OperatorInfo,
    pub(super) transport: TransportHead,
}

/// Which sections hold the transport.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum TransportHead {
    Tiles(super::tiles::TilesHead),
    Blocks(super::blocks::BlocksHead),
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "CodecError")]
struct ErrorJson {
    rms: f64,
    worst: f64,
    energy: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "ElementSettings")]
struct ElementsJson {
    #[serde(with = "BasisJson")]
    basis: Basis,
    #[serde(with = "SidesJson")]
    sides: Sides,
    largest: f32,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Basis", rename_all = "lowercase")]
enum BasisJson {
    Constant,
    Linear,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Sides", rename_all = "lowercase")]
enum SidesJson {
    Together,
    Apart,
}

/// 32 bytes as 64 digits.
mod hexadecimal {
    use super::*;

    pub(super) fn serialize<S: Serializer>(bytes: &[u8; 32], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&blake3::Hash::from_bytes(*bytes).to_hex())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[u8; 32], D::Error> {
        let text = String::deserialize(from)?;
        match blake3::Hash::from_hex(&text) {
            Ok(hash) => Ok(*hash.as_bytes()),
            Err(_) => {
                Err(de::Error::custom(format!("found {}, expected 64 hexadecimal digits", quoted(&text))))
            }
        }
    }
}
