//! The files of a virtual test.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Duration;

use nlmodes::modal::ModalBranch;
use nlmodes::report::{ReportError, write_branch, write_summary};
use nlmodes::rig::Exciter;
use nlmodes::virtual_test::TestLevel;
use serde_json::json;

use super::bench::Rig;
use super::summary;
use crate::config::scene::TestScene;
use crate::experiment::{Outcome, figures, table};

/// Folder of the records.
pub const RECORDS: &str = "records";

/// Makes the directory, and removes what an earlier test left and this one may not write again.
///
/// # Errors
/// If it cannot be made.
pub fn prepare(directory: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Io { path: directory.to_path_buf(), source })?;
    figures::remove(directory);
    // What cannot be removed cannot be overwritten either, which is said when it is.
    ["modal_points.csv", "backbone.csv", "summary.json"]
        .iter()
        .for_each(|name| drop(fs::remove_file(directory.join(name))));
    Ok(())
}

/// Writes table, summary and figures.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    scene: &TestScene,
    rig: &Rig,
    levels: Vec<TestLevel>,
    backbone: Option<&ModalBranch>,
    wall_time: Duration,
) -> Result<(), Box<dyn Error>> {
    let directory = &scene.output_directory;
    let told: Vec<_> = levels.iter().map(summary::level).collect();
    let outcomes: Vec<Outcome> = levels.into_iter().map(outcome).collect();
    let column = match scene.exciter {
        Exciter::Shaker(_) => "drive_v",
        Exciter::IdealForce => "drive_n",
    };
    table::write(&directory.join("modal_points.csv"), rig.modes.n_modes(), Some(column), &outcomes)?;
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

fn outcome(level: TestLevel) -> Outcome {
    Outcome {
        record: level.outcome.record.name.clone(),
        level: Some(level.outcome.level),
        findings: level.outcome.findings.iter().map(|finding| finding.name()).collect(),
        result: level.extraction,
    }
}
