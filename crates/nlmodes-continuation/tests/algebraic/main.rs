//! Continuation of algebraic systems whose curves, folds, corners and crossings are known.

mod bends;
mod cells;
mod corners;
mod crossings;
mod effort;
mod ends;
mod onsets;
mod pieces;
mod resumed;
mod rounding;
mod samples;
mod seen;
mod several;
mod smooth;
mod sparse;
mod three_free;
mod trees;
mod units;
