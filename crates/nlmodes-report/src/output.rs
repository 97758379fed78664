use crate::ReportError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file, which is replaced at once, never half.
///
/// # Errors
/// [`ReportError::Io`] if it cannot be written.
pub fn write_file(path: impl AsRef<Path>, content: &[u8]) -> Result<(), ReportError> {
    replace_file(path.as_ref(), |file| file.write_all(content))
}

/// Writes a file under a temporary name beside `path` and renames it, so that `path` is never half written.
pub(crate) fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), ReportError> {
    let temporary = temporary_name(path);
    write_all(&temporary, write).and_then(|()| fs::rename(&temporary, path)).map_err(|source| {
        // The first error is the one to tell; the file may not even exist.
        let _ = fs::remove_file(&temporary);
        ReportError::Io { path: path.to_path_buf(), source }
    })
}

fn write_all(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    write(&mut file)?;
    file.flush()
}

/// Hidden name in the same directory: a rename must not cross file systems.
pub(crate) fn temporary_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.nlmodes.tmp", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failed_write_keeps_the_old_file_and_leaves_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        fs::write(&path, "old").unwrap();
        let outcome = replace_file(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("cut off"))
        });
        assert!(matches!(outcome, Err(ReportError::Io { path: ref p, .. }) if *p == path));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
