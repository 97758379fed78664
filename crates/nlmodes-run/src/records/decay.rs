//! Free decays at the ends of records.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::experiment::extraction::{
    ExtractionError, FreeDecay, Measured, RecordExtraction, extract as extract_record, free_decay,
};
use nlmodes::experiment::records::Record;
use nlmodes::report::columns::{DecayRow, Row};
use nlmodes::report::{MeasuredFigure, write_rows};
use nlmodes_scene::RecordScene;

use super::{RecordOutcome, Segment};
use crate::Failure;
use crate::curve::figures::Named;

const TABLE: &str = "decay.csv";
const FIGURE: &str = "decay.svg";

/// The decay of a record, and the level before it; `outcome` makes an outcome of a segment and a level.
pub fn of_record(
    scene: &RecordScene,
    record: &Record,
    [from, to]: [Option<f64>; 2],
    outcome: impl Fn(Option<Segment>, Result<RecordExtraction, ExtractionError>) -> RecordOutcome,
) -> RecordOutcome {
    let decay = match free_decay(record, &scene.settings, from, to) {
        Ok(decay) => decay,
        Err(error) => return outcome(None, Err(error)),
    };
    let [start, _] = record.span();
    let locked = Segment { name: "locked".into(), from: start, to: decay.from };
    let samples = record.between(start, decay.from).unwrap_or(0..0);
    let part = record.part(locked.of(&record.name), samples);
    let level = extract_record(&part, &scene.settings);
    RecordOutcome { decay: Some(decay), ..outcome(Some(locked), level) }
}

/// Writes table and figure; nothing without a decay.
pub fn write(directory: &Path, title: &str, outcomes: &[RecordOutcome]) -> Result<Option<Named>, Failure> {
    let decays = || outcomes.iter().filter_map(|outcome| Some((&outcome.record, outcome.decay.as_ref()?)));
    if decays().next().is_none() {
        return Ok(None);
    }
    let rows = decays().flat_map(|(record, decay)| rows(record, decay));
    write_rows(directory.join(TABLE), &DecayRow::unknown(), rows)?;
    let points: Vec<_> = decays().flat_map(|(_, decay)| &decay.points).collect();
    let amplitudes: Vec<f64> = points.iter().map(|point| point.amplitude.value).collect();
    let pairs = |of: &dyn Fn(usize) -> Measured| -> Vec<(f64, f64)> {
        (0..points.len()).map(|k| (of(k).value, of(k).uncertainty)).collect()
    };
    let figure = MeasuredFigure::new(&amplitudes)
        .title(title)
        .scattered()
        .bars("bars: standard error")
        .panel("frequency in Hz", &pairs(&|k| points[k].omega.times(1.0 / TAU)))
        .panel("damping ratio", &pairs(&|k| points[k].damping))
        .render()?;
    figure.write(directory.join(FIGURE))?;
    Ok(Some(Named::new(FIGURE, "Free decay: frequency and damping", figure)))
}

fn rows<'a>(record: &'a str, decay: &'a FreeDecay) -> impl Iterator<Item = DecayRow> + 'a {
    decay.points.iter().map(move |point| {
        let frequency = point.omega.times(1.0 / TAU);
        DecayRow {
            record: record.to_owned(),
            time_s: point.time,
            frequency_hz: frequency.value,
            modal_amplitude: point.amplitude.value,
            damping: point.damping.value,
            frequency_hz_uncertainty: frequency.uncertainty,
            modal_amplitude_uncertainty: point.amplitude.uncertainty,
            damping_uncertainty: point.damping.uncertainty,
        }
    })
}
