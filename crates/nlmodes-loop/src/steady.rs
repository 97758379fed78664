use crate::PhaseLoopError;
use crate::error::{not_negative, positive};

/// Most windows that are considered together.
pub const MAX_WINDOWS: usize = 16;

/// When a level is steady, judged on windows of whole periods against the noise that they show themselves.
///
/// ```text
/// y_k = ȳ + b t_k + r_k ,   s² = Σ r_k² / (n − 2)            a line through the means y_k of the last n windows
/// |ȳ| ≤ tolerance + c s / √n                                 for the lag error and the controlled amplitude
/// |b| ≤ tolerance + c s / √(Σ t_k²)                          for the drifts of frequency and response
/// ```
///
/// So a noisy sensor delays no level for ever, and a quiet one is held to the tolerances. What is not seen: a drift
/// below `c` standard errors of its slope. The windows are taken to be independent; the control makes those of lag and
/// frequency alternate, so that their errors are rather overestimated.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyCriteria {
    /// Periods a window.
    pub periods: usize,
    /// Number of windows `n`, from 3 to [`MAX_WINDOWS`].
    pub windows: usize,
    /// Largest deviation of the lag from its target, rad.
    pub lag: f64,
    /// Largest relative drift of the frequency, 1/s.
    pub frequency_drift: f64,
    /// Largest relative drift of the response, 1/s.
    pub amplitude_drift: f64,
    /// Largest relative deviation of a controlled amplitude from its level.
    pub amplitude: f64,
    /// Standard errors `c` that are let through beyond each tolerance.
    pub confidence: f64,
    /// Longest time, s: after it the level is recorded as it is, and counts as not settled.
    pub longest: f64,
}

impl Default for SteadyCriteria {
    /// Six windows of 20 periods, 0.02 degrees, 3e-6/s, 3e-4/s, 0.1 % of a controlled amplitude, three standard errors,
    /// at most 40 s.
    fn default() -> Self {
        Self {
            periods: 20,
            windows: 6,
            lag: 0.02_f64.to_radians(),
            frequency_drift: 3e-6,
            amplitude_drift: 3e-4,
            amplitude: 1e-3,
            confidence: 3.0,
            longest: 40.0,
        }
    }
}

impl SteadyCriteria {
    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        positive("periods a window", self.periods as f64)?;
        if !(3..=MAX_WINDOWS).contains(&self.windows) {
            return Err(PhaseLoopError::Windows { windows: self.windows, least: 3, most: MAX_WINDOWS });
        }
        not_negative("lag tolerance (rad)", self.lag)?;
        not_negative("tolerance of the frequency drift (1/s)", self.frequency_drift)?;
        not_negative("tolerance of the amplitude drift (1/s)", self.amplitude_drift)?;
        not_negative("tolerance of the controlled amplitude", self.amplitude)?;
        not_negative("standard errors", self.confidence)?;
        positive("longest hold (s)", self.longest).map(drop)
    }

    /// Judges the windows, `length` seconds each.
    fn judge(&self, windows: &Windows, length: f64) -> Drifts {
        let line = |of: fn(&Means) -> f64| Line::through(windows, self.windows, of);
        let (lag, omega) = (line(|w| w.lag_error), line(|w| w.omega));
        let (response, deviation) = (line(|w| w.response), line(|w| w.deviation));
        let drift = |line: &Line| [line.slope / (line.mean * length), line.slope_error / (line.mean.abs() * length)];
        let ([frequency, frequency_error], [amplitude, amplitude_error]) = (drift(&omega), drift(&response));
        // Formulated such that NaN is not settled.
        let within = |value: f64, tolerance: f64, error: f64| value.abs() <= tolerance + self.confidence * error;
        Drifts {
            lag_error: lag.mean,
            lag_noise: lag.mean_error,
            frequency_drift: frequency,
            frequency_noise: frequency_error,
            amplitude_drift: amplitude,
            amplitude_noise: amplitude_error,
            amplitude_deviation: deviation.mean,
            settled: within(lag.mean, self.lag, lag.mean_error)
                && within(frequency, self.frequency_drift, frequency_error)
                && within(amplitude, self.amplitude_drift, amplitude_error)
                && within(deviation.mean, self.amplitude, deviation.mean_error),
        }
    }
}

/// How steady the last windows are; all zero before there are enough of them.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drifts {
    /// Mean deviation of the lag from its target, rad.
    pub lag_error: f64,
    /// Its standard error, rad.
    pub lag_noise: f64,
    /// Relative drift of the frequency, 1/s.
    pub frequency_drift: f64,
    /// Its standard error, 1/s.
    pub frequency_noise: f64,
    /// Relative drift of the response, 1/s.
    pub amplitude_drift: f64,
    /// Its standard error, 1/s.
    pub amplitude_noise: f64,
    /// Relative deviation of a controlled amplitude from its level.
    pub amplitude_deviation: f64,
    /// Whether all are within tolerance and noise.
    pub settled: bool,
}

/// Means over a window, or sums while it lasts.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Means {
    pub(crate) lag_error: f64,
    pub(crate) omega: f64,
    pub(crate) response: f64,
    pub(crate) deviation: f64,
}

impl Means {
    const ZERO: Self = Self { lag_error: 0.0, omega: 0.0, response: 0.0, deviation: 0.0 };

    fn plus(self, other: Self, factor: f64) -> Self {
        Self {
            lag_error: self.lag_error + factor * other.lag_error,
            omega: self.omega + factor * other.omega,
            response: self.response + factor * other.response,
            deviation: self.deviation + factor * other.deviation,
        }
    }
}

/// The last windows of a level, and the one that is being filled.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Windows {
    sum: Means,
    samples: u64,
    /// Those of them that were measured.
    measured: u64,
    /// Beginnings of periods since the hold began: the first window begins with the first.
    periods: usize,
    last: [Means; MAX_WINDOWS],
    count: usize,
}

impl Windows {
    pub(crate) const EMPTY: Self =
        Self { sum: Means::ZERO, samples: 0, measured: 0, periods: 0, last: [Means::ZERO; MAX_WINDOWS], count: 0 };

    /// Adds a sample, none where nothing could be measured; `wrapped` where a new period begins with it. The judgement if a window is complete, and there
    /// are enough.
    pub(crate) fn push(
        &mut self,
        settings: &SteadyCriteria,
        sample: Option<Means>,
        wrapped: bool,
        step: f64,
    ) -> Option<Drifts> {
        let mut judged = None;
        if wrapped {
            if self.periods >= settings.periods {
                let length = self.samples as f64 * step;
                // A window of which less than half was measured has no mean.
                let share = if 2 * self.measured > self.samples { 1.0 / self.measured as f64 } else { f64::NAN };
                self.keep(Means::ZERO.plus(self.sum, share), settings.windows);
                judged = (self.count >= settings.windows).then(|| settings.judge(self, length));
                self.periods = 0;
            }
            if self.periods == 0 {
                (self.sum, self.samples, self.measured) = (Means::ZERO, 0, 0);
            }
            self.periods += 1;
        }
        if self.periods > 0 {
            self.samples = self.samples.saturating_add(1);
            if let Some(sample) = sample {
                self.sum = self.sum.plus(sample, 1.0);
                self.measured = self.measured.saturating_add(1);
            }
        }
        judged
    }

    /// The last `n` windows, the newest at the end.
    fn keep(&mut self, window: Means, n: usize) {
        if self.count >= n {
            let later = self.last;
            self.last.iter_mut().zip(later.iter().skip(1)).for_each(|(mine, next)| *mine = *next);
            self.count = n.saturating_sub(1);
        }
        if let Some(place) = self.last.get_mut(self.count) {
            *place = window;
            self.count += 1;
        }
    }
}

/// Least squares line through values at equal distances.
struct Line {
    mean: f64,
    mean_error: f64,
    /// Per window.
    slope: f64,
    slope_error: f64,
}

impl Line {
    fn through(windows: &Windows, n: usize, of: fn(&Means) -> f64) -> Self {
        let values = || windows.last.iter().take(n).map(of);
        let middle = 0.5 * (n as f64 - 1.0);
        let at = |k: usize| k as f64 - middle;
        // Differences from the first: a frequency is large against its changes.
        let [first, ..] = &windows.last;
        let base = of(first);
        let rest = values().map(|y| y - base).sum::<f64>() / n as f64;
        let square: f64 = (0..n).map(|k| at(k) * at(k)).sum();
        let slope = values().enumerate().map(|(k, y)| at(k) * (y - base)).sum::<f64>() / square;
        let residual = |(k, y): (usize, f64)| (y - base) - rest - slope * at(k);
        let variance =
            values().enumerate().map(|value| residual(value) * residual(value)).sum::<f64>() / (n as f64 - 2.0);
        Self {
            mean: base + rest,
            mean_error: libm::sqrt(variance / n as f64),
            slope,
            slope_error: libm::sqrt(variance / square),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 1e-3;

    /// Periods of ten samples with these means; the judgements.
    fn judged(settings: &SteadyCriteria, of: impl Fn(f64, usize) -> Option<Means>, periods: usize) -> Vec<Drifts> {
        let mut windows = Windows::EMPTY;
        let one = |k: usize| windows.push(settings, of(STEP * k as f64, k), k.is_multiple_of(10), STEP);
        (0..10 * periods + 1).filter_map(one).collect()
    }

    #[test]
    fn a_drift_is_the_slope_of_its_line_and_a_tolerance_separates() {
        let settings = SteadyCriteria { periods: 5, ..SteadyCriteria::default() };
        let drifting = |rate: f64| {
            let omega = |t: f64| 250.0 * (1.0 + rate * t);
            let of = |t: f64, _| Some(Means { lag_error: 1e-5, omega: omega(t), response: 1e-4, deviation: 0.0 });
            judged(&settings, of, 60)
        };
        let all = drifting(2.9e-6);
        // Twelve windows of 50 ms, judged from the sixth on.
        assert_eq!(all.len(), 7);
        assert!(all.iter().all(|s| s.settled && (s.frequency_drift / 2.9e-6 - 1.0).abs() < 1e-4), "{all:?}");
        let all = drifting(3.1e-6);
        assert!(all.iter().all(|s| !s.settled && s.frequency_noise < 1e-9), "{all:?}");
    }

    /// Means of windows with independent noise: a level with none but noise settles as often as the t distribution with
    /// n − 2 = 4 degrees of freedom says, and a drift of ten standard errors does not.
    #[test]
    fn noise_alone_settles_and_a_drift_beyond_it_does_not() {
        let settings = SteadyCriteria {
            periods: 1,
            lag: 0.0,
            frequency_drift: 0.0,
            amplitude_drift: 0.0,
            amplitude: 0.0,
            ..SteadyCriteria::default()
        };
        let mut seed = 1_u64;
        let mut noise = move || {
            let mut sum = -6.0;
            for _ in 0..12 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sum += (seed >> 11) as f64 / (1_u64 << 53) as f64;
            }
            sum
        };
        let mut fill = |drift: f64| {
            let mut windows = Windows::EMPTY;
            for k in 0..6 {
                let line = Means { lag_error: 0.0, omega: 250.0, response: 1.0 + drift * f64::from(k), deviation: 0.0 };
                let response = line.response + 1e-4 * noise();
                windows.keep(Means { response, lag_error: 1e-3 * noise(), omega: 250.0 + 1e-3 * noise(), ..line }, 6);
            }
            settings.judge(&windows, 1.0)
        };
        let settled = (0..2000).filter(|_| fill(0.0).settled).count() as f64 / 2000.0;
        // P(|t_4| ≤ 3) = 0.960 three times; the standard deviation of the share is 0.007.
        assert!((settled - 0.960_f64.powi(3)).abs() < 0.025, "{settled}");
        let drifting = (0..2000).filter(|_| fill(10.0 * 1e-4 / 17.5_f64.sqrt()).settled).count();
        assert!(drifting < 2000 / 20, "{drifting}");
    }

    /// A sample that is missing now and then delays nothing; a window of which more than half is missing does.
    #[test]
    fn what_could_not_be_measured_is_left_out() {
        let settings = SteadyCriteria { periods: 1, ..SteadyCriteria::default() };
        let missing = |every: usize, of: usize| {
            let mean = Means { lag_error: 0.0, omega: 250.0, response: 1.0, deviation: 0.0 };
            let judged = judged(&settings, |_, k| (k % of >= every).then_some(mean), 20);
            assert_eq!(judged.len(), 15);
            judged.iter().filter(|s| s.settled).count()
        };
        assert_eq!([missing(0, 10), missing(4, 10), missing(6, 10), missing(10, 10)], [15, 15, 0, 0]);
    }

    #[test]
    fn the_number_of_windows_is_limited() {
        for windows in [2, 17] {
            let refused = SteadyCriteria { windows, ..SteadyCriteria::default() }.check();
            assert!(matches!(refused, Err(PhaseLoopError::Windows { .. })));
        }
    }
}
