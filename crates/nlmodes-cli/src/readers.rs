//! Readers of files that come back, for `fuzz/`; no part of the interface.

use std::path::Path;

pub use crate::run::repeated::{Interrupted, Left};

use crate::run::chain;
use crate::verify::results::Point;
use crate::{lcp, verify};

/// Reads contact problems, as `nlmodes-cli lcp` does; the number of samples.
///
/// # Errors
/// The message.
pub fn contact_problem(path: &Path) -> Result<usize, String> {
    lcp::problem::read(path).map(|problem| problem.n_samples()).map_err(|error| chain(&error))
}

/// Reads a point of a run, as `nlmodes-cli verify` does; the number of its degrees of freedom.
///
/// # Errors
/// The message.
pub fn point(directory: &Path, number: usize) -> Result<usize, String> {
    let read: Result<Point, verify::error::VerifyError> = Point::read(directory, number);
    read.map(|point| point.coefficients.n_coordinates()).map_err(|error| chain(&error))
}
