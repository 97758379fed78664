//! `nlmodes.verify`: one period of the full structure from a computed point.

use std::path::PathBuf;

use nlmodes_run::chain;
use nlmodes_run::verify::{Exact, Found, Point, VerifyError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// What is missing after a period of the motion of a point, and the exact motion beside it.
#[pyfunction]
pub fn verify(py: Python<'_>, directory: PathBuf, point: usize) -> PyResult<Bound<'_, PyDict>> {
    let found = errors::computed(py, || -> Result<Found, VerifyError> {
        Ok(nlmodes_run::verify::verify(&Point::read(&directory, point)?)?)
    })?;
    let found = found.map_err(|error| errors::run_error(py, &format!("{}: {}", directory.display(), chain(&error))))?;
    let (dict, v) = (PyDict::new(py), &found.verification);
    dict.set_item("modes", found.modes)?;
    dict.set_item("period_s", v.period)?;
    dict.set_item("energy_j", v.energy)?;
    dict.set_item("energy_norm", v.energy_norm)?;
    dict.set_item("displacement", v.displacement)?;
    dict.set_item("velocity", v.velocity)?;
    dict.set_item("energy_drift", v.energy_drift)?;
    dict.set_item("peak_contact_force_n", v.peak_force)?;
    dict.set_item("contact_intervals", v.n_intervals)?;
    dict.set_item("contact_fraction", v.closed_share.clone())?;
    dict.set_item("exact", found.exact.map(|exact| of_exact(py, exact)).transpose()?)?;
    Ok(dict)
}

fn of_exact(py: Python<'_>, exact: Result<Exact, nlmodes::timestep::TimestepError>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    match exact {
        Ok(exact) => {
            dict.set_item("frequency_hz", exact.motion.omega / std::f64::consts::TAU)?;
            dict.set_item("largest_multiplier", exact.largest_multiplier)?;
            dict.set_item("stable", exact.stable)?;
        }
        Err(error) => dict.set_item("not_found", error.to_string())?,
    }
    Ok(dict)
}
