//! `etendue conformance`: the suite that every backend must pass.

use super::args::{BackendArgs, TalkArgs};
use super::error::CliError;
use std::process::ExitCode;

/// Options of `conformance`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    backend: BackendArgs,
    #[command(flatten)]
    talk: TalkArgs,
}

pub(super) fn run(_args: &Args) -> Result<ExitCode, CliError> {
    Err(CliError::Usage("not yet".into()))
}
