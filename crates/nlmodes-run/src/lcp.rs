//! Contact problems of one's own, `0 ≤ A λ + b ⊥ λ ≥ 0`, in NumPy archives.

mod archive;
mod error;
mod problem;
mod solution;
mod solve;
mod text;

pub(crate) use archive::Archive;
pub use error::ProblemError;
pub use problem::{Problem, read};
pub use solution::{check_place, write};
pub use solve::{Solved, solve};
