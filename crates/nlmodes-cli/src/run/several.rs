//! One branch for each of several methods or numbers of harmonics, and their common figures (Figs. 3 b, 8).

use std::error::Error;
use std::path::{Path, PathBuf};

use nlmodes::modal::ModalBranch;
use nlmodes::report::{Abscissa, BranchFigure, write_summary};
use nlmodes::study::ComputedBranch;
use serde::Serialize;

use crate::Status;
use crate::config::SceneFile;
use crate::config::scene::Scene;

use super::{chain, figures, histories, one_branch, page};

#[derive(Serialize)]
struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    /// A scene for each method.
    scenes: Vec<&'a Scene>,
    branches: Vec<Branch>,
}

#[derive(Serialize)]
struct Branch {
    method: &'static str,
    harmonics: usize,
    label: String,
    directory: PathBuf,
    points: usize,
    reason: String,
    message: String,
    complete: bool,
}

/// One of several studies.
pub struct Part {
    pub file: SceneFile,
    /// Its folder within the output directory; none where it is the only one.
    pub folder: PathBuf,
}

/// A part for each method and each of its numbers of harmonics.
pub fn parts(files: &[SceneFile]) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut kinds: Vec<&str> = Vec::new();
    for file in files {
        let method = &file.scene.method;
        let kind = method.kind.name();
        let mut folder = PathBuf::new();
        if files.len() > 1 {
            kinds.push(kind);
            let count = kinds.iter().filter(|k| **k == kind).count();
            folder.push(if count > 1 { format!("{kind}_{count}") } else { kind.to_owned() });
        }
        for &harmonics in &method.harmonics_list {
            let mut folder = folder.clone();
            if method.harmonics_list.len() > 1 {
                folder.push(format!("h{harmonics}"));
            }
            parts.push(Part { file: with_harmonics(file, harmonics, &folder), folder });
        }
    }
    parts
}

/// Computes each part in its folder (`ms-hbm`, `hbm`, …; `h1`, `h3`, …), then the common figures and the summary.
///
/// # Errors
/// The status, where one of them could not be computed at all.
pub fn study(files: &[SceneFile], parts: &[Part], quiet: bool) -> Result<Status, Status> {
    let mut status = Status::Done;
    let (mut computed, mut rows) = (Vec::new(), Vec::new());
    for part in parts {
        let (mut tree, ended) = one_branch(&part.file, quiet)?;
        if ended != Status::Done {
            status = ended;
        }
        let branch = tree.branches.swap_remove(0);
        rows.push(Branch::new(part, &branch.branch));
        computed.push(branch);
    }
    if let Err(error) = write(files, &computed, rows) {
        say!("error: {}", chain(error.as_ref()));
        return Ok(Status::EndedEarly);
    }
    Ok(status)
}

/// The scene with one of its numbers of harmonics, and a folder of its own.
fn with_harmonics(file: &SceneFile, harmonics: usize, folder: &Path) -> SceneFile {
    let mut own = file.clone();
    own.scene.method.harmonics = harmonics;
    own.scene.method.harmonics_list = vec![harmonics];
    if folder != Path::new("") {
        own.scene.output_directory.push(folder);
    }
    own
}

impl Branch {
    fn new(part: &Part, branch: &ModalBranch) -> Self {
        Self {
            method: part.file.scene.method.kind.name(),
            harmonics: part.file.scene.method.harmonics,
            label: branch.label.clone(),
            directory: part.folder.clone(),
            points: branch.points.len(),
            reason: branch.end.reason.clone(),
            message: branch.end.message.clone(),
            complete: branch.end.complete,
        }
    }
}

fn write(files: &[SceneFile], computed: &[ComputedBranch], rows: Vec<Branch>) -> Result<(), Box<dyn Error>> {
    let Some(scene) = files.first().map(|file| &file.scene) else { return Ok(()) };
    let directory = &scene.output_directory;
    figures::remove(directory);
    let all: Vec<&ModalBranch> = computed.iter().map(|c| &c.branch).collect();
    let branches: Vec<&ComputedBranch> = computed.iter().collect();
    let references = histories::references(&branches)?;
    for (abscissa, name) in
        [(Abscissa::Energy, "frequency_energy.svg"), (Abscissa::ModalAmplitude, "frequency_amplitude.svg")]
    {
        let mut figure = BranchFigure::new(abscissa, &all).title(&scene.title);
        for reference in references.iter().filter(|_| abscissa == Abscissa::ModalAmplitude) {
            figure = figure.mark(0, reference.point, &reference.name);
        }
        figure.render()?.write(directory.join(name))?;
    }
    figures::participation(directory, scene, &branches)?;
    histories::write(directory, &references)?;
    let scenes: Vec<&Scene> = files.iter().map(|file| &file.scene).collect();
    page::write(directory, &scenes, &branches, &references)?;
    let summary = Summary { program: "nlmodes-cli", version: env!("CARGO_PKG_VERSION"), scenes, branches: rows };
    Ok(write_summary(directory.join("summary.json"), &summary)?)
}
