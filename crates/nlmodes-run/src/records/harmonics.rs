//! `damping_by_harmonic.csv`: damping and energy of each harmonic of a record.

use std::path::Path;

use nlmodes::report::columns::{HarmonicDampingRow, Row, Sometimes};
use nlmodes::report::write_rows;

use super::RecordOutcome;
use crate::Failure;

const TABLE: &str = "damping_by_harmonic.csv";

/// Writes the table; nothing without linear modes.
pub fn write(directory: &Path, outcomes: &[RecordOutcome]) -> Result<(), Failure> {
    let has_segments = outcomes.iter().any(|outcome| outcome.segment.is_some());
    let like =
        HarmonicDampingRow { segment: Sometimes(has_segments.then(String::new)), ..HarmonicDampingRow::unknown() };
    let rows: Vec<HarmonicDampingRow> = outcomes.iter().flat_map(|outcome| rows(outcome, has_segments)).collect();
    if !rows.is_empty() {
        write_rows(directory.join(TABLE), &like, rows)?;
    }
    Ok(())
}

fn rows(outcome: &RecordOutcome, has_segments: bool) -> Vec<HarmonicDampingRow> {
    let Some(modal) = outcome.result.as_ref().ok().and_then(|found| found.modal.as_ref()) else { return vec![] };
    let segment = outcome.segment.as_ref().map_or_else(String::new, |segment| segment.name.clone());
    let power = modal.dissipation.power.iter();
    let of = |(k, ((damping, power), energy)): (usize, ((&_, &f64), &f64))| {
        let damping: &nlmodes::experiment::extraction::Measured = damping;
        HarmonicDampingRow {
            record: outcome.record.clone(),
            segment: Sometimes(has_segments.then(|| segment.clone())),
            harmonic: k + 1,
            damping: damping.value,
            linear_dissipation_w: *power,
            energy_j: *energy,
            damping_uncertainty: Some(damping.uncertainty).filter(|error| error.is_finite()),
        }
    };
    modal.harmonic_damping.iter().zip(power).zip(modal.harmonic_energy.iter().skip(1)).enumerate().map(of).collect()
}
