//! `nlmodes-cli at`: what results say at a frequency or an energy.

use std::path::PathBuf;

use clap::Args;
use nlmodes_run::passages::{Abscissa, json, passages, text};

use crate::Status;
use crate::terminal::print;

/// What stands on the command line.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directory that `run` has written, or a table branch.csv
    #[arg(value_name = "RESULTS")]
    results: PathBuf,
    #[command(flatten)]
    place: Place,
    /// All of it as JSON
    #[arg(long)]
    json: bool,
}

/// One of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// Frequency of the motion, Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    frequency_hz: Option<f64>,
    /// Averaged kinetic energy, J
    #[arg(long, value_name = "J", allow_negative_numbers = true)]
    energy_j: Option<f64>,
}

/// Prints every passage of every branch there.
pub fn run(arguments: &Arguments) -> Status {
    let (abscissa, value) = match (arguments.place.frequency_hz, arguments.place.energy_j) {
        (Some(frequency), _) => (Abscissa::FrequencyHz, frequency),
        (_, energy) => (Abscissa::EnergyJ, energy.unwrap_or(f64::NAN)),
    };
    match passages(&arguments.results, abscissa, value) {
        Ok(curves) if arguments.json => print(&json(&curves)),
        Ok(curves) => print(text(&arguments.results, abscissa, value, &curves).trim_end()),
        Err(error) => {
            say!("error: {error}");
            Status::Wrong
        }
    }
}
