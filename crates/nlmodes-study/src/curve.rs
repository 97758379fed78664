//! The branch of a case from its table, quantities of it, and what parameters do to these.

mod between;
mod pick;
mod slope;
mod table;

pub use pick::{Picked, pick};
pub use slope::{DIFFERENTIATED, derivatives};
pub use table::{Curve, CurveError, ENERGY_RATIO, Held, Level, has_numbers};
