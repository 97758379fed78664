//! All tests of `nlmodes-model` beside those in its sources, as one binary: each would link all dependencies once
//! more.

mod beams_and_springs;
mod direction;
mod few_digits;
mod given;
