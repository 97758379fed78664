//! `nlmodes-cli experiment extract`: measured records into modal points.

pub mod figures;
mod modes;
pub mod page;
pub mod summary;
pub mod table;

use std::error::Error;
use std::f64::consts::TAU;

use nlmodes::experiment::extraction::{ExtractionError, Measured, RecordExtraction, extract as extract_record};
use nlmodes::experiment::records::{Record, RecordError};

use crate::Status;
use crate::claim::{Claim, Over, unwritable};
use crate::command::print;
use crate::config::SceneFile;
use crate::config::{RecordScene, number};
use crate::options::RunOptions;
use crate::run::chain;
use table::Table;

/// A record, and what came of it.
#[derive(Debug)]
pub struct Outcome {
    pub record: String,
    /// Level of the drive, where it is known.
    pub level: Option<f64>,
    /// Names of what was found while the record was made, before the extraction.
    pub findings: Vec<&'static str>,
    pub result: Result<RecordExtraction, ExtractionError>,
}

impl Outcome {
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

/// Reads all records, extracts from each, and writes table, figures and summary.
///
/// A file that cannot be read ends it before anything is written. A record that gives no point has a row with the reason.
pub fn extract(file: &SceneFile<RecordScene>, options: RunOptions) -> Status {
    let claim = match claim(file, options) {
        Ok(claim) => claim,
        Err(status) => return status,
    };
    let Some(file) = with_modes(file) else { return Status::Wrong };
    let Some(records) = read(&file) else { return Status::Wrong };
    let outcomes: Vec<Outcome> = records
        .into_iter()
        .map(|(name, record)| Outcome {
            record: name,
            level: None,
            findings: Vec::new(),
            result: extract_record(&record, &file.scene.settings),
        })
        .collect();
    if let Err(failure) = claim.take() {
        return unwritable(&failure, &file.scene.output_directory, false);
    }
    if let Err(error) = write(&file.scene, &outcomes) {
        say!("error: {}", chain(error.as_ref()));
        return Status::EndedEarly;
    }
    for outcome in &outcomes {
        if let Err(error) = &outcome.result {
            say!("warning: {}: no modal point: {}", outcome.record, chain(error));
        }
    }
    if !options.quiet {
        let mut lines: Vec<String> =
            outcomes.iter().filter_map(|outcome| Some(described(outcome.result.as_ref().ok()?))).collect();
        lines.push(format!("Results in {}", file.scene.output_directory.display()));
        print(&lines.join("\n"));
    }
    if outcomes.iter().all(|outcome| outcome.result.is_ok()) { Status::Done } else { Status::EndedEarly }
}

/// The output directory; its records are known by their names.
fn claim(file: &SceneFile<RecordScene>, options: RunOptions) -> Result<Claim, Status> {
    let mut scene = RecordScene { title: String::new(), output_directory: Default::default(), ..file.scene.clone() };
    // The same from wherever the program is started.
    if let Ok(base) = scene.base.canonicalize() {
        scene.base = base;
    }
    let told = serde_json::json!([{ "records": scene.files, "scene": format!("{scene:?}") }]);
    Claim::new(&file.scene.output_directory, &file.document, told, Over::of(options))
}

/// The scene with the linear modes of its structure, where it has one; `None` where they cannot be had, which is said.
fn with_modes(file: &SceneFile<RecordScene>) -> Option<SceneFile<RecordScene>> {
    let mut file = file.clone();
    let Some(structure) = &file.scene.structure else { return Some(file) };
    match modes::at_sensors(structure, &file.scene.recording.channels, file.scene.settings.mode) {
        Ok(modes) => file.scene.settings.linear_modes = Some(modes),
        Err(error) => {
            say!("{}", file.error_at("structure", &chain(error.as_ref()), "", &[]));
            return None;
        }
    }
    Some(file)
}

/// All records with the names of their files; `None` where one cannot be read, which is said at its place in the scene.
fn read(file: &SceneFile<RecordScene>) -> Option<Vec<(String, Record)>> {
    let scene = &file.scene;
    let mut records = Vec::new();
    for (i, name) in scene.files.iter().enumerate() {
        match scene.recording.read(&scene.base.join(name)) {
            Ok(record) => records.push((name.clone(), record)),
            Err(error) => {
                let title = format!("the record \"{name}\" cannot be used: {}", chain(&error));
                say!("{}", file.error_at(&format!("recording.files.{i}"), &title, "this file", help(&error)));
            }
        }
    }
    (records.len() == scene.files.len()).then_some(records)
}

fn help(error: &RecordError) -> &'static [&'static str] {
    match error {
        RecordError::Io { .. } => &["paths count from the directory of the scene"],
        RecordError::NoColumn { .. } => &["`recording.time_column` names the column of the time"],
        RecordError::RateDisagrees { .. } => {
            &["`recording.sample_rate_hz` must agree with the file; leave it out to take the file's"]
        }
        RecordError::NoRate => &["give `recording.sample_rate_hz`, or `recording.time_column` for .csv files"],
        _ => &[],
    }
}

fn write(scene: &RecordScene, outcomes: &[Outcome]) -> Result<(), Box<dyn Error>> {
    let directory = &scene.output_directory;
    let modes = scene.settings.linear_modes.as_ref().map_or(0, |modes| modes.n_modes());
    let mut table = Table::new(modes, None)?;
    outcomes.iter().try_for_each(|outcome| table.push(outcome))?;
    table.write(&directory.join("modal_points.csv"))?;
    summary::write(directory, scene, outcomes)?;
    let drawn = figures::write(directory, &scene.title, outcomes, &[])?;
    let line = format!("Records: {}", scene.files.join(", "));
    page::write(directory, &scene.title, &[line], outcomes, &[], &drawn, &[])
}

/// What `check` says about a scene of records.
pub fn summary(scene: &RecordScene) -> String {
    let settings = &scene.settings;
    let row = |name: &str, text: String| format!("  {name:<12}{text}");
    let channels: Vec<&str> = scene.recording.channels.iter().map(|channel| channel.name.as_str()).collect();
    let without = match scene.structure {
        Some(_) => "of the structure, at the sensors",
        None => "none: no modal amplitude, damping and participation",
    };
    let modes = settings.linear_modes.as_ref().map_or_else(
        || without.into(),
        |modes| {
            format!("{} at {} positions, mode {} is excited", modes.n_modes(), modes.n_coordinates(), settings.mode)
        },
    );
    let rate = scene.recording.sample_rate.map_or_else(|| "of the files".into(), |rate| format!("{} Hz", number(rate)));
    let pbmif = settings.pbmif_harmonics.map_or_else(|| "all below half the sampling rate".into(), |n| n.to_string());
    let periods = settings.periods.map_or_else(|| "all".into(), |n| n.to_string());
    let harmonics = format!("{} of the shape; mode indicator: {pbmif}; periods: {periods}", settings.harmonics);
    let stop = settings.stop.map_or_else(
        || "none: no restitution and no contact stiffness".into(),
        |stop| format!("{} m, gap {} m", number(stop.position), number(stop.gap)),
    );
    [
        scene.title.clone(),
        String::new(),
        row("records", scene.files.join(", ")),
        row("sampling", rate),
        row("channels", channels.join(", ")),
        row("modes", modes),
        row("harmonics", harmonics),
        row("stop", stop),
        row("results", scene.output_directory.display().to_string()),
        String::new(),
        "The scene is sound; nothing was read or computed.".into(),
    ]
    .join("\n")
}

/// A record in a few lines.
fn described(found: &RecordExtraction) -> String {
    let mut lines = vec![format!("{}: {} periods", found.record, found.periods)];
    let mut row = |name: &str, text: String| lines.push(format!("  {name:<20}{text}"));
    row("frequency", with_error(found.omega.times(1.0 / TAU), "Hz"));
    if let Some(modal) = &found.modal {
        row("modal amplitude", with_error(modal.amplitude, "m √kg"));
        if let Some(damping) = modal.damping {
            row("damping", with_error(damping, ""));
        }
    }
    if let Some(excitation) = &found.excitation {
        row("lag", with_error(excitation.lag.times(1f64.to_degrees()), "°"));
        let harmonics = excitation.power.harmonics;
        row("mode indicator", format!("{} from {harmonics} harmonics", with_error(excitation.pbmif, "")));
    }
    if let Some(stiffness) = found.contact.as_ref().and_then(|contact| contact.stiffness) {
        let measured = Measured { value: stiffness.stiffness, uncertainty: stiffness.stiffness_error };
        row("contact stiffness", with_error(measured, "N/m"));
    }
    if let Some(restitution) = found.contact.as_ref().and_then(|contact| contact.restitution.as_ref()) {
        let s = restitution.statistics();
        let text = format!(
            "{:.3}, spread {:.3}, at {} m/s ({} impacts)",
            s.mean,
            s.std,
            significant(s.approach, 3),
            s.n_impacts
        );
        row("restitution", text);
    }
    lines.extend(found.findings.iter().map(|finding| format!("  finding {}: {finding}", finding.name())));
    lines.join("\n")
}

/// The figure to the second digit of its error.
fn with_error(measured: Measured, unit: &str) -> String {
    let Measured { value, uncertainty } = measured;
    let digits = if uncertainty > 0.0 && uncertainty.is_finite() && value != 0.0 {
        ((value.abs().log10().floor() - uncertainty.log10().floor()) as i32 + 2).clamp(2, 12)
    } else {
        6
    };
    let text = format!("{} ± {} {unit}", significant(value, digits as usize), significant(uncertainty, 2));
    text.trim_end().to_owned()
}

fn significant(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x);
    number(rounded)
}
