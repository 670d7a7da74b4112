//! Errors of the command and their exit codes.

use crate::driver::OpenError;
use crate::driver::radiosity::BakeError;
use crate::io::{LoadError, SaveError};
use crate::metrics::MetricsError;
use crate::report::ReportError;
use etendue_core::backend::BackendError;
use etendue_core::scene::SceneError;
use std::process::ExitCode;

/// The answer is 'no'.
pub(super) const NO: u8 = 1;
/// Bad usage (clap's own code, too).
pub(super) const USAGE: u8 = 2;
/// Bad input.
const INPUT: u8 = 3;
/// A resource is missing or too small.
const RESOURCE: u8 = 4;
/// Stopped by Ctrl-C.
pub(super) const INTERRUPTED: u8 = 130;

/// Why a verb did not do its work.
#[derive(Debug, thiserror::Error)]
pub(super) enum CliError {
    #[error("{0}")]
    Load(#[from] LoadError),
    #[error("{file}: {error}")]
    Scene { file: String, error: SceneError },
    #[error("{0}")]
    Backend(#[from] BackendError),
    #[error("{0}")]
    Bake(#[from] BakeError),
    #[error("{file}: {error}")]
    Operator { file: String, error: OpenError },
    #[error("{0}")]
    Save(#[from] SaveError),
    #[error("{file}: its folder does not exist")]
    NoFolder { file: String },
    #[error("{0}")]
    Metrics(#[from] MetricsError),
    #[error("{0}")]
    Report(#[from] ReportError),
    #[error("{folder}: cannot be made: {reason}")]
    Folder { folder: String, reason: String },
    #[error("{0}")]
    Usage(String),
    #[error("{0}")]
    Input(String),
}

impl CliError {
    pub(super) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Load(_) | Self::Scene { .. } | Self::Metrics(_) | Self::Input(_) => INPUT,
            Self::Operator { .. } => INPUT,
            Self::Bake(BakeError::Backend(e)) | Self::Backend(e) => backend_code(e),
            Self::Bake(_) => INPUT,
            Self::Usage(_) => USAGE,
            Self::Report(ReportError::Backend(e) | ReportError::Bake(BakeError::Backend(e))) => {
                backend_code(e)
            }
            Self::Report(ReportError::Save(_) | ReportError::Figure(_)) => RESOURCE,
            Self::Report(_) => INPUT,
            Self::Save(_) | Self::NoFolder { .. } | Self::Folder { .. } => RESOURCE,
        })
    }
}

fn backend_code(e: &BackendError) -> u8 {
    match e {
        BackendError::Unsupported { .. }
        | BackendError::NoAdapter { .. }
        | BackendError::DeviceLost { .. }
        | BackendError::Device { .. }
        | BackendError::LimitExceeded { .. } => RESOURCE,
        BackendError::BadJob { .. } => USAGE,
        _ => INPUT,
    }
}
