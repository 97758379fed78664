use std::f64::consts::TAU;

use num_complex::Complex64;

/// Number of harmonics.
const HARMONICS: usize = 5;

/// Minimum number of points per period at which the signals are resampled.
const FEWEST: f64 = 32.0;

/// Complex amplitudes of force and response over one period, in the frame of the drive; harmonics 1 to 5.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Period {
    pub(crate) force: [Complex64; HARMONICS],
    pub(crate) response: [Complex64; HARMONICS],
}

impl Period {
    /// Mean of some periods.
    pub(crate) fn mean(periods: &[Self]) -> Self {
        let mut mean = Self::default();
        let share = 1.0 / periods.len() as f64;
        for period in periods {
            mean.force.iter_mut().zip(&period.force).for_each(|(m, f)| *m += f * share);
            mean.response.iter_mut().zip(&period.response).for_each(|(m, x)| *m += x * share);
        }
        mean
    }

    /// Root mean square distance of some periods from their mean, relative to the mean: the larger of force and
    /// response.
    pub(crate) fn spread(periods: &[Self]) -> f64 {
        let mean = Self::mean(periods);
        let size = |z: &[Complex64]| z.iter().map(|z| z.norm_sqr()).sum::<f64>();
        let distance = |a: &[Complex64], b: &[Complex64]| a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum::<f64>();
        let of = |part: fn(&Self) -> &[Complex64; HARMONICS]| {
            let sum: f64 = periods.iter().map(|period| distance(part(period), part(&mean))).sum();
            (sum / (periods.len() as f64 * size(part(&mean)))).sqrt()
        };
        of(|period| &period.force).max(of(|period| &period.response))
    }
}

/// Resamples force and response at equal angles of the drive and computes the Fourier coefficients of each period.
///
/// A period is not a whole number of samples; with cubic interpolation at equal angles there is no leakage, and one
/// period can be compared with the next. There are as many points as samples, so that the high harmonics of contact are
/// not aliased.
#[derive(Debug, Clone)]
pub(crate) struct PeriodAnalyzer {
    points: usize,
    /// Angle between points, rad.
    width: f64,
    /// Unwrapped phase, force, response of the last four samples, oldest first.
    last: [[f64; 3]; 4],
    samples: u64,
    /// Number of the next point since phase zero.
    point: f64,
    taken: usize,
    period: Period,
}

impl PeriodAnalyzer {
    /// For drives with about `angle` rad per sample.
    pub(crate) fn new(angle: f64) -> Self {
        let points = (TAU / angle).ceil().max(FEWEST);
        Self {
            points: points as usize,
            width: TAU / points,
            last: [[0.0; 3]; 4],
            samples: 0,
            point: 0.0,
            taken: 0,
            period: Period::default(),
        }
    }

    /// Takes the samples at the drive phase `theta` (in [0, 2π)); returns a period when it is complete.
    pub(crate) fn push(&mut self, theta: f64, force: f64, response: f64) -> Option<Period> {
        let before = self.last[3][0];
        let unwrapped = if self.samples == 0 { theta } else { before + (theta - before).rem_euclid(TAU) };
        self.last.rotate_left(1);
        self.last[3] = [unwrapped, force, response];
        self.samples += 1;
        if self.samples == 4 {
            self.point = (self.last[1][0] / self.width).ceil();
        }
        if self.samples < 4 { None } else { self.take_points() }
    }

    /// All points between the two middle samples.
    fn take_points(&mut self) -> Option<Period> {
        let mut complete = None;
        while self.point * self.width < self.last[2][0] {
            let θ = self.point * self.width;
            let [force, response] = self.interpolate((θ - self.last[1][0]) / (self.last[2][0] - self.last[1][0]));
            let (turn, mut wave) = (Complex64::cis(-θ), Complex64::from(2.0 / self.points as f64));
            for n in 0..HARMONICS {
                wave *= turn;
                self.period.force[n] += wave * force;
                self.period.response[n] += wave * response;
            }
            self.point += 1.0;
            self.taken += 1;
            if self.taken == self.points {
                self.taken = 0;
                complete = Some(std::mem::take(&mut self.period));
            }
        }
        complete
    }

    /// Cubic Lagrange interpolation at the fraction `s` between the two middle samples.
    fn interpolate(&self, s: f64) -> [f64; 2] {
        let weights = [
            -s * (s - 1.0) * (s - 2.0) / 6.0,
            (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0,
            -(s + 1.0) * s * (s - 2.0) / 2.0,
            (s + 1.0) * s * (s - 1.0) / 6.0,
        ];
        let sum = |column: usize| weights.iter().zip(&self.last).map(|(w, sample)| w * sample[column]).sum();
        [sum(1), sum(2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_of_each_period_are_found_at_any_frequency() {
        let (mut analyzer, mut found) = (PeriodAnalyzer::new(0.012345), Vec::new());
        for k in 0..4000 {
            let θ = 0.9 + 0.012345 * f64::from(k);
            let force = 3.0 * (θ + 0.2).cos() + 0.5 * (3.0 * θ).sin() + 0.1;
            found.extend(analyzer.push(θ.rem_euclid(TAU), force, 1e-5 * θ.sin()));
        }
        assert_eq!(found.len(), 7);
        for period in &found {
            // The error of cubic interpolation is (n Δθ)⁴ 3/128, 5e-10 for the fundamental.
            assert!((period.force[0] - Complex64::from_polar(3.0, 0.2)).norm() < 1e-8);
            assert!((period.force[2] - Complex64::new(0.0, -0.5)).norm() < 1e-7);
            assert!((period.response[0] - Complex64::new(0.0, -1e-5)).norm() < 1e-13);
        }
        assert!(Period::spread(&found) < 1e-8);
    }

    #[test]
    fn alternating_periods_are_not_periodic() {
        let period = |x: f64| Period { force: [1.0.into(); HARMONICS], response: [x.into(); HARMONICS] };
        assert!((Period::spread(&[period(1.1), period(0.9), period(1.1), period(0.9)]) - 0.1).abs() < 1e-12);
    }
}
