//! Redraws the figures of results in another width: the steps of the run are repeated, and only the contents of figures
//! are computed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::Scene;
use serde::Deserialize;
use thiserror::Error;

use crate::files::{DEPTH, RUN, STEPS};
use crate::{Event, Observer, Over, RunError, branches, responses};

const SUMMARY: &str = "summary.json";

/// Why figures are not redrawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RedrawError {
    /// A file cannot be read or written.
    #[error("{}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The summary is not one of a run.
    #[error("{SUMMARY} is not that of a run")]
    NotASummary(#[from] serde_json::Error),
    /// It has no scene whose figures have a width.
    #[error(
        "only figures of branches and responses are drawn anew: figures of records and tests have one width, and those \
            of a folder branch_1 … are the figures of the folder above"
    )]
    NoScene,
    /// It is a folder within the results of a run.
    #[error(
        "the figures of one method, number of harmonics or branch are drawn anew with the whole run: name the folder \
            above"
    )]
    Within,
    /// The run had not ended.
    #[error("the run had not ended, and is not gone on with for a figure: `run --resume` first")]
    NotEnded,
    /// Its structure or an overlay has changed.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// What is read of a summary: one scene, or those of several methods.
#[derive(Deserialize)]
struct Summary {
    scene: Option<Scene>,
    #[serde(default)]
    scenes: Vec<Scene>,
}

/// Draws the figures of the run in `results` into the folder `into`, which is made: so wide in print, mm, and without
/// their titles unless `titled`.
///
/// Curves of responses are computed again.
///
/// # Errors
/// [`RedrawError`].
pub fn redraw(results: &Path, into: &Path, width_mm: Option<f64>, titled: bool) -> Result<(), RedrawError> {
    let path = results.join(SUMMARY);
    let text = fs::read(&path).map_err(|source| RedrawError::Io { path, source })?;
    let Summary { scene, scenes } = serde_json::from_slice(&text)?;
    let mut scenes = if scenes.is_empty() { scene.into_iter().collect() } else { scenes };
    if scenes.is_empty() {
        return Err(RedrawError::NoScene);
    }
    if !results.join(RUN).is_file() {
        return Err(RedrawError::Within);
    }
    for scene in &mut scenes {
        scene.output_directory = into.to_path_buf();
        scene.files.figures = true;
        scene.files.page = false;
        scene.files.figure_width_mm = width_mm;
        scene.files.figure_titles = titled;
        if scene.method.harmonics_list.is_empty() {
            // A single number is not written as a list.
            scene.method.harmonics_list = vec![scene.method.harmonics];
        }
    }
    let mut files: Vec<SceneFile> = scenes.into_iter().map(|scene| SceneFile::without_text(scene, SUMMARY)).collect();
    if files.len() == 1 && !files[0].scene.responses.is_empty() {
        let outcome = responses::run(&files.swap_remove(0), Over::Anything, &mut Repeating::default())?;
        return outcome.failure.map_or(Ok(()), |failure| Err(RunError::Files(failure).into()));
    }
    if files.len() == 1 && files[0].scene.transient.is_some() {
        let outcome = crate::transient::run(&files.swap_remove(0), Over::Anything, &mut Repeating::default())?;
        return outcome.failure.map_or(Ok(()), |failure| Err(RunError::Files(failure).into()));
    }
    copy_steps(results, into, DEPTH)?;
    let mut repeating = Repeating::default();
    let done = branches::run(files, Over::Resumed, &mut repeating);
    if repeating.is_new {
        return Err(RedrawError::NotEnded);
    }
    let outcome = done?;
    let failures = outcome.parts.into_iter().filter_map(|part| part.failure).chain(outcome.failure);
    failures.map(|failure| Err(RunError::Files(failure).into())).next().unwrap_or(Ok(()))
}

/// Looks on while steps are repeated, and ends the run where a point would be computed.
#[derive(Default)]
struct Repeating {
    is_new: bool,
}

impl Observer for Repeating {
    fn event(&mut self, event: Event<'_>) {
        self.is_new |= matches!(event, Event::Point { is_new: true, .. });
    }

    fn is_cancelled(&self) -> bool {
        self.is_new
    }
}

/// The steps and their scene, with the folders in which they are.
fn copy_steps(from: &Path, to: &Path, depth: usize) -> Result<(), RedrawError> {
    let io = |path: &Path| {
        let path = path.to_path_buf();
        move |source| RedrawError::Io { path, source }
    };
    fs::create_dir_all(to).map_err(io(to))?;
    for name in [RUN, STEPS].into_iter().filter(|name| from.join(name).is_file()) {
        fs::copy(from.join(name), to.join(name)).map_err(io(&from.join(name)))?;
    }
    for entry in fs::read_dir(from).map_err(io(from))?.flatten().filter(|_| depth > 0) {
        let path = entry.path();
        if path.join(STEPS).is_file() || path.join(SUMMARY).is_file() {
            copy_steps(&path, &to.join(entry.file_name()), depth - 1)?;
        }
    }
    Ok(())
}
