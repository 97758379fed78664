//! Assembled structures, compared with closed forms, reference values and invariants.

mod calculix;
mod closed_forms;
mod common;
mod contacts;
mod euler_bernoulli;
mod interpolation;
mod redistribution;
mod reduction;
mod reference_values;
mod rod;
mod slender;
mod stepped;
mod thick;
mod units;
