use crate::noise::noise_level;
use crate::{ModalError, TimeHistory};

/// The contact is closed if its force exceeds this many standard deviations of its noise …
const NOISE_FACTOR: f64 = 6.0;
/// … and this fraction of its peak.
const PEAK_SHARE: f64 = 0.02;
/// Contact is not interrupted if the force is below the threshold for fewer samples than this.
const SHORTEST_GAP: usize = 3;

/// A time span in which a contact is closed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactInterval {
    /// Instant of closing, s.
    pub touching: f64,
    /// Instant of opening, s.
    pub leaving: f64,
    /// First sample within.
    pub first: usize,
    /// Last sample within.
    pub last: usize,
}

/// Closed intervals of a time history that begin and end within it.
///
/// They follow from the instants in the history, as in a computed one, or otherwise from its force: a contact is closed
/// if the force exceeds six standard deviations of the noise and a fiftieth of the peak, and the instants are the zeros
/// of the force, extrapolated linearly.
///
/// # Errors
/// [`ModalError::HistoryLength`], [`ModalError::NotFinite`], [`ModalError::NoContact`].
pub fn contact_intervals(history: &TimeHistory) -> Result<Vec<ContactInterval>, ModalError> {
    check(history)?;
    let threshold = closed_force(&history.force);
    let intervals = if history.instants.is_empty() { from_force(history, threshold) } else { from_instants(history) };
    if intervals.is_empty() {
        let peak = history.force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        return Err(ModalError::NoContact { peak, threshold });
    }
    Ok(intervals)
}

/// Force above which a contact is closed, N.
pub fn closed_force(force: &[f64]) -> f64 {
    let peak = force.iter().copied().fold(0.0, f64::max);
    (NOISE_FACTOR * noise_level(force)).max(PEAK_SHARE * peak)
}

fn check(history: &TimeHistory) -> Result<(), ModalError> {
    let lengths = [&history.time, &history.displacement, &history.velocity, &history.force].map(Vec::len);
    let needed = 8;
    if lengths.iter().any(|n| *n != lengths[0]) || lengths[0] < needed {
        let [time, displacement, velocity, force] = lengths;
        return Err(ModalError::HistoryLength { needed, time, displacement, velocity, force });
    }
    let mut series = [&history.time, &history.displacement, &history.velocity, &history.force].into_iter().flatten();
    if series.all(|x| x.is_finite()) { Ok(()) } else { Err(ModalError::NotFinite { what: "time history" }) }
}

fn from_instants(history: &TimeHistory) -> Vec<ContactInterval> {
    let pairs = history.instants.windows(2).filter(|pair| pair[0].touching && !pair[1].touching);
    let interval = |(touching, leaving): (f64, f64)| {
        let first = history.time.partition_point(|t| *t < touching);
        let last = history.time.partition_point(|t| *t <= leaving).checked_sub(1)?;
        (first <= last).then_some(ContactInterval { touching, leaving, first, last })
    };
    pairs.filter_map(|pair| interval((pair[0].time, pair[1].time))).collect()
}

fn from_force(history: &TimeHistory, threshold: f64) -> Vec<ContactInterval> {
    let n = history.force.len();
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (j, _) in history.force.iter().enumerate().filter(|(_, force)| **force > threshold && threshold >= 0.0) {
        match runs.last_mut() {
            Some((_, last)) if j - *last <= SHORTEST_GAP => *last = j,
            _ => runs.push((j, j)),
        }
    }
    let whole = runs.into_iter().filter(|(first, last)| *first > 0 && *last + 1 < n && last > first);
    whole.map(|(first, last)| interval(history, first, last)).collect()
}

/// The instants are between the last open sample and the first closed one, and likewise at the other end.
fn interval(history: &TimeHistory, first: usize, last: usize) -> ContactInterval {
    let touching = zero_before(history, first, first + 1).clamp(history.time[first - 1], history.time[first]);
    let leaving = zero_before(history, last, last - 1).clamp(history.time[last], history.time[last + 1]);
    ContactInterval { touching, leaving, first, last }
}

/// Zero of the line through the forces of two samples; the instant of the outer one if they do not rise inward.
fn zero_before(history: &TimeHistory, outer: usize, inner: usize) -> f64 {
    let (time, force) = (&history.time, &history.force);
    let rise = force[inner] - force[outer];
    if rise <= 0.0 {
        return time[outer] + 0.5 * (time[outer] - time[inner]);
    }
    time[outer] - force[outer] * (time[inner] - time[outer]) / rise
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a force every 0.5 s.
    fn history(force: &[f64], unit: f64) -> TimeHistory {
        let mut history = TimeHistory::empty("", 1.0);
        for (j, force) in force.iter().enumerate() {
            history.push(0.5 * j as f64, [0.0; 3], force * unit);
        }
        history
    }

    #[test]
    fn instants_are_where_the_line_through_the_outer_two_samples_comes_to_zero_in_any_unit_of_force() {
        let mut force = vec![0.0; 40];
        force[10..16].copy_from_slice(&[20.0, 60.0, 70.0, 65.0, 55.0, 50.0]);
        for unit in [1.0, 1e-6, 1e6] {
            let found = contact_intervals(&history(&force, unit)).unwrap();
            assert_eq!(found.len(), 1);
            assert_eq!((found[0].first, found[0].last), (10, 15));
            // Rises by 40 in half a second; the line at the other end would reach zero beyond the next sample.
            assert!((found[0].touching - (5.0 - 0.25)).abs() < 1e-13, "{found:?}");
            assert!((found[0].leaving - 8.0).abs() < 1e-13, "{found:?}");
        }
    }

    #[test]
    fn a_contact_is_whole_if_a_sample_on_either_side_is_open() {
        let mut force = vec![0.0; 40];
        force[1..4].fill(5.0);
        force[20..39].fill(4.0);
        let found = contact_intervals(&history(&force, 1.0)).unwrap();
        assert_eq!(found.iter().map(|i| [i.first, i.last]).collect::<Vec<_>>(), [[1, 3], [20, 38]]);
        (force[0], force[39]) = (5.0, 4.0);
        assert!(matches!(contact_intervals(&history(&force, 1.0)), Err(ModalError::NoContact { peak: 5.0, .. })));
    }
}
