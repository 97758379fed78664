//! `nlmodes-cli study serve`: a line of JSON for each requested case, a line for each completed one.

use std::io;
use std::num::NonZeroUsize;

use clap::Args;
use nlmodes_study::Settings;

use super::{Place, refused};
use crate::Status;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Number of cases at a time [default: number of cores]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

/// Answers until there are no more lines.
pub fn serve(arguments: &Arguments) -> Status {
    arguments.place.with(|study| {
        let settings = Settings { jobs: arguments.jobs, ..Settings::default() };
        match nlmodes_study::serve(study, settings, io::stdin().lock(), &mut io::stdout()) {
            Ok(()) => Status::Done,
            Err(error) => refused(&error),
        }
    })
}
