//! All tests of `nlmodes-response` beside those in its sources, as one binary: each would link all dependencies once more.

mod beam;
mod curves;
mod dissipating_stops;
mod free_phase;
mod integrated;
mod limits;
mod limits_of_structures;
