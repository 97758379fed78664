//! All tests of `nlmodes-report` beside those in its sources, as one binary: each would link all dependencies once
//! more.

mod browser;
#[cfg(feature = "print")]
mod print;
mod report;
