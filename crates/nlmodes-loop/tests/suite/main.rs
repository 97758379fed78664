//! All tests of `nlmodes-loop` beside those in its sources, as one binary.

mod phase_loop;
mod test_control;
