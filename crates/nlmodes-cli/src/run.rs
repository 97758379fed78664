//! `nlmodes-cli run`: the whole study that a scene describes.

mod figures;
mod histories;
mod journal;
mod page;
mod progress;
pub mod repeated;
mod several;
mod sink;
mod starts;
mod summary;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;
use std::time::Instant;

use nlmodes::hbm::HbmError;
use nlmodes::modal::ModalPoint;
use nlmodes::model::{MasslessContactModel, StructuralModel};
use nlmodes::report::write_harmonics;
use nlmodes::study::{
    Accuracy, BranchMethod, BranchPointRule, BranchSettings, BranchStart, ComputedBranch, ComputedTree, ResonanceRule,
    StabilityRule, StudyError, check_study, compute_tree_with_log,
};
use nlmodes::timestep::TimestepError;

use crate::Status;
use crate::claim::{Claim, unwritable};
use crate::command::print;
use crate::config::SceneFile;
use crate::config::scene::{
    AtBranchPoint, Direction, FrequencyDirection, InternalResonance, MethodKind, Scene, StabilityChoice, Start,
    StructureKind, Switching, Symmetry,
};
use crate::interrupt;
use crate::modes::modal_model;
use crate::options::RunOptions;
use journal::Journal;
use nlmodes_scene::assemble::{contact_model, structural_model};
use progress::Progress;
use sink::{Sink, branch_directory};
pub use starts::STARTS;

/// Computes the branches of a scene and writes their files.
///
/// Each point is in `branch.csv`, and the step to it in `steps.jsonl`, as soon as it is found. Nothing is written before the first one.
/// Several methods or numbers of harmonics have a folder each, and common figures beside these.
///
/// `files` are scenes that differ in their method only.
pub fn run(files: &[SceneFile], claim: &Claim, options: RunOptions) -> Status {
    let outcome = match several::parts(files).as_slice() {
        [only] => one_branch(&only.file, claim, options).map(|(_, status)| status),
        parts => several::study(files, parts, claim, options),
    };
    outcome.unwrap_or_else(|status| status)
}

/// One branch with all its files, and how it ended.
fn one_branch(file: &SceneFile, claim: &Claim, options: RunOptions) -> Result<(ComputedTree, Status), Status> {
    let scene = &file.scene;
    let directory = &scene.output_directory;
    let began = Instant::now();
    let (model, massless) = models(file)?;
    if let Some(text) = modal_model(&scene.structure).filter(|_| !options.quiet) {
        _ = print(&text);
    }
    let mut journal = Journal::open(scene, claim).map_err(|failure| unwritable(&failure, directory, true))?;
    if claim.resumes() && journal.known_steps() == 0 && !options.quiet {
        say!("{} holds no interrupted run: computed from the beginning", directory.display());
    }
    let progress = Progress::new(options, scene);
    let mut sink = Sink::new(directory, claim, journal.computing.clone(), progress);
    let tree = compute(scene, massless, &mut journal, &mut sink);
    sink.finish();
    if let Some(failure) = sink.failure.take().or(journal.failure) {
        return Err(unwritable(&failure, directory, !sink.is_empty()));
    }
    let tree = tree.map_err(|error| refuse_study(file, &error))?;
    let status = finish(file, &model, &tree, began, options.quiet);
    Ok((tree, status))
}

/// Whether a run of the scene would begin, with each of its numbers of harmonics; says why where it would not.
pub fn check(file: &SceneFile) -> Status {
    let checked = models(file).and_then(|(_, massless)| {
        let list = &file.scene.method.harmonics_list;
        // They differ in size only.
        let harmonics = list.iter().copied().max().unwrap_or(file.scene.method.harmonics);
        let (start, _) = starts(file.scene.continuation.start);
        let settings = BranchSettings { start, harmonics, ..branch_settings(&file.scene) };
        check_study(&massless, &settings).map_err(|error| refuse_study(file, &error))
    });
    checked.err().unwrap_or(Status::Done)
}

/// Removes what a run writes at its end, which would not belong to the points of another one.
pub fn remove(directory: &Path) {
    figures::remove(directory);
    summary::remove(directory);
}

/// The structure of the scene, and the model of it that the method works on.
pub fn models(file: &SceneFile) -> Result<(StructuralModel, MasslessContactModel), Status> {
    let model = structural_model(&file.scene).map_err(|error| refuse(file, error.path(), &error))?;
    let massless =
        contact_model(&file.scene, &model).map_err(|error| refuse(file, "method.mass_redistribution", &error))?;
    Ok((model, massless))
}

/// The branches from their start; where both ways are asked for, the way down first and then, behind its points in reverse order,
/// the way up.
fn compute(
    scene: &Scene,
    model: MasslessContactModel,
    journal: &mut Journal,
    sink: &mut Sink,
) -> Result<ComputedTree, StudyError> {
    let (start, other) = starts(scene.continuation.start);
    let settings = BranchSettings { start, ..branch_settings(scene) };
    let mut tree = compute_tree_with_log(model.clone(), &settings, journal, |progress| sink.take(progress))?;
    let ended = sink.failure.is_some() || journal.failure.is_some() || interrupt::requested();
    let (Some(start), false) = (other, ended) else { return Ok(tree) };
    let first = tree.branches.swap_remove(0);
    sink.begin_again(first.branch.points.iter().skip(1).rev());
    let settings = BranchSettings { start, ..settings };
    let mut tree = compute_tree_with_log(model, &settings, journal, |progress| sink.take(progress))?;
    let second = tree.branches.swap_remove(0);
    tree.branches.push(second.preceded_by(first));
    Ok(tree)
}

/// Where the branch of a scene starts, and the start of its other half where it goes both ways.
pub fn starts(start: Start) -> (BranchStart, Option<BranchStart>) {
    let both = |direction, begin: &dyn Fn(bool) -> BranchStart| match direction {
        FrequencyDirection::Up => (begin(true), None),
        FrequencyDirection::Down => (begin(false), None),
        FrequencyDirection::Both => (begin(false), Some(begin(true))),
    };
    match start {
        Start::Grazing => (BranchStart::Grazing, None),
        Start::Frequency { hz, direction } => both(direction, &|upward| BranchStart::Frequency { hz, upward }),
        Start::Energy { ratio, direction } => both(direction, &|upward| BranchStart::Energy { ratio, upward }),
    }
}

pub fn branch_settings(scene: &Scene) -> BranchSettings {
    let method = &scene.method;
    BranchSettings {
        method: match method.kind {
            MethodKind::MsHbm | MethodKind::Hbm => BranchMethod::HarmonicBalance,
            MethodKind::Shooting => BranchMethod::Shooting,
        },
        stability: match scene.stability {
            StabilityChoice::Auto => StabilityRule::Auto,
            StabilityChoice::Always => StabilityRule::Always,
            StabilityChoice::Never => StabilityRule::Never,
        },
        mode: method.mode,
        harmonics: method.harmonics,
        accuracy: method.accuracy.map(|a| Accuracy { error: a.error, max_harmonics: a.max_harmonics }),
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
        at_branch_point: match scene.continuation.at_branch_point {
            AtBranchPoint::Stay => BranchPointRule::Stay,
            AtBranchPoint::Switch => BranchPointRule::Switch,
            AtBranchPoint::All => BranchPointRule::All,
        },
        max_branches: scene.continuation.max_branches,
        internal_resonance: match scene.continuation.internal_resonance {
            InternalResonance::Follow => ResonanceRule::Follow,
            InternalResonance::Skip => ResonanceRule::Skip,
        },
        ..BranchSettings::default()
    }
}

fn finish(file: &SceneFile, model: &StructuralModel, tree: &ComputedTree, began: Instant, quiet: bool) -> Status {
    let directory = &file.scene.output_directory;
    let harmonics = |(number, computed): (usize, &ComputedBranch)| {
        write_harmonics(branch_directory(directory, number).join("harmonics.npz"), &computed.branch)
    };
    let written = (tree.branches.iter().enumerate().try_for_each(harmonics).map_err(Box::<dyn Error>::from))
        .and_then(|()| starts::write(directory, &tree.branches))
        .and_then(|()| summary::write(directory, &file.scene, model, tree, began.elapsed()))
        .and_then(|()| figures::write(directory, &file.scene, &tree.branches))
        .and_then(|()| page::write(directory, &[&file.scene], &tree.branches.iter().collect::<Vec<_>>(), &[]));
    if let Err(error) = written {
        say!("error: {}", chain(error.as_ref()));
        return Status::EndedEarly;
    }
    let statuses = tree.branches.iter().enumerate().map(|(number, computed)| {
        let name = if tree.branches.len() > 1 { format!("branch {number}: ") } else { String::new() };
        tell(computed, &name, began, quiet)
    });
    if statuses.collect::<Vec<_>>().contains(&Status::EndedEarly) {
        say!("What was found is in {}", directory.display());
        if interrupt::requested() {
            say!("The same call with `--resume` goes on from there");
        }
        return Status::EndedEarly;
    }
    if tree.not_followed > 0 {
        let limit = file.scene.continuation.max_branches;
        say!(
            "warning: {} arms of branch points were not followed, since there are {limit} branches",
            tree.not_followed
        );
    }
    if quiet { Status::Done } else { print(&format!("Results in {}", directory.display())) }
}

/// Says how a branch ended.
fn tell(computed: &ComputedBranch, name: &str, began: Instant, quiet: bool) -> Status {
    let points = &computed.branch.points;
    let at = points.last().map_or_else(String::new, |p| format!(" at {:.6} Hz", p.omega / TAU));
    let end = &computed.branch.end;
    warn_of_accuracy(computed, name);
    let time = began.elapsed().as_secs_f64();
    let advice = advice(computed).unwrap_or_default();
    let line = format!("{name}{} points in {time:.2} s; ended{at}: {}{advice}", points.len(), end.message);
    if end.complete {
        if quiet { Status::Done } else { print(&line) }
    } else {
        say!("warning: the computation ended early. {line}");
        Status::EndedEarly
    }
}

/// What to do where a branch did not end where it was meant to.
fn advice(computed: &ComputedBranch) -> Option<String> {
    let end = &computed.branch.end;
    let wandered = wandered(computed).unwrap_or_default();
    if end.reason == "max-points" {
        return Some(format!("; with a higher continuation.max_points, --resume goes on{wandered}"));
    }
    if !wandered.is_empty() {
        return Some(wandered);
    }
    if computed.branch.points.iter().any(|point| point.has_event(ModalPoint::RESUMED)) {
        return None;
    }
    let resonance = computed.branch.points.last()?.resonance.as_ref()?;
    Some(format!(", on the tongue {resonance} (continuation.internal_resonance = \"skip\" leaves it out)"))
}

/// Folds by which an exact branch shows that it follows tongues of internal resonances; a loop has four.
const FOLDS: usize = 6;

/// What an exact branch met that has every internal resonance of its modes.
fn wandered(computed: &ComputedBranch) -> Option<String> {
    let points = &computed.branch.points;
    let folds = points.iter().filter(|p| p.has_event("fold") || p.has_event("frequency-fold")).count();
    let modes = computed.structure.modes().len();
    (computed.is_exact() && folds >= FOLDS).then(|| {
        format!(
            "; it turned {folds} times, on tongues of internal resonances with its {modes} modes (fewer method.held_modes have fewer)"
        )
    })
}

/// Most stretches that are named.
const NAMED: usize = 4;

/// Says where the accuracy was not reached: the points are there, and each has its estimate.
fn warn_of_accuracy(computed: &ComputedBranch, name: &str) {
    let Some(reached) = computed.accuracy.filter(|reached| reached.points_beyond > 0) else { return };
    let (beyond, all, [_, most]) = (reached.points_beyond, computed.branch.points.len(), reached.harmonics);
    say!(
        "warning: {name}{beyond} of {all} points do not reach the accuracy with up to {most} harmonics; the largest estimated error is {:.1e} (column error_estimate)",
        reached.largest_estimate
    );
    let stretches = computed.beyond_accuracy();
    for stretch in stretches.iter().take(NAMED) {
        let ([from, to], [first, last]) = (stretch.frequency.map(|omega| omega / TAU), stretch.points);
        let place = if first == last {
            format!("at {from:.6} Hz (point {first})")
        } else {
            format!("between {from:.6} and {to:.6} Hz (points {first} to {last})")
        };
        say!("  not reached {place}: estimate up to {:.1e}", stretch.largest_estimate);
    }
    if stretches.len() > NAMED {
        say!("  and on {} more stretches (accuracy.not_reached in summary.json)", stretches.len() - NAMED);
    }
}

/// An error of the study, at the key of the scene that it is about.
pub fn refuse_study(file: &SceneFile, error: &StudyError) -> Status {
    let path = match error {
        StudyError::Hbm(HbmError::NeverTouches { mode, frequency_hz, .. }) if stops_beside_bending(&file.scene) => {
            let title = format!("mode {mode} ({frequency_hz:.4} Hz) never touches: all stops stand along the beam");
            let label = format!("mode {mode} moves across the beam: expected \"transverse\"");
            let help =
                "an axial stop is met by axial modes only: `nlmodes-cli modes` lists all, `method.mode` takes one";
            say!("{}", file.error_at("contact.0.direction", &title, &label, &[help]));
            return Status::Wrong;
        }
        StudyError::Hbm(
            HbmError::NoSuchMode { .. } | HbmError::NeverTouches { .. } | HbmError::RigidBodyMode { .. },
        ) => "method.mode",
        StudyError::Hbm(HbmError::TouchesAtRest { contact, .. }) => {
            let key = format!("contact.{contact}.gap_m");
            say!("{}", file.error_at(&key, &chain(error), "here", &["a small positive gap starts at the first touch"]));
            return Status::Wrong;
        }
        StudyError::Timestep(TimestepError::TooManyModes { most, .. }) => {
            let (key, help) =
                ("method.held_modes", "the modes left out answer statically; or take fewer `structure.elements`");
            let label = format!("expected `held_modes` in this table: a whole number from 1 to {most}");
            say!("{}", file.error_at(key, &chain(error), &label, &[help]));
            return Status::Wrong;
        }
        StudyError::StartOutsideWindow { .. } => {
            let help =
                "`nlmodes-cli modes` lists the linear frequencies; `continuation.start_frequency_hz` starts elsewhere";
            let label = "expected a window that holds the start";
            say!("{}", file.error_at("continuation.frequency_hz", &chain(error), label, &[help]));
            return Status::Wrong;
        }
        StudyError::NotEven => "method.symmetry",
        StudyError::Hbm(HbmError::Harmonics { .. }) => "method.harmonics",
        StudyError::Hbm(HbmError::Samples { .. }) => "method.samples",
        StudyError::NoStartTouching { .. } => "contact.0.gap_m",
        StudyError::NoStart { .. } => "continuation.start_frequency_hz",
        StudyError::NoStartAtEnergy { .. } => "continuation.start_energy_ratio",
        StudyError::Contact(_) => "method.contact_solver",
        StudyError::Hbm(HbmError::Linalg { .. } | HbmError::Model(_)) => "structure",
        _ => "method",
    };
    let status = refuse(file, path, error);
    // Where Newton's method fails the scene is not to blame.
    let unlucky = matches!(
        error,
        StudyError::NoStart { .. }
            | StudyError::NoStartAtEnergy { .. }
            | StudyError::NoStartTouching { .. }
            | StudyError::Continuation(_)
    );
    if unlucky { Status::EndedEarly } else { status }
}

/// Whether all stops of a beam stand along its axis.
fn stops_beside_bending(scene: &Scene) -> bool {
    scene.structure.kind() == StructureKind::Beam && scene.contacts.iter().all(|c| c.direction == Direction::Axial)
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
