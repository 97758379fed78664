//! The points checked, and those that did not pass.

use std::f64::consts::TAU;

use nlmodes::modal::ModalPoint;
use serde::{Serialize, Serializer};

use super::{Check, Number, named};

/// A point, and where it is found on the curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// Its number.
    pub point: usize,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Its averaged kinetic energy, J; none where a curve does not go over energy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<f64>,
}

impl Place {
    /// Of a point of a branch.
    pub(super) fn of(number: usize, point: &ModalPoint) -> Self {
        Self { point: number, frequency_hz: point.omega / TAU, energy_j: Some(point.kinetic_energy) }
    }

    /// `7 (66.123 Hz)`.
    pub(super) fn name(&self) -> String {
        format!("{} ({} Hz)", self.point, self.hertz())
    }

    /// Its frequency to six digits.
    pub(super) fn hertz(&self) -> String {
        digits(self.frequency_hz, 5)
    }

    /// Its energy in J to four digits.
    pub(super) fn joule(&self) -> String {
        self.energy_j.map_or_else(|| "–".to_owned(), |energy| digits(energy, 3))
    }
}

/// ` (60.8 to 66.2 Hz)`: the lowest and the highest frequency.
pub(super) fn range(places: &[Place]) -> String {
    let lower = |a: &&Place, b: &&Place| a.frequency_hz.total_cmp(&b.frequency_hz);
    let ends = places.iter().min_by(lower).zip(places.iter().max_by(lower));
    ends.map_or_else(String::new, |(low, high)| format!(" ({} to {} Hz)", low.hertz(), high.hertz()))
}

/// A number with this many digits after the first.
fn digits(x: f64, behind: usize) -> String {
    nlmodes_scene::number(format!("{x:.behind$e}").parse().unwrap_or(x))
}

/// All points of a branch.
pub(super) fn places(points: &[ModalPoint]) -> Vec<Place> {
    points.iter().enumerate().map(|(number, point)| Place::of(number, point)).collect()
}

/// Writes the numbers of points alone.
#[expect(clippy::ptr_arg, reason = "serde gives the field as it is")]
pub(super) fn numbers<S: Serializer>(places: &Vec<Place>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(places.iter().map(|place| place.point))
}

/// A point that did not pass, and the checks that speak against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointInDoubt {
    /// The point.
    #[serde(flatten)]
    pub place: Place,
    /// Names of the checks, with the number to which each applies: `harmonics (impulse of each contact)`.
    pub against: Vec<String>,
}

/// The points of all checks, ascending.
pub(super) fn looked_at(checks: &[Check], all: &[Place]) -> Vec<Place> {
    of_all(checks.iter().flat_map(|check| check.looked.iter().copied()), all)
}

/// Points in order, each once.
fn of_all(points: impl Iterator<Item = usize>, all: &[Place]) -> Vec<Place> {
    let mut points: Vec<usize> = points.collect();
    points.sort_unstable();
    points.dedup();
    points.into_iter().filter_map(|point| all.get(point).copied()).collect()
}

/// The points that failed in any check, ascending.
pub(super) fn in_doubt(checks: &[Check], all: &[Place]) -> Vec<PointInDoubt> {
    let of = |place: Place| {
        let failed = checks.iter().filter(|check| check.failed.contains(&place.point));
        let mut against: Vec<String> = failed.map(|check| name(check, place.point)).collect();
        against.dedup();
        PointInDoubt { place, against }
    };
    of_all(checks.iter().flat_map(|check| check.failed.iter().copied()), all).into_iter().map(of).collect()
}

fn name(check: &Check, point: usize) -> String {
    if check.lost.iter().any(|lost| lost.point == point) {
        return format!("{}: no motion with twice as many leads there and back", check.name);
    }
    check
        .number
        .map_or_else(|| check.name.to_owned(), |number: Number| format!("{} ({})", check.name, number.meaning()))
}

/// Statement on the points, after a verdict; empty without point-wise checks and failures.
pub(super) fn sentence(all: usize, looked: &[Place], doubted: &[PointInDoubt]) -> String {
    let failed: Vec<Place> = doubted.iter().map(|doubt| doubt.place).collect();
    let not_passed = if failed.is_empty() { String::new() } else { format!(", {} did not pass", named(&failed)) };
    match (looked.len(), failed.len()) {
        (0, 0) => String::new(),
        (n, _) if n >= all => format!("; all {all} points were looked at{not_passed}"),
        (n, _) => format!("; {n} of {all} points were looked at{not_passed}; of the others nothing is known"),
    }
}
