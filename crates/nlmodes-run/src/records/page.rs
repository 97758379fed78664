//! `report.html` of records: modal points, figures and findings on one page.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::experiment::extraction::{Measured, RecordExtraction};
use nlmodes::report::DataTable;

use super::RecordOutcome;
use super::figures::{Drawn, measured, scattered};
use crate::Failure;
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
    figures: &[Drawn],
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
    let content = Content {
        title,
        lines: lines.to_vec(),
        tables: [points(outcomes)].into_iter().chain(against.tables()).chain([findings(outcomes)]).collect(),
        laid: own.iter().chain(beside.iter().map(|laid| &laid.branch)).collect(),
        scattered,
        ..Content::default()
    };
    let shown = hardest(&found);
    let figures = figures.iter().filter(|drawn| number_in(&drawn.file).is_none_or(|k| shown.contains(&k)));
    // The page draws that one itself, to zoom.
    let figures = figures.filter(|drawn| drawn.file != "frequency_amplitude.svg" || own.is_none());
    page::write(directory, &[], content, |mut report| {
        for drawn in figures {
            report = report.figure(&drawn.heading, drawn.figure.clone());
        }
        report
    })
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
        let found = outcome.result.as_ref().ok();
        let text = |of: &dyn Fn(&RecordExtraction) -> Option<Measured>| {
            found.and_then(of).map_or_else(|| "–".to_owned(), |measured| significant(measured.value, 5))
        };
        table.rows.push(vec![
            // A name, even one that begins with a digit.
            format!(" {}", outcome.name()),
            outcome.level.map_or_else(|| "–".to_owned(), number),
            found.map_or_else(|| "–".to_owned(), |found| format!("{:.5}", found.omega.value / TAU)),
            text(&|found| Some(found.modal.as_ref()?.amplitude)),
            text(&|found| found.modal.as_ref()?.damping),
            text(&|found| Some(found.excitation.as_ref()?.lag.times(1f64.to_degrees()))),
            text(&|found| Some(found.excitation.as_ref()?.pbmif)),
            text(&|found| Some(found.contact.as_ref()?.peak_force)),
            text(&|found| {
                let fit = found.contact.as_ref()?.stiffness?;
                Some(Measured { value: fit.stiffness, uncertainty: fit.stiffness_error })
            }),
            text(&|found| {
                let statistics = found.contact.as_ref()?.restitution.as_ref()?.statistics();
                Some(Measured { value: statistics.mean, uncertainty: statistics.std })
            }),
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
