//! All tests of `nlmodes-experiment` beside those in its sources, as one binary: each would link all dependencies once
//! more.

mod disturbed;
mod disturbed_more;
mod files;
mod findings;
mod headers;
mod impacts;
mod known_answers;
mod malformed;
mod pyuff;
mod slips;
mod support;
mod tdms;
mod time_stamps;
mod uff;
mod units;
