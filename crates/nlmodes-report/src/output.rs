use crate::ReportError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Writes a file, replacing an existing one atomically.
///
/// # Errors
/// [`ReportError::Io`] if it cannot be written.
pub fn write_file(path: impl AsRef<Path>, content: &[u8]) -> Result<(), ReportError> {
    replace_file(path.as_ref(), |file| file.write_all(content))
}

/// Writes a file under a temporary name beside `path` and renames it, so that `path` is never half written.
pub(crate) fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut Output<BufWriter<File>>) -> io::Result<()>,
) -> Result<(), ReportError> {
    let temporary = temporary_name(path);
    write_all(&temporary, write).and_then(|()| fs::rename(&temporary, path)).map_err(|source| {
        // The first error is reported; the file may not even exist.
        let _ = fs::remove_file(&temporary);
        ReportError::Io { path: path.to_path_buf(), source }
    })
}

fn write_all(path: &Path, write: impl FnOnce(&mut Output<BufWriter<File>>) -> io::Result<()>) -> io::Result<()> {
    let mut file = Output { inner: BufWriter::new(File::create(path)?), has_failed: false, position: 0 };
    write(&mut file)?;
    if file.has_failed {
        return Err(io::Error::other("an earlier write had failed"));
    }
    file.flush()
}

/// A writer that fails once and is silent from then on: archive writers that are dropped after a failure try to write
/// their end, and would print this on standard error in addition to the message of the failure itself.
pub(crate) struct Output<W> {
    inner: W,
    has_failed: bool,
    /// Position of the next byte, also after a failure: archive writers compute differences of positions even then.
    position: u64,
}

impl<W> Output<W> {
    /// `work` unless something has failed before, else `otherwise`.
    fn once<T>(&mut self, otherwise: T, work: impl FnOnce(&mut W) -> io::Result<T>) -> io::Result<T> {
        if self.has_failed {
            return Ok(otherwise);
        }
        let done = work(&mut self.inner);
        // Interrupted writes are retried.
        self.has_failed = done.as_ref().is_err_and(|error| error.kind() != io::ErrorKind::Interrupted);
        done
    }
}

impl<W: Write> Write for Output<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.once(bytes.len(), |inner| inner.write(bytes))?;
        self.position += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.once((), Write::flush)
    }
}

impl<W: Seek> Seek for Output<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let aimed = match to {
            SeekFrom::Start(place) => place,
            SeekFrom::Current(by) | SeekFrom::End(by) => self.position.saturating_add_signed(by),
        };
        self.position = self.once(aimed, |inner| inner.seek(to))?;
        Ok(self.position)
    }
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
    fn an_archive_on_a_full_disk_fails_once_and_is_silent_when_it_is_dropped() {
        // A limited number of bytes, with a record of each attempt to write beyond it.
        struct Full(usize, usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                if bytes.len() > self.0 {
                    self.1 += 1;
                    return Err(io::ErrorKind::StorageFull.into());
                }
                self.0 -= bytes.len();
                Ok(bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut output = Output { inner: Full(10, 0), has_failed: false, position: 0 };
        output.write_all(b"12345678").unwrap();
        assert_eq!(output.write_all(b"12345678").unwrap_err().kind(), io::ErrorKind::StorageFull);
        output.write_all(b"the end of the archive").unwrap();
        output.flush().unwrap();
        assert!(output.has_failed && output.inner.1 == 1);
        // Eight bytes are there, and 22 would be.
        assert_eq!(output.position, 8 + 22);
        // Even if a writer overlooks the failure, its file is not written.
        let folder = tempfile::tempdir().unwrap();
        let outcome = replace_file(&folder.path().join("archive"), |file| {
            file.has_failed = true;
            file.write_all(b"end")
        });
        assert!(outcome.is_err() && fs::read_dir(folder.path()).unwrap().count() == 0);
    }

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
