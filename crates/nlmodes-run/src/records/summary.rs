//! `summary.json` of an extraction.

use std::path::Path;

use nlmodes::experiment::extraction::Finding;
use nlmodes::report::{ReportError, write_summary};
use serde_json::{Value, json};

use super::RecordOutcome;
use nlmodes_scene::RecordScene;

/// Writes the results of each record, and all findings in words.
pub fn write(directory: &Path, scene: &RecordScene, outcomes: &[RecordOutcome]) -> Result<(), ReportError> {
    let summary = json!({
        "title": scene.title,
        "version": env!("CARGO_PKG_VERSION"),
        "warnings": scene.warnings,
        "records": outcomes.iter().map(record).collect::<Vec<_>>(),
    });
    write_summary(directory.join("summary.json"), &summary)
}

/// What was taken from a record.
pub fn record(outcome: &RecordOutcome) -> Value {
    let mut told = told(outcome);
    if let (Some(segment), Some(told)) = (&outcome.segment, told.as_object_mut()) {
        let told_of_it = json!({ "name": segment.name, "from_s": segment.from, "to_s": segment.to });
        told.insert("segment".into(), told_of_it);
    }
    told
}

fn told(outcome: &RecordOutcome) -> Value {
    match &outcome.result {
        Ok(found) => json!({
            "record": outcome.record,
            "periods": found.periods,
            "participation_harmonics": [1, found.harmonics],
            "pbmif_harmonics": found.excitation.as_ref().map(|excitation| excitation.power.harmonics),
            "sensor_positions_m": found.positions,
            "findings": found.findings.iter().map(finding).collect::<Vec<_>>(),
        }),
        Err(error) => json!({ "record": outcome.record, "error": error.to_string(), "findings": error.names() }),
    }
}

fn finding(finding: &Finding) -> Value {
    json!({ "name": finding.name(), "message": finding.to_string() })
}
