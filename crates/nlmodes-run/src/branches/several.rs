//! One branch for each of several methods or numbers of harmonics, and their common figures (Figs. 3 b, 8).

use std::path::{Path, PathBuf};

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::ModalBranch;
use nlmodes::report::write_summary;
use serde::Serialize;

use super::curve::BranchCurve;
use super::references::references;
use super::{one_branch, page};
use crate::certificate::Certificate;
use crate::claim::Claim;
use crate::curve::{Curve, figures, histories};
use crate::files::remove_figures;
use crate::outcome::{PartOutcome, RunOutcome};
use crate::overlay::{Laid, Overlaid};
use crate::style::style_of;
use crate::{Event, Failure, Observer, RunError};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::scene::Scene;

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
/// [`RunError`], where one of them could not be computed at all.
pub fn run(
    files: &[SceneFile],
    parts: &[Part],
    (claim, laid): (&Claim, &[Laid]),
    observer: &mut dyn Observer,
    structures: &Structures,
) -> Result<RunOutcome, RunError> {
    let mut outcome = RunOutcome { parts: Vec::new(), compared: Vec::new(), failure: None, is_cut_off: false };
    let mut rows = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        if observer.is_cancelled() {
            outcome.is_cut_off = true;
            break;
        }
        observer.event(Event::Part { number, of: parts.len(), folder: &part.folder });
        let done = one_branch(&part.file, claim, laid, observer, structures);
        if matches!(done, Err(RunError::Ended)) && !outcome.parts.is_empty() {
            outcome.is_cut_off = true;
            break;
        }
        let mut done = done?;
        // The others are on disk; those that are compared stay in memory.
        done.tree.branches.truncate(1);
        done.participation.truncate(1);
        done.certificates.truncate(1);
        let Some(first) = done.tree.branches.first() else { continue };
        rows.push(Branch::new(part, &first.branch));
        outcome.parts.push(done);
    }
    if !outcome.parts.is_empty() {
        match write(files, &outcome.parts, rows, laid) {
            Ok(compared) => outcome.compared = compared,
            Err(failure) => outcome.failure = Some(failure),
        }
    }
    Ok(outcome)
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
            reason: branch.end.names(),
            message: branch.end.message.clone(),
            complete: branch.end.complete,
        }
    }
}

/// The first branch of a part as a curve.
fn first_curve(part: &PartOutcome) -> Option<BranchCurve<'_>> {
    Some(BranchCurve::new(part.tree.branches.first()?, part.shares(), part.state.as_ref()))
}

/// Writes the common files; the differences from the first part in lines.
fn write(files: &[SceneFile], parts: &[PartOutcome], rows: Vec<Branch>, laid: &[Laid]) -> Result<Vec<String>, Failure> {
    let Some(file) = files.first() else { return Ok(Vec::new()) };
    let curves: Vec<BranchCurve<'_>> = parts.iter().filter_map(first_curve).collect();
    let curves: Vec<&dyn Curve> = curves.iter().map(|curve| curve as &dyn Curve).collect();
    let Some(own) = curves.first() else { return Ok(Vec::new()) };
    let (scene, directory) = (&file.scene, &file.scene.output_directory);
    remove_figures(directory);
    let laid = Overlaid::new(laid, *own);
    laid.write(directory, "overlay")?;
    let methods = Overlaid::others(&curves);
    methods.write(directory, "methods")?;
    if scene.files.figures || scene.files.page {
        write_figures(files, parts, &curves, (&laid, &methods))?;
    }
    let scenes: Vec<&Scene> = files.iter().map(|file| &file.scene).collect();
    let summary = Summary { program: "nlmodes-cli", version: env!("CARGO_PKG_VERSION"), scenes, branches: rows };
    write_summary(directory.join("summary.json"), &summary)?;
    Ok(methods.lines())
}

/// The common figures and the page, as requested.
fn write_figures(
    files: &[SceneFile],
    parts: &[PartOutcome],
    curves: &[&dyn Curve],
    (laid, methods): (&Overlaid, &Overlaid),
) -> Result<(), Failure> {
    let (Some(file), Some(first)) = (files.first(), parts.first()) else { return Ok(()) };
    let (scene, directory) = (&file.scene, &file.scene.output_directory);
    let branches: Vec<&ComputedBranch> = parts.iter().filter_map(|part| part.tree.branches.first()).collect();
    let references = references(&branches, first.state.as_ref())?;
    if scene.files.figures {
        let shown: Vec<&ModalBranch> = curves.iter().map(|curve| curve.branch()).chain(laid.branches()).collect();
        figures::frequencies(directory, scene, (&shown, &laid.scattered(curves.len())), &[], &references)?;
        figures::participation(directory, scene, curves)?;
        histories::write(directory, &references, &style_of(&scene.files))?;
    }
    if !scene.files.page {
        return Ok(());
    }
    let scenes: Vec<&Scene> = files.iter().map(|file| &file.scene).collect();
    let certificates: Vec<&Certificate> = parts.iter().filter_map(|part| part.certificates.first()).collect();
    let shown = (branches.as_slice(), curves, certificates.as_slice());
    page::write(directory, &scenes, &first.linear, shown, (laid, methods), (&references, None))
}
