//! Which points were looked at, and which of them not to believe.

use serde::Serialize;

use super::{Check, Number, listed};

/// A point that did not pass, and the checks that speak against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointInDoubt {
    /// The point.
    pub point: usize,
    /// Names of the checks, with the number of which each speaks: `harmonics (impulse of each contact)`.
    pub against: Vec<String>,
}

/// The points at which any check looked, ascending.
pub(super) fn looked_at(checks: &[Check]) -> Vec<usize> {
    let mut points: Vec<usize> = checks.iter().flat_map(|check| check.looked.iter().copied()).collect();
    points.sort_unstable();
    points.dedup();
    points
}

/// The points that failed in any check, ascending.
pub(super) fn in_doubt(checks: &[Check]) -> Vec<PointInDoubt> {
    let mut points: Vec<usize> = checks.iter().flat_map(|check| check.failed.iter().copied()).collect();
    points.sort_unstable();
    points.dedup();
    let of = |point: usize| {
        let failed = checks.iter().filter(|check| check.failed.contains(&point));
        let mut against: Vec<String> = failed.map(|check| name(check, point)).collect();
        against.dedup();
        PointInDoubt { point, against }
    };
    points.into_iter().map(of).collect()
}

fn name(check: &Check, point: usize) -> String {
    if check.lost.contains(&point) {
        return format!("{}: no motion with twice as many leads there and back", check.name);
    }
    check
        .number
        .map_or_else(|| check.name.to_owned(), |number: Number| format!("{} ({})", check.name, number.meaning()))
}

/// What is known of the points, behind a verdict; nothing where no check took a point and none failed.
pub(super) fn sentence(all: usize, looked: &[usize], doubted: &[PointInDoubt]) -> String {
    let failed: Vec<usize> = doubted.iter().map(|doubt| doubt.point).collect();
    let not_passed = if failed.is_empty() { String::new() } else { format!(", {} did not pass", listed(&failed)) };
    match (looked.len(), failed.len()) {
        (0, 0) => String::new(),
        (n, _) if n >= all => format!("; all {all} points were looked at{not_passed}"),
        (n, _) => format!("; {n} of {all} points were looked at{not_passed}; of the others nothing is known"),
    }
}
