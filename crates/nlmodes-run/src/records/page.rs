//! `report.html` of records: modal points, figures and findings on one page.

use std::path::Path;

use nlmodes::experiment::extraction::RecordExtraction;
use nlmodes::report::DataTable;
use nlmodes::report::columns::{ModalPointRow, Row};

use super::RecordOutcome;
use super::figures::{measured, scattered};
use super::table::row;
use crate::Failure;
use crate::curve::figures::Named;
use crate::curve::page::{self, Content};
use crate::overlay::{Laid, Overlaid};
use nlmodes_scene::{number, significant};

/// Most records whose time histories and contact forces are on the page: those with the largest forces.
const SHOWN: usize = 4;

/// Writes the page. `lines` are below the title, `wrong` are the reasons why the test is incomplete.
///
/// # Errors
/// If it cannot be drawn or written.
pub fn write(
    directory: &Path,
    title: &str,
    lines: &[String],
    outcomes: &[RecordOutcome],
    (beside, against): (&[Laid], &Overlaid),
    figures: Vec<Named>,
    wrong: &[String],
) -> Result<(), Failure> {
    let found: Vec<&RecordExtraction> = outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()).collect();
    let mut own = measured(&found);
    if let Some(branch) = &mut own {
        branch.end.complete = wrong.is_empty() && found.len() == outcomes.len();
        branch.end.message = if branch.end.complete {
            format!("all {} records gave a point", outcomes.len())
        } else if wrong.is_empty() {
            format!("{} of {} records gave a point", found.len(), outcomes.len())
        } else {
            wrong.join("; ")
        };
    }
    let scattered = scattered(beside, usize::from(own.is_some()));
    let shown = hardest(&found);
    let figures = figures.into_iter().filter(|drawn| number_in(&drawn.file).is_none_or(|k| shown.contains(&k)));
    // The page draws that one itself, to zoom.
    let figures = figures.filter(|drawn| drawn.file != "frequency_amplitude.svg" || own.is_none());
    let content = Content {
        title,
        lines: lines.to_vec(),
        tables: [points(outcomes)].into_iter().chain(against.tables()).chain([findings(outcomes)]).collect(),
        laid: own.iter().chain(beside.iter().map(|laid| &laid.branch)).collect(),
        scattered,
        figures: figures.collect(),
        ..Content::default()
    };
    page::write(directory, &[], content, |report| report)
}

/// Numbers, from 1, of the records with the largest contact forces.
fn hardest(found: &[&RecordExtraction]) -> Vec<usize> {
    let force = |found: &RecordExtraction| found.contact.as_ref().map_or(0.0, |contact| contact.peak_force.value);
    let mut numbers: Vec<usize> = (1..=found.len()).collect();
    numbers.sort_by(|a, b| force(found[b - 1]).total_cmp(&force(found[a - 1])));
    numbers.truncate(SHOWN);
    numbers
}

/// The number of the record in `history_7.svg` or `contact_7.svg`.
fn number_in(file: &str) -> Option<usize> {
    let (_, rest) = file.split_once('_')?;
    rest.strip_suffix(".svg")?.parse().ok()
}

/// The modal points, one row per record.
fn points(outcomes: &[RecordOutcome]) -> DataTable {
    let head = [
        "record",
        "level",
        "frequency, Hz",
        "amplitude, m√kg",
        "damping",
        "lag, °",
        "mode indicator",
        "largest force of a period, mean, N",
        "contact stiffness, N/m",
        "restitution",
        "findings",
    ];
    let mut table = DataTable::new("Modal points", &head);
    for outcome in outcomes {
        let found = outcome.result.as_ref().map_or_else(|_| ModalPointRow::unknown(), |found| row(found, 0));
        let none = || "–".to_owned();
        let text = |value: Option<f64>| value.map_or_else(none, |value| significant(value, 5));
        table.rows.push(vec![
            // A name, even one that begins with a digit.
            format!(" {}", outcome.name()),
            outcome.level.map_or_else(none, number),
            found.frequency_hz.map_or_else(none, |hz| format!("{hz:.5}")),
            text(found.modal_amplitude),
            text(found.damping),
            text(found.lag_deg),
            text(found.pbmif),
            text(found.peak_contact_force_n),
            text(found.contact_stiffness_n_m),
            text(found.restitution_mean),
            outcome.finding_names(),
        ]);
    }
    table
}

/// Findings in words.
fn findings(outcomes: &[RecordOutcome]) -> DataTable {
    let mut table = DataTable::new("Findings", &["record", "finding", "what it says"]);
    for outcome in outcomes {
        let mut row = |name: &str, text: String| {
            table.rows.push(vec![format!(" {}", outcome.name()), name.to_owned(), format!(" {text}")]);
        };
        match &outcome.result {
            Ok(found) => found.findings.iter().for_each(|finding| row(finding.name(), finding.to_string())),
            Err(error) => row(&error.names(), error.to_string()),
        }
        for name in &outcome.findings {
            row(name, format!("{}while the record was made", unsettled(name)));
        }
    }
    table
}

/// What it means that a level had not settled.
fn unsettled(name: &str) -> &'static str {
    match name {
        "not-locked" => "the lag was not held within its tolerance ",
        "frequency-drift" => "the frequency drifted ",
        "amplitude-drift" => "the amplitude of the response drifted ",
        "aperiodic" => "periods differed from their mean ",
        _ => "",
    }
}
