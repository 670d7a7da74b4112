//! Options of the radiosity operator for the verbs that look at its light, and the way from an operator to a map.

use super::bake_args::BakeArgs;
use super::error::CliError;
use super::job::Stages;
use crate::driver::Watcher;
use crate::driver::open_operator;
use crate::driver::radiosity::{self, CodecError, Operator, Relit};
use crate::io::read_operator;
use clap::Args;
use etendue_core::backend::{GivenMap, Session};
use etendue_core::illumination::ElementSettings;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Where an operator comes from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of --method radiosity")]
pub(super) struct RadiosityArgs {
    /// An operator that was baked from this scene, whatever its lights without size were then; without it one is baked first
    #[arg(long, value_name = "OP.etd")]
    operator: Option<PathBuf>,
    #[command(flatten)]
    bake: BakeArgs,
}

/// The light of a scene by its operator, ready to be looked at.
#[derive(Debug)]
pub(super) struct Ready {
    pub operator: Operator,
    pub relit: Relit,
    /// Error of the codec over probe lights, as it was measured when the operator was baked.
    pub codec_error: CodecError,
    /// Whether the first surface gathers.
    pub gather: bool,
}

impl RadiosityArgs {
    /// The first option that was given, if any was.
    pub(super) fn given(&self) -> Option<&'static str> {
        if self.operator.is_some() { Some("--operator") } else { self.bake.given() }
    }

    /// Refuses options that do not go together.
    pub(super) fn check(&self) -> Result<(), CliError> {
        if let (Some(_), Some(name)) = (&self.operator, self.bake.given()) {
            return Err(CliError::Usage(format!(
                "{name} has no use with --operator, which is baked already"
            )));
        }
        self.bake.check()
    }

    /// Reads or bakes the operator, and relights it.
    pub(super) fn ready(
        &self,
        session: &dyn Session,
        (seed, gather): (u64, bool),
        watcher: &dyn Watcher,
        stages: &mut Stages,
    ) -> Result<Ready, CliError> {
        let (operator, codec_error) = match &self.operator {
            Some(file) => read(file, session, stages)?,
            None => {
                let baked = radiosity::bake(session, &self.bake.settings(seed), watcher)?;
                stages.add(&baked.stages);
                (baked.operator, baked.error)
            }
        };
        ready(session, operator, codec_error, (seed, gather), watcher, stages)
    }
}

/// What a codec was measured to lose.
pub(super) fn error_json(e: &CodecError) -> Value {
    json!({ "rms": e.rms, "worst": e.worst, "energy": e.energy })
}

/// The operator of a file, for a session's scene.
pub(super) fn read(
    file: &Path,
    session: &dyn Session,
    stages: &mut Stages,
) -> Result<(Operator, CodecError), CliError> {
    let read = read_operator(file)?;
    let error = read.info.error;
    let operator = open_operator(read, session)
        .map_err(|error| CliError::Operator { file: file.display().to_string(), error })?;
    stages.done("operator");
    Ok((operator, error))
}

/// Relights an operator by the lights of a session's scene.
pub(super) fn ready(
    session: &dyn Session,
    operator: Operator,
    codec_error: CodecError,
    (seed, gather): (u64, bool),
    watcher: &dyn Watcher,
    stages: &mut Stages,
) -> Result<Ready, CliError> {
    let relit = radiosity::relit(session, &operator, seed, watcher)?;
    stages.add(&relit.stages);
    Ok(Ready { operator, relit, codec_error, gather })
}

impl Ready {
    /// What its light is read by.
    pub(super) fn view(&self) -> GivenMap<'_> {
        let elements: ElementSettings = *self.operator.map.elements.settings();
        GivenMap { elements, values: &self.relit.values, gather: self.gather }
    }

    fn patches(&self) -> usize {
        self.operator.map.patches.len()
    }

    fn per_pair(&self) -> f64 {
        let n = self.patches() as f64;
        self.operator.bytes() as f64 / (n * n)
    }

    /// Adds what it is made of.
    pub(super) fn describe(&self, map: &mut Map<String, Value>) {
        map.insert("gather".into(), json!(self.gather));
        map.insert("patches".into(), json!(self.patches()));
        map.insert("bytes_per_pair".into(), json!(self.per_pair()));
        map.insert("passes".into(), json!(self.operator.passes));
        map.insert("codec_error".into(), error_json(&self.codec_error));
    }

    /// For people.
    pub(super) fn words(&self) -> String {
        format!(
            "{} patches, {:.3} bytes a pair, codec error {:.2} %, ",
            self.patches(),
            self.per_pair(),
            100.0 * self.codec_error.rms
        )
    }
}
