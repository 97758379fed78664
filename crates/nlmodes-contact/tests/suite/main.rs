//! All tests of `nlmodes-contact` beside those in its sources, in one binary, so that the dependencies are linked only
//! once.

mod conformance;
mod effort;
mod integers;
mod properties;
