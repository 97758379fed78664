use core::f64::consts::{FRAC_PI_2, PI, TAU};

use num_complex::Complex64;

use crate::math::{cis, larger, norm, rem_tau};

/// Fundamentals of force and response over each single period, and how far they lie apart.
///
/// ```text
/// Z_p = ∫_p y e^{−iθ} dθ                                  over the period p, by the trapezoidal rule between samples
/// spread² = Σ_p |Z_p − Z̄|² / (P |Z̄|²)                    the larger one of force and response
/// noise² = 4 σ² / (N |Z̄/π|²) ,  σ² = Σ (Δ⁴y)² / 70 N              what white noise adds to it, N samples a period
/// ```
///
/// Motions of several periods and those of two frequencies are seen, for neither repeats itself after one period. The
/// noise is that of the quietest quarter of the period, without the impacts.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Periods {
    /// Integrals over the period that is under way.
    now: [Complex64; 2],
    /// Whether no sample of it is missing.
    whole: bool,
    /// Phase of the last sample, and the signals there times `e^{−iθ}`.
    theta: f64,
    last: [Complex64; 2],
    /// Sums over the periods.
    sum: [Complex64; 2],
    squares: [f64; 2],
    count: u64,
    /// The last samples, and sums of squared fourth differences over each quarter of the period.
    before: [[f64; 2]; 4],
    bends: [[f64; 2]; 4],
    in_quarter: [u64; 4],
}

/// How far single periods lie apart, and how far noise alone would put them, relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spread {
    pub(crate) spread: f64,
    pub(crate) noise: f64,
}

impl Periods {
    pub(crate) const EMPTY: Self = Self {
        now: [Complex64::ZERO; 2],
        whole: false,
        theta: 0.0,
        last: [Complex64::ZERO; 2],
        sum: [Complex64::ZERO; 2],
        squares: [0.0; 2],
        count: 0,
        before: [[0.0; 2]; 4],
        bends: [[0.0; 2]; 4],
        in_quarter: [0; 4],
    };

    /// Adds force and response at the phase `theta`, which grows by less than a turn from sample to sample.
    pub(crate) fn push(&mut self, theta: f64, signals: [f64; 2]) {
        if !signals.iter().all(|y| y.is_finite()) {
            self.whole = false;
            return;
        }
        let wave = cis(-theta);
        let here = signals.map(|y| wave * y);
        let (width, wraps) = (rem_tau(theta - self.theta), theta < self.theta);
        let share = if wraps && width > 0.0 { (TAU - self.theta) / width } else { 1.0 };
        for ((now, last), here) in self.now.iter_mut().zip(&self.last).zip(&here) {
            let end = last + (here - last) * share;
            *now += (last + end) * (0.5 * share * width);
        }
        if wraps {
            self.complete();
            for ((now, last), here) in self.now.iter_mut().zip(&self.last).zip(&here) {
                let end = last + (here - last) * share;
                *now = (end + here) * (0.5 * (1.0 - share) * width);
            }
        }
        (self.theta, self.last) = (theta, here);
        self.bend(theta, signals);
    }

    /// Fourth differences, in which smooth signals leave next to nothing.
    fn bend(&mut self, theta: f64, signals: [f64; 2]) {
        let [a, b, c, d] = self.before;
        let quarter = (theta / FRAC_PI_2) as usize;
        if let (true, Some(sums), Some(count)) =
            (self.whole, self.bends.get_mut(quarter), self.in_quarter.get_mut(quarter))
        {
            let outer = a.iter().zip(&signals).map(|(a, y)| a + y);
            let inner = b.iter().zip(&d).zip(&c).map(|((b, d), c)| 6.0 * c - 4.0 * (b + d));
            for (sum, (outer, inner)) in sums.iter_mut().zip(outer.zip(inner)) {
                *sum += (outer + inner) * (outer + inner);
            }
            *count = count.saturating_add(1);
        }
        self.before = [b, c, d, signals];
    }

    fn complete(&mut self) {
        if self.whole {
            self.sum.iter_mut().zip(&self.now).for_each(|(sum, now)| *sum += now);
            self.squares.iter_mut().zip(&self.now).for_each(|(sum, now)| *sum += now.norm_sqr());
            self.count = self.count.saturating_add(1);
        }
        self.whole = true;
    }

    /// The spread of the periods since the last call; not a number without any.
    pub(crate) fn take(&mut self) -> Spread {
        let count = self.count as f64;
        let samples = self.in_quarter.iter().sum::<u64>() as f64 / count;
        let mut found = Spread { spread: 0.0, noise: 0.0 };
        for (signal, (sum, squares)) in self.sum.iter().zip(&self.squares).enumerate() {
            let mean = norm(sum / count);
            let quarters = self.bends.iter().zip(&self.in_quarter);
            let of_quarter = |(bends, n): (&[f64; 2], &u64)| bends.get(signal).map_or(0.0, |sum| sum / *n as f64);
            let variance = quarters.map(of_quarter).fold(f64::INFINITY, f64::min) / 70.0;
            found.spread = larger(found.spread, libm::sqrt((squares / count - mean * mean).max(0.0)) / mean);
            found.noise = larger(found.noise, 2.0 * PI * libm::sqrt(variance / samples) / mean);
        }
        *self = Self {
            now: self.now,
            whole: self.whole,
            theta: self.theta,
            last: self.last,
            before: self.before,
            ..Self::EMPTY
        };
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The spread of a response over `periods` periods of 123.4 samples, with a force that is a sine.
    fn spread(periods: f64, mut response: impl FnMut(f64) -> f64) -> Spread {
        let (mut found, step) = (Periods::EMPTY, TAU / 123.4);
        for k in 0..(periods * 123.4) as usize {
            let theta = 0.3 + step * k as f64;
            found.push(rem_tau(theta), [2.0 * libm::cos(theta), response(theta)]);
        }
        found.take()
    }

    #[test]
    fn what_repeats_itself_has_no_spread_whatever_its_harmonics() {
        let found = spread(20.0, |theta| 1e-5 * (0.2 + libm::sin(theta) + 0.4 * libm::cos(5.0 * theta)));
        // The trapezoidal rule: (2π/123.4)²/12 of what changes about the ends of a period.
        assert!(found.spread < 3e-4 && found.noise < 3e-4, "{found:?}");
    }

    /// `∫ a cos(θ/2) e^{−iθ} dθ` over one period is `± (8/3) i a`, with alternating sign.
    #[test]
    fn two_periods_that_alternate_have_the_spread_of_their_subharmonic() {
        let found = spread(40.0, |theta| libm::sin(theta) + 0.01 * libm::cos(0.5 * theta));
        let expected = 0.01 * 8.0 / 3.0 / PI;
        assert!((found.spread / expected - 1.0).abs() < 0.03 && found.noise < 1e-4, "{found:?} {expected}");
    }

    #[test]
    fn a_period_with_a_missing_sample_is_left_out() {
        let sine = |theta: f64| if (50.0..50.1).contains(&theta) { f64::NAN } else { libm::sin(theta) };
        assert!(spread(20.0, sine).spread < 3e-4);
        assert!(spread(20.0, |_| f64::NAN).spread.is_nan());
    }

    /// White noise gives the spread that is reported for it, also beside impacts.
    #[test]
    fn noise_has_the_spread_that_its_fourth_differences_tell() {
        let mut seed = 3_u64;
        for impact in [0.0, 0.3] {
            let found = spread(400.0, |theta| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let uniform = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
                libm::sin(theta) + 0.1 * uniform + impact * (20.0 * (libm::sin(theta) - 0.95)).max(0.0)
            });
            // σ = 0.1/√3, 123.4 samples a period.
            let expected = 2.0 * 0.1 / (3.0 * 123.4_f64).sqrt();
            let size = if impact > 0.0 { 1.06 } else { 1.0 };
            assert!((found.noise * size / expected - 1.0).abs() < 0.06, "{found:?} {expected}");
            assert!((found.spread / found.noise - 1.0).abs() < 0.06, "{found:?}");
        }
    }
}
