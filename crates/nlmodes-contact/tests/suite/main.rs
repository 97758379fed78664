//! All tests of `nlmodes-contact` beside those in its sources, as one binary: each would link all dependencies once more.

mod conformance;
mod effort;
mod integers;
mod properties;
