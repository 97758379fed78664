//! All tests of `nlmodes-run` beside those in its sources, in one binary, so that the dependencies are linked only
//! once.

mod bodies;
mod curves;
mod overlays;
mod passages;
mod threads;
