//! Numbers of a structure that was reduced elsewhere which may not be what they are taken for.

use std::f64::consts::TAU;

use super::short;
use crate::assemble::{OpenStructure, ReducedElsewhere};

/// A frequency below this share of the next one is that of a rigid-body motion, as solvers leave it.
const NEXT_TO_ZERO: f64 = 1e-3;

/// Rows that may be modes, and rigid-body motions that are not called so.
pub(super) fn doubts(elsewhere: &ReducedElsewhere, open: &OpenStructure) -> Vec<String> {
    [ambiguous(elsewhere), nearly_rigid(open)].into_iter().flatten().collect()
}

fn ambiguous(elsewhere: &ReducedElsewhere) -> Option<String> {
    let n = elsewhere.rows;
    elsewhere.is_ambiguous().then(|| {
        format!(
            "`structure.contact_rows` is {n} × {n}, with as many rows as modes: a line is taken for that of a row, \
            with a number for each mode"
        )
    })
}

fn nearly_rigid(open: &OpenStructure) -> Option<String> {
    let hz: Vec<f64> = open.modes.omega_squared().iter().map(|square| square.sqrt() / TAU).collect();
    let mode = (1..hz.len()).find(|&k| hz[k - 1] > 0.0 && hz[k - 1] < NEXT_TO_ZERO * hz[k])?;
    Some(format!(
        "mode {mode} has {} Hz and the next one {} Hz: enter a rigid-body motion as 0 in `structure.frequencies_hz`",
        short(hz[mode - 1]),
        short(hz[mode])
    ))
}
