//! Solutions of contact problems into a file.

use std::fs;
use std::io::{self, Cursor};
use std::path::Path;

use nlmodes::contact::SeriesSolution;
use npyz::WriterBuilder;
use npyz::npz::NpzWriter;

use super::error::ProblemError;

type Archive = NpzWriter<Cursor<Vec<u8>>>;

/// Refuses a place where no file can be written before time is spent on the solution.
///
/// # Errors
/// [`ProblemError::Write`].
pub fn check_place(path: &Path, problem: &Path) -> Result<(), ProblemError> {
    let refuse = |what: &str| {
        Err(ProblemError::Write { path: path.to_path_buf(), source: io::Error::new(io::ErrorKind::NotFound, what) })
    };
    match path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        _ if path.is_dir() => refuse("this is a directory, expected a file"),
        Some(parent) if !parent.is_dir() => refuse("its directory does not exist"),
        _ if path.exists() && path.canonicalize().ok() == problem.canonicalize().ok() => {
            refuse("this is the problem itself, expected another file")
        }
        _ => Ok(()),
    }
}

/// Writes the first `samples` samples of the solution, at once and under their name only when complete.
///
/// # Errors
/// [`ProblemError::Write`].
pub fn write(path: &Path, solution: &SeriesSolution, samples: usize, c: usize) -> Result<(), ProblemError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let temporary = path.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
    let written = archive(solution, samples, c)
        .and_then(|bytes| fs::write(&temporary, bytes))
        .and_then(|()| fs::rename(&temporary, path));
    written.map_err(|source| {
        // The first error is reported; the file may not even exist.
        let _ = fs::remove_file(&temporary);
        ProblemError::Write { path: path.to_path_buf(), source }
    })
}

fn archive(solution: &SeriesSolution, samples: usize, c: usize) -> io::Result<Vec<u8>> {
    let mut archive = NpzWriter::new(Cursor::new(Vec::new()));
    let statistics = &solution.statistics()[..samples];
    let shape = [samples as u64, c as u64];
    let rows =
        |row: fn(&SeriesSolution, usize) -> &[f64]| (0..samples).flat_map(move |k| row(solution, k).iter().copied());
    put(&mut archive, "lambda", &shape, rows(SeriesSolution::lambda))?;
    put(&mut archive, "g", &shape, rows(SeriesSolution::gaps))?;
    put(&mut archive, "violation", &shape[..1], statistics.iter().map(|s| s.violation))?;
    put(&mut archive, "iterations", &shape[..1], statistics.iter().map(|s| s.iterations as u64))?;
    Ok(archive.zip_writer().finish()?.into_inner())
}

fn put<T: npyz::AutoSerialize>(
    archive: &mut Archive,
    name: &str,
    shape: &[u64],
    values: impl Iterator<Item = T>,
) -> io::Result<()> {
    let mut array = archive.array::<T>(name, Default::default())?.default_dtype().shape(shape).begin_nd()?;
    array.extend(values)?;
    array.finish()
}
