//! One branch for each of several numbers of harmonics, and their common figures (Fig. 3 b).

use std::error::Error;
use std::path::PathBuf;

use nlmodes::modal::ModalBranch;
use nlmodes::report::{Abscissa, BranchFigure, write_summary};
use nlmodes::study::ComputedBranch;
use serde::Serialize;

use crate::Status;
use crate::config::SceneFile;
use crate::config::scene::Scene;

use super::{chain, one_branch, page};

#[derive(Serialize)]
struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    scene: &'a Scene,
    branches: Vec<Branch>,
}

#[derive(Serialize)]
struct Branch {
    harmonics: usize,
    directory: PathBuf,
    points: usize,
    reason: String,
    message: String,
    complete: bool,
}

/// Computes the branches into folders `h1`, `h3`, … of the output directory, then the common figures and the summary.
///
/// # Errors
/// The status, where one of them could not be computed at all.
pub fn study(file: &SceneFile, numbers: &[usize], quiet: bool) -> Result<Status, Status> {
    let mut status = Status::Done;
    let (mut branches, mut rows) = (Vec::new(), Vec::new());
    for &harmonics in numbers {
        let own = with_harmonics(file, harmonics);
        let (computed, ended) = one_branch(&own, quiet)?;
        if ended != Status::Done {
            status = ended;
        }
        rows.push(Branch::new(harmonics, &own.scene, &computed.branch));
        branches.push(computed);
    }
    if let Err(error) = write(file, &branches, rows) {
        say!("error: {}", chain(error.as_ref()));
        return Ok(Status::EndedEarly);
    }
    Ok(status)
}

/// The scene with one of its numbers of harmonics, and a folder of its own.
fn with_harmonics(file: &SceneFile, harmonics: usize) -> SceneFile {
    let mut own = file.clone();
    own.scene.method.harmonics = harmonics;
    own.scene.method.harmonics_list = vec![harmonics];
    own.scene.output_directory.push(format!("h{harmonics}"));
    own
}

impl Branch {
    fn new(harmonics: usize, scene: &Scene, branch: &ModalBranch) -> Self {
        Self {
            harmonics,
            directory: scene.output_directory.clone(),
            points: branch.points.len(),
            reason: branch.end.reason.clone(),
            message: branch.end.message.clone(),
            complete: branch.end.complete,
        }
    }
}

fn write(file: &SceneFile, branches: &[ComputedBranch], rows: Vec<Branch>) -> Result<(), Box<dyn Error>> {
    let scene = &file.scene;
    let all: Vec<&ModalBranch> = branches.iter().map(|computed| &computed.branch).collect();
    for (abscissa, name) in
        [(Abscissa::Energy, "frequency_energy.svg"), (Abscissa::ModalAmplitude, "frequency_amplitude.svg")]
    {
        let figure = BranchFigure::new(abscissa, &all).title(&scene.title).render()?;
        figure.write(scene.output_directory.join(name))?;
    }
    page::write(&scene.output_directory, scene, &branches.iter().collect::<Vec<_>>())?;
    let summary = Summary { program: "nlmodes-cli", version: env!("CARGO_PKG_VERSION"), scene, branches: rows };
    Ok(write_summary(scene.output_directory.join("summary.json"), &summary)?)
}
