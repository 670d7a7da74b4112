//! Why a backend did not do a job.

use crate::film::FilmError;
use crate::transport::first_shot::FirstShotError;
use alloc::string::String;
use core::fmt;

/// Why a backend did not do a job.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BackendError {
    /// The backend cannot do this at all.
    Unsupported {
        /// Which backend.
        backend: &'static str,
        /// What was asked, in words.
        what: String,
    },
    /// The scene needs transport that the method lacks.
    SceneNeeds {
        /// The method.
        method: &'static str,
        /// What is missing, in words.
        missing: String,
    },
    /// An image was asked for and the scene has no camera.
    NoCamera,
    /// Photons were asked for and nothing in the scene emits.
    Dark,
    /// Photons cannot start on the surfaces of this scene.
    FirstShot(FirstShotError),
    /// No device.
    NoAdapter {
        /// What was looked for.
        wanted: String,
    },
    /// The device went away in the middle of a job; nothing of the job was kept.
    DeviceLost {
        /// The device.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// The device refused what a job asked of it: a fault of the backend, not of the job.
    Device {
        /// The device.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// The device has too little of something.
    LimitExceeded {
        /// The resource.
        what: &'static str,
        /// How much was needed.
        asked: u64,
        /// How much there is.
        allowed: u64,
    },
    /// A probe is not usable.
    BadProbe {
        /// Its index.
        index: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A job's numbers make no sense.
    BadJob {
        /// What is wrong.
        reason: &'static str,
    },
    /// Slices passed to [`map`](super::Backend::map) do not fit the kernel.
    WrongLength {
        /// The kernel's name.
        kernel: &'static str,
        /// `constants`, `items` or `out`.
        slice: &'static str,
        /// Words found.
        found: usize,
        /// Words expected.
        expected: usize,
    },
    /// The film does not belong to the job.
    Film(FilmError),
    /// The control stopped the job; the film holds nothing of it.
    Cancelled,
}

impl BackendError {
    /// [`Self::SceneNeeds`] where the scene needs something that a method lacks.
    ///
    /// # Errors
    /// That.
    pub fn unless_covered(method: &'static str, missing: Option<String>) -> Result<(), Self> {
        missing.map_or(Ok(()), |missing| Err(Self::SceneNeeds { method, missing }))
    }
}

impl fmt::Display for BackendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsupported { backend, what } => write!(f, "the {backend} backend does not support {what}"),
            Self::SceneNeeds { method, missing } => {
                write!(f, "the scene needs {missing}, which method `{method}` of this version does not carry")
            }
            Self::Dark => write!(f, "nothing in the scene emits light: there are no photons to start"),
            Self::FirstShot(e) => e.fmt(f),
            Self::NoCamera => write!(f, "the scene has no [camera], and an image needs one"),
            Self::NoAdapter { wanted } => write!(f, "no adapter found: {wanted}"),
            Self::DeviceLost { adapter, reason } => write!(f, "the device {adapter} was lost: {reason}"),
            Self::Device { adapter, reason } => write!(f, "the device {adapter} refused a job: {reason}"),
            Self::LimitExceeded { what, asked, allowed } => {
                write!(f, "the job needs {asked} {what}, but only {allowed} are there")
            }
            Self::BadProbe { index, reason } => write!(f, "probe {index}: {reason}"),
            Self::BadJob { reason } => write!(f, "job: {reason}"),
            Self::WrongLength { kernel, slice, found, expected } => {
                write!(f, "kernel {kernel}: {slice} has {found} words, expected {expected}")
            }
            Self::Film(e) => e.fmt(f),
            Self::Cancelled => write!(f, "cancelled"),
        }
    }
}

impl core::error::Error for BackendError {}

impl From<FirstShotError> for BackendError {
    fn from(e: FirstShotError) -> Self {
        Self::FirstShot(e)
    }
}

impl From<FilmError> for BackendError {
    fn from(e: FilmError) -> Self {
        Self::Film(e)
    }
}
