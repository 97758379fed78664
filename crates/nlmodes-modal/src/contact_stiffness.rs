use crate::contact_interval::closed_force;
use crate::noise::noise_level;
use crate::{ContactInterval, ModalError, TimeHistory, contact_intervals};

/// Forces below this fraction of the peak are excluded from the fit, since contact is only beginning there.
const PEAK_SHARE: f64 = 0.1;

/// Contact stiffness by a straight line through force over displacement, `λ = k_c (q − g₀)`, eq. (3), Fig. 7 b.
///
/// Both are measured and noisy, and ordinary regression would underestimate the stiffness. The line is fitted with
/// errors in both variables (Deming), with the ratio of the noise levels taken from the record itself.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactStiffness {
    /// Stiffness `k_c`, N/m.
    pub stiffness: f64,
    /// Its standard error, N/m.
    pub stiffness_error: f64,
    /// Displacement at which the force vanishes, along the coordinate, m: the effective position of the stop.
    pub stop: f64,
    /// Its standard error, m.
    pub stop_error: f64,
    /// Number of samples in the fit.
    pub n_samples: usize,
    /// Number of contact intervals.
    pub n_intervals: usize,
}

/// Sums of a sample of points.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    n: f64,
    x: f64,
    f: f64,
    xx: f64,
    xf: f64,
    ff: f64,
}

impl ContactStiffness {
    /// Fits the samples in contact of a time history. Standard errors come from leaving out one contact interval at a
    /// time (jackknife), or from the scatter about the line if there are fewer than three intervals.
    ///
    /// # Errors
    /// As [`contact_intervals`]; [`ModalError::NoPenetration`] if force and displacement do not increase together, as
    /// at a rigid stop.
    pub fn of(history: &TimeHistory) -> Result<Self, ModalError> {
        let peak = history.force.iter().copied().fold(0.0, f64::max);
        let least = closed_force(&history.force).max(PEAK_SHARE * peak);
        Self::of_pressed(history, |j| history.force[j] > least)
    }

    /// The same from the samples in contact that are `pressed`. To choose them by the noisy force itself makes the line
    /// too flat; a mean of many periods does not.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_pressed(history: &TimeHistory, pressed: impl Fn(usize) -> bool) -> Result<Self, ModalError> {
        let intervals = contact_intervals(history)?;
        let side = if history.stop < 0.0 { -1.0 } else { 1.0 };
        // Displacements relative to the stop keep the sums well conditioned.
        let origin = history.stop;
        let groups: Vec<Moments> =
            intervals.iter().map(|interval| moments(history, interval, &pressed, side, origin)).collect();
        let all = groups.iter().fold(Moments::default(), |sum, group| sum.plus(group, 1.0));
        let ratio = noise_ratio(history);
        let span = (all.variance().0.max(0.0) * 12.0).sqrt();
        let none = ModalError::NoPenetration { samples: all.n as usize, span };
        let (stiffness, stop) = all.line(ratio).ok_or(none)?;
        let (stiffness_error, stop_error) = match groups.len() {
            0..=2 => all.scatter_errors(stiffness),
            _ => jackknife(&groups, &all, ratio),
        };
        Ok(Self {
            stiffness,
            stiffness_error,
            stop: origin + side * stop,
            stop_error,
            n_samples: all.n as usize,
            n_intervals: groups.len(),
        })
    }
}

fn moments(
    history: &TimeHistory,
    interval: &ContactInterval,
    pressed: impl Fn(usize) -> bool,
    side: f64,
    origin: f64,
) -> Moments {
    let samples = (interval.first..=interval.last).filter(|j| pressed(*j));
    let points = samples.map(|j| (side * (history.displacement[j] - origin), history.force[j]));
    points.fold(Moments::default(), |sum, (x, f)| {
        sum.plus(&Moments { n: 1.0, x, f, xx: x * x, xf: x * f, ff: f * f }, 1.0)
    })
}

/// Variance of the force noise over that of the displacement noise; infinite if only the force is noisy.
fn noise_ratio(history: &TimeHistory) -> f64 {
    let (force, displacement) = (noise_level(&history.force), noise_level(&history.displacement));
    if displacement == 0.0 { f64::INFINITY } else { (force / displacement).powi(2) }
}

impl Moments {
    fn plus(self, other: &Self, sign: f64) -> Self {
        Self {
            n: self.n + sign * other.n,
            x: self.x + sign * other.x,
            f: self.f + sign * other.f,
            xx: self.xx + sign * other.xx,
            xf: self.xf + sign * other.xf,
            ff: self.ff + sign * other.ff,
        }
    }

    /// Variance of the displacement, covariance, variance of the force.
    fn variance(&self) -> (f64, f64, f64) {
        let mean = |sum: f64| sum / self.n.max(1.0);
        let (x, f) = (mean(self.x), mean(self.f));
        (mean(self.xx) - x * x, mean(self.xf) - x * f, mean(self.ff) - f * f)
    }

    /// Slope and displacement at zero force of the line with errors in both variables.
    fn line(&self, ratio: f64) -> Option<(f64, f64)> {
        let (sxx, sxf, sff) = self.variance();
        if self.n < 3.0 || !(sxf > 0.0 && sxx > 0.0) {
            return None;
        }
        let slope = if ratio.is_finite() {
            let d = sff - ratio * sxx;
            // The root that does not cancel, whichever sign d has.
            let root = (d * d + 4.0 * ratio * sxf * sxf).sqrt();
            if d >= 0.0 { (d + root) / (2.0 * sxf) } else { 2.0 * ratio * sxf / (root - d) }
        } else {
            sxf / sxx
        };
        (slope.is_finite() && slope > 0.0).then_some((slope, self.x / self.n - self.f / self.n / slope))
    }

    /// Standard errors from the scatter of the force about the line.
    fn scatter_errors(&self, slope: f64) -> (f64, f64) {
        let (sxx, sxf, sff) = self.variance();
        let scatter = (sff - 2.0 * slope * sxf + slope * slope * sxx).max(0.0) * self.n / (self.n - 2.0).max(1.0);
        let slope_error = (scatter / (self.n * sxx)).sqrt();
        let lever = self.f / self.n / slope;
        (slope_error, (scatter / self.n / slope.powi(2) + (lever * slope_error / slope).powi(2)).sqrt())
    }
}

fn jackknife(groups: &[Moments], all: &Moments, ratio: f64) -> (f64, f64) {
    let without: Vec<(f64, f64)> = groups.iter().filter_map(|group| all.plus(group, -1.0).line(ratio)).collect();
    let n = without.len() as f64;
    let error = |part: fn(&(f64, f64)) -> f64| {
        let mean = without.iter().map(part).sum::<f64>() / n;
        ((n - 1.0) / n * without.iter().map(|line| (part(line) - mean).powi(2)).sum::<f64>()).sqrt()
    };
    (error(|line| line.0), error(|line| line.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::tests::Normal;

    /// A sine that presses a spring beyond the gap.
    fn pressed(k: f64, gap: f64, noise: [f64; 2], n_periods: usize, side: f64, seed: u64) -> TimeHistory {
        let mut normal = Normal::new(seed);
        let n = 488 * n_periods;
        let time: Vec<f64> = (0..n).map(|j| j as f64 / 20_000.0).collect();
        let true_x = |t: &f64| 1.045e-3 * (std::f64::consts::TAU * 41.0 * t).cos();
        let force =
            time.iter().map(|t| (k * (true_x(t) - gap)).max(0.0)).map(|f| f + noise[0] * normal.draw()).collect();
        let displacement = time.iter().map(true_x).map(|x| side * (x + noise[1] * normal.draw())).collect();
        let velocity = vec![0.0; n];
        TimeHistory {
            label: String::new(),
            time,
            displacement,
            velocity: velocity.clone(),
            acceleration: velocity,
            force,
            stop: side * gap,
            instants: vec![],
        }
    }

    #[test]
    fn without_noise_the_line_is_exact() {
        for (side, k) in [(1.0, 2.3e6), (-1.0, 2.3e6), (1.0, 2.3)] {
            let mut history = pressed(k, 1.03e-3, [0.0, 0.0], 6, side, 1);
            // The actual position of the stop may differ from the drawing.
            history.stop = side * 1.0e-3;
            let fit = ContactStiffness::of(&history).unwrap();
            assert!((fit.stiffness / k - 1.0).abs() < 1e-9, "{fit:?}");
            assert!((fit.stop - side * 1.03e-3).abs() < 1e-13, "{fit:?}");
            assert!(fit.stiffness_error < k * 1e-8, "{fit:?}");
            let closed = history.force.iter().filter(|force| **force > 0.0).count();
            assert!(fit.n_samples > closed / 2 && fit.n_samples <= closed, "{fit:?}");
        }
    }

    #[test]
    fn errors_from_the_scatter_of_two_contacts_hold_what_noise_does() {
        let (mut outside, n) = (0, 24);
        for seed in 0..n {
            let fit = ContactStiffness::of(&pressed(2.3e6, 1.03e-3, [0.5, 0.0], 3, 1.0, 70 + seed)).unwrap();
            assert_eq!(fit.n_intervals, 2);
            assert!(fit.stop_error > 0.0 && fit.stop_error.is_finite(), "{fit:?}");
            outside += usize::from((fit.stop - 1.03e-3).abs() > 3.0 * fit.stop_error);
        }
        assert!(outside <= 3, "{outside} of {n} beyond three standard errors");
    }

    #[test]
    fn forces_that_do_not_rise_with_the_displacement_are_refused_with_its_span() {
        for unit in [1.0, 1e-5] {
            let mut history = TimeHistory::empty("", 0.5 * unit);
            for j in 0..40_i32 {
                let force = if (10..18).contains(&j) { 9.0 - 0.1 * f64::from(j - 10) } else { 0.0 };
                history.push(f64::from(j), [unit * f64::from(j), 0.0, 0.0], force);
            }
            // Eight equidistant values have the variance (8² − 1)/12; evenly spread ones, the square of their span over
            // twelve.
            let error = ContactStiffness::of(&history).unwrap_err();
            let ModalError::NoPenetration { samples: 8, span } = error else { panic!("{error}") };
            assert!((span / (unit * 63f64.sqrt()) - 1.0).abs() < 1e-12, "{span}");
        }
    }

    /// Slope of a line `f = k (x − s)` and its zero, with textbook errors from the individual residuals.
    #[test]
    fn errors_from_the_scatter_are_those_of_a_regression() {
        for (k, unit) in [(3.0, 1.0), (0.4, 1e-3), (2e6, 1e-6)] {
            let points: Vec<(f64, f64)> = (0..9)
                .map(|j| (unit * f64::from(j), k * unit * (f64::from(j) + 2.0 + 0.3 * f64::from(j * j % 5))))
                .collect();
            let one = |sum: Moments, (x, f): &(f64, f64)| {
                sum.plus(&Moments { n: 1.0, x: *x, f: *f, xx: x * x, xf: x * f, ff: f * f }, 1.0)
            };
            let all = points.iter().fold(Moments::default(), one);
            let n = points.len() as f64;
            let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
            let (mx, mf) = (mean(|p| p.0), mean(|p| p.1));
            let spread: f64 = points.iter().map(|(x, _)| (x - mx).powi(2)).sum();
            let slope = points.iter().map(|(x, f)| (x - mx) * (f - mf)).sum::<f64>() / spread;
            let (found, zero) = all.line(f64::INFINITY).unwrap();
            assert!((found / slope - 1.0).abs() < 1e-12 && (zero / (mx - mf / slope) - 1.0).abs() < 1e-12);
            let left: f64 = points.iter().map(|(x, f)| (f - mf - slope * (x - mx)).powi(2)).sum();
            let of_slope = (left / (n - 2.0) / spread).sqrt();
            // Of the zero mx − mf/k: the mean force and the slope are independent.
            let of_zero = (left / (n - 2.0) / n + (mf / slope * of_slope).powi(2)).sqrt() / slope;
            let (slope_error, zero_error) = all.scatter_errors(slope);
            assert!((slope_error / of_slope - 1.0).abs() < 1e-10, "{slope_error} {of_slope}");
            assert!((zero_error / of_zero - 1.0).abs() < 1e-10, "{zero_error} {of_zero}");
            // The jackknife: the lines without each three of the points.
            let groups: Vec<Moments> =
                points.chunks(3).map(|three| three.iter().fold(Moments::default(), one)).collect();
            let without = |left: usize| {
                let kept = points.iter().enumerate().filter(|(j, _)| j / 3 != left).map(|(_, point)| point);
                kept.fold(Moments::default(), one).line(f64::INFINITY).unwrap()
            };
            let lines = [0, 1, 2].map(without);
            let error = |of: fn(&(f64, f64)) -> f64| {
                let mean = lines.iter().map(of).sum::<f64>() / 3.0;
                (2.0 / 3.0 * lines.iter().map(|line| (of(line) - mean).powi(2)).sum::<f64>()).sqrt()
            };
            let found = jackknife(&groups, &all, f64::INFINITY);
            assert!((found.0 / error(|line| line.0) - 1.0).abs() < 1e-9, "{found:?}");
            assert!((found.1 / error(|line| line.1) - 1.0).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn noise_on_both_neither_biases_the_stiffness_nor_escapes_its_error() {
        let (mut sum, mut outside, n) = (0.0, 0, 24);
        for seed in 0..n {
            let fit = ContactStiffness::of(&pressed(2.3e6, 1.03e-3, [0.1, 2e-7], 24, 1.0, 11 + seed)).unwrap();
            let miss = (fit.stiffness - 2.3e6) / fit.stiffness_error;
            (sum, outside) = (sum + fit.stiffness / n as f64, outside + usize::from(miss.abs() > 2.0));
            assert!((fit.stiffness / 2.3e6 - 1.0).abs() < 0.01, "{fit:?}");
        }
        // The mean of 24 fits, each accurate to 0.2 %; one fit in twenty is outside two standard errors, and five of 24
        // with a probability of one in 500.
        assert!((sum / 2.3e6 - 1.0).abs() < 2e-3, "{sum}");
        assert!(outside <= 5, "{outside} of {n} beyond two standard errors");
    }

    #[test]
    fn the_ratio_of_the_noise_is_that_of_the_record_in_any_unit() {
        for unit in [1.0, 1e-6] {
            let mut history = pressed(2.3e6, 1.03e-3, [0.1, 2e-7], 24, 1.0, 5);
            history.force.iter_mut().for_each(|f| *f *= unit);
            // Some 12 000 samples: medians are accurate to some per cent, and some samples include the kink at the
            // beginning or end of contact.
            let ratio = noise_ratio(&history) / (0.1 * unit / 2e-7_f64).powi(2);
            assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
            history.displacement.fill(0.0);
            assert_eq!(noise_ratio(&history), f64::INFINITY);
        }
    }

    #[test]
    fn a_rigid_stop_has_no_stiffness() {
        let mut history = pressed(2.3e6, 1.03e-3, [0.0, 0.0], 6, 1.0, 1);
        history.displacement.iter_mut().for_each(|x| *x = x.min(1.03e-3));
        assert!(matches!(ContactStiffness::of(&history), Err(ModalError::NoPenetration { .. })));
    }
}
