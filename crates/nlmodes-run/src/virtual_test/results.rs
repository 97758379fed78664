//! The files of a virtual test.

use std::fs;
use std::path::Path;
use std::time::Duration;

use nlmodes::modal::ModalBranch;
use nlmodes::report::columns::AppropriationRow;
use nlmodes::report::{write_branch, write_summary};
use nlmodes::virtual_test::TestLevel;
use serde_json::json;

use super::bench::Rig;
use super::summary;
use crate::Failure;
use crate::forces;
use crate::overlay::{Laid, Overlaid};
use crate::records::table::Table;
use crate::records::{RecordOutcome, figures, page};
use nlmodes_scene::scene::{BackboneMethod, RecordFormat, TestScene};

/// Folder of the records.
pub const RECORDS: &str = "records";
/// Beginning of the names of its files; the number of the level follows.
const LEVEL: &str = "level-";

fn backbone_file(method: BackboneMethod) -> &'static str {
    match method {
        BackboneMethod::Hbm => "backbone.csv",
        BackboneMethod::MsHbm => "backbone_ms-hbm.csv",
        BackboneMethod::DampedMode => "backbone_damped-mode.csv",
        BackboneMethod::PhaseResonance => "backbone_phase-resonance.csv",
    }
}

/// Removes the records of an earlier test and its forces, which this one may not write again.
pub fn prepare(directory: &Path) {
    drop(fs::remove_file(directory.join(forces::FILE)));
    remove_records(&directory.join(RECORDS));
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

/// Writes summary and figures.
///
/// # Errors
/// If a file cannot be written.
pub fn write(
    scene: &TestScene,
    rig: &Rig,
    levels: &[TestLevel],
    (backbones, laid): (&[(BackboneMethod, ModalBranch)], &[Laid]),
    wrong: &[String],
    wall_time: Duration,
) -> Result<(), Failure> {
    let directory = &scene.output_directory;
    let told: Vec<_> = levels.iter().map(summary::level).collect();
    forces::write(directory, levels.iter().enumerate().flat_map(controlled).collect())?;
    let outcomes: Vec<RecordOutcome> = levels.iter().map(outcome).collect();
    for (method, branch) in backbones {
        write_branch(directory.join(backbone_file(*method)), branch)?;
    }
    let backbones: Vec<&ModalBranch> = backbones.iter().map(|(_, branch)| branch).collect();
    let told: Vec<_> = told
        .into_iter()
        .zip(&outcomes)
        .map(|(level, outcome)| json!({ "level": level, "extraction": crate::records::summary::record(outcome) }))
        .collect();
    let computed = backbones.iter().map(|branch| Laid { branch: (*branch).clone(), is_scattered: false });
    let beside: Vec<Laid> = computed.chain(laid.iter().cloned()).collect();
    let against = Overlaid::of_test(figures::of_records(&outcomes).as_ref(), &beside);
    against.write(directory, "overlay")?;
    let text = summary::json(scene, rig, told, (&backbones, &against), wrong, wall_time);
    write_summary(directory.join("summary.json"), &text)?;
    let drawn = figures::write(directory, &scene.title, &outcomes, &beside)?;
    let lines: Vec<String> = summary::model(scene, rig).lines().map(str::to_owned).collect();
    let lines: Vec<String> = lines.into_iter().chain(against.sentences()).collect();
    page::write(directory, &scene.title, &lines, &outcomes, (&beside, &against), drawn, wrong)
}

/// The force of a level in the harmonics that were controlled, if there were several.
fn controlled((index, level): (usize, &TestLevel)) -> impl Iterator<Item = AppropriationRow> {
    forces::rows(index + 1, level.outcome.steady.omega, 0, &level.outcome.force_harmonics)
}

/// The table of the levels.
pub fn table(scene: &TestScene, rig: &Rig) -> Table {
    Table::new(rig.modes.n_modes(), Some(scene.exciter.unit()))
}

/// A level as a row of the table.
pub fn outcome(level: &TestLevel) -> RecordOutcome {
    RecordOutcome {
        record: level.outcome.record.name.clone(),
        segment: None,
        decay: None,
        level: Some(level.outcome.level),
        findings: level.outcome.findings.iter().map(|finding| finding.name()).collect(),
        result: level.extraction.clone(),
    }
}
