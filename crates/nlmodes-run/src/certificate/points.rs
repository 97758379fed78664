//! The points checked, and those that did not pass.

use std::f64::consts::TAU;

use nlmodes::modal::ModalPoint;
use serde::{Serialize, Serializer};

use super::{Check, NumberError};

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
    pub(crate) fn of(number: usize, point: &ModalPoint) -> Self {
        Self { point: number, frequency_hz: point.listed_omega() / TAU, energy_j: Some(point.kinetic_energy) }
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
pub(super) fn digits(x: f64, behind: usize) -> String {
    nlmodes_scene::significant(x, behind + 1)
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

/// Writes the points of values alone.
#[expect(clippy::ptr_arg, reason = "serde gives the field as it is")]
pub(super) fn of_values<S: Serializer>(values: &Vec<(usize, f64)>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.iter().map(|(point, _)| point))
}

/// A point that did not pass, and what speaks against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointInDoubt {
    /// The point.
    #[serde(flatten)]
    pub place: Place,
    /// The equations that do not hold there, the numbers whose required error is not met, and that no motion with more
    /// harmonics was found next to it.
    pub against: Vec<String>,
}

/// The points at which numbers were compared, ascending.
pub(super) fn compared(checks: &[Check], all: &[Place]) -> Vec<Place> {
    let estimates = checks.iter().filter(|check| check.number.is_some());
    let looked = estimates.flat_map(|check| check.looked.iter().map(|(point, _)| *point));
    let lost = checks.iter().flat_map(|check| check.lost.iter().map(|place| place.point));
    of_all(looked.chain(lost), all)
}

/// Points in order, each once.
fn of_all(points: impl Iterator<Item = usize>, all: &[Place]) -> Vec<Place> {
    let mut points: Vec<usize> = points.collect();
    points.sort_unstable();
    points.dedup();
    points.into_iter().filter_map(|point| all.get(point).copied()).collect()
}

/// The points that did not pass, ascending.
pub(super) fn in_doubt(checks: &[Check], errors: &[NumberError], all: &[Place]) -> Vec<PointInDoubt> {
    let unmet = |point: usize| errors.iter().filter(move |error| error.beyond.contains(&point));
    let against = |point: usize| {
        let failed =
            checks.iter().filter(|check| check.failed().any(|k| k == point)).map(|check| check.name.to_owned());
        let lost = checks.iter().filter(|check| check.lost.iter().any(|place| place.point == point));
        let lost = lost.map(|check| format!("{}: no motion with twice as many leads there and back", check.name));
        let unmet = unmet(point).map(|error| format!("{} beyond the required error", error.number.meaning()));
        let mut all: Vec<String> = failed.chain(lost).chain(unmet).collect();
        all.dedup();
        all
    };
    let failed = checks.iter().flat_map(Check::failed);
    let lost = checks.iter().flat_map(|check| check.lost.iter().map(|place| place.point));
    let unmet = errors.iter().flat_map(|error| error.beyond.iter().copied());
    let places = of_all(failed.chain(lost).chain(unmet), all).into_iter();
    places.map(|place| PointInDoubt { place, against: against(place.point) }).collect()
}
