//! The folder from which the relative files of the scene of results count.

use std::fs;
use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use crate::files::{DEPTH, RUN};

/// The current folder as seen from a directory of results, so that both may move together; `None` if either is unknown.
pub fn seen_from(results: &Path) -> Option<PathBuf> {
    let (here, there) = (std::env::current_dir().ok()?.canonicalize().ok()?, results.canonicalize().ok()?);
    let same = here.components().zip(there.components()).take_while(|(a, b)| a == b).count();
    if same == 0 {
        return Some(here);
    }
    let up = there.components().skip(same).map(|_| Component::ParentDir);
    Some(up.chain(here.components().skip(same)).collect())
}

/// The folder in which the run of these results was started: from there relative files of its scene count. `None` where
/// the results do not say.
pub fn started_in(results: &Path) -> Option<PathBuf> {
    let of = results.ancestors().take(DEPTH + 1).find(|folder| folder.join(RUN).is_file())?;
    let run: Value = serde_json::from_slice(&fs::read(of.join(RUN)).ok()?).ok()?;
    Some(of.join(run["folder"].as_str()?))
}
