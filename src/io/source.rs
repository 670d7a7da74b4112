//! Where bytes come from: a disk, or memory for tests and fuzzers.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::error::{LoadError, Problem};

/// A read-only view of named files.
pub trait FileSource {
    /// The bytes of a file; an error of kind `FileTooLarge` when there are more than `limit`.
    fn read(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>>;
    /// Is there a file of this name?
    fn is_file(&self, path: &Path) -> bool;
    /// Names of the entries of a folder, sorted; empty when it cannot be listed.
    fn list(&self, folder: &Path) -> Vec<String>;
    /// The path of a file or folder without links.
    fn canonical(&self, path: &Path) -> io::Result<PathBuf> {
        Ok(path.to_path_buf())
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskSource;

impl FileSource for DiskSource {
    fn read(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        // Only regular files: a pipe or a device could block for ever.
        let length = std::fs::metadata(path).and_then(|m| {
            if m.is_file() { Ok(m.len()) } else { Err(io::Error::other("this is not a regular file")) }
        })?;
        if length > limit {
            return Err(too_large(length, limit));
        }
        std::fs::read(path)
    }

    fn is_file(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
        let mut names: Vec<String> = entries.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
        names.sort();
        names
    }

    fn canonical(&self, path: &Path) -> io::Result<PathBuf> {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        path.canonicalize()
    }
}

/// Files held in memory.
#[derive(Clone, Debug, Default)]
pub struct MemorySource {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl MemorySource {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file.
    #[must_use]
    pub fn with(mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(path.into(), bytes.into());
        self
    }
}

impl FileSource for MemorySource {
    fn read(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        let bytes = self.files.get(path).ok_or(io::ErrorKind::NotFound)?;
        if bytes.len() as u64 > limit {
            return Err(too_large(bytes.len() as u64, limit));
        }
        Ok(bytes.clone())
    }

    fn is_file(&self, path: &Path) -> bool {
        self.files.contains_key(path)
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = self
            .files
            .keys()
            .filter_map(|p| p.strip_prefix(folder).ok()?.components().next()?.as_os_str().to_str())
            .map(str::to_owned)
            .collect();
        names.dedup();
        names
    }
}

fn too_large(found: u64, limit: u64) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, format!("{found} bytes, expected at most {limit}"))
}

/// Reads a whole file, or says why not.
pub(crate) fn read_file(source: &dyn FileSource, path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
    source.read(path, limit).map_err(|e| LoadError::new(path, Problem::Read(e)))
}

/// How a name written in a file leads to a file.
pub(crate) enum Found {
    /// Under the very name.
    Exact(PathBuf),
    /// Under a name that differs in letter case.
    OtherCase(PathBuf),
    /// Not at all.
    Missing,
}

/// Finds the file that `name` means beside `folder`. Backslashes separate folders as slashes do, and
/// letter case is mended: both are what exporters on other systems leave behind.
pub(crate) fn find(source: &dyn FileSource, folder: &Path, name: &str) -> Found {
    let exact = folder.join(name);
    if source.is_file(&exact) {
        return Found::Exact(exact);
    }
    let name = name.replace('\\', "/");
    let path = folder.join(&name);
    if source.is_file(&path) {
        return Found::Exact(path);
    }
    let mut walked = if Path::new(&name).is_absolute() { PathBuf::new() } else { folder.to_path_buf() };
    for component in Path::new(&name).components() {
        match component {
            Component::Normal(part) => {
                let Some(part) = part.to_str() else { return Found::Missing };
                let lower = part.to_lowercase();
                let names = source.list(&walked);
                let Some(hit) = names.iter().find(|n| *n == part).or_else(|| {
                    // The first in sorted order, so that the choice does not depend on the disk.
                    names.iter().find(|n| n.to_lowercase() == lower)
                }) else {
                    return Found::Missing;
                };
                walked.push(hit);
            }
            Component::CurDir => {}
            other => walked.push(other.as_os_str()),
        }
    }
    if source.is_file(&walked) { Found::OtherCase(walked) } else { Found::Missing }
}
