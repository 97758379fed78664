//! All tests of `nlmodes-timestep` beside those in its sources, as one binary: each would link all dependencies once
//! more.

mod against_ms_hbm;
mod bouncing;
mod contact_figures;
mod forced;
mod global_problem;
mod invariants;
mod laws;
mod mode_shooting;
mod rigid_bodies;
mod stability;
mod support;
mod three_element_rod;
mod transient;
mod two_element_rod;
