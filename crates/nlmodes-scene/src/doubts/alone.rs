//! Degrees of freedom that nothing couples to the others.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::{Subject, short};
use crate::rule::counted;

/// Squared frequencies that differ by less than this share are equal.
const EQUAL: f64 = 1e-12;
/// Nodes that are listed.
const LISTED: usize = 5;

/// Several rows that are coupled to nothing, vibrate at one frequency, and are touched by no contact: programs that
/// take a row out may leave numbers of their own on its two diagonals. A true mass on a spring is as good a guess, and
/// stays.
pub(super) fn doubt(subject: &Subject<'_>) -> Option<String> {
    let (model, alone) = (subject.model, subject.model.rows_alone());
    if alone.iter().all(|alone| *alone) {
        return None;
    }
    let touched = |node: u64| subject.found.iter().any(|contact| contact.node == node || contact.against == Some(node));
    let (stiffness, mass) = (model.stiffness.diagonal(), model.mass.diagonal());
    let is_one = |row: &usize| alone[*row] && mass[*row] > 0.0 && !touched(model.labels[*row].node);
    let mut rows: Vec<(f64, u64)> =
        (0..model.n_dofs()).filter(is_one).map(|row| (stiffness[row] / mass[row], model.labels[row].node)).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = rows.chunk_by(|a, b| b.0 - a.0 <= EQUAL * b.0).max_by_key(|same| same.len())?;
    let nodes: BTreeSet<u64> = most.iter().map(|row| row.1).collect();
    if most.len() < 2 {
        return None;
    }
    let listed: Vec<String> = nodes.iter().take(LISTED).map(u64::to_string).collect();
    let more = if nodes.len() > LISTED { ", …" } else { "" };
    Some(format!(
        "{} degrees of freedom of {} ({}{more}) are coupled to nothing, vibrate at {} Hz each, and no contact touches \
        them: are these rows \
        that the program has taken out, with numbers of its own on both diagonals? Then `fixed` holds their nodes; \
        equal values on both diagonals, or no mass, need nothing",
        most.len(),
        counted(nodes.len(), "node"),
        listed.join(", "),
        short(most[0].0.max(0.0).sqrt() / TAU)
    ))
}
