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
use crate::config::scene::{BackboneMethod, RecordFormat, TestScene};
use crate::experiment::{Outcome, figures, table};

/// Folder of the records.
pub const RECORDS: &str = "records";
/// Beginning of the names of its files; the number of the level follows.
const LEVEL: &str = "level-";

fn backbone_file(method: BackboneMethod) -> &'static str {
    match method {
        BackboneMethod::Hbm => "backbone.csv",
        BackboneMethod::MsHbm => "backbone_ms-hbm.csv",
    }
}

/// Makes the directory, and removes what an earlier test left and this one may not write again.
///
/// # Errors
/// If it cannot be made.
pub fn prepare(directory: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Io { path: directory.to_path_buf(), source })?;
    figures::remove(directory);
    // What cannot be removed cannot be overwritten either, which is said when it is.
    ["modal_points.csv", "backbone.csv", "backbone_ms-hbm.csv", "summary.json"]
        .iter()
        .for_each(|name| drop(fs::remove_file(directory.join(name))));
    remove_records(&directory.join(RECORDS));
    Ok(())
}

/// Removes the records of an earlier test, in whatever format, and their folder if nothing else is in it.
fn remove_records(directory: &Path) {
    let Ok(entries) = fs::read_dir(directory) else { return };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        let is_record = path.file_name().and_then(|name| name.to_str()).is_some_and(|name| {
            let number = name.strip_prefix(LEVEL).and_then(|rest| rest.split_once('.'));
            number.is_some_and(|(number, format)| {
                number.parse::<usize>().is_ok() && RecordFormat::ALL.iter().any(|known| known.name() == format)
            })
        });
        if is_record {
            drop(fs::remove_file(path));
        }
    }
    drop(fs::remove_dir(directory));
}

/// Writes table, summary and figures.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    scene: &TestScene,
    rig: &Rig,
    levels: Vec<TestLevel>,
    backbones: &[(BackboneMethod, ModalBranch)],
    wrong: &[String],
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
    for (method, branch) in backbones {
        write_branch(directory.join(backbone_file(*method)), branch)?;
    }
    let backbones: Vec<&ModalBranch> = backbones.iter().map(|(_, branch)| branch).collect();
    let told: Vec<_> = told
        .into_iter()
        .zip(&outcomes)
        .map(|(level, outcome)| json!({ "level": level, "extraction": crate::experiment::summary::record(outcome) }))
        .collect();
    let text = summary::json(scene, rig, told, &backbones, wrong, wall_time);
    write_summary(directory.join("summary.json"), &text)?;
    figures::write(directory, &scene.title, &outcomes, &backbones)
}

fn outcome(level: TestLevel) -> Outcome {
    Outcome {
        record: level.outcome.record.name.clone(),
        level: Some(level.outcome.level),
        findings: level.outcome.findings.iter().map(|finding| finding.name()).collect(),
        result: level.extraction,
    }
}
