//! Signals that stay at a limit.

use crate::extraction::Finding;
use crate::records::Channel;

/// A run of equal samples at an extreme counts as clipped from this share of a period on: a sine clipped by one part in a thousand.
const PLATEAU: f64 = 0.014;
/// Fewest samples of such a run.
const SHORTEST: usize = 4;

/// Reports samples at the limits of the sensor's range, or, where that is unknown, runs of equal samples at the extremes of the signal.
pub fn check(channel: &Channel, samples: &[f64], samples_per_period: f64, findings: &mut Vec<Finding>) {
    let name = || channel.name.clone();
    if let Some([low, high]) = channel.si_range() {
        // Rounding of the conversion must not hide a sample that is at the limit.
        let slack = 1e-9 * (high - low).abs();
        for (limit, beyond) in [
            (low, samples.iter().filter(|x| **x <= low + slack).count()),
            (high, samples.iter().filter(|x| **x >= high - slack).count()),
        ] {
            if beyond > 0 {
                findings.push(Finding::Clipped { channel: name(), samples: beyond, limit });
            }
        }
        return;
    }
    let longest = ((PLATEAU * samples_per_period) as usize).max(SHORTEST);
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for limit in [low, high] {
        // A force that rests at zero is open, not clipped; a constant signal has other troubles.
        let at_limit = if limit == 0.0 || low == high { 0 } else { in_runs(samples, limit, longest) };
        if at_limit > 0 {
            findings.push(Finding::Clipped { channel: name(), samples: at_limit, limit });
        }
    }
}

/// Samples that equal the limit, in runs of at least this length.
fn in_runs(samples: &[f64], limit: f64, shortest: usize) -> usize {
    let runs = samples.split(|x| *x != limit);
    runs.map(<[f64]>::len).filter(|length| *length >= shortest).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{Quantity, Role};

    fn found(limit: f64, range: Option<[f64; 2]>) -> Vec<Finding> {
        let mut channel = Channel::new("x", Quantity::Displacement, Role::Response, None);
        channel.range = range;
        let wave = |j: u32| (0.0126 * f64::from(j)).cos().min(limit);
        let samples: Vec<f64> = (0..5000).map(wave).collect();
        let mut findings = vec![];
        check(&channel, &samples, std::f64::consts::TAU / 0.0126, &mut findings);
        findings
    }

    #[test]
    fn clipped_sines_are_seen_and_others_not() {
        assert!(found(2.0, None).is_empty());
        assert!(found(2.0, Some([-1.5, 1.5])).is_empty());
        assert!(
            matches!(found(0.99, None)[..], [Finding::Clipped { samples, limit, .. }] if samples > 200 && limit == 0.99)
        );
        assert!(matches!(found(0.99, Some([-1.5, 0.99]))[..], [Finding::Clipped { limit, .. }] if limit == 0.99));
    }
}
