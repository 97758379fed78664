//! Measured records into modal points.

mod decay;
pub(crate) mod figures;
mod harmonics;
mod modes;
pub(crate) mod page;
mod segments;
mod sources;
pub(crate) mod summary;
pub(crate) mod table;
mod words;

use std::error::Error;

use nlmodes::experiment::extraction::{ExtractionError, FreeDecay, RecordExtraction, extract as extract_record};
use nlmodes::experiment::records::{Record, RecordError, RecordTable};

use nlmodes_scene::{RecordScene, SceneError, SceneFile};

use crate::claim::Claim;
use crate::overlay::{self, Laid, Overlaid};
use crate::{Failure, Observer, Over, RunError, chain, links, refusal};
pub use segments::Segment;
use table::Table;
pub use words::{decay_in_words, in_words};

/// A record, and what came of it.
#[derive(Debug)]
pub struct RecordOutcome {
    /// Name of its file, or of its level.
    pub record: String,
    /// Which part of the record it is, where it is one of several.
    pub segment: Option<Segment>,
    /// Level of the drive, where it is known.
    pub level: Option<f64>,
    /// Names of what was found while the record was made, before the extraction.
    pub findings: Vec<&'static str>,
    /// The free decay at its end, where the scene says that there is one.
    pub decay: Option<FreeDecay>,
    /// What was extracted, or why there is no point.
    pub result: Result<RecordExtraction, ExtractionError>,
}

impl RecordOutcome {
    /// Name of the record, with that of its segment.
    pub fn name(&self) -> String {
        self.segment.as_ref().map_or_else(|| self.record.clone(), |segment| segment.of(&self.record))
    }

    /// Names of all findings, each once, separated by spaces.
    pub fn finding_names(&self) -> String {
        let extracted = self.result.as_ref().map_or_else(ExtractionError::names, RecordExtraction::finding_names);
        let mut names: Vec<&str> = Vec::new();
        for name in self.findings.iter().copied().chain(extracted.split_whitespace()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.join(" ")
    }
}

/// Reads all records, extracts from each, and writes table, figures and summary. A record that gives no point has a row
/// with the reason.
///
/// # Errors
/// [`RunError`]; a file that cannot be read ends it before anything is written.
pub fn extract(
    file: &SceneFile<RecordScene>,
    over: Over,
    observer: &mut dyn Observer,
) -> Result<Vec<RecordOutcome>, RunError> {
    // Before anything else: earlier results say nothing about files that are not there.
    files_are_there(file)?;
    links::refuse(&file.scene.output_directory)?;
    let laid = overlay::laid_over(file, &file.scene.overlays, &overlay::OF_TESTS, observer)?;
    let claim = claim(file, over, observer)?;
    let scene = with_modes(file)?;
    let outcomes = read_all(file, &scene)?;
    claim.take_at_once()?;
    write(&scene, &outcomes, &laid).map_err(RunError::Files)?;
    Ok(outcomes)
}

/// Extracts from records that are in memory, each with its name, instead of the files of the scene; writes nothing.
///
/// # Errors
/// [`RunError`] for a record that does not fit the channels of the scene, at the place of the latter.
pub fn extract_tables(
    file: &SceneFile<RecordScene>,
    tables: Vec<(String, RecordTable)>,
) -> Result<Vec<RecordOutcome>, RunError> {
    let scene = with_modes(file)?;
    let recording = &scene.recording;
    let mut outcomes = Vec::new();
    for (name, table) in tables {
        let number = scene.files.iter().position(|file| *file == name);
        let flags = segments::flags(&scene, number);
        let record = table.into_flagged_record(&name, &recording.channels, &flags, recording.sample_rate);
        let record = record.map_err(|error| {
            let title = format!("the record \"{name}\" cannot be used: {}", chain(&error));
            file.error_at("recording", &title, "", help(&error))
        })?;
        outcomes.extend(of_record(file, &scene, number, record)?);
    }
    Ok(outcomes)
}

/// The levels of a record, each with what was extracted; `number` is that of its file.
///
/// # Errors
/// [`SceneError`] for a segment that the record does not have, or that is too short.
fn of_record(
    file: &SceneFile<RecordScene>,
    scene: &RecordScene,
    number: Option<usize>,
    record: Record,
) -> Result<Vec<RecordOutcome>, SceneError> {
    let name = number.map_or_else(|| record.name.clone(), |number| scene.files[number].clone());
    let outcome = |segment, result| RecordOutcome {
        record: name.clone(),
        segment,
        level: None,
        findings: Vec::new(),
        decay: None,
        result,
    };
    if let Some(span) = scene.free_decay {
        return Ok(vec![decay::of_record(scene, &record, span, outcome)]);
    }
    let levels = segments::levels(file, scene, number, &record)?;
    if levels.is_empty() {
        return Ok(vec![outcome(None, extract_record(&record, &scene.settings))]);
    }
    let mut outcomes = Vec::new();
    for level in levels {
        let part = record.part(level.segment.of(&record.name), level.samples.clone());
        let result = extract_record(&part, &scene.settings);
        level.long_enough(file, &name, &result)?;
        outcomes.push(outcome(Some(level.segment), result));
    }
    Ok(outcomes)
}

/// The text of `modal_points.csv`, with the participation of so many modes.
///
/// # Errors
/// None but those of a writer to memory.
pub fn table_of(outcomes: &[RecordOutcome], modes: usize) -> Result<Vec<u8>, Failure> {
    table_with(outcomes, modes).into_bytes()
}

fn table_with(outcomes: &[RecordOutcome], modes: usize) -> Table {
    let mut table = Table::new(modes, None);
    if outcomes.iter().any(|outcome| outcome.segment.is_some()) {
        table = table.with_segments();
    }
    outcomes.iter().for_each(|outcome| table.push(outcome));
    table
}

/// The output directory; its records are known by their names.
fn claim(file: &SceneFile<RecordScene>, over: Over, observer: &mut dyn Observer) -> Result<Claim, RunError> {
    let mut scene = RecordScene { title: String::new(), output_directory: Default::default(), ..file.scene.clone() };
    // The same from wherever the program is started.
    if let Ok(base) = scene.base.canonicalize() {
        scene.base = base;
    }
    let told = serde_json::json!([{ "records": scene.files, "scene": format!("{scene:?}") }]);
    Claim::new(&file.scene.output_directory, &file.document, told, over, observer)
}

/// The scene with the linear modes of its structure, where it has one.
fn with_modes(file: &SceneFile<RecordScene>) -> Result<RecordScene, RunError> {
    let mut scene = file.scene.clone();
    let Some(structure) = &file.scene.structure else { return Ok(scene) };
    let modes = modes::at_sensors(structure, &scene.recording.channels, scene.settings.mode)
        .map_err(|error| refusal::at(file, "structure", error.as_ref()))?;
    scene.settings.linear_modes = Some(modes);
    Ok(scene)
}

/// Whether an extraction would begin: all files are there, and what is laid over can be read.
///
/// # Errors
/// [`RunError::Scene`] with each that is not, at its place in the scene.
pub(crate) fn check(file: &SceneFile<RecordScene>, observer: &mut dyn Observer) -> Result<(), RunError> {
    files_are_there(file)?;
    overlay::laid_over(file, &file.scene.overlays, &overlay::OF_TESTS, observer).map(drop)
}

/// Whether all files of the scene are there, of kinds that can be read.
///
/// # Errors
/// [`RunError::Scene`] with each that is not, at its place in the scene.
pub fn files_are_there(file: &SceneFile<RecordScene>) -> Result<(), RunError> {
    let lost = file.scene.files.iter().enumerate().filter_map(|(i, name)| {
        let error = sources::find(&file.scene, name).err()?;
        Some(unusable(file, i, name, error.as_ref()))
    });
    lost.reduce(SceneError::with).map_or(Ok(()), |error| Err(error.into()))
}

fn unusable(file: &SceneFile<RecordScene>, i: usize, name: &str, error: &(dyn Error + 'static)) -> SceneError {
    let title = format!("the record \"{name}\" cannot be used: {}", chain(error));
    file.error_at(&format!("recording.files.{i}"), &title, "this file", error.downcast_ref().map_or(&[], help))
}

/// Reads one record after the other and extracts from it, so that one at a time is in memory.
///
/// # Errors
/// [`RunError::Scene`] with each that cannot be read or has not the segments of the scene, at its place there.
fn read_all(file: &SceneFile<RecordScene>, scene: &RecordScene) -> Result<Vec<RecordOutcome>, RunError> {
    let (mut outcomes, mut refused) = (Vec::new(), Vec::new());
    for (i, name) in scene.files.iter().enumerate() {
        let record = sources::read(scene, name, &segments::flags(scene, Some(i)));
        let found = record.map_err(|error| unusable(file, i, name, error.as_ref()));
        match found.and_then(|record| of_record(file, scene, Some(i), record)) {
            Ok(found) => outcomes.extend(found),
            Err(error) => refused.push(error),
        }
    }
    refused.into_iter().reduce(SceneError::with).map_or(Ok(outcomes), |error| Err(error.into()))
}

fn help(error: &RecordError) -> &'static [&'static str] {
    match error {
        RecordError::Io { .. } => &["paths count from the directory of the scene"],
        RecordError::NoColumn { .. } => &["`recording.time_column` names the column of the time"],
        RecordError::RateDisagrees { .. } => {
            &["`recording.sample_rate_hz` must agree with the file; leave it out to take the file's"]
        }
        RecordError::NoFlag { .. } => {
            &["`segment.flag` is any of the names of a column; of files without names its number"]
        }
        RecordError::NoChannels { .. } | RecordError::Ambiguous { .. } => {
            &["`channel.name` is any of the names of a column, as they are written between the signs ="]
        }
        RecordError::UnitDisagrees { .. } => {
            &["`unit` and `sensitivity` of the channel must make of the numbers what the file says that they are"]
        }
        RecordError::NoRate => &["give `recording.sample_rate_hz`, or `recording.time_column` for .csv files"],
        _ => &[],
    }
}

fn write(scene: &RecordScene, outcomes: &[RecordOutcome], laid: &[Laid]) -> Result<(), Failure> {
    let directory = &scene.output_directory;
    let modes = scene.settings.linear_modes.as_ref().map_or(0, |modes| modes.n_modes());
    table_with(outcomes, modes).write(&directory.join("modal_points.csv"))?;
    harmonics::write(directory, outcomes)?;
    summary::write(directory, scene, outcomes)?;
    let mut drawn = figures::write(directory, &scene.title, outcomes, laid)?;
    drawn.extend(decay::write(directory, &scene.title, outcomes)?);
    let against = Overlaid::of_test(figures::of_records(outcomes).as_ref(), laid);
    against.write(directory, "overlay")?;
    let lines: Vec<String> =
        std::iter::once(format!("Records: {}", scene.files.join(", "))).chain(against.sentences()).collect();
    page::write(directory, &scene.title, &lines, outcomes, (laid, &against), drawn, &[])
}
