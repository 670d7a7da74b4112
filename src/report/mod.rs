//! Speed against error, measured on the user's own scene: which method, backend, codec and setting gives which error in which time.
//!
//! [`Contender`]s are what is measured, each one or more [`Curve`]s; [`measure()`] runs all of them in turns, at a ladder of efforts and some replicates, against a reference; [`Summary`] is what follows from
//! the runs alone, so that runs of other programs ([`Run`]s in a CSV file) can be summed up beside ours; [`write()`] draws it.
//!
//! Definitions of errors are those of [`crate::metrics`]. Seconds are of the clock on the wall, of everything between an opened scene and the image; `cpu_seconds` are of all threads of this process meanwhile.

#![allow(clippy::disallowed_methods, reason = "statistics for people, in f64: no kernel")]

mod contenders;
mod figures;
mod files;
mod measure;
mod page;
mod pictures;
mod price;
mod reference;
mod runs;
mod structure;
mod summary;
mod verdict;
mod words;

pub use contenders::{Baking, Sampling, SamplingMethod, contenders};
pub use figures::register_fonts;
pub use files::{Facts, write};
pub use measure::{LeftOut, Measured, Plan, measure, modest_size};
pub use price::Price;
pub use reference::Reference;
pub use runs::{Curve, Run, read_runs};
pub use structure::Structure;
pub use summary::{Cell, CurveSummary, Middle, Summary};
pub use verdict::{Bias, Goal, Reach};

use crate::driver::radiosity::BakeError;
use crate::driver::{Outcome, Watcher};
use crate::io::{LoadError, SaveError};
use crate::metrics::MetricsError;
use etendue_core::backend::BackendError;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A backend's.
    #[error("{0}")]
    Backend(#[from] BackendError),
    /// No operator.
    #[error("{0}")]
    Bake(#[from] BakeError),
    /// Images that cannot be compared.
    #[error("{0}")]
    Metrics(#[from] MetricsError),
    /// A file that cannot be read.
    #[error("{0}")]
    Load(#[from] LoadError),
    /// A file that cannot be written.
    #[error("{0}")]
    Save(#[from] SaveError),
    /// A reference of another size.
    #[error("the reference has {} x {} pixels, the image {} x {}: --size sets the latter", found.0, found.1, expected.0, expected.1)]
    OtherSize {
        /// Of the reference.
        found: (u32, u32),
        /// Of what is measured.
        expected: (u32, u32),
    },
    /// A table of runs that is none.
    #[error("{file}: {reason}")]
    Runs {
        /// The file.
        file: String,
        /// What is wrong, and where.
        reason: String,
    },
    /// Nothing ran to its end.
    #[error("nothing was measured: {reason}")]
    Nothing {
        /// Why not.
        reason: String,
    },
    /// A figure that cannot be drawn.
    #[error("a figure cannot be drawn: {0}")]
    Figure(String),
}

impl ReportError {
    /// It was stopped.
    pub fn is_cancelled(&self) -> bool {
        let (Self::Backend(e) | Self::Bake(BakeError::Backend(e))) = self else { return false };
        *e == BackendError::Cancelled
    }
}

/// One image that a contender made, and what it took.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Which of the contender's curves it is of.
    pub curve: usize,
    /// What it was made with, in words.
    pub effort: String,
    /// Options of `etendue render` that make it again.
    pub options: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Radiance per pixel.
    pub radiance: Vec<[f32; 3]>,
    /// Variance of the mean per pixel, where blocks tell it.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Seconds by stage; together they are all that it took.
    pub stages: Vec<(&'static str, f64)>,
    /// Seconds of all threads.
    pub cpu_seconds: f64,
    /// Rays traced.
    pub rays: u64,
    /// Bytes of the operator, where there is one.
    pub bytes: Option<u64>,
}

impl Picture {
    /// Seconds of all stages.
    pub fn seconds(&self) -> f64 {
        self.stages.iter().map(|s| s.1).sum()
    }
}

/// Something that makes images with more or less effort.
pub trait Contender {
    /// The curves that it makes points of.
    fn curves(&self) -> &[Curve];

    /// About how many times longer each rung of the ladder takes than the one before.
    fn growth(&self) -> f64 {
        2.0
    }

    /// Whether more effort makes any error as small as one likes, so that it can be the reference.
    fn converges(&self) -> bool {
        false
    }

    /// An image in so many seconds, to be the reference; of those that converge.
    ///
    /// # Errors
    /// As [`Self::run`], and of those that do not.
    fn for_seconds(
        &mut self,
        seconds: f64,
        seed: u64,
        watcher: &dyn Watcher,
    ) -> Result<Outcome, ReportError> {
        let _ = (seconds, seed, watcher);
        Err(ReportError::Nothing { reason: "this method does not converge".into() })
    }

    /// Runs one rung with a seed: a picture of each curve, but of those that refuse.
    ///
    /// # Errors
    /// The backend's; being stopped is one ([`BackendError::Cancelled`]).
    fn run(&mut self, rung: u32, seed: u64, watcher: &dyn Watcher) -> Result<Vec<Picture>, ReportError>;
}
