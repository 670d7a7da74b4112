//! The choice of the estimator of images and probes: paths, maps of photons, or an operator; and the options of the latter two.

use super::args::{HeuristicChoice, Method, SamplingArgs};
use super::error::CliError;
use super::job::Stages;
use super::photon_args::PhotonArgs;
use super::radiosity_args::{RadiosityArgs, Ready};
use crate::driver::{self, Budget, GatherSettings, Outcome, Settings, Watcher};
use clap::Args;
use etendue_core::backend::{GatherJob, Session};
use etendue_core::illumination::Sides;
use serde_json::{Map, Value, json};

/// Photons of all blocks together, where nothing is said.
const PHOTONS: u64 = 1 << 20;

/// How an image or probes come from maps of photons.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of --method photon")]
pub(super) struct GatherArgs {
    /// Photons of all blocks of samples together, each block having a map of its own; rounded up to a power of two a block [default: 1048576; with --time or --error 65536 a block]
    #[arg(long, value_name = "N", conflicts_with_all = ["time", "error"], value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    photons: Option<u64>,
    /// With photons or radiosity: whether the first diffuse surface gathers its light by one bounce of rays: smooth, and the map's elements are seen at second hand alone. Without it the map is read where the
    /// eye looks, elements and all, and the noise is the map's [default: render false, probe true]
    #[arg(long, value_name = "true|false", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    gather: Option<bool>,
    #[command(flatten)]
    photon: PhotonArgs,
    #[command(flatten)]
    radiosity: RadiosityArgs,
}

/// The estimator of a job, with what it needs to know.
#[derive(Debug)]
pub(super) enum Estimator {
    Path,
    Bidirectional(HeuristicChoice),
    Photon(GatherSettings),
    Radiosity(Box<Ready>),
}

impl GatherArgs {
    /// The estimator that was asked for; `gather` is the verb's default.
    ///
    /// # Errors
    /// For options that the estimator does not have, and limits of depth where ways to the map have several lengths.
    pub(super) fn estimator(
        &self,
        sampling: &SamplingArgs,
        session: &dyn Session,
        gather: bool,
        (watcher, stages): (&dyn Watcher, &mut Stages),
    ) -> Result<Estimator, CliError> {
        let gather = self.gather.unwrap_or(gather);
        match sampling.method {
            Some(Method::Radiosity) => {
                let choice = (sampling.seed, gather);
                return Ok(Estimator::Radiosity(Box::new(
                    self.radiosity.ready(session, choice, watcher, stages)?,
                )));
            }
            Some(Method::Photon) => {}
            Some(Method::Bdpt) => {
                return Ok(Estimator::Bidirectional(sampling.heuristic.unwrap_or_default()));
            }
            _ => return Ok(Estimator::Path),
        }
        let scene = session.scene();
        if sampling.max_depth.is_some() && GatherJob::ways_differ(scene) {
            let text = "--max-depth with --method photon needs a scene of diffuse surfaces without spheres and disks: \
                        the photons of a map have one limit";
            return Err(CliError::Usage(text.into()));
        }
        let count = self.photons.unwrap_or(PHOTONS);
        let mut photons = self.photon.settings(session, Budget::Samples(count), Sides::Apart)?;
        if !photons.elements.largest.is_finite() {
            photons.elements.largest = driver::element_size(scene);
        }
        Ok(Estimator::Photon(GatherSettings { photons, count, gather }))
    }

    /// Refuses options that only another estimator has.
    ///
    /// # Errors
    /// [`CliError::Usage`] with the option.
    pub(super) fn check(&self, sampling: &SamplingArgs) -> Result<(), CliError> {
        let photon = self.photons.map(|_| "--photons").or(self.photon.given());
        let radiosity = self.radiosity.given();
        let refuse = |name: Option<&str>, method: &str| {
            name.map_or(Ok(()), |name| Err(CliError::Usage(format!("{name} needs --method {method}"))))
        };
        match sampling.method {
            Some(Method::Photon) => refuse(radiosity, "radiosity"),
            Some(Method::Radiosity) => {
                refuse(photon, "photon")?;
                if sampling.max_depth.is_some() {
                    let text = "--max-depth has no use with --method radiosity, expected --bounces K";
                    return Err(CliError::Usage(text.into()));
                }
                self.radiosity.check()
            }
            _ => {
                refuse(photon, "photon")?;
                refuse(self.gather.map(|_| "--gather"), "photon or radiosity")?;
                refuse(radiosity, "radiosity")
            }
        }
    }

    /// Adds what decides the bits.
    pub(super) fn describe(&self, estimator: &Estimator, settings: &Settings, map: &mut Map<String, Value>) {
        map.insert("method".into(), json!(estimator.name()));
        if let Estimator::Photon(gather) = estimator {
            let each = driver::photons_per_block(settings.budget, gather.count);
            map.insert("photons_per_block".into(), json!(each));
            map.insert("gather".into(), json!(gather.gather));
            self.photon.describe(&gather.photons.start, map);
            map.insert("element_size".into(), json!(gather.photons.elements.largest));
        }
        if let Estimator::Bidirectional(heuristic) = estimator {
            map.insert("heuristic".into(), json!(heuristic.name()));
        }
        if let Estimator::Radiosity(ready) = estimator {
            ready.describe(map);
        }
    }
}

impl Estimator {
    fn name(&self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Bidirectional(_) => "bdpt",
            Self::Photon(_) => "photon",
            Self::Radiosity(_) => "radiosity",
        }
    }

    /// Adds the counts of photons to a report.
    pub(super) fn count(&self, outcome: &Outcome, settings: &Settings, map: &mut Map<String, Value>) {
        if let Some((photons, hits)) = self.photons(outcome, settings) {
            map.insert("photons".into(), json!(photons));
            map.insert("hits".into(), json!(hits));
        }
    }

    /// For people.
    pub(super) fn words(&self, outcome: &Outcome, settings: &Settings) -> String {
        if let Self::Radiosity(ready) = self {
            return ready.words();
        }
        match self.photons(outcome, settings) {
            Some((photons, hits)) => {
                let each = hits as f64 / photons.max(1) as f64;
                format!("{photons} photons, {each:.2} hits each, ")
            }
            None => String::new(),
        }
    }

    fn photons(&self, outcome: &Outcome, settings: &Settings) -> Option<(u64, u64)> {
        let Self::Photon(gather) = self else { return None };
        let each = driver::photons_per_block(settings.budget, gather.count);
        Some((outcome.film.block_count() * u64::from(each), outcome.stats.hits))
    }
}
