//! `nlmodes-cli compare`: the same branch with several contact solvers.

mod difference;
mod measure;
mod table;

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use nlmodes::contact::SOLVER_NAMES;
use nlmodes::hbm::HbmError;
use nlmodes::model::MasslessContactModel;
use nlmodes::study::{ComputedBranch, StudyError};

use crate::Status;
use crate::command::print;
use crate::config::SceneFile;
use crate::config::scene::MethodKind;
use crate::run::{chain, models, refuse_study};
use difference::difference;
use measure::{branch, largest_violation};
use table::{Row, Run};

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
    if file.scene.method.kind == MethodKind::Shooting {
        let title = "there are no contact solvers to compare in method \"shooting\"";
        let help = "it solves contact problems at the start of a motion only; method.kind = \"ms-hbm\" solves one at each instant";
        say!("{}", file.error_at("method.kind", title, "expected \"ms-hbm\" or \"hbm\" here", &[help]));
        return Status::Wrong;
    }
    match models(file).and_then(|(_, massless)| rows(file, &massless, &arguments.solvers)) {
        Ok(rows) => finish(file, arguments, &rows),
        Err(status) => status,
    }
}

fn rows(file: &SceneFile, model: &MasslessContactModel, solvers: &[String]) -> Result<Vec<Row>, Status> {
    let mut reference: Option<ComputedBranch> = None;
    let mut rows = Vec::new();
    for solver in solvers {
        let outcome = match branch(&file.scene, model, solver) {
            Ok((computed, time)) => {
                let violation = largest_violation(&computed).map_err(|error| refuse_study(file, &error))?;
                let difference = reference.as_ref().map(|first| difference(&first.branch, &computed.branch));
                let run = Run::new(&computed, time, violation, difference);
                reference.get_or_insert(computed);
                Ok(run)
            }
            Err(error) if concerns_the_solver(&error) => Err(chain(&error)),
            Err(error) => return Err(refuse_study(file, &error)),
        };
        rows.push(Row { solver: solver.clone(), outcome });
    }
    Ok(rows)
}

/// Whether another solver may succeed where this error was met; all other errors are those of the scene.
fn concerns_the_solver(error: &StudyError) -> bool {
    matches!(
        error,
        StudyError::Contact(_)
            | StudyError::Continuation(_)
            | StudyError::Hbm(HbmError::Contact { .. } | HbmError::Compliance(_))
    )
}

fn finish(file: &SceneFile, arguments: &Arguments, rows: &[Row]) -> Status {
    let mut text = table::text(&file.scene.title, rows);
    if let Some(directory) = &arguments.out {
        let path = directory.join("compare.csv");
        let place = std::fs::create_dir_all(directory).map_err(csv::Error::from);
        if let Err(error) = place.and_then(|()| table::write(&path, rows)) {
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
