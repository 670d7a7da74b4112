//! Options of baking, for every verb that may.

use crate::driver::radiosity::{BakeSettings, Codec};
use clap::{Args, ValueEnum};
use etendue_core::radiosity::patches::PatchSettings;

/// Patches, where nothing is said.
const PATCHES: u32 = 4096;
/// Error that `auto` keeps below, where nothing is said.
const MAX_ERROR: f64 = 0.01;
/// Most rays of a patch: counts have 32 bits.
const RAYS_MOST: u64 = 1 << 24;

/// How form factors are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum CodecName {
    /// Tiles in as many bits as each is worth: the fewest bytes below --max-error
    Auto,
    /// Tiles of eight bits, empty ones left out
    Tiles,
    /// f32
    F32,
    /// f16
    F16,
}

/// Bounces of light: a number, or all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bounces {
    All,
    Some(u32),
}

impl std::str::FromStr for Bounces {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "inf" => Ok(Self::All),
            _ => s
                .parse()
                .ok()
                .filter(|k| (1..=1000).contains(k))
                .map(Self::Some)
                .ok_or_else(|| "expected 1 to 1000, or inf".into()),
        }
    }
}

/// How an operator is baked.
#[derive(Clone, Debug, Args)]
pub(super) struct BakeArgs {
    /// About how many patches [default: 4096]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub patches: Option<u32>,
    /// Rays for each pair of patches in the mean; large patches have more [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub pair_samples: Option<u32>,
    /// How form factors are stored [default: auto]
    #[arg(long, value_enum)]
    pub codec: Option<CodecName>,
    /// Error of irradiance, in the root mean square over eight probe lights, that `--codec auto` keeps below [default: 0.01]
    #[arg(long, value_name = "E", value_parser = super::args::positive, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Bounces of the indirect light [default: inf]
    #[arg(long, value_name = "K|inf")]
    pub bounces: Option<Bounces>,
}

impl BakeArgs {
    /// The first option that was given, if any was.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--patches", self.patches.is_some()),
            ("--pair-samples", self.pair_samples.is_some()),
            ("--codec", self.codec.is_some()),
            ("--max-error", self.max_error.is_some()),
            ("--bounces", self.bounces.is_some()),
        ];
        given.into_iter().find(|g| g.1).map(|g| g.0)
    }

    /// An option that the codec does not have.
    pub(super) fn check(&self) -> Result<(), super::error::CliError> {
        if self.max_error.is_some() && self.codec() != CodecName::Auto {
            return Err(super::error::CliError::Usage("--max-error needs --codec auto".into()));
        }
        Ok(())
    }

    fn codec(&self) -> CodecName {
        self.codec.unwrap_or(CodecName::Auto)
    }

    /// The settings.
    pub(super) fn settings(&self, seed: u64) -> BakeSettings {
        let count = self.patches.unwrap_or(PATCHES);
        let rays = u64::from(count) * u64::from(self.pair_samples.unwrap_or(1));
        BakeSettings {
            patches: PatchSettings { count, seed },
            rays: rays.min(RAYS_MOST) as u32,
            codec: match self.codec() {
                CodecName::Auto => Codec::Auto { max_error: self.max_error.unwrap_or(MAX_ERROR) },
                CodecName::Tiles => Codec::Tiles,
                CodecName::F32 => Codec::F32,
                CodecName::F16 => Codec::F16,
            },
            passes: None,
            bounces: match self.bounces {
                None | Some(Bounces::All) => None,
                Some(Bounces::Some(k)) => Some(k),
            },
        }
    }
}
