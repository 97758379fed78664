//! `nlmodes-cli compare`: the same branch with several contact solvers.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use nlmodes::contact::SOLVER_NAMES;
use nlmodes_run::compare::{Row, rows, text, write};
use nlmodes_scene::SceneFile;

use crate::Status;
use crate::terminal::{print, refuse_run};

/// Command-line arguments in addition to the scene.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Contact solvers; the others are compared with the first
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
