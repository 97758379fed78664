//! All tests of `nlmodes-reduction` beside those in its sources, as one binary: each would link all dependencies once
//! more.

mod few_digits;
mod given;
mod held_modes;
mod open_modes;
mod rest;
