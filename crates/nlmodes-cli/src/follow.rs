//! `nlmodes-cli follow`: a fold, a first touch, a phase resonance or a mode at an energy over a parameter.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use nlmodes::branches::Watch;
use nlmodes_run::chain;
use nlmodes_run::follow::{FollowError, FollowSettings, Wanted, follow};

use crate::terminal::{print, refuse};
use crate::{Status, interrupt};

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE")]
    path: PathBuf,
    /// What is followed
    #[arg(long, value_enum, default_value_t = What::Fold)]
    of: What,
    /// Key of the parameter, as --set takes it; its value has to be in the scene
    #[arg(long, value_name = "KEY")]
    over: String,
    /// Lowest value, in the unit of the key
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    from: f64,
    /// Highest value
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    to: f64,
    /// Level of the response, where the scene has several
    #[arg(long, value_name = "LEVEL")]
    level: Option<f64>,
    /// Averaged kinetic energy of the mode, J
    #[arg(long, value_name = "J", required_if_eq("of", "mode"))]
    energy_j: Option<f64>,
    /// Override of a value of the scene
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Directory of the files [default: results/<scene>_over_<key>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What can be followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// The folds of a response over the frequency: where it jumps
    Fold,
    /// Where a response over the frequency first touches a stop
    Touch,
    /// The phase resonance at a level
    Resonance,
    /// The mode at an energy
    Mode,
}

/// Follows it, prints where it goes and writes the files.
pub fn run(arguments: &Arguments) -> Status {
    let (level, energy_j) = (arguments.level, arguments.energy_j.unwrap_or(f64::NAN));
    let wanted = match arguments.of {
        What::Fold => Wanted::Folds { level },
        What::Touch => Wanted::Touches { level },
        What::Resonance => Wanted::Resonance { level },
        What::Mode => Wanted::Mode { energy_j },
    };
    let (key, window) = (arguments.over.clone(), [arguments.from, arguments.to]);
    let settings = FollowSettings { wanted, key, window };
    interrupt::install();
    interrupt::something_found();
    let watch = Watch::until(interrupt::requested);
    let found = match follow(&arguments.path, &arguments.overrides, &settings, &watch) {
        Ok(found) => found,
        Err(FollowError::Scene(refused)) => return refuse(&refused),
        Err(error) => {
            say!("error: {}", chain(&error));
            return match error {
                FollowError::Run(_) | FollowError::Response(_) => Status::EndedEarly,
                _ => Status::Wrong,
            };
        }
    };
    let directory = arguments.out.clone().unwrap_or_else(|| {
        let stem = arguments.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        PathBuf::from("results").join(format!("{stem}_over_{}", settings.key.replace('.', "_")))
    });
    if let Err(error) = found.write(&directory) {
        say!("error: {}", chain(&error));
        return Status::EndedEarly;
    }
    let place = directory.join("follow.csv");
    match print(&format!("{found}\n\nTable in {}, figures beside it", place.display())) {
        Status::Done if found.is_complete() => Status::Done,
        Status::Done => Status::EndedEarly,
        other => other,
    }
}
