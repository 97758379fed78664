//! A virtual test: a rig with its loop, level by level, and what its records give.

mod ahead;
mod backbone;
mod bench;
mod damped;
mod refused;
mod results;
mod summary;
mod words;

use std::fs;
use std::ops::ControlFlow;
use std::time::Instant;

use nlmodes::branches::Watch;
use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::phase_loop::TestSettings;
use nlmodes::experiment::records::write_record;
use nlmodes::modal::ModalBranch;
use nlmodes::report::ReportError;
use nlmodes::rig::{ControlChannels, RigError, VirtualTest};
use nlmodes::virtual_test::{self, DRIVE_DISPLACEMENT, FORCE, TestLevel, TestRun};

use crate::claim::Claim;
use crate::overlay;
use crate::records::table::Table;
use crate::{Event, Observer, Over, RunError, chain, links, refusal};
pub(crate) use ahead::{levels_ahead, warning};
pub(crate) use bench::Rig;
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::{BackboneMethod, KeptRecords, TestScene};
pub use words::in_words;

/// What a virtual test came to.
#[derive(Debug)]
pub struct TestOutcome {
    /// What was recorded and extracted, level by level.
    pub levels: Vec<TestLevel>,
    /// Why the test is not complete, if it is not.
    pub wrong: Vec<String>,
}

/// Runs the test, extracts from the record of each level, and writes table, figures, summary and the records that are
/// to be kept.
///
/// A level is in the table, and its record in its file, as soon as it is recorded. One that does not settle is recorded
/// as it is, with what is wrong with it among its findings, and the outcome says so. A test begins anew, whatever there
/// was of it.
///
/// # Errors
/// [`RunError`] if there is no level, or what was recorded cannot be written.
pub fn run(file: &SceneFile<TestScene>, over: Over, observer: &mut dyn Observer) -> Result<TestOutcome, RunError> {
    let (scene, began) = (&file.scene, Instant::now());
    let directory = &scene.output_directory;
    links::refuse(directory)?;
    let laid = overlay::laid_over(file, &scene.overlays, &overlay::OF_TESTS, observer)?;
    let claim = claim(file, over, observer)?;
    let (rig, test) = prepared(file)?;
    if over == Over::Resumed {
        observer.event(Event::TestBeginsAnew);
    }
    claim.take_at_once()?;
    results::prepare(directory);
    observer.event(Event::Rig(&summary::model(scene, &rig)));
    warn(scene, &test, observer);
    let not_recorded = |reason| RunError::NotRecorded { directory: directory.clone(), reason };
    let TestRun { levels, failure } = levels(scene, &rig, &test, observer).map_err(not_recorded)?;
    let mut wrong = Vec::new();
    match failure {
        Some(RigError::Interrupted) if levels.is_empty() => return Err(RunError::Ended),
        Some(error) if levels.is_empty() => return Err(refused::by_rig(file, &error)),
        // What was interrupted is reported below.
        None | Some(RigError::Interrupted) => {}
        Some(error) => {
            let (done, all) = (levels.len(), scene.schedule.count);
            wrong.push(format!("the test ended after {done} of {all} levels: {}", chain(&error)));
        }
    }
    let computed = if observer.is_cancelled() {
        Vec::new()
    } else {
        backbones(scene, &rig, &levels, &observer.watch(), &mut wrong)
    };
    let (n, settled) = (levels.len(), levels.iter().filter(|level| is_good(level)).count());
    if settled < n {
        wrong.push(format!("{} of {n} levels did not settle, or gave no modal point; the table says why", n - settled));
    }
    if observer.is_cancelled() {
        wrong.push(format!("the test was interrupted behind level {n} of {}", scene.schedule.count));
    }
    results::write(scene, &rig, &levels, (&computed, &laid), &wrong, began.elapsed()).map_err(RunError::Files)?;
    Ok(TestOutcome { levels, wrong })
}

/// Says which levels phase control will not hold. What cannot be foreseen, the test itself will say.
fn warn(scene: &TestScene, test: &VirtualTest, observer: &mut dyn Observer) {
    let levels = levels_ahead(test, &observer.watch()).unwrap_or_default();
    let texts = levels.iter().enumerate().filter_map(|(index, level)| warning(scene, index + 1, level));
    observer.warn(texts);
}

/// Whether the test would begin: refuses all that [`run`] refuses before its first sample, with the same words, but for
/// what is in its directory.
///
/// # Errors
/// [`RunError`] that says why it would not.
pub fn check(file: &SceneFile<TestScene>, observer: &mut dyn Observer) -> Result<(), RunError> {
    overlay::laid_over(file, &file.scene.overlays, &overlay::OF_TESTS, observer)?;
    prepared(file).map(drop)
}

/// The rig at rest and the test on it, or why it would not begin.
pub(crate) fn prepared(file: &SceneFile<TestScene>) -> Result<(Rig, VirtualTest), RunError> {
    let scene = &file.scene;
    let rig = Rig::new(scene).map_err(|error| refusal::at(file, error.path, error.source.as_ref()))?;
    let test = VirtualTest {
        rig: rig.bench.setup(&rig.reduction),
        control: TestSettings::new(rig.control.clone(), scene.schedule),
        channels: ControlChannels::new(FORCE, DRIVE_DISPLACEMENT),
        harmonics: rig.controlled_harmonics(scene.control.controlled_harmonics),
    };
    refused::short_record(file, &rig)?;
    test.check().map_err(|error| refused::by_rig(file, &error))?;
    Ok((rig, test))
}

/// The output directory; a test is known by its scene in words.
fn claim(file: &SceneFile<TestScene>, over: Over, observer: &mut dyn Observer) -> Result<Claim, RunError> {
    let scene = TestScene { title: String::new(), output_directory: Default::default(), ..file.scene.clone() };
    let told = serde_json::json!([{ "structure": scene.structure, "scene": format!("{scene:?}") }]);
    let over = if over == Over::Resumed { Over::Same } else { over };
    Claim::new(&file.scene.output_directory, &file.document, told, over, observer)
}

/// The backbones that the scene asks for; what is wrong with them is added to the reasons for which the test is not
/// complete.
fn backbones(
    scene: &TestScene,
    rig: &Rig,
    levels: &[TestLevel],
    watch: &Watch,
    wrong: &mut Vec<String>,
) -> Vec<(BackboneMethod, ModalBranch)> {
    let Some(wanted) = &scene.backbone else { return Vec::new() };
    let force = levels.iter().map(|level| level.outcome.steady.force).fold(0.0, f64::max);
    let mut computed = Vec::new();
    for &method in &wanted.methods {
        if watch.has_ended() {
            break;
        }
        let found = match method {
            BackboneMethod::Hbm | BackboneMethod::MsHbm => backbone::compute(scene, rig, wanted, method, watch),
            BackboneMethod::DampedMode | BackboneMethod::PhaseResonance => {
                damped::compute(scene, rig, wanted, method, force, watch)
            }
        };
        match found {
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
fn levels(scene: &TestScene, rig: &Rig, test: &VirtualTest, observer: &mut dyn Observer) -> Result<TestRun, String> {
    let settings = ExtractionSettings {
        linear_modes: Some(rig.modes.clone()),
        stop: rig.bench.extraction_stop(),
        ..scene.settings.clone()
    };
    let mut table = results::table(scene, rig);
    let (mut count, mut failure) = (0, None);
    let run = virtual_test::run_while(test, &settings, &observer.watch(), |level| {
        count += 1;
        observer.event(Event::Level { scene, number: count, level });
        failure = write(scene, count, level, &mut table).err();
        if failure.is_some() || observer.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    failure.map_or(Ok(run), Err)
}

/// Writes the table up to this level, and its record, if that is to be kept.
fn write(scene: &TestScene, count: usize, level: &TestLevel, table: &mut Table) -> Result<(), String> {
    keep(scene, count, level)?;
    table.push(&results::outcome(level));
    table.write(&scene.output_directory.join("modal_points.csv")).map_err(|error| chain(&error))
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
