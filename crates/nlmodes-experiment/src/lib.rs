//! Measured records to nonlinear modes: signals in, modal frequency, shape, damping and mode indicator out.

pub mod extraction;
pub mod phase_loop;
pub mod records;
