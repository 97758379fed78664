//! The branch of a case from its table, and quantities of it.

mod between;
mod pick;
mod table;

pub use pick::{Picked, pick};
pub use table::{Curve, CurveError, ENERGY_RATIO, Level, has_numbers};
