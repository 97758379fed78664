use std::path::Path;
use std::time::Duration;

use nlmodes::modal::BranchEnd;
use nlmodes::study::ComputedBranch;

use super::difference::Difference;

/// A contact solver and what became of it.
pub struct Row {
    pub solver: String,
    /// What was measured, or why there is no branch.
    pub outcome: Result<Run, String>,
}

/// What was measured of a branch.
pub struct Run {
    pub points: usize,
    pub time: Duration,
    pub evaluations: usize,
    pub contact_iterations: usize,
    pub violation: f64,
    /// From the first branch; `None` for itself.
    pub difference: Option<Difference>,
    pub end: BranchEnd,
}

impl Run {
    pub fn new(computed: &ComputedBranch, time: Duration, violation: f64, difference: Option<Difference>) -> Self {
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
    pub fn is_complete(&self) -> bool {
        self.outcome.as_ref().is_ok_and(|run| run.end.complete)
    }
}

const EXPLANATION: &str = "
iterations  of Newton's method: evaluations of residual and Jacobian
contact     iterations of the contact solver over all problems, each solver in its own unit
violation   of 0 ≤ g ⊥ λ ≥ 0 at 256 instants of each point, over the amplitude at grazing
difference  in frequency or energy, relative, from the first branch
";

/// The table as text.
pub fn text(title: &str, rows: &[Row]) -> String {
    let mut text = format!(
        "{title}\n\n{:<14}{:>7}{:>11}{:>12}{:>11}{:>11}{:>13}  {}\n",
        "solver", "points", "time, s", "iterations", "contact", "violation", "difference", "ended"
    );
    for row in rows {
        text += &match &row.outcome {
            Ok(run) => line(&row.solver, run),
            Err(reason) => format!("{:<14}no branch: {reason}\n", row.solver),
        };
    }
    text += EXPLANATION;
    let chords =
        |row: &Row| row.outcome.as_ref().is_ok_and(|r| matches!(r.difference, Some(Difference::FromChords(_))));
    if rows.iter().any(chords) {
        text += "~           the branch has another number of points: distance from the chords of the first, with their error\n";
    }
    text
}

fn line(solver: &str, run: &Run) -> String {
    let difference = match run.difference {
        None => "-".to_owned(),
        Some(Difference::OfPoints(d)) => format!("{d:.1e}"),
        Some(Difference::FromChords(d)) => format!("~{d:.1e}"),
    };
    let end = if run.end.complete { run.end.reason.clone() } else { format!("early: {}", run.end.message) };
    let seconds = run.time.as_secs_f64();
    format!(
        "{solver:<14}{:>7}{seconds:>11.4}{:>12}{:>11}{:>11.1e}{difference:>13}  {end}\n",
        run.points, run.evaluations, run.contact_iterations, run.violation
    )
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
        run.end.reason.clone(),
        run.end.message.clone(),
    ]
}
