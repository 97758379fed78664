//! `nlmodes-cli study collect`.

use clap::Args;
use nlmodes_study::{Collected, Settings, Study};

use super::{Place, refused, shown};
use crate::Status;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Writes table, statistics and page of the existing cases.
pub fn run(arguments: &Arguments) -> Status {
    arguments.place.with(|study| write(study, Settings::default().jobs(), arguments.quiet))
}

/// The same for a study already read.
pub fn write(study: &Study, threads: usize, quiet: bool) -> Status {
    let collected = Collected::new(study, threads);
    if let Err(error) = collected.write(study) {
        return refused(&error);
    }
    let counts = collected.counts;
    if counts.missing + counts.damaged > 0 {
        say!("warning: {} of {} cases are missing, {} are damaged", counts.missing, counts.cases, counts.damaged);
    }
    if !quiet {
        let mut text = counts.to_string();
        collected.statistics.iter().for_each(|statistics| text += &format!("\n\n{statistics}"));
        collected.first_order.iter().for_each(|first_order| text += &format!("\n\n{first_order}"));
        let place = |name| shown(&study.directory, name);
        let parquet = if cfg!(feature = "parquet") { " and study.parquet" } else { "" };
        text += &format!("\n\nTable in {}{parquet}, page in {}", place("study.csv"), place("report.html"));
        if print(&text) != Status::Done {
            return Status::EndedEarly;
        }
    }
    if counts.missing + counts.damaged > 0 { Status::EndedEarly } else { Status::Done }
}
