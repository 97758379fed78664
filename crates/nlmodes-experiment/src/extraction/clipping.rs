//! Signals that stay at a limit.

use crate::extraction::Finding;
use crate::records::Channel;

/// A run of equal samples at an extreme counts as clipped from this share of a period on: a sine clipped by one part in
/// a thousand.
const PLATEAU: f64 = 0.014;
/// Factor on the time for which a coarse converter holds the top of a sine.
const COARSE: f64 = 2.0;
/// Fewest steps of a converter.
const FEWEST_STEPS: usize = 8;
/// Samples that show the steps of a converter.
const ENOUGH: usize = 1 << 17;
/// Fewest samples of such a run.
const SHORTEST: usize = 4;

/// Reports samples at the limits of the sensor's range, or, where that is unknown, runs of equal samples at the
/// extremes of the signal.
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
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // A coarse converter holds the top of a sine of half the range for `√(2 step/A)/π` of a period.
    let coarse = COARSE * (4.0 * step(samples) / (high - low)).sqrt() / std::f64::consts::PI;
    let longest = ((PLATEAU.max(coarse) * samples_per_period) as usize).max(SHORTEST);
    for limit in [low, high] {
        // A force that rests at zero is open, not clipped; a constant signal has other troubles.
        let at_limit = if limit == 0.0 || low == high { 0 } else { in_runs(samples, limit, longest) };
        if at_limit > 0 {
            findings.push(Finding::Clipped { channel: name(), samples: at_limit, limit });
        }
    }
}

/// Smallest difference between values that differ, where there are few of them: the step of a coarse converter; else
/// zero.
fn step(samples: &[f64]) -> f64 {
    let samples = &samples[samples.len().saturating_sub(ENOUGH)..];
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let steps: Vec<f64> =
        sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-9 * largest).collect();
    let is_coarse = steps.len() >= FEWEST_STEPS && 2 * steps.len() < samples.len();
    steps.into_iter().reduce(f64::min).filter(|_| is_coarse).unwrap_or(0.0)
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

    /// A converter of 40 to 400 steps over the signal is coarse, not clipped; one that is clipped as well is.
    #[test]
    fn a_coarse_converter_is_not_clipped() {
        let found = |steps: f64, limit: f64| {
            let channel = Channel::new("x", Quantity::Displacement, Role::Response, None);
            let wave = |j: u32| ((0.0126 * f64::from(j)).cos().min(limit) * 0.5 * steps).round() / steps;
            let samples: Vec<f64> = (0..5000).map(wave).collect();
            let mut findings = vec![];
            check(&channel, &samples, std::f64::consts::TAU / 0.0126, &mut findings);
            findings.len()
        };
        for steps in [40.0, 100.0, 400.0] {
            assert_eq!((found(steps, 2.0), found(steps, 0.3)), (0, 1), "{steps}");
        }
    }

    #[test]
    fn a_sample_that_rounding_leaves_short_of_a_known_limit_is_at_it() {
        for (scale, inside) in [(1.0, 1e-12), (1e-6, 1e-18), (1e6, 1e-6)] {
            let mut channel = Channel::new("x", Quantity::Displacement, Role::Response, None);
            channel.range = Some([-scale, scale]);
            let samples = [0.0, scale - inside, 0.5 * scale, inside - scale, inside - scale, 0.999_99 * scale];
            let mut findings = vec![];
            check(&channel, &samples, 100.0, &mut findings);
            let found: Vec<(usize, f64)> = findings
                .iter()
                .map(|finding| match finding {
                    Finding::Clipped { samples, limit, .. } => (*samples, *limit),
                    other => panic!("{other}"),
                })
                .collect();
            assert_eq!(found, [(2, -scale), (1, scale)]);
        }
    }

    #[test]
    fn plateaus_count_from_their_length_on_and_rest_at_zero_is_none() {
        let found = |samples: &[f64], samples_per_period: f64| {
            let mut findings = vec![];
            let channel = Channel::new("f", Quantity::Force, Role::Contact, None);
            check(&channel, samples, samples_per_period, &mut findings);
            findings.len()
        };
        let plateau = |length: usize| [vec![0.0, -1.0, 0.5], vec![2.0; length], vec![0.25]].concat();
        // Four samples at least, else 0.014 of a period.
        assert_eq!([3, 4].map(|length| found(&plateau(length), 100.0)), [0, 1]);
        assert_eq!([13, 14].map(|length| found(&plateau(length), 1000.0)), [0, 1]);
        assert_eq!(found(&[vec![0.0; 50], vec![0.3, 1.0, 0.3]].concat(), 53.0), 0, "an open contact");
        assert_eq!(found(&[7.0; 50], 50.0), 0, "a constant");
    }
}
