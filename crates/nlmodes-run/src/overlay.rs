//! Results of other runs, and of tests, laid over those of a scene, with the differences in numbers.

mod differences;
mod read;

pub use differences::{Difference, differences, sentence, table, write};
pub use read::{Laid, OverlayError, read};
