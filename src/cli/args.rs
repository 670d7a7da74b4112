//! Options that several verbs share.

use super::error::CliError;
use crate::driver::{Budget, Settings};
use crate::engine::{BackendKind, open_backend_on};
use clap::{Args, ValueEnum};
use etendue_core::backend::Backend;
use etendue_core::tone::{ToneMap, ToneSettings};
use etendue_core::transport::bidirectional::{CUTOFF, Heuristic};
use std::path::PathBuf;

/// Where to compute.
#[derive(Debug, Args)]
pub(super) struct BackendArgs {
    /// Which backend computes
    #[arg(long, default_value_t = BackendKind::Cpu, value_name = "cpu|wgpu")]
    pub backend: BackendKind,
    /// Worker threads; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Part of the name of the adapter that the wgpu backend takes, as `etendue adapters` lists them [default: the best]
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

impl BackendArgs {
    /// Starts it.
    pub(super) fn open(&self) -> Result<Box<dyn Backend>, CliError> {
        if self.adapter.is_some() && self.backend != BackendKind::Wgpu {
            return Err(CliError::Usage("--adapter needs --backend wgpu".into()));
        }
        let threads = self.threads.map(|n| n as usize);
        Ok(open_backend_on(self.backend, threads, self.adapter.as_deref())?)
    }
}

/// What to say.
#[derive(Debug, Args)]
pub(super) struct TalkArgs {
    /// Say nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
}

/// The estimator of light transport.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Method {
    /// Path tracing from the sensor
    Path,
    /// Bidirectional path tracing
    Bdpt,
    /// Maps of photons, read or gathered by tracing back from the sensor
    Photon,
    /// The radiosity operator: light between patches, baked once; diffuse triangles only
    Radiosity,
}

/// How strategies share paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum HeuristicChoice {
    /// By the squares of their densities
    #[default]
    Power,
    /// By their densities
    Balance,
    /// By their densities, leaving out those below a tenth of the largest
    Cutoff,
}

impl HeuristicChoice {
    /// As it is asked for.
    pub(super) fn name(self) -> String {
        self.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
    }

    pub(super) fn heuristic(self) -> Heuristic {
        match self {
            Self::Power => Heuristic::Power,
            Self::Balance => Heuristic::Balance,
            Self::Cutoff => Heuristic::Cutoff(CUTOFF),
        }
    }
}

/// How to sample and when to stop.
#[derive(Debug, Args)]
pub(super) struct SamplingArgs {
    /// Estimator [default: the cheapest that covers what the scene needs]
    #[arg(long, value_enum)]
    pub method: Option<Method>,
    /// How the strategies of bidirectional path tracing share paths [default: power]
    #[arg(long, value_enum)]
    pub heuristic: Option<HeuristicChoice>,
    /// Largest number of edges of a path, as Mitsuba counts them (2: direct light) [default: unlimited]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: Option<u32>,
    /// Samples per pixel or point, rounded up to whole blocks of at least 16 [default: 256]
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    pub samples: Option<u64>,
    /// Stop after this many seconds
    #[arg(long, value_name = "SECONDS", group = "budget", value_parser = positive, allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Stop when the estimated rel_error falls below this; tested when the number of samples doubles
    #[arg(long, value_name = "E", group = "budget", value_parser = positive, allow_negative_numbers = true)]
    pub error: Option<f64>,
    /// Seed of all samples
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err("expected a number above 0".into()),
    }
}

fn finite(text: &str) -> Result<f32, String> {
    text.parse::<f32>().ok().filter(|x| x.is_finite()).ok_or_else(|| "expected a finite number".into())
}

impl SamplingArgs {
    /// Refuses options that the method does not have.
    pub(super) fn check_method(&self) -> Result<(), CliError> {
        if self.heuristic.is_some() && self.method != Some(Method::Bdpt) {
            return Err(CliError::Usage("--heuristic needs --method bdpt".into()));
        }
        Ok(())
    }

    pub(super) fn settings(&self) -> Settings {
        let budget = match (self.samples, self.time, self.error) {
            (_, Some(seconds), _) => Budget::Seconds(seconds),
            (_, _, Some(error)) => Budget::Error(error),
            (samples, ..) => Budget::Samples(samples.unwrap_or(256)),
        };
        Settings { seed: self.seed, max_depth: self.max_depth.unwrap_or(u32::MAX), budget }
    }
}

/// A second picture for people.
#[derive(Debug, Args)]
pub(super) struct ToneArgs {
    /// Also write a tone-mapped PNG
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Tone mapping of the PNG
    #[arg(long, value_enum, default_value_t = Tone::Reinhard)]
    pub tone: Tone,
    /// Exposure of the PNG in stops: 1 doubles
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
    pub exposure: f32,
    /// Factor a of the gamma curve a (x + c)^gamma
    #[arg(long, default_value_t = ToneSettings::default().gamma_a, value_parser = finite)]
    pub gamma_a: f32,
    /// Shift c of the gamma curve
    #[arg(long, default_value_t = ToneSettings::default().gamma_c, allow_negative_numbers = true, value_parser = finite)]
    pub gamma_c: f32,
    /// Exponent of the gamma curve
    #[arg(long, default_value_t = ToneSettings::default().gamma, value_parser = finite)]
    pub gamma: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Tone {
    /// x / (1 + x), then the sRGB curve
    Reinhard,
    /// a (x + c)^gamma, which is a display curve itself
    Gamma,
    /// The sRGB curve alone
    None,
}

impl ToneArgs {
    pub(super) fn settings(&self) -> ToneSettings {
        let map = match self.tone {
            Tone::Reinhard => ToneMap::Reinhard,
            Tone::Gamma => ToneMap::Gamma,
            Tone::None => ToneMap::None,
        };
        ToneSettings {
            map,
            exposure: self.exposure,
            gamma_a: self.gamma_a,
            gamma_c: self.gamma_c,
            gamma: self.gamma,
        }
    }
}

/// Width and height as `640x480`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size(pub u32, pub u32);

impl std::str::FromStr for Size {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let side = |t: &str| t.parse::<u32>().ok().filter(|n| (1..=32768).contains(n));
        s.split_once('x')
            .and_then(|(w, h)| Some(Self(side(w)?, side(h)?)))
            .ok_or_else(|| "expected WIDTHxHEIGHT with 1 to 32768 pixels a side, as in 640x480".into())
    }
}
