//! All tests of `nlmodes-response` beside those in its sources, in one binary, so that the dependencies are linked only
//! once.

mod beam;
mod curves;
mod dissipating_stops;
mod finer;
mod floating;
mod free_phase;
mod gradients;
mod integrated;
mod limits;
mod limits_of_structures;
