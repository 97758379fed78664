use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use num_complex::Complex64;

use crate::extraction::ExtractionError;

/// Least squares fit of a mean and harmonics to evenly sampled signals: `x_j ≈ Re Σ_{n=0}^{H} q_n e^{inψ_j}`,
/// `ψ_j = ω (j − (N−1)/2) Δt`.
///
/// It is exact for a periodic signal, whatever the number of periods (at least one): there is no leakage. With phases
/// counted from the middle of the samples cosines and sines are orthogonal to each other, and the sums of their
/// products are in closed form, `Σ_j cos kψ_j = sin(kN ωΔt/2) / sin(k ωΔt/2)`; so the matrices cost nothing but their
/// size.
#[derive(Debug, Clone)]
pub struct HarmonicFit {
    n_harmonics: usize,
    n_samples: usize,
    step: f64,
    cosines: Cholesky<f64, Dyn>,
    sines: Option<Cholesky<f64, Dyn>>,
}

impl HarmonicFit {
    /// `n_harmonics` of a frequency whose phase advances by `step` (rad) from sample to sample, over `n_samples`.
    ///
    /// # Errors
    /// [`ExtractionError::Harmonics`] if they cannot be separated: less than about a period, or harmonics at half the
    /// sampling rate.
    pub fn new(n_harmonics: usize, step: f64, n_samples: usize) -> Result<Self, ExtractionError> {
        let refuse =
            || ExtractionError::Harmonics { harmonics: n_harmonics, frequency_hz: f64::NAN, samples: n_samples };
        if !(step > 0.0 && step.is_finite()) || n_samples < 2 * n_harmonics + 1 {
            return Err(refuse());
        }
        let sums: Vec<f64> = (0..=2 * n_harmonics).map(|k| sum_of_cosines(k as f64 * step, n_samples)).collect();
        let cosine = |m: usize, n: usize| 0.5 * (sums[m.abs_diff(n)] + sums[m + n]);
        let sine = |m: usize, n: usize| 0.5 * (sums[m.abs_diff(n)] - sums[m + n + 2]);
        let cosines = DMatrix::from_fn(n_harmonics + 1, n_harmonics + 1, cosine).cholesky().ok_or_else(refuse)?;
        let sines = DMatrix::from_fn(n_harmonics, n_harmonics, sine);
        let sines = if n_harmonics == 0 { None } else { Some(sines.cholesky().ok_or_else(refuse)?) };
        Ok(Self { n_harmonics, n_samples, step, cosines, sines })
    }

    /// Highest harmonic H.
    pub fn n_harmonics(&self) -> usize {
        self.n_harmonics
    }

    /// Phase of sample `j`, rad.
    pub fn phase(&self, j: usize) -> f64 {
        self.step * (j as f64 - 0.5 * (self.n_samples as f64 - 1.0))
    }

    /// Coefficients `q_0 … q_H` of each signal.
    ///
    /// # Panics
    /// If a signal has another number of samples.
    pub fn coefficients(&self, signals: &[&[f64]]) -> Vec<Vec<Complex64>> {
        self.projections(signals).into_iter().map(|sums| self.solve(&sums)).collect()
    }

    /// `Σ_j x_j e^{inψ_j}` of each signal.
    fn projections(&self, signals: &[&[f64]]) -> Vec<Vec<Complex64>> {
        assert!(signals.iter().all(|signal| signal.len() == self.n_samples));
        let mut sums = vec![vec![Complex64::default(); self.n_harmonics + 1]; signals.len()];
        let mut powers = vec![Complex64::new(1.0, 0.0); self.n_harmonics + 1];
        for j in 0..self.n_samples {
            self.powers(j, &mut powers);
            for (sums, signal) in sums.iter_mut().zip(signals) {
                let x = signal[j];
                sums.iter_mut().zip(&powers).for_each(|(sum, power)| *sum += power * x);
            }
        }
        sums
    }

    fn solve(&self, sums: &[Complex64]) -> Vec<Complex64> {
        let real = self.cosines.solve(&DVector::from_iterator(sums.len(), sums.iter().map(|s| s.re)));
        let mut coefficients: Vec<Complex64> = real.iter().map(|a| Complex64::new(*a, 0.0)).collect();
        if let Some(sines) = &self.sines {
            let imaginary = sines.solve(&DVector::from_iterator(self.n_harmonics, sums[1..].iter().map(|s| s.im)));
            coefficients[1..].iter_mut().zip(imaginary.iter()).for_each(|(q, b)| q.im = -b);
        }
        coefficients
    }

    /// `e^{inψ_j}` for n = 0 … H.
    pub(crate) fn powers(&self, j: usize, powers: &mut [Complex64]) {
        let first = Complex64::cis(self.phase(j));
        let mut power = Complex64::new(1.0, 0.0);
        for p in powers {
            *p = power;
            power *= first;
        }
    }

    /// The periodic signals of several sets of coefficients.
    pub(crate) fn signals(&self, coefficients: &[Vec<Complex64>]) -> Vec<Vec<f64>> {
        let mut powers = vec![Complex64::default(); self.n_harmonics + 1];
        let mut signals = vec![Vec::with_capacity(self.n_samples); coefficients.len()];
        for j in 0..self.n_samples {
            self.powers(j, &mut powers);
            for (signal, q) in signals.iter_mut().zip(coefficients) {
                signal.push(q.iter().zip(&powers).map(|(q, p)| q.re * p.re - q.im * p.im).sum());
            }
        }
        signals
    }

    /// The periodic signal of coefficients, and its derivative with respect to `ln ω`: `Re Σ i n ψ_j q_n e^{inψ_j}`.
    pub(crate) fn synthesize(&self, coefficients: &[Complex64]) -> (Vec<f64>, Vec<f64>) {
        let mut powers = vec![Complex64::default(); self.n_harmonics + 1];
        let (mut signal, mut slope) = (Vec::with_capacity(self.n_samples), Vec::with_capacity(self.n_samples));
        for j in 0..self.n_samples {
            self.powers(j, &mut powers);
            let (mut x, mut d) = (0.0, 0.0);
            for (n, (q, power)) in coefficients.iter().zip(&powers).enumerate() {
                let term = q * power;
                x += term.re;
                d -= n as f64 * term.im;
            }
            signal.push(x);
            slope.push(d * self.phase(j));
        }
        (signal, slope)
    }
}

/// `Σ_j cos(x (j − (N−1)/2))`.
fn sum_of_cosines(x: f64, n: usize) -> f64 {
    let half = 0.5 * x;
    // Next to a multiple of the sampling frequency all terms are alike.
    if half.sin().abs() < 1e-9 {
        let turns = (half / std::f64::consts::PI).round();
        return if (turns as i64 * (n as i64 - 1)) % 2 == 0 { n as f64 } else { -(n as f64) };
    }
    (half * n as f64).sin() / half.sin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_closed_sums_are_the_sums(x in 0.0..20.0f64, n in 1..400_usize) {
            let direct: f64 = (0..n).map(|j| (x * (j as f64 - 0.5 * (n as f64 - 1.0))).cos()).sum();
            prop_assert!((sum_of_cosines(x, n) - direct).abs() < 1e-9 * n as f64);
        }

        #[test]
        fn a_periodic_signal_comes_back_from_any_length(
            parts in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 2..9), periods in 1.3..7.0f64, step in 0.01..0.2f64
        ) {
            let n = (periods * std::f64::consts::TAU / step) as usize;
            let fit = HarmonicFit::new(parts.len() - 1, step, n).unwrap();
            let mut q: Vec<Complex64> = parts.iter().map(|p| Complex64::new(p.0, p.1)).collect();
            q[0].im = 0.0;
            let (signal, _) = fit.synthesize(&q);
            let back = fit.coefficients(&[&signal]).remove(0);
            for (a, b) in q.iter().zip(&back) {
                prop_assert!((a - b).norm() < 1e-7, "{a} {b}");
            }
        }
    }

    #[test]
    fn terms_that_are_all_alike_are_counted_with_their_sign() {
        for (turns, n) in [0, 1, 2, 3, 4].into_iter().flat_map(|turns| (1..8_usize).map(move |n| (turns, n))) {
            let x = std::f64::consts::TAU * f64::from(turns);
            let direct: f64 = (0..n).map(|j| (x * (j as f64 - 0.5 * (n as f64 - 1.0))).cos()).sum();
            assert!((sum_of_cosines(x, n) - direct).abs() < 1e-9, "{turns} {n}");
        }
    }

    #[test]
    fn what_cannot_be_told_apart_is_refused() {
        assert!(HarmonicFit::new(5, 0.1, 10).is_err());
        assert!(HarmonicFit::new(1, f64::NAN, 100).is_err());
        assert!(HarmonicFit::new(2, std::f64::consts::FRAC_PI_2, 100).is_err());
    }

    #[test]
    fn the_slope_is_that_of_the_frequency() {
        let q = [Complex64::new(0.3, 0.0), Complex64::new(1.0, -0.4), Complex64::new(0.2, 0.1)];
        let at = |step: f64| HarmonicFit::new(2, step, 300).unwrap().synthesize(&q);
        let (step, h) = (0.05, 1e-6);
        let (plus, minus) = (at(step * (1.0 + h)).0, at(step * (1.0 - h)).0);
        for (j, slope) in at(step).1.iter().enumerate() {
            assert!((slope - (plus[j] - minus[j]) / (2.0 * h)).abs() < 1e-6);
        }
    }
}
