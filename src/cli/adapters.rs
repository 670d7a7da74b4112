//! `etendue adapters`: what `--adapter` can name.

use super::args::TalkArgs;
use super::error::{CliError, NO};
use crate::engine;
use serde_json::json;
use std::process::ExitCode;

/// Options of `adapters`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    talk: TalkArgs,
}

/// Runs the verb; exit 1 where there is none.
pub(super) fn run(args: &Args) -> Result<ExitCode, CliError> {
    let list = engine::adapters();
    if args.talk.json {
        println!("{}", json!({ "version": env!("CARGO_PKG_VERSION"), "adapters": list }));
    } else if !args.talk.quiet {
        for name in &list {
            println!("{name}");
        }
    }
    Ok(if list.is_empty() { ExitCode::from(NO) } else { ExitCode::SUCCESS })
}
