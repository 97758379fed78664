//! `nlmodes-cli settle`: what the motion of a response's point becomes once it is disturbed.

use std::path::PathBuf;

use clap::Args;
use nlmodes::report::write_summary;
use nlmodes_run::chain;
use nlmodes_run::settle::{SettleSettings, settle};
use nlmodes_run::verify::VerifyError;

use crate::Status;
use crate::results::entered;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directory with responses, written by `run`
    #[arg(value_name = "RESULTS")]
    results: PathBuf,
    /// Number of the point, as in branch.csv
    #[arg(long, value_name = "N")]
    point: usize,
    /// Size of the disturbance, relative to the motion
    #[arg(long, value_name = "SHARE", default_value_t = SettleSettings::default().disturbance)]
    disturbance: f64,
    /// Maximum number of periods of the load to integrate; by default until the slowest mode has decayed
    #[arg(long, value_name = "N")]
    periods: Option<usize>,
    /// As JSON
    #[arg(long)]
    json: bool,
}

/// Follows the point, prints what it becomes and writes it beside the results.
pub fn run(arguments: &Arguments) -> Status {
    let settings = SettleSettings { disturbance: arguments.disturbance, periods: arguments.periods };
    let results = entered(&arguments.results);
    let found = match settle(&results, arguments.point, settings) {
        Ok(found) => found,
        Err(error) => {
            say!("error: {}: {}", arguments.results.display(), chain(&error));
            return match error {
                VerifyError::Integration(_) => Status::EndedEarly,
                _ => Status::Wrong,
            };
        }
    };
    let status = print(&if arguments.json { found.json() } else { found.text() });
    if let Err(error) = write_summary(results.join("settled.json"), &found) {
        say!("error: {}", chain(&error));
        return Status::EndedEarly;
    }
    status
}
