use num_complex::Complex64;

use crate::error::{not_negative, positive};
use crate::math::{larger, norm};
use crate::periods::{Periods, Spread};
use crate::{MAX_HARMONICS, PhaseLoopError};

/// Most windows that are considered together.
pub const MAX_WINDOWS: usize = 16;

/// Fewest through which a line has a residual.
const LEAST_WINDOWS: usize = 3;

/// When a level is steady, judged on windows of whole periods against the noise that they show themselves.
///
/// ```text
/// y_k = ȳ + b t_k + r_k ,   s² = Σ r_k² / (n − 2)            a line through the means y_k of the last n windows
/// |ȳ| ≤ tolerance + c s / √n                                 for the lag error and the controlled amplitude
/// |b| ≤ tolerance + c s / √(Σ t_k²)                          for the drifts of frequency and response
/// ```
///
/// Single periods of a window must not differ by more than their own tolerance and `c` times what white noise of the
/// sensors makes of them, and the means of controlled harmonics must have reached what is wanted.
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
    /// Largest root mean square difference of single periods from their mean, relative.
    pub spread: f64,
    /// Largest deviation of a controlled harmonic of the force, relative to its fundamental.
    pub harmonics: f64,
    /// Standard errors `c` that are let through beyond the first five tolerances.
    pub confidence: f64,
    /// Longest time, s: after it the level is recorded as it is, and counts as not settled.
    pub longest: f64,
}

impl Default for SteadyCriteria {
    /// Six windows of 20 periods, 0.02 degrees, 3e-6/s, 3e-4/s, 0.1 % of a controlled amplitude, 1 % between periods,
    /// 0.1 % for controlled harmonics, three standard errors, at most 40 s.
    fn default() -> Self {
        Self {
            periods: 20,
            windows: 6,
            lag: 0.02_f64.to_radians(),
            frequency_drift: 3e-6,
            amplitude_drift: 3e-4,
            amplitude: 1e-3,
            spread: 0.01,
            harmonics: 1e-3,
            confidence: 3.0,
            longest: 40.0,
        }
    }
}

impl SteadyCriteria {
    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        positive("periods a window", self.periods as f64)?;
        if !(LEAST_WINDOWS..=MAX_WINDOWS).contains(&self.windows) {
            let (windows, least) = (self.windows, LEAST_WINDOWS);
            return Err(PhaseLoopError::Windows { windows, least, most: MAX_WINDOWS });
        }
        not_negative("lag tolerance (rad)", self.lag)?;
        not_negative("tolerance of the frequency drift (1/s)", self.frequency_drift)?;
        not_negative("tolerance of the amplitude drift (1/s)", self.amplitude_drift)?;
        not_negative("tolerance of the controlled amplitude", self.amplitude)?;
        not_negative("tolerance of the periodicity", self.spread)?;
        not_negative("tolerance of controlled harmonics", self.harmonics)?;
        not_negative("standard errors", self.confidence)?;
        positive("longest hold (s)", self.longest).map(drop)
    }

    /// What these drifts exceed.
    pub fn missed(&self, found: &Drifts) -> Missed {
        // Formulated such that NaN is a miss.
        let beyond = |value: f64, tolerance: f64, error: f64| {
            let within = value.abs() <= tolerance + self.confidence * error;
            !within
        };
        Missed {
            lag: beyond(found.lag_error, self.lag, found.lag_noise),
            frequency: beyond(found.frequency_drift, self.frequency_drift, found.frequency_noise),
            amplitude: beyond(found.amplitude_drift, self.amplitude_drift, found.amplitude_noise),
            level: beyond(found.amplitude_deviation, self.amplitude, found.deviation_noise),
            spread: beyond(found.spread, self.spread, found.spread_noise),
            harmonics: beyond(found.harmonic_error, self.harmonics, 0.0),
        }
    }

    /// Judges the windows, `length` seconds each.
    fn judge(&self, windows: &Windows, length: f64) -> Drifts {
        let line = |of: fn(&Means) -> f64| Line::through(windows, of);
        let (lag, omega) = (line(|w| w.lag_error), line(|w| w.omega));
        let (response, deviation) = (line(|w| w.response), line(|w| w.deviation));
        let largest = |of: fn(&Means) -> f64| windows.kept().iter().map(of).fold(0.0, larger);
        let drift = |line: &Line| [line.slope / (line.mean * length), line.slope_error / (line.mean.abs() * length)];
        let ([frequency, frequency_error], [amplitude, amplitude_error]) = (drift(&omega), drift(&response));
        let found = Drifts {
            lag_error: lag.mean,
            lag_noise: lag.mean_error,
            frequency_drift: frequency,
            frequency_noise: frequency_error,
            amplitude_drift: amplitude,
            amplitude_noise: amplitude_error,
            amplitude_deviation: deviation.mean,
            deviation_noise: deviation.mean_error,
            spread: largest(|w| w.spread),
            spread_noise: largest(|w| w.spread_noise),
            harmonic_error: windows.kept().last().map_or(0.0, |w| w.harmonic_error),
            windows: windows.count,
            settled: false,
        };
        Drifts { settled: windows.count >= self.windows && self.missed(&found) == Missed::default(), ..found }
    }
}

/// Which tolerances are exceeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Missed {
    /// The lag from its target.
    pub lag: bool,
    /// The drift of the frequency.
    pub frequency: bool,
    /// The drift of the response.
    pub amplitude: bool,
    /// A controlled amplitude from its level.
    pub level: bool,
    /// Single periods from their mean.
    pub spread: bool,
    /// A controlled harmonic of the force from what is wanted.
    pub harmonics: bool,
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
    /// Its standard error.
    pub deviation_noise: f64,
    /// Largest root mean square difference of the periods of a window from their mean, relative.
    pub spread: f64,
    /// What white noise of the sensors makes of it.
    pub spread_noise: f64,
    /// Largest mean deviation of a controlled harmonic of the force over the last window, relative to the fundamental.
    pub harmonic_error: f64,
    /// Windows that this is from; none: nothing can be known yet.
    pub windows: usize,
    /// Whether there are enough of them, and all is within tolerance and noise.
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
    /// Of the periods of a window, and what noise would give.
    pub(crate) spread: f64,
    pub(crate) spread_noise: f64,
    /// Of the controlled harmonics, over a window.
    pub(crate) harmonic_error: f64,
}

impl Means {
    pub(crate) const ZERO: Self = Self {
        lag_error: 0.0,
        omega: 0.0,
        response: 0.0,
        deviation: 0.0,
        spread: 0.0,
        spread_noise: 0.0,
        harmonic_error: 0.0,
    };

    fn plus(self, other: Self, factor: f64) -> Self {
        Self {
            lag_error: self.lag_error + factor * other.lag_error,
            omega: self.omega + factor * other.omega,
            response: self.response + factor * other.response,
            deviation: self.deviation + factor * other.deviation,
            ..self
        }
    }
}

/// What the windows need of a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Phase of the drive, rad.
    pub(crate) theta: f64,
    /// Force and response.
    pub(crate) signals: [f64; 2],
    /// What the loop has measured, if anything.
    pub(crate) means: Option<Means>,
    /// What is missing of each controlled harmonic of the force, relative to its fundamental.
    pub(crate) missing: [Complex64; MAX_HARMONICS],
}

/// The last windows of a level, and the one that is being filled.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Windows {
    sum: Means,
    missing: [Complex64; MAX_HARMONICS],
    samples: u64,
    /// Those of them that were measured.
    measured: u64,
    single: Periods,
    /// Beginnings of periods since the hold began: the first window begins with the first.
    periods: usize,
    last: [Means; MAX_WINDOWS],
    count: usize,
}

impl Windows {
    pub(crate) const EMPTY: Self = Self {
        sum: Means::ZERO,
        missing: [Complex64::ZERO; MAX_HARMONICS],
        samples: 0,
        measured: 0,
        single: Periods::EMPTY,
        periods: 0,
        last: [Means::ZERO; MAX_WINDOWS],
        count: 0,
    };

    /// Adds a sample; `wrapped` where a new period begins with it. The judgement if a window is complete, and there are
    /// enough for one.
    pub(crate) fn push(
        &mut self,
        settings: &SteadyCriteria,
        sample: &Sample,
        wrapped: bool,
        step: f64,
    ) -> Option<Drifts> {
        let mut judged = None;
        self.single.push(sample.theta, sample.signals);
        if wrapped {
            if self.periods >= settings.periods {
                let length = self.samples as f64 * step;
                let window = self.complete();
                self.keep(window, settings.windows);
                judged = (self.count >= LEAST_WINDOWS).then(|| settings.judge(self, length));
                self.periods = 0;
            }
            if self.periods == 0 {
                (self.sum, self.missing) = (Means::ZERO, [Complex64::ZERO; MAX_HARMONICS]);
                (self.samples, self.measured) = (0, 0);
                self.single.take();
            }
            self.periods += 1;
        }
        if self.periods > 0 {
            self.samples = self.samples.saturating_add(1);
            if let Some(means) = sample.means {
                self.sum = self.sum.plus(means, 1.0);
                self.missing.iter_mut().zip(&sample.missing).for_each(|(sum, missing)| *sum += missing);
                self.measured = self.measured.saturating_add(1);
            }
        }
        judged
    }

    /// The means of a full window.
    fn complete(&mut self) -> Means {
        // A window of which less than half was measured has no mean.
        let share = if 2 * self.measured > self.samples { 1.0 / self.measured as f64 } else { f64::NAN };
        let harmonic_error = self.missing.iter().map(|sum| norm(*sum) * share).fold(0.0, larger);
        let Spread { spread, noise: spread_noise } = self.single.take();
        Means { spread, spread_noise, harmonic_error, ..Means::ZERO.plus(self.sum, share) }
    }

    /// Those that are full, the newest at the end.
    fn kept(&self) -> &[Means] {
        self.last.get(..self.count).unwrap_or_default()
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
    fn through(windows: &Windows, of: fn(&Means) -> f64) -> Self {
        let (n, values) = (windows.count, || windows.kept().iter().map(of));
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
    use std::f64::consts::TAU;

    const STEP: f64 = 1e-3;

    /// Periods of ten samples with these means; the judgements.
    fn judged(settings: &SteadyCriteria, of: impl Fn(f64, usize) -> Option<Means>, periods: usize) -> Vec<Drifts> {
        let mut windows = Windows::EMPTY;
        let one = |k: usize| {
            let theta = 0.1 * TAU * (k % 10) as f64;
            let (signals, means) = ([theta.cos(), theta.sin()], of(STEP * k as f64, k));
            let sample = Sample { theta, signals, means, missing: [Complex64::ZERO; MAX_HARMONICS] };
            windows.push(settings, &sample, k.is_multiple_of(10), STEP)
        };
        (0..10 * periods + 1).filter_map(one).collect()
    }

    #[test]
    fn a_drift_is_the_slope_of_its_line_and_a_tolerance_separates() {
        let settings = SteadyCriteria { periods: 5, ..SteadyCriteria::default() };
        let drifting = |rate: f64| {
            let omega = |t: f64| 250.0 * (1.0 + rate * t);
            let of = |t: f64, _| Some(Means { lag_error: 1e-5, omega: omega(t), response: 1e-4, ..Means::ZERO });
            judged(&settings, of, 60)
        };
        let all = drifting(2.9e-6);
        // Twelve windows of 50 ms, judged from the third on, and settled from the sixth.
        assert_eq!(all.iter().map(|s| s.windows).collect::<Vec<_>>(), [3, 4, 5, 6, 6, 6, 6, 6, 6, 6]);
        assert!(all.iter().all(|s| s.settled == (s.windows == 6)));
        assert!(all.iter().all(|s| (s.frequency_drift / 2.9e-6 - 1.0).abs() < 1e-4), "{all:?}");
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
                let line = Means { omega: 250.0, response: 1.0 + drift * f64::from(k), ..Means::ZERO };
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
            let mean = Means { omega: 250.0, response: 1.0, ..Means::ZERO };
            let judged = judged(&settings, |_, k| (k % of >= every).then_some(mean), 20);
            assert_eq!(judged.len(), 18);
            judged.iter().filter(|s| s.settled).count()
        };
        // The first period has no beginning: from the seventh on.
        assert_eq!([missing(0, 10), missing(4, 10), missing(6, 10), missing(10, 10)], [14, 14, 0, 0]);
    }

    #[test]
    fn what_is_beyond_its_tolerance_is_named() {
        const SAMPLES: usize = 200;
        let settings = SteadyCriteria { periods: 2, ..SteadyCriteria::default() };
        let sample = |k: usize| {
            let theta = TAU * ((k % SAMPLES) as f64 + 0.5) / SAMPLES as f64;
            let alternating = if (k / SAMPLES).is_multiple_of(2) { 1.0 } else { 1.2 };
            let means = Some(Means { omega: 250.0, response: 1.0, ..Means::ZERO });
            let mut missing = [Complex64::ZERO; MAX_HARMONICS];
            missing[2] = Complex64::new(0.0, 0.05);
            Sample { theta, signals: [theta.cos(), alternating * theta.sin()], means, missing }
        };
        let mut windows = Windows::EMPTY;
        let mut push = |k: usize| windows.push(&settings, &sample(k), k.is_multiple_of(SAMPLES), STEP);
        let found = (0..20 * SAMPLES).filter_map(&mut push).last().unwrap();
        // Periods of 1 and 1.2: a tenth of 1.1 to either side.
        assert!((found.spread / (0.1 / 1.1) - 1.0).abs() < 0.05 && found.spread_noise < 1e-3, "{found:?}");
        assert!((found.harmonic_error - 0.05).abs() < 1e-12 && !found.settled);
        assert_eq!(settings.missed(&found), Missed { spread: true, harmonics: true, ..Missed::default() });
    }

    #[test]
    fn the_number_of_windows_is_limited() {
        for windows in [2, 17] {
            let refused = SteadyCriteria { windows, ..SteadyCriteria::default() }.check();
            assert!(matches!(refused, Err(PhaseLoopError::Windows { .. })));
        }
    }
}
