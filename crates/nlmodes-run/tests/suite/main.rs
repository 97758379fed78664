//! All tests of `nlmodes-run` beside those in its sources, as one binary: each would link all dependencies once more.

mod bodies;
mod overlays;
mod passages;
mod threads;
