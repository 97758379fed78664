//! The files of a virtual test.

use std::error::Error;
use std::time::Duration;

use nlmodes::modal::ModalBranch;
use nlmodes::report::{write_branch, write_summary};
use nlmodes::rig::Exciter;
use nlmodes::virtual_test::TestLevel;
use serde_json::json;

use super::bench::Rig;
use super::summary;
use crate::config::scene::TestScene;
use crate::experiment::table::Table;
use crate::experiment::{Outcome, figures};

/// Folder of the records.
pub const RECORDS: &str = "records";

/// Writes summary and figures.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    scene: &TestScene,
    rig: &Rig,
    levels: &[TestLevel],
    backbone: Option<&ModalBranch>,
    wall_time: Duration,
) -> Result<(), Box<dyn Error>> {
    let directory = &scene.output_directory;
    let told: Vec<_> = levels.iter().map(summary::level).collect();
    let outcomes: Vec<Outcome> = levels.iter().map(outcome).collect();
    if let Some(branch) = backbone {
        write_branch(directory.join("backbone.csv"), branch)?;
    }
    let told: Vec<_> = told
        .into_iter()
        .zip(&outcomes)
        .map(|(level, outcome)| json!({ "level": level, "extraction": crate::experiment::summary::record(outcome) }))
        .collect();
    let text = summary::json(scene, rig, told, backbone, wall_time);
    write_summary(directory.join("summary.json"), &text)?;
    figures::write(directory, &scene.title, &outcomes, backbone)
}

/// The table of the levels.
///
/// # Errors
/// As [`Table::new`].
pub fn table(scene: &TestScene, rig: &Rig) -> Result<Table, Box<dyn Error>> {
    let column = match scene.exciter {
        Exciter::Shaker(_) => "drive_v",
        Exciter::IdealForce => "drive_n",
    };
    Table::new(rig.modes.n_modes(), Some(column))
}

/// A level as a row of the table.
pub fn outcome(level: &TestLevel) -> Outcome {
    Outcome {
        record: level.outcome.record.name.clone(),
        level: Some(level.outcome.level),
        findings: level.outcome.findings.iter().map(|finding| finding.name()).collect(),
        result: level.extraction.clone(),
    }
}
