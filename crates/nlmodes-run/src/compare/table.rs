//! The table of contact solvers.

use std::path::Path;
use std::time::Duration;

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::BranchEnd;

use super::difference::Difference;

/// A contact solver and its outcome.
#[derive(Debug)]
pub struct Row {
    /// Its name.
    pub solver: String,
    /// What was measured, or why there is no branch.
    pub outcome: Result<Run, String>,
}

/// What was measured of a branch.
#[derive(Debug)]
pub struct Run {
    /// Its points.
    pub points: usize,
    /// By the clock.
    pub time: Duration,
    /// Of residual and Jacobian.
    pub evaluations: usize,
    /// Iterations of the contact solver over all problems.
    pub contact_iterations: usize,
    /// Largest one of `0 ≤ g ⊥ λ ≥ 0`, over the amplitude at grazing.
    pub violation: f64,
    /// From the first branch; `None` for itself.
    pub difference: Option<Difference>,
    /// Why it ended.
    pub end: BranchEnd,
}

impl Run {
    pub(super) fn new(
        computed: &ComputedBranch,
        time: Duration,
        violation: f64,
        difference: Option<Difference>,
    ) -> Self {
        Self {
            points: computed.branch.points.len(),
            time,
            evaluations: computed.evaluations,
            contact_iterations: computed.contact_iterations,
            violation,
            difference,
            end: computed.branch.end.clone(),
        }
    }
}

impl Row {
    /// Whether there is a branch, up to where it was meant to end.
    pub fn is_complete(&self) -> bool {
        self.outcome.as_ref().is_ok_and(|run| run.end.complete)
    }
}

const COLUMNS: [&str; 10] = [
    "contact_solver",
    "points",
    "time_s",
    "evaluations",
    "contact_iterations",
    "violation",
    "difference",
    "difference_of",
    "end",
    "message",
];

/// Writes the table as comma-separated values.
///
/// # Errors
/// [`csv::Error`] if it cannot be written.
pub fn write(path: &Path, rows: &[Row]) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_path(path)?;
    writer.write_record(COLUMNS)?;
    for row in rows {
        writer.write_record(record(row))?;
    }
    Ok(writer.flush()?)
}

fn record(row: &Row) -> [String; 10] {
    let run = match &row.outcome {
        Ok(run) => run,
        Err(reason) => {
            let mut record = [const { String::new() }; 10];
            (record[0], record[8], record[9]) = (row.solver.clone(), "no-branch".to_owned(), reason.clone());
            return record;
        }
    };
    let (difference, of) = match run.difference {
        None => (String::new(), ""),
        Some(Difference::OfPoints(d)) => (format!("{d:e}"), "points"),
        Some(Difference::FromChords(d)) => (format!("{d:e}"), "chords"),
    };
    [
        row.solver.clone(),
        run.points.to_string(),
        run.time.as_secs_f64().to_string(),
        run.evaluations.to_string(),
        run.contact_iterations.to_string(),
        format!("{:e}", run.violation),
        difference,
        of.to_owned(),
        run.end.names(),
        run.end.message.clone(),
    ]
}
