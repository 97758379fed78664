//! The branch of a case as its table has it, and quantities of it.

mod between;
mod pick;
mod table;

pub use pick::{Picked, pick};
pub use table::{Curve, CurveError, ENERGY_RATIO, has_numbers};
