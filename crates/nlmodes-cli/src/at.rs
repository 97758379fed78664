//! `nlmodes-cli at`: results at a frequency or an energy.

use std::path::PathBuf;

use clap::Args;
use nlmodes_run::chain;
use nlmodes_run::overlay::{OverlayError, SheetError};
use nlmodes_run::passages::{Abscissa, Answer, PassageError, json, passages, text};

use crate::Status;
use crate::terminal::print;

/// Quantities at which results can be requested.
pub const PLACES: &str = "results are asked for at a frequency, `--frequency-hz 50`, or at an energy, `--energy-j 0.1`";

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directory written by `run`, or a table branch.csv
    #[arg(value_name = "RESULTS")]
    results: PathBuf,
    #[command(flatten)]
    place: Place,
    /// Print everything as JSON
    #[arg(long)]
    json: bool,
}

/// One of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// Frequency of the motion, a number in Hz
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = number)]
    frequency_hz: Option<f64>,
    /// Averaged kinetic energy, a number in J
    #[arg(long, value_name = "J", allow_negative_numbers = true, value_parser = number)]
    energy_j: Option<f64>,
}

/// A number without a unit, since the unit is in the name of the option.
fn number(text: &str) -> Result<f64, String> {
    let wrong = |_| "expected a number with a decimal point and without its unit, as 50.5".to_owned();
    text.parse().map_err(wrong)
}

/// Prints every passage of every branch; if there is none, the status is [`Status::EndedEarly`].
pub fn run(arguments: &Arguments) -> Status {
    let (abscissa, value) = match (arguments.place.frequency_hz, arguments.place.energy_j) {
        (Some(frequency), _) => (Abscissa::FrequencyHz, frequency),
        (_, energy) => (Abscissa::EnergyJ, energy.unwrap_or(f64::NAN)),
    };
    match passages(&arguments.results, abscissa, value) {
        Ok(curves) => {
            let printed = match arguments.json {
                true => print(&json(&curves)),
                false => print(text(&arguments.results, abscissa, value, &curves).trim_end()),
            };
            let is_passed = curves.iter().any(|curve| curve.answer == Answer::Passed);
            if is_passed { printed } else { Status::EndedEarly }
        }
        Err(error) => {
            say!("error: {}", chain(&error));
            if matches!(error, PassageError::Table(OverlayError::Sheet(SheetError::NoColumn { .. }))) {
                say!("  expected a directory that `run` has written, or the branch.csv in it");
            }
            Status::Wrong
        }
    }
}
