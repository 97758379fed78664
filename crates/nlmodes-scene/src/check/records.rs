//! Scenes of measured records: what must hold between their values.

mod segments;

use std::f64::consts::TAU;
use std::path::PathBuf;

use nlmodes::experiment::extraction::{ExtractionSettings, ModeErrors, Stop};
use nlmodes::experiment::records::{Channel, Quantity, Recording, Role};
use nlmodes::modal::LinearModes;

use crate::nearest::nearest;
use crate::raw::{RawChannel, RawExtraction, RawLinearModes, RawPbmifHarmonics, RawRecordScene, RawStop};
use crate::rule::either;
use crate::scene::{ChannelRole, MeasuredQuantity, RecordScene, Side};
use crate::{Diagnostic, Diagnostics};

const HARMONICS: u32 = 20;

/// The checked scene, or `None` if an error among the diagnostics prevents it. `stem` is the name of the file,
/// `base` its directory.
pub fn scene(
    raw: &RawRecordScene,
    stem: &str,
    base: PathBuf,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<RecordScene> {
    let channels = channels(&raw.channel, diagnostics);
    let modes = raw.linear_modes.as_ref().and_then(|modes| linear_modes(modes, diagnostics));
    let settings = settings(raw, modes, diagnostics);
    let structure = raw.structure.as_ref().and_then(|structure| super::one_structure(structure, &[], diagnostics));
    if let Some(structure) = &structure {
        super::plausible::structure(structure, diagnostics);
    }
    one_source_of_modes(raw, diagnostics);
    let recording = &raw.recording;
    let segments = segments::check(raw, diagnostics);
    segments::free_decay(raw, diagnostics);
    rate(&recording.files, recording.sample_rate_hz, recording.time_column.as_deref(), diagnostics);
    Some(RecordScene {
        title: raw.title.clone().unwrap_or_else(|| stem.to_owned()),
        files: recording.files.clone(),
        overlays: super::overlays(raw.overlay.as_deref(), &base),
        base,
        recording: Recording {
            channels: channels?,
            sample_rate: recording.sample_rate_hz,
            time_column: recording.time_column.clone(),
        },
        free_decay: raw.free_decay.as_ref().map(|decay| [decay.from_s, decay.to_s]),
        segments,
        structure,
        settings: settings?,
        output_directory: super::output_directory(
            raw.output.as_ref().and_then(|output| output.directory.as_ref()),
            stem,
        ),
        warnings: Vec::new(),
    })
}

/// Linear modes are given or computed, not both.
fn one_source_of_modes(raw: &RawRecordScene, diagnostics: &mut Diagnostics<'_>) {
    if raw.structure.is_some() && raw.linear_modes.is_some() {
        let diagnostic = Diagnostic::error("the linear modes are given twice");
        let help = "leave out [structure] to use the given modes, or [linear_modes] to have them computed";
        diagnostics.put("structure", diagnostic.help(help), "there are `linear_modes` too");
    }
}

/// Files that tell no sampling rate need one in the scene.
fn rate(files: &[String], rate: Option<f64>, time_column: Option<&str>, diagnostics: &mut Diagnostics<'_>) {
    let needs = |file: &String| {
        let file = file.to_lowercase();
        let with_time = [".csv", ".mat", ".h5", ".hdf5"];
        let holds = |ending: &str| file.ends_with(ending) || file.contains(&format!("{ending}#"));
        file.ends_with(".npy") || (with_time.into_iter().any(holds) && time_column.is_none())
    };
    if let Some(file) = files.iter().find(|file| rate.is_none() && needs(file)) {
        let diagnostic = Diagnostic::error(format!("no sampling rate is known for \"{file}\""));
        let help = "give `sample_rate_hz`, or for .csv, .mat and .h5 files the name of their `time_column`";
        diagnostics.put("recording", diagnostic.help(help), "expected `sample_rate_hz` in this table");
    }
}

fn channels(raw: &[RawChannel], diagnostics: &mut Diagnostics<'_>) -> Option<Vec<Channel>> {
    let mut channels: Vec<Channel> = Vec::new();
    let mut sound = true;
    for (i, raw) in raw.iter().enumerate() {
        match channel(raw, &format!("channel.{i}"), diagnostics) {
            Some(channel) if channels.iter().any(|other| other.name == channel.name) => {
                let diagnostic = Diagnostic::error(format!("two channels have the name \"{}\"", channel.name));
                diagnostics.put(&format!("channel.{i}.name"), diagnostic, "the second one");
                sound = false;
            }
            Some(channel) => channels.push(channel),
            None => sound = false,
        }
    }
    sound.then_some(channels)
}

fn channel(raw: &RawChannel, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<Channel> {
    let (quantity, role) = (quantity(raw.quantity), role(raw.role));
    if !role.fits(quantity) {
        let fitting: Vec<&str> = Quantity::ALL.into_iter().filter(|q| role.fits(*q)).map(Quantity::name).collect();
        let diagnostic =
            Diagnostic::error(format!("a channel with the role \"{}\" cannot measure {quantity}", role.name()));
        diagnostics.put(&format!("{path}.quantity"), diagnostic, format!("expected {}", either(&fitting)));
        return None;
    }
    let unit = raw.unit.clone().unwrap_or_else(|| quantity.si_unit().to_owned());
    if quantity.factor(&unit).is_none() {
        unknown_unit(&unit, quantity, path, diagnostics);
        return None;
    }
    if raw.sign == Some(0) {
        let diagnostic = Diagnostic::error(format!("`{path}.sign` cannot be 0"));
        diagnostics.put(&format!("{path}.sign"), diagnostic, "found 0, expected 1 or -1");
        return None;
    }
    if let Some([low, high]) = raw.range.filter(|[low, high]| low >= high) {
        let diagnostic = Diagnostic::error(format!("`{path}.range` is empty"));
        diagnostics.put(&format!("{path}.range"), diagnostic, format!("{low} is not less than {high}"));
        return None;
    }
    Some(Channel {
        unit,
        sign: f64::from(raw.sign.unwrap_or(1)),
        sensitivity: raw.sensitivity.unwrap_or(1.0),
        delay: raw.delay_s.unwrap_or(0.0),
        uncertainty: raw.uncertainty,
        range: raw.range,
        ..Channel::new(raw.name.clone(), quantity, role, raw.position_m)
    })
}

fn unknown_unit(unit: &str, quantity: Quantity, path: &str, diagnostics: &mut Diagnostics<'_>) {
    let known: Vec<&str> = quantity.units().iter().map(|(name, _)| *name).collect();
    let diagnostic = Diagnostic::error(format!("\"{unit}\" is not a unit of {quantity}"));
    let diagnostic = match nearest(unit, known.iter().copied()) {
        Some(meant) => diagnostic.help(format!("did you mean \"{meant}\"?")),
        None => diagnostic,
    };
    diagnostics.put(&format!("{path}.unit"), diagnostic, format!("expected {}", either(&known)));
}

fn quantity(quantity: MeasuredQuantity) -> Quantity {
    match quantity {
        MeasuredQuantity::Force => Quantity::Force,
        MeasuredQuantity::Displacement => Quantity::Displacement,
        MeasuredQuantity::Velocity => Quantity::Velocity,
        MeasuredQuantity::Acceleration => Quantity::Acceleration,
        MeasuredQuantity::Phase => Quantity::Phase,
    }
}

fn role(role: ChannelRole) -> Role {
    match role {
        ChannelRole::Excitation => Role::Excitation,
        ChannelRole::DrivePoint => Role::DrivePoint,
        ChannelRole::Response => Role::Response,
        ChannelRole::Contact => Role::Contact,
        ChannelRole::ExcitationPhase => Role::ExcitationPhase,
    }
}

fn linear_modes(raw: &RawLinearModes, diagnostics: &mut Diagnostics<'_>) -> Option<LinearModes> {
    let (positions, shapes) = (&raw.positions_m, &raw.shapes);
    let omegas: Vec<f64> = raw.frequencies_hz.iter().map(|f| TAU * f).collect();
    let damping = raw.damping_ratios.clone().unwrap_or_else(|| vec![0.0; omegas.len()]);
    super::plausible::damping("linear_modes.damping_ratios", &damping, diagnostics);
    let columns = table(positions, shapes, omegas.len(), damping.len(), diagnostics)?;
    given(positions, &omegas, &damping, shapes, columns, diagnostics)
}

/// The table of shapes, if its rows fit; the number of its columns.
fn table(
    positions: &[f64],
    shapes: &[Vec<f64>],
    frequencies: usize,
    damping: usize,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<usize> {
    let path = "linear_modes.shapes";
    let columns = shapes.first().map_or(0, Vec::len);
    if shapes.len() != positions.len() {
        let diagnostic =
            Diagnostic::error(format!("`{path}` has {} rows for {} positions", shapes.len(), positions.len()));
        diagnostics.put(path, diagnostic, format!("expected a row for each of the {} `positions_m`", positions.len()));
        return None;
    }
    if let Some(row) = shapes.iter().position(|row| row.len() != columns) {
        let diagnostic =
            Diagnostic::error(format!("`{path}.{row}` has {} entries, the first row {columns}", shapes[row].len()));
        diagnostics.put(&format!("{path}.{row}"), diagnostic, "expected as many entries as in the first row");
        return None;
    }
    for (key, found) in [("frequencies_hz", frequencies), ("damping_ratios", damping)] {
        if found < columns {
            let diagnostic =
                Diagnostic::error(format!("`{path}` has {columns} modes, but `linear_modes.{key}` only {found}"));
            diagnostics.put(&format!("linear_modes.{key}"), diagnostic, format!("expected {columns} numbers"));
            return None;
        }
    }
    Some(columns)
}

/// The modes, of which only so many are kept as the positions of the table can tell apart.
fn given(
    positions: &[f64],
    omegas: &[f64],
    damping: &[f64],
    shapes: &[Vec<f64>],
    columns: usize,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<LinearModes> {
    let kept = columns.min(positions.len());
    let shapes: Vec<Vec<f64>> = shapes.iter().map(|row| row[..kept].to_vec()).collect();
    match LinearModes::new(positions, omegas, damping, &shapes) {
        Ok(modes) if kept < columns => {
            let diagnostic =
                Diagnostic::warning(format!("{columns} linear modes, but shapes at {kept} positions only"));
            diagnostics.put("linear_modes.shapes", diagnostic, format!("the first {kept} modes are used"));
            Some(modes)
        }
        Ok(modes) => Some(modes),
        Err(error) => {
            diagnostics.put("linear_modes.shapes", Diagnostic::error(error.to_string()), "these shapes");
            None
        }
    }
}

fn settings(
    raw: &RawRecordScene,
    modes: Option<LinearModes>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<ExtractionSettings> {
    let default = RawExtraction::default();
    let extraction = raw.extraction.as_ref().unwrap_or(&default);
    let mode = extraction.mode.unwrap_or(1) as usize;
    if let Some(n) = modes.as_ref().map(LinearModes::n_modes).filter(|n| mode > *n) {
        let diagnostic = Diagnostic::error(format!("there is no mode {mode}: `linear_modes` has {n}"));
        diagnostics.put("extraction.mode", diagnostic, format!("expected a whole number from 1 to {n}"));
        return None;
    }
    let stop = raw.stop.as_ref().map(stop);
    let mode_errors = raw.linear_modes.as_ref().map_or_else(ModeErrors::default, mode_errors);
    let shape_error = raw.linear_modes.as_ref().and_then(|modes| modes.shape_uncertainty).unwrap_or(0.0);
    Some(ExtractionSettings { linear_modes: modes, mode_errors, shape_error, stop, ..self::extraction(extraction) })
}

fn mode_errors(raw: &RawLinearModes) -> ModeErrors {
    let default = ModeErrors::default();
    ModeErrors {
        frequency: raw.frequency_uncertainty.unwrap_or(default.frequency),
        damping: raw.damping_uncertainty.unwrap_or(default.damping),
        shape: raw.shape_uncertainty.unwrap_or(default.shape),
    }
}

/// What the table says, so far without modes and stop.
pub fn extraction(raw: &RawExtraction) -> ExtractionSettings {
    ExtractionSettings {
        mode: raw.mode.unwrap_or(1) as usize,
        periods: raw.periods.map(|n| n as usize),
        harmonics: raw.harmonics.unwrap_or(HARMONICS) as usize,
        pbmif_harmonics: match raw.pbmif_harmonics {
            Some(RawPbmifHarmonics::Number(n)) => Some(n as usize),
            Some(RawPbmifHarmonics::Word(_)) | None => None,
        },
        omega: raw.frequency_hz.map(|f| TAU * f),
        ..ExtractionSettings::default()
    }
}

fn stop(raw: &RawStop) -> Stop {
    let positive = raw.side.unwrap_or(Side::Positive) == Side::Positive;
    Stop { position: raw.position_m, gap: raw.gap_m, positive }
}
