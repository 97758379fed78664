//! `nlmodes-cli study fit`.

use clap::Args;
use nlmodes_scene::memory;
use nlmodes_study::{FitError, Settings, fit};

use super::run::Watch;
use super::{Place, refused, shown};
use crate::terminal::print;
use crate::{Status, interrupt};

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Maximum memory of a case, for instance 8GiB; default: three quarters of the machine's
    #[arg(long, value_name = "SIZE")]
    memory_limit: Option<memory::Limit>,
    /// Errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Fits the variables, and writes what was found.
pub fn run(arguments: &Arguments) -> Status {
    arguments.place.with(|study| {
        interrupt::install();
        interrupt::something_found();
        let settings = Settings { memory_limit: arguments.memory_limit, ..Settings::default() };
        let found = match fit(study, &settings, &mut Watch::new(true)) {
            Ok(found) => found,
            Err(FitError::Study(error)) => return refused(&error),
            Err(error) => {
                say!("error: {}", nlmodes_run::chain(&error));
                return match error {
                    FitError::NothingMeasured | FitError::Few { .. } | FitError::Start { .. } => Status::Wrong,
                    _ => Status::EndedEarly,
                };
            }
        };
        if let Err(error) = found.write(study) {
            return refused(&error);
        }
        let place = |name| shown(&study.directory, name);
        let text = found.to_string().replace("SCENE", &study.scene_name);
        match arguments.quiet {
            true => Status::Done,
            false => print(&format!("{text}\n\nPoints in {}, all of it in {}", place("fit.csv"), place("fit.json"))),
        }
    })
}
