//! The points of a design, one for each number; the kinds of designs are in `crate::study`.

mod points;
mod random;
mod sobol;
mod tolerance;

pub use points::{Points, n_listed};
pub use sobol::MAX_DIMENSIONS;
