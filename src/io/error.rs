//! What can be wrong with a file, said in one sentence.

use std::fmt;
use std::path::{Path, PathBuf};

/// What is wrong, without the place.
#[derive(Debug)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be read.
    Read(std::io::Error),
    /// Something else was expected.
    Unexpected {
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// More than a sane file holds, or than 32-bit indices can count.
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        found: u64,
        /// How many are accepted.
        limit: u64,
    },
    /// Well-formed, and not supported by this version.
    Unsupported(String),
    /// Not what was written: cut short or changed since.
    Damaged(String),
    /// Of a version that did not exist when this program was made.
    Newer {
        /// Version of the file.
        found: u32,
        /// Newest version that is read.
        known: u32,
    },
    /// A library that decodes a format refused the bytes.
    Decode {
        /// The format.
        format: &'static str,
        /// What the library said.
        message: String,
    },
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(e) => write!(f, "cannot be read: {e}"),
            Self::Unexpected { found, expected } => write!(f, "found {found}, expected {expected}"),
            Self::TooLarge { what, found, limit } => {
                write!(f, "found {found} {what}, expected at most {limit}")
            }
            Self::Unsupported(what) => write!(f, "{what} is not supported by this version"),
            Self::Damaged(how) => write!(f, "is damaged: {how}"),
            Self::Newer { found, known } => {
                write!(f, "was written by a newer version: file version {found}, this program reads {known}")
            }
            Self::Decode { format, message } => write!(f, "is not a readable {format} file: {message}"),
        }
    }
}

/// Why a file was refused: where, what was found and what was expected.
#[derive(Debug, thiserror::Error)]
#[error("{}", sentence(.file, *.line, .field.as_deref(), .problem))]
pub struct LoadError {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1, in formats that have lines.
    pub line: Option<usize>,
    /// The field, keyword or element.
    pub field: Option<String>,
    /// What is wrong.
    #[source]
    pub problem: Problem,
}

impl std::error::Error for Problem {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read(e) => Some(e),
            _ => None,
        }
    }
}

fn sentence(file: &Path, line: Option<usize>, field: Option<&str>, problem: &Problem) -> String {
    let mut out = file.display().to_string();
    if let Some(line) = line {
        out += &format!(":{line}");
    }
    if let Some(field) = field {
        out += &format!(": {field}");
    }
    out + &format!(": {problem}")
}

impl LoadError {
    pub(crate) fn new(file: &Path, problem: Problem) -> Self {
        Self { file: file.to_path_buf(), line: None, field: None, problem }
    }

    pub(crate) fn unexpected(file: &Path, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::new(file, Problem::Unexpected { found: found.into(), expected: expected.into() })
    }

    pub(crate) fn decode(file: &Path, format: &'static str, message: impl fmt::Display) -> Self {
        Self::new(file, Problem::Decode { format, message: clip(&message.to_string()) })
    }

    pub(crate) fn at(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    pub(crate) fn field(mut self, field: impl Into<String>) -> Self {
        self.field = Some(field.into());
        self
    }
}

/// Quotes what was found, cut short: a message must stay readable whatever the file holds.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", clip(text))
}

fn clip(text: &str) -> String {
    const LONGEST: usize = 120;
    let mut out: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push_str("...");
    }
    out
}

/// Why a file could not be written. What stood under that name before is untouched.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", .file.display())]
pub struct SaveError {
    /// The file.
    pub file: PathBuf,
    /// Why, in words.
    pub reason: String,
}

impl SaveError {
    pub(crate) fn new(file: &Path, reason: impl fmt::Display) -> Self {
        Self { file: file.to_path_buf(), reason: reason.to_string() }
    }
}

/// Something in a file that was mended, left out or assumed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1, where there is one.
    pub line: Option<usize>,
    /// One sentence.
    pub message: String,
}

impl Note {
    pub(crate) fn new(file: &Path, line: Option<usize>, message: impl Into<String>) -> Self {
        Self { file: file.to_path_buf(), line, message: message.into() }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file.display(), self.message),
            None => write!(f, "{}: {}", self.file.display(), self.message),
        }
    }
}
