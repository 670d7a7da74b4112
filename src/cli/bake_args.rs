//! Options of baking, for every verb that may.

use super::error::CliError;
use crate::driver::radiosity::{BakeSettings, Codec, Order};
use clap::{Args, ValueEnum};
use etendue_core::radiosity::patches::PatchSettings;

/// Patches, where nothing is said.
const PATCHES: u32 = 4096;
/// Error that `auto` keeps below, where nothing is said.
const MAX_ERROR: f64 = 0.01;
/// Share of entries that blocks keep, and bounces of the published codec, where nothing is said.
const KEEP: f32 = 0.04;
const PUBLISHED_BOUNCES: u32 = 3;
/// Most rays of a patch: counts have 32 bits.
const RAYS_MOST: u64 = 1 << 24;

fn share(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x| (0.0..=1.0).contains(x))
        .ok_or_else(|| "expected a number from 0 to 1".into())
}

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
    /// As published: the sum of the powers of --bounces (3), its largest entries kept, the rest as logarithms in BC1
    Published,
    /// The published one with its losses mended: all bounces, colours outside
    Bc1,
    /// Form factors in BC4
    Bc4,
}

/// Orders of rows and columns, for the published codec.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OrderName {
    /// By halves in place and normal
    Kd,
    /// Each row after the one that is most like it
    Greedy1,
    /// Then columns the same way
    Greedy2,
    /// As voxels come
    None,
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
    /// Error of irradiance, in the root mean square over eight probe lights and what the scene emits itself, that `--codec auto` keeps below [default: 0.01]
    #[arg(long, value_name = "E", value_parser = super::args::positive, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Share of entries, the largest, that `--codec published|bc1|bc4` keep as they are [default: 0.04]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub keep: Option<f32>,
    /// Order of rows and columns of `--codec published` [default: greedy2]
    #[arg(long, value_enum)]
    pub order: Option<OrderName>,
    /// Bounces of the indirect light [default: inf; published: 3]
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
            ("--keep", self.keep.is_some()),
            ("--order", self.order.is_some()),
            ("--bounces", self.bounces.is_some()),
        ];
        given.into_iter().find(|g| g.1).map(|g| g.0)
    }

    /// Refuses options that the codec does not have.
    ///
    /// # Errors
    /// [`CliError::Usage`] with the option and the codecs that have it.
    pub(super) fn check(&self) -> Result<(), CliError> {
        let codec = self.codec();
        let blocks = self.has_blocks();
        let refused = [
            ("--max-error", self.max_error.is_some() && codec != CodecName::Auto, "auto"),
            ("--keep", self.keep.is_some() && !blocks, "published, bc1 or bc4"),
            ("--order", self.order.is_some() && codec != CodecName::Published, "published"),
            (
                "--bounces with a number",
                matches!(self.bounces, Some(Bounces::Some(_))) && codec == CodecName::Bc1,
                "another than bc1, which is of all bounces",
            ),
        ];
        match refused.into_iter().find(|r| r.1) {
            Some((name, _, codecs)) => Err(CliError::Usage(format!("{name} needs --codec {codecs}"))),
            None => Ok(()),
        }
    }

    /// Whether texture blocks come of it.
    pub(super) fn has_blocks(&self) -> bool {
        matches!(self.codec(), CodecName::Published | CodecName::Bc1 | CodecName::Bc4)
    }

    fn codec(&self) -> CodecName {
        self.codec.unwrap_or(CodecName::Auto)
    }

    /// The settings.
    pub(super) fn settings(&self, seed: u64) -> BakeSettings {
        let count = self.patches.unwrap_or(PATCHES);
        let keep = self.keep.unwrap_or(KEEP);
        let rays = u64::from(count) * u64::from(self.pair_samples.unwrap_or(1));
        BakeSettings {
            patches: PatchSettings { count, seed },
            rays: rays.min(RAYS_MOST) as u32,
            codec: match self.codec() {
                CodecName::Auto => Codec::Auto { max_error: self.max_error.unwrap_or(MAX_ERROR) },
                CodecName::Tiles => Codec::Tiles,
                CodecName::F32 => Codec::F32,
                CodecName::F16 => Codec::F16,
                CodecName::Published => Codec::Published {
                    bounces: match self.bounces {
                        None => Some(PUBLISHED_BOUNCES),
                        Some(Bounces::All) => None,
                        Some(Bounces::Some(k)) => Some(k),
                    },
                    keep,
                    order: match self.order {
                        Some(OrderName::Kd) => Order::Kd,
                        Some(OrderName::Greedy1) => Order::Greedy1,
                        None | Some(OrderName::Greedy2) => Order::Greedy2,
                        Some(OrderName::None) => Order::Voxels,
                    },
                },
                CodecName::Bc1 => Codec::Bc1 { keep },
                CodecName::Bc4 => Codec::Bc4 { keep },
            },
            passes: None,
            // What the published codec cuts off is part of its error.
            bounces: match self.bounces {
                Some(Bounces::Some(k)) if self.codec() != CodecName::Published => Some(k),
                _ => None,
            },
        }
    }
}
