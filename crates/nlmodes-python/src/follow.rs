//! `nlmodes.follow`: a fold, a first touch or a mode at an energy over a parameter.

use std::path::PathBuf;

use nlmodes_run::follow::{FollowError, FollowOutcome, FollowSettings, Wanted, follow as of_file, follow_text};
use nlmodes_run::{Observer, chain};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors;
use crate::looking::{Looking, Onlooker};
use crate::scene::Source;

/// Follows what is wanted over a key between two values, `at` a level or an energy, and writes the files into a
/// directory.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "those of the function of Python")]
pub fn follow(
    py: Python<'_>,
    source: Source,
    overrides: Vec<String>,
    of: &str,
    key: String,
    window: [f64; 2],
    at: (Option<f64>, Option<f64>),
    directory: PathBuf,
) -> PyResult<()> {
    let (level, energy_j) = at;
    let wanted = match of {
        "fold" => Wanted::Folds { level },
        "touch" => Wanted::Touches { level },
        "resonance" => Wanted::Resonance { level },
        "mode" => Wanted::Mode {
            energy_j: energy_j.ok_or_else(|| PyValueError::new_err("a mode is followed at an energy: energy_j"))?,
        },
        _ => {
            let expected = "\"fold\", \"touch\", \"resonance\" or \"mode\"";
            return Err(PyValueError::new_err(format!("of is {of:?}; {expected} was expected")));
        }
    };
    let settings = FollowSettings { wanted, key, window };
    let onlooker = Onlooker { looking: Looking::new(None), warnings: Vec::new() };
    let watch = onlooker.watch();
    let found = errors::computed(py, || -> Result<FollowOutcome, FollowError> {
        match &source {
            Source::File(path) => of_file(path, &overrides, &settings, &watch),
            Source::Text(name, text) => follow_text((name, text), &overrides, &settings, &watch),
        }
    })?;
    onlooker.looking.look();
    if let Some(error) = onlooker.looking.raised() {
        return Err(error);
    }
    let found = found.map_err(|error| match &error {
        FollowError::Scene(refused) => errors::refused(py, refused),
        FollowError::Run(_) | FollowError::Response(_) => errors::run_error(py, &chain(&error)),
        _ => errors::scene_error(py, &chain(&error)),
    })?;
    found.write(&directory).map_err(|error| errors::of_run(py, &error))
}
