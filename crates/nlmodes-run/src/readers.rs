//! Readers of files that come back, for `fuzz/`; no part of the interface.

use std::path::Path;

pub use crate::branches::repeated::{Interrupted, Left};

use crate::chain;
use crate::lcp;
use crate::verify::{Point, VerifyError};

/// Reads contact problems, as `nlmodes-cli lcp` does; the number of samples.
///
/// # Errors
/// The message.
pub fn contact_problem(path: &Path) -> Result<usize, String> {
    lcp::read(path).map(|problem| problem.n_samples()).map_err(|error| chain(&error))
}

/// Reads a point of a run, as `nlmodes-cli verify` does; the number of its degrees of freedom.
///
/// # Errors
/// The message.
pub fn point(directory: &Path, number: usize) -> Result<usize, String> {
    let read: Result<Point, VerifyError> = Point::read(directory, number);
    read.map(|point| point.coefficients.n_coordinates()).map_err(|error| chain(&error))
}
