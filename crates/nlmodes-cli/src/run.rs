//! `nlmodes-cli run`: the whole study that a scene describes.

mod figures;
mod harmonics;
mod progress;
mod summary;

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use nlmodes::hbm::HbmError;
use nlmodes::modal::ModalPoint;
use nlmodes::model::{MasslessContactModel, StructuralModel};
use nlmodes::report::{BranchWriter, ReportError, write_harmonics};
use nlmodes::study::{BranchSettings, BranchStart, ComputedBranch, StudyError, compute_branch};

use crate::Status;
use crate::assemble::{contact_model, structural_model};
use crate::command::print;
use crate::config::SceneFile;
use crate::config::scene::{FrequencyDirection, Scene, Start, Switching, Symmetry};
use progress::Progress;

/// Computes the branches of a scene and writes their files; `quiet` leaves out the progress.
///
/// Each point is in `branch.csv` as soon as it is found. Nothing is written before the first one. Several numbers of harmonics have a
/// folder each, and common figures beside these.
pub fn run(file: &SceneFile, quiet: bool) -> Status {
    let outcome = match file.scene.method.harmonics_list.as_slice() {
        [_] => one_branch(file, quiet).map(|(_, status)| status),
        several => harmonics::study(file, several, quiet),
    };
    outcome.unwrap_or_else(|status| status)
}

/// One branch with all its files, and how it ended.
fn one_branch(file: &SceneFile, quiet: bool) -> Result<(ComputedBranch, Status), Status> {
    let scene = &file.scene;
    let began = Instant::now();
    let (model, massless) = models(file)?;
    let mut sink =
        Sink { directory: &scene.output_directory, writer: None, failure: None, progress: Progress::new(quiet) };
    let computed = compute(scene, massless, &mut sink);
    if let Some(failure) = sink.failure {
        say!("error: {}", chain(&failure));
        say!("expected a directory for the results that can be created and written; nothing was kept");
        return Err(Status::Wrong);
    }
    sink.progress.finish();
    let computed = computed.map_err(|error| refuse_study(file, &error))?;
    let status = finish(file, &model, &computed, began, quiet);
    Ok((computed, status))
}

/// The structure of the scene, and the model of it that the method works on.
pub fn models(file: &SceneFile) -> Result<(StructuralModel, MasslessContactModel), Status> {
    let model = structural_model(&file.scene).map_err(|error| refuse(file, "structure", &error))?;
    let massless =
        contact_model(&file.scene, &model).map_err(|error| refuse(file, "method.mass_redistribution", &error))?;
    Ok((model, massless))
}

/// The branch from its start; where both ways are asked for, the way down first and then, behind its points in reverse order, the
/// way up.
fn compute(scene: &Scene, model: MasslessContactModel, sink: &mut Sink) -> Result<ComputedBranch, StudyError> {
    let (start, both) = match scene.continuation.start {
        Start::Grazing => (BranchStart::Grazing, false),
        Start::Frequency { hz, direction } => {
            let upward = direction == FrequencyDirection::Up;
            (BranchStart::Frequency { hz, upward }, direction == FrequencyDirection::Both)
        }
    };
    let settings = BranchSettings { start, ..branch_settings(scene) };
    let one_way = compute_branch(model.clone(), &settings, |point| sink.take(point))?;
    let BranchStart::Frequency { hz, .. } = start else { return Ok(one_way) };
    if !both || sink.failure.is_some() {
        return Ok(one_way);
    }
    sink.begin_again(one_way.branch.points.iter().skip(1).rev());
    let up = BranchSettings { start: BranchStart::Frequency { hz, upward: true }, ..settings };
    let other = compute_branch(model, &up, |point| sink.take(point))?;
    Ok(other.preceded_by(one_way))
}

pub fn branch_settings(scene: &Scene) -> BranchSettings {
    let method = &scene.method;
    BranchSettings {
        mode: method.mode,
        harmonics: method.harmonics,
        symmetry: match method.symmetry {
            Symmetry::Even => nlmodes::hbm::Symmetry::Even,
            Symmetry::None => nlmodes::hbm::Symmetry::None,
        },
        switching: match method.switching {
            Switching::Exact => nlmodes::hbm::Switching::Exact,
            Switching::Sampled => nlmodes::hbm::Switching::Sampled { samples: method.samples },
        },
        contact_solver: method.contact_solver.name().to_owned(),
        held_modes: method.held_modes,
        max_energy_ratio: scene.continuation.max_energy_ratio,
        frequency_hz: scene.continuation.frequency_hz,
        max_points: scene.continuation.max_points,
        ..BranchSettings::default()
    }
}

/// Takes the points as they are found.
struct Sink<'a> {
    directory: &'a Path,
    writer: Option<BranchWriter>,
    failure: Option<ReportError>,
    progress: Progress,
}

impl Sink<'_> {
    fn take(&mut self, point: &ModalPoint) -> ControlFlow<()> {
        match self.write(point) {
            Ok(()) => {
                self.progress.point(point);
                ControlFlow::Continue(())
            }
            Err(failure) => {
                self.failure = Some(failure);
                ControlFlow::Break(())
            }
        }
    }

    /// Writes the table anew, beginning with these points.
    fn begin_again<'p>(&mut self, points: impl Iterator<Item = &'p ModalPoint>) {
        self.writer = None;
        for point in points {
            if self.take(point).is_break() {
                return;
            }
        }
    }

    fn write(&mut self, point: &ModalPoint) -> Result<(), ReportError> {
        if self.writer.is_none() {
            std::fs::create_dir_all(self.directory)
                .map_err(|source| ReportError::Io { path: self.directory.to_path_buf(), source })?;
            figures::remove(self.directory);
            summary::remove(self.directory);
            self.writer = Some(BranchWriter::create(self.directory.join("branch.csv"))?);
        }
        self.writer.as_mut().map_or(Ok(()), |writer| writer.append(point))
    }
}

fn finish(file: &SceneFile, model: &StructuralModel, computed: &ComputedBranch, began: Instant, quiet: bool) -> Status {
    let directory = &file.scene.output_directory;
    let written = write_harmonics(directory.join("harmonics.npz"), &computed.branch)
        .map_err(Box::<dyn Error>::from)
        .and_then(|()| summary::write(directory, &file.scene, model, computed, began.elapsed()))
        .and_then(|()| figures::write(directory, &file.scene, computed));
    if let Err(error) = written {
        say!("error: {}", chain(error.as_ref()));
        return Status::EndedEarly;
    }
    let end = &computed.branch.end;
    let last = computed.branch.points.last();
    let at = last.map_or_else(String::new, |p| format!(" at {:.6} Hz", p.omega / std::f64::consts::TAU));
    let line = format!(
        "{} points in {:.2} s; ended{at}: {}",
        computed.branch.points.len(),
        began.elapsed().as_secs_f64(),
        end.message
    );
    if end.complete {
        if quiet { Status::Done } else { print(&format!("{line}\nResults in {}", directory.display())) }
    } else {
        say!("warning: the computation ended early. {line}\nWhat was found is in {}", directory.display());
        Status::EndedEarly
    }
}

/// An error of the study, at the key of the scene that it is about.
pub fn refuse_study(file: &SceneFile, error: &StudyError) -> Status {
    let path = match error {
        StudyError::Hbm(
            HbmError::NoSuchMode { .. } | HbmError::NeverTouches { .. } | HbmError::RigidBodyMode { .. },
        ) => "method.mode",
        StudyError::Hbm(HbmError::TouchesAtRest { contact, .. }) => {
            let key = format!("contact.{contact}.gap_m");
            say!("{}", file.error_at(&key, &chain(error), "here", &["a small positive gap starts at the first touch"]));
            return Status::Wrong;
        }
        StudyError::Hbm(HbmError::Harmonics { .. }) => "method.harmonics",
        StudyError::Hbm(HbmError::Samples { .. }) => "method.samples",
        StudyError::StartOutsideWindow { .. } => "continuation.frequency_hz",
        StudyError::NoStart { .. } => "continuation.start_frequency_hz",
        StudyError::Contact(_) => "method.contact_solver",
        StudyError::Hbm(HbmError::Linalg { .. } | HbmError::Model(_)) => "structure",
        _ => "method",
    };
    let status = refuse(file, path, error);
    // Where Newton's method fails the scene is not to blame.
    if matches!(error, StudyError::NoStart { .. } | StudyError::Continuation(_)) { Status::EndedEarly } else { status }
}

pub fn refuse(file: &SceneFile, path: &str, error: &(dyn Error + 'static)) -> Status {
    say!("{}", file.error_at(path, &chain(error), "", &[]));
    Status::Wrong
}

/// The message of an error and of all its causes.
pub fn chain(error: &(dyn Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        // Some messages name their cause themselves.
        let said = inner.to_string();
        if !text.ends_with(&said) {
            text = format!("{text}: {said}");
        }
        cause = inner.source();
    }
    text
}
