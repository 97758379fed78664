//! `nlmodes-cli compare`: the same branch with several contact solvers.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use nlmodes::contact::SOLVER_NAMES;
use nlmodes_run::compare::{Difference, Row, Run, rows, write};
use nlmodes_scene::SceneFile;

use crate::Status;
use crate::terminal::{print, refuse_run};

/// What stands on the command line beside the scene.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact solvers, the first of which the others are compared with
    #[arg(
        long = "contact-solver",
        value_name = "NAME,NAME…",
        value_delimiter = ',',
        default_value = "active-set,proximal,clarabel,lemke",
        value_parser = PossibleValuesParser::new(SOLVER_NAMES)
    )]
    solvers: Vec<String>,
    /// Directory for the table as `compare.csv`
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Computes the branch with each solver and prints the table; the first branch is the reference of the others.
pub fn run(file: &SceneFile, arguments: &Arguments) -> Status {
    match rows(file, &arguments.solvers) {
        Ok(rows) => finish(file, arguments, &rows),
        Err(error) => refuse_run(&error),
    }
}

fn finish(file: &SceneFile, arguments: &Arguments, rows: &[Row]) -> Status {
    let mut text = text(&file.scene.title, rows);
    if let Some(directory) = &arguments.out {
        let path = directory.join("compare.csv");
        let place = std::fs::create_dir_all(directory).map_err(csv::Error::from);
        if let Err(error) = place.and_then(|()| write(&path, rows)) {
            print(text.trim_end());
            say!("error: the table cannot be written to {}: {error}", path.display());
            return Status::Wrong;
        }
        text += &format!("\nTable in {}\n", path.display());
    }
    match print(text.trim_end()) {
        Status::Done if !rows.iter().all(Row::is_complete) => Status::EndedEarly,
        status => status,
    }
}

const EXPLANATION: &str = "
iterations  of Newton's method: evaluations of residual and Jacobian
contact     iterations of the contact solver over all problems, each solver in its own unit
violation   of 0 ≤ g ⊥ λ ≥ 0 at 256 instants of each point, over the amplitude at grazing
difference  in frequency or energy, relative, from the first branch
";

/// The table as text.
fn text(title: &str, rows: &[Row]) -> String {
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
    let end = if run.end.complete { run.end.names() } else { format!("early: {}", run.end.message) };
    let seconds = run.time.as_secs_f64();
    format!(
        "{solver:<14}{:>7}{seconds:>11.4}{:>12}{:>11}{:>11.1e}{difference:>13}  {end}\n",
        run.points, run.evaluations, run.contact_iterations, run.violation
    )
}
