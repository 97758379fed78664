//! Results whose scene is computed again.

use std::path::{Path, PathBuf};

/// The directory of results seen from the folder in which they were computed, which becomes the current one: relative
/// files of their scene count from there.
pub fn entered(results: &Path) -> PathBuf {
    let absolute = std::path::absolute(results).unwrap_or_else(|_| results.to_path_buf());
    // Where the folder is gone, the missing files are reported.
    match nlmodes_run::started_in(&absolute).map(std::env::set_current_dir) {
        Some(Err(_)) | None => results.to_path_buf(),
        Some(Ok(())) => absolute,
    }
}
