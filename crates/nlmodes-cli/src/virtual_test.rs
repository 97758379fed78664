//! `nlmodes-cli run` of a virtual test: a rig with its loop, level by level, and what its records give.

mod backbone;
mod bench;
mod results;
mod summary;

use std::f64::consts::TAU;
use std::fs;
use std::ops::ControlFlow;
use std::time::Instant;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::records::write_record;
use nlmodes::modal::ModalBranch;
use nlmodes::report::ReportError;
use nlmodes::rig::{RigError, VirtualTest};
use nlmodes::virtual_test::{self, DRIVE_DISPLACEMENT, FORCE, TestLevel, TestRun};

use crate::Status;
use crate::claim::{Claim, Over, unwritable};
use crate::command::print;
use crate::config::scene::{BackboneMethod, KeptRecords, TestScene};
use crate::config::{SceneFile, number};
use crate::experiment::table::Table;
use crate::interrupt;
use crate::options::RunOptions;
use crate::run::chain;
use bench::Rig;
pub use summary::summary;

/// Runs the test, extracts from the record of each level, and writes table, figures, summary and the records that are to be kept.
///
/// A level is in the table, and its record in its file, as soon as it is recorded. One that does not settle is recorded as it is, with what
/// is wrong with it among its findings, and the status says so.
pub fn run(file: &SceneFile<TestScene>, options: RunOptions) -> Status {
    let (scene, began, quiet) = (&file.scene, Instant::now(), options.quiet);
    let directory = &scene.output_directory;
    let claim = match claim(file, options) {
        Ok(claim) => claim,
        Err(status) => return status,
    };
    let rig = match Rig::new(scene) {
        Ok(rig) => rig,
        Err(error) => return refuse(file, error.path, &chain(error.source.as_ref())),
    };
    if options.resume && !quiet {
        say!("a virtual test begins anew: each level goes on from the motion at the end of the one before");
    }
    if let Err(failure) = claim.take() {
        return unwritable(&failure, directory, false);
    }
    results::prepare(directory);
    if !quiet {
        say!("{}", summary::model(scene, &rig));
    }
    let (levels, mut wrong) = match levels(scene, &rig, quiet) {
        Ok(TestRun { levels, failure: None }) => (levels, Vec::new()),
        Ok(TestRun { levels, failure: Some(error) }) if levels.is_empty() => return refuse_rig(file, &error),
        Ok(TestRun { levels, failure: Some(error) }) => {
            let (done, all) = (levels.len(), scene.schedule.levels.len());
            let reason = format!("the test ended after {done} of {all} levels: {}", chain(&error));
            (levels, vec![reason])
        }
        Err(error) => {
            say!("error: {error}");
            say!("what was recorded until then is in {}", directory.display());
            return Status::EndedEarly;
        }
    };
    let computed = if interrupt::requested() { Vec::new() } else { backbones(scene, &rig, &mut wrong) };
    let (n, settled) = (levels.len(), levels.iter().filter(|level| is_good(level)).count());
    if settled < n {
        wrong.push(format!("{} of {n} levels did not settle, or gave no modal point; the table says why", n - settled));
    }
    if interrupt::requested() {
        wrong.push(format!("the test was interrupted behind level {n} of {}", scene.schedule.levels.len()));
    }
    if let Err(error) = results::write(scene, &rig, &levels, &computed, &wrong, began.elapsed()) {
        say!("error: {}", chain(error.as_ref()));
        return Status::EndedEarly;
    }
    wrong.iter().for_each(|reason| say!("warning: {reason}"));
    if !quiet {
        print(&format!("Results in {}", scene.output_directory.display()));
    }
    if wrong.is_empty() { Status::Done } else { Status::EndedEarly }
}

/// Whether the test would begin; says why where it would not.
pub fn check(file: &SceneFile<TestScene>) -> Status {
    match Rig::new(&file.scene) {
        Ok(_) => Status::Done,
        Err(error) => refuse(file, error.path, &chain(error.source.as_ref())),
    }
}

/// The output directory; a test is known by its scene in words.
fn claim(file: &SceneFile<TestScene>, options: RunOptions) -> Result<Claim, Status> {
    let scene = TestScene { title: String::new(), output_directory: Default::default(), ..file.scene.clone() };
    let told = serde_json::json!([{ "structure": scene.structure, "scene": format!("{scene:?}") }]);
    // A test begins anew, whatever there was of it.
    let over = if options.resume { Over::Same } else { Over::of(options) };
    Claim::new(&file.scene.output_directory, &file.document, told, over)
}

/// The backbones that the scene asks for; what is wrong with them is added to the reasons for which the test is not complete.
fn backbones(scene: &TestScene, rig: &Rig, wrong: &mut Vec<String>) -> Vec<(BackboneMethod, ModalBranch)> {
    let Some(wanted) = &scene.backbone else { return Vec::new() };
    let mut computed = Vec::new();
    for &method in &wanted.methods {
        match backbone::compute(scene, rig, wanted, method) {
            Ok(branch) => {
                if !branch.end.complete {
                    wrong.push(format!("the backbone ({}) ended early: {}", branch.label, branch.end.message));
                }
                computed.push((method, branch));
            }
            Err(error) => {
                wrong.push(format!("the backbone by {} was not computed: {}", method.name(), chain(error.as_ref())));
            }
        }
    }
    computed
}

fn is_good(level: &TestLevel) -> bool {
    level.outcome.findings.is_empty() && level.extraction.is_ok()
}

/// The levels, or why a record could not be kept.
fn levels(scene: &TestScene, rig: &Rig, quiet: bool) -> Result<TestRun, String> {
    let test = VirtualTest {
        rig: rig.bench.setup(&rig.reduction),
        settings: rig.control.clone(),
        force: FORCE,
        response: DRIVE_DISPLACEMENT,
        schedule: scene.schedule.clone(),
    };
    let settings = ExtractionSettings {
        linear_modes: Some(rig.modes.clone()),
        stop: rig.bench.extraction_stop(),
        ..scene.settings.clone()
    };
    let mut table = results::table(scene, rig).map_err(|error| chain(error.as_ref()))?;
    let (mut count, mut failure) = (0, None);
    let run = virtual_test::run_while(&test, &settings, |level| {
        count += 1;
        if !quiet {
            say!("{}", line(scene, count, level));
        }
        failure = write(scene, count, level, &mut table).err();
        if failure.is_some() || interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    failure.map_or(Ok(run), Err)
}

/// Writes the table up to this level, and its record, if that is to be kept.
fn write(scene: &TestScene, count: usize, level: &TestLevel, table: &mut Table) -> Result<(), String> {
    keep(scene, count, level)?;
    table.push(&results::outcome(level)).map_err(|error| chain(error.as_ref()))?;
    table.write(&scene.output_directory.join("modal_points.csv")).map_err(|error| chain(&error))
}

/// What is said about a level as soon as it is recorded.
fn line(scene: &TestScene, count: usize, level: &TestLevel) -> String {
    let (outcome, steady) = (&level.outcome, &level.outcome.steady);
    let mut text = format!(
        "level {count} of {}: {} {}, {:.4} Hz, lag {:.3}°, held for {:.1} s",
        scene.schedule.levels.len(),
        number(outcome.level),
        scene.exciter.unit(),
        steady.omega / TAU,
        steady.lag.to_degrees(),
        outcome.settling.duration
    );
    match &level.extraction {
        Ok(found) => {
            if let Some(modal) = &found.modal {
                text += &format!(", amplitude {:.4e} m√kg", modal.amplitude.value);
                text += &modal.damping.map_or_else(String::new, |damping| format!(", damping {:.3e}", damping.value));
            }
            text += &found.findings.iter().map(|finding| format!("\n  {finding}")).collect::<String>();
        }
        Err(error) => text += &format!("\n  no modal point: {}", chain(error)),
    }
    text + &outcome.findings.iter().map(|finding| format!("\n  {finding}")).collect::<String>()
}

/// Writes the record of a level, if it is to be kept.
fn keep(scene: &TestScene, count: usize, level: &TestLevel) -> Result<(), String> {
    let Some(KeptRecords { format, levels }) = &scene.records else { return Ok(()) };
    if levels.as_ref().is_some_and(|levels| !levels.contains(&count)) {
        return Ok(());
    }
    let directory = scene.output_directory.join(results::RECORDS);
    let io = |source: std::io::Error| chain(&ReportError::Io { path: directory.clone(), source });
    fs::create_dir_all(&directory).map_err(io)?;
    let name = format!("{}.{}", level.outcome.record.name, format.name());
    // A record is there as a whole or not at all.
    let temporary = directory.join(format!(".nlmodes-tmp.{name}"));
    write_record(&temporary, &level.outcome.record).map_err(|error| chain(&error))?;
    fs::rename(temporary, directory.join(name)).map_err(io)
}

fn refuse(file: &SceneFile<TestScene>, path: &str, title: &str) -> Status {
    say!("{}", file.error_at(path, title, "", &[]));
    Status::Wrong
}

/// An error of the rig, at the key of the scene that it is about.
fn refuse_rig(file: &SceneFile<TestScene>, error: &RigError) -> Status {
    let path = match error {
        RigError::Loop(_) => "virtual_test.loop",
        RigError::RigidStopWithoutFlexibility { .. } => "virtual_test.stop",
        RigError::StepTooLarge { .. } | RigError::DriveTooFast { .. } => "virtual_test.sample_rate_hz",
        _ => "virtual_test",
    };
    let status = refuse(file, path, &chain(error));
    // A motion that cannot be followed is not the scene's mistake.
    if matches!(error, RigError::Chatter { .. } | RigError::Diverged { .. }) { Status::EndedEarly } else { status }
}
