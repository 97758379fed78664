//! Continuation of algebraic systems whose curves, folds, corners and crossings are known.

mod corners;
mod crossings;
mod ends;
mod samples;
mod smooth;
mod three_free;
mod trees;
