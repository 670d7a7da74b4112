//! Output that appears whole or not at all.

use std::io::Write as _;
use std::path::Path;

use super::error::SaveError;

/// Writes `bytes` to a temporary file beside `path`, then renames it over `path`.
/// On any failure what stood there before is untouched.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), SaveError> {
    let fail = |reason: String| Err(SaveError::new(path, reason));
    let folder = match path.parent() {
        Some(p) if p.as_os_str().is_empty() => Path::new("."),
        Some(p) => p,
        None => return fail("cannot be written: this is not the name of a file".into()),
    };
    if !folder.is_dir() {
        return fail(format!("cannot be written: the folder {} does not exist", folder.display()));
    }
    if path.is_dir() {
        return fail("cannot be written: a folder has this name".into());
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".etendue-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As for any new file: the user's umask takes its bits away.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let written = builder.tempfile_in(folder).and_then(|mut file| {
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|e| e.error)
    });
    match written {
        Ok(_) => Ok(()),
        Err(e) => fail(format!("cannot be written: {e}")),
    }
}
