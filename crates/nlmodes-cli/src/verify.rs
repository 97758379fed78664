//! `nlmodes-cli verify`: one period of the full structure, without truncation of harmonics, from a computed point.

use std::path::{Path, PathBuf};

use clap::Args;
use nlmodes::timestep::TimestepError;
use nlmodes_run::chain;
use nlmodes_run::settle::verify_response;
use nlmodes_run::verify::{Point, VerifyError, verify};

use crate::Status;
use crate::results::entered;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directory written by `run`, or the folder of one of its branches
    #[arg(value_name = "RESULTS")]
    results: PathBuf,
    /// Number of the point, as in branch.csv
    #[arg(long, value_name = "N")]
    point: usize,
}

/// Verifies the point and prints the result.
pub fn run(arguments: &Arguments) -> Status {
    let results = entered(&arguments.results);
    let point = match Point::read(&results, arguments.point) {
        Ok(point) => point,
        Err(VerifyError::Responses) => return response(arguments, &results),
        Err(error) => return refuse(arguments, &error, Status::Wrong),
    };
    match verify(&point) {
        Ok(found) => print(found.text(&point).trim_end()),
        Err(error @ TimestepError::TooLarge { .. }) => refuse(arguments, &error.into(), Status::Wrong),
        Err(error) => refuse(arguments, &error.into(), Status::EndedEarly),
    }
}

/// Verifies a point of responses.
fn response(arguments: &Arguments, results: &Path) -> Status {
    match verify_response(results, arguments.point) {
        Ok(found) => print(found.text().trim_end()),
        Err(error) => {
            let is_integrated = matches!(error, VerifyError::Integration(_));
            refuse(arguments, &error, if is_integrated { Status::EndedEarly } else { Status::Wrong })
        }
    }
}

fn refuse(arguments: &Arguments, error: &VerifyError, status: Status) -> Status {
    say!("error: {}: {}", arguments.results.display(), chain(error));
    status
}
