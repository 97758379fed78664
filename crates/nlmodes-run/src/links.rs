//! Results stay in their directory: none is written through a symbolic link that lies in it.

use std::fs;
use std::path::{Path, PathBuf};

use crate::RunError;

/// Endings of files that are written.
const ENDINGS: [&str; 9] = ["csv", "json", "npz", "svg", "html", "uff", "wav", "npy", "tmp"];
/// Depth of folders within the directory: method, harmonics, branch.
const DEPTH: usize = 4;

/// Rejects a directory with a link in place of a results file.
///
/// # Errors
/// [`RunError::Link`].
pub fn refuse(directory: &Path) -> Result<(), RunError> {
    let Some(link) = link(directory, DEPTH) else { return Ok(()) };
    let target = fs::read_link(&link).map_or_else(|_| "elsewhere".into(), |target| target.display().to_string());
    Err(RunError::Link { link, target })
}

/// The first such link.
fn link(directory: &Path, depth: usize) -> Option<PathBuf> {
    // A directory that is not there, or cannot be read, is created or complained of when it is written.
    let entries = fs::read_dir(directory).ok().filter(|_| depth > 0)?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.into_iter().find_map(|path| {
        let kind = fs::symlink_metadata(&path).ok()?.file_type();
        if kind.is_symlink() && (is_result(&path) || is_folder(&path)) {
            return Some(path);
        }
        if kind.is_dir() && is_folder(&path) { link(&path, depth - 1) } else { None }
    })
}

fn is_result(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending == *known))
}

/// Whether a run makes folders of such names: of methods, harmonics, branches and records.
fn is_folder(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (stem, number) = name.rsplit_once('_').unwrap_or((&name, "1"));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let harmonics = name.strip_prefix('h').is_some_and(digits);
    harmonics || (digits(number) && ["branch", "ms-hbm", "hbm", "shooting", "records"].contains(&stem))
}
