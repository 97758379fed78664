//! All tests of `nlmodes-study` beside those in its sources, as one binary: each would link all dependencies once more.

mod first_order;
mod fit;
mod oscillator;
mod responses;
mod schemas;
mod serve;
mod studies;
