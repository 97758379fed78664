//! The table of contact solvers as text.

use super::difference::Difference;
use super::table::{Row, Run};

const EXPLANATION: &str = "
iterations  of Newton's method: evaluations of residual and Jacobian
contact     iterations of the contact solver over all problems, each solver in its own unit
violation   of 0 ≤ g ⊥ λ ≥ 0 at 256 instants of each point, over the amplitude at grazing
difference  in frequency or energy, relative, from the first branch
";

/// The table as text, with what its columns are.
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
        text += "~           the branch has another number of points: distance from the chords of the first, with \
            their error\n";
    }
    text
}

fn line(solver: &str, run: &Run) -> String {
    let difference = match run.difference {
        None => "-".to_owned(),
        Some(Difference::OfPoints(d)) => format!("{d:.1e}"),
        Some(Difference::FromChords(d)) => format!("~{d:.1e}"),
    };
    let end = if run.end.complete { run.end.names() } else { format!("early: {}", run.end.message) };
    let seconds = run.time.as_secs_f64();
    format!(
        "{solver:<14}{:>7}{seconds:>11.4}{:>12}{:>11}{:>11.1e}{difference:>13}  {end}\n",
        run.points, run.evaluations, run.contact_iterations, run.violation
    )
}
