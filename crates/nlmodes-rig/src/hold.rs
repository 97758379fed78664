use nlmodes_experiment::phase_loop::AppropriationState;

use crate::error::positive;
use crate::{Finding, RigError};

/// Duration of a level: until lag, drift and periodicity are all within tolerance.
///
/// Judged on windows of whole periods; drift is the slope of a straight line through the last windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// Periods per window.
    pub periods: usize,
    /// Number of windows considered together.
    pub windows: usize,
    /// Largest deviation of the lag from its target, rad.
    pub lag: f64,
    /// Largest relative drift of the frequency, 1/s.
    pub frequency_drift: f64,
    /// Largest relative drift of the response, 1/s.
    pub amplitude_drift: f64,
    /// Largest relative difference between a period and the mean one.
    pub spread: f64,
    /// Largest deviation of a controlled harmonic of the force, relative to the fundamental.
    pub harmonics: f64,
    /// Longest time, s. After it the level is recorded as it is, with the deviations among its findings.
    pub longest: f64,
}

impl Default for Hold {
    /// Six windows of 20 periods, 0.02 degrees, 3e-6/s, 3e-4/s, 1 %, 0.1 % for controlled harmonics, and at most 40 s.
    fn default() -> Self {
        Self {
            periods: 20,
            windows: 6,
            lag: 0.02_f64.to_radians(),
            frequency_drift: 3e-6,
            amplitude_drift: 3e-4,
            spread: 0.01,
            harmonics: 1e-3,
            longest: 40.0,
        }
    }
}

/// Means over some periods of the steady state, or of the unsteady motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SteadyState {
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Lag of the response behind the force, rad, from the measured signals.
    pub lag: f64,
    /// Amplitude of the fundamental of the force, N.
    pub force: f64,
    /// Amplitude of the fundamental of the response, in its unit.
    pub response: f64,
    /// Relative root mean square difference of single periods from the mean one.
    pub spread: f64,
}

/// Outcome of holding a level.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Settling {
    /// Duration, s.
    pub duration: f64,
    /// Mean of the last windows.
    pub steady: SteadyState,
    /// Remaining deviations; empty if settled.
    pub findings: Vec<Finding>,
}

impl Hold {
    pub(crate) fn check(&self) -> Result<(), RigError> {
        positive("periods a window", self.periods as f64)?;
        positive("number of windows less one", self.windows as f64 - 1.0)?;
        positive("lag tolerance (rad)", self.lag)?;
        positive("tolerance of the frequency drift (1/s)", self.frequency_drift)?;
        positive("tolerance of the amplitude drift (1/s)", self.amplitude_drift)?;
        positive("tolerance of the periodicity", self.spread)?;
        positive("tolerance of controlled harmonics", self.harmonics)?;
        positive("longest hold (s)", self.longest).map(drop)
    }

    /// Findings of the last windows, each `length` seconds long.
    pub(crate) fn judge(&self, windows: &[SteadyState], target: f64, length: f64) -> Vec<Finding> {
        let error = mean(windows, |w| w.lag - target);
        let omega = slope(windows, length, |w| w.omega) / mean(windows, |w| w.omega);
        let response = slope(windows, length, |w| w.response) / mean(windows, |w| w.response);
        let spread = windows.iter().map(|w| w.spread).fold(0.0, f64::max);
        // Formulated such that NaN is a finding.
        let within = |value: f64, tolerance: f64| value.abs() <= tolerance;
        [
            (within(error, self.lag), Finding::NotLocked { error }),
            (within(omega, self.frequency_drift), Finding::FrequencyDrift { rate: omega }),
            (within(response, self.amplitude_drift), Finding::AmplitudeDrift { rate: response }),
            (within(spread, self.spread), Finding::Aperiodic { spread }),
        ]
        .into_iter()
        .filter_map(|(good, finding)| (!good).then_some(finding))
        .collect()
    }
}

impl Hold {
    /// Deviations of the controlled harmonics, each as its mean error relative to the fundamental.
    pub(crate) fn judge_harmonics(&self, off: &[f64], control: &AppropriationState) -> Vec<Finding> {
        let one = |(index, &error): (usize, &f64)| {
            let harmonic = index + 1;
            if control.is_limited(harmonic) {
                return Some(Finding::HarmonicLimit { harmonic });
            }
            // Formulated such that NaN is a finding.
            let within = error <= self.harmonics;
            (!within).then_some(Finding::HarmonicNotReached { harmonic, error })
        };
        off.iter().enumerate().skip(1).filter_map(one).collect()
    }

    /// Findings of a record that follows a hold. One window alone is noisier than their mean: three times the lag
    /// tolerance.
    pub(crate) fn judge_record(&self, record: &SteadyState, target: f64) -> Vec<Finding> {
        let (error, spread) = (record.lag - target, record.spread);
        let mut findings = Vec::new();
        if error.is_nan() || error.abs() > 3.0 * self.lag {
            findings.push(Finding::NotLocked { error });
        }
        if spread.is_nan() || spread > self.spread {
            findings.push(Finding::Aperiodic { spread });
        }
        findings
    }
}

impl SteadyState {
    /// Mean over windows of equal length.
    pub(crate) fn mean(windows: &[Self]) -> Self {
        Self {
            omega: mean(windows, |w| w.omega),
            lag: mean(windows, |w| w.lag),
            force: mean(windows, |w| w.force),
            response: mean(windows, |w| w.response),
            spread: windows.iter().map(|w| w.spread).fold(0.0, f64::max),
        }
    }
}

fn mean(windows: &[SteadyState], value: impl Fn(&SteadyState) -> f64) -> f64 {
    windows.iter().map(value).sum::<f64>() / windows.len() as f64
}

/// Slope of the least-squares line through values with spacing `length`.
fn slope(windows: &[SteadyState], length: f64, value: impl Fn(&SteadyState) -> f64) -> f64 {
    let middle = 0.5 * (windows.len() as f64 - 1.0);
    let (mut product, mut square) = (0.0, 0.0);
    for (k, window) in windows.iter().enumerate() {
        let t = k as f64 - middle;
        product += t * value(window);
        square += t * t;
    }
    product / (square * length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_slope_and_each_departure_its_name() {
        let window = |k: f64| SteadyState {
            omega: 250.0 + 0.25 * k,
            lag: 1.6,
            force: 1.0,
            response: 1.0 - 0.01 * k,
            spread: 0.1,
        };
        let windows: Vec<SteadyState> = (0..5).map(|k| window(f64::from(k))).collect();
        assert!((slope(&windows, 0.5, |w| w.omega) - 0.5).abs() < 1e-12);
        let found = Hold::default().judge(&windows, 1.5, 0.5);
        let names: Vec<&str> = found.iter().map(Finding::name).collect();
        assert_eq!(names, ["not-locked", "frequency-drift", "amplitude-drift", "aperiodic"]);
        assert!(matches!(found[0], Finding::NotLocked { error } if (error - 0.1).abs() < 1e-12));
        assert!(matches!(found[2], Finding::AmplitudeDrift { rate } if (rate + 0.02 / 0.98).abs() < 1e-12));
    }
}
