use std::f64::consts::TAU;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use num_complex::Complex64;

use crate::extraction::ExtractionError;
use crate::extraction::phase_grid::PhaseGrid;

/// Samples times harmonics from which on sums are taken over a grid of phases: below, those term by term cost nothing.
const MANY: usize = 1 << 22;

/// Most harmonics of a block, and fewest samples of a period for each.
const IN_A_BLOCK: (usize, f64) = (10, 2.5);

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

    /// Of a block of a longer record: ten harmonics, or as many as leave [`IN_A_BLOCK`] samples a period for each.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn of_block(step: f64, n_samples: usize) -> Result<Self, ExtractionError> {
        let (most, samples) = IN_A_BLOCK;
        Self::new(((TAU / step / samples) as usize).clamp(1, most), step, n_samples)
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
        match self.grid() {
            Some(mut grid) => self.spread(&mut grid, signals),
            None => self.term_by_term(signals),
        }
    }

    fn term_by_term(&self, signals: &[&[f64]]) -> Vec<Vec<Complex64>> {
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

    fn spread(&self, grid: &mut PhaseGrid, signals: &[&[f64]]) -> Vec<Vec<Complex64>> {
        let mut spread = vec![grid.empty(); signals.len()];
        for j in 0..self.n_samples {
            let weights = grid.weights(self.phase(j));
            spread.iter_mut().zip(signals).for_each(|(spread, signal)| weights.spread(signal[j], spread));
        }
        spread.iter().map(|spread| grid.sums(spread)).collect()
    }

    /// A grid for sums over all samples, where term by term they would take long.
    fn grid(&self) -> Option<PhaseGrid> {
        let is_long = self.n_samples.saturating_mul(self.n_harmonics + 1) >= MANY;
        is_long.then(|| PhaseGrid::new(self.n_harmonics).ok()).flatten()
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

    /// What the harmonics of each signal leave: squared, of all samples, and `Σ_j x_j e^{inψ_j}` of what is left in
    /// each of the `blocks` of samples.
    pub(crate) fn rests(
        &self,
        signals: &[&[f64]],
        coefficients: &[Vec<Complex64>],
        blocks: &[std::ops::Range<usize>],
    ) -> (Vec<f64>, Vec<Vec<Vec<Complex64>>>) {
        match self.grid() {
            Some(mut grid) => self.rests_on(&mut grid, signals, coefficients, blocks),
            None => self.rests_term_by_term(signals, coefficients, blocks),
        }
    }

    fn rests_term_by_term(
        &self,
        signals: &[&[f64]],
        coefficients: &[Vec<Complex64>],
        blocks: &[std::ops::Range<usize>],
    ) -> (Vec<f64>, Vec<Vec<Vec<Complex64>>>) {
        let none = || vec![vec![Complex64::default(); self.n_harmonics + 1]; signals.len()];
        let (mut squares, mut sums) = (vec![0.0; signals.len()], vec![none(); blocks.len()]);
        let mut powers = vec![Complex64::default(); self.n_harmonics + 1];
        for j in 0..self.n_samples {
            self.powers(j, &mut powers);
            let mut own = blocks.iter().position(|block| block.contains(&j)).map(|k| &mut sums[k]);
            for (c, (signal, q)) in signals.iter().zip(coefficients).enumerate() {
                let model: f64 = q.iter().zip(&powers).map(|(q, p)| q.re * p.re - q.im * p.im).sum();
                let rest = signal[j] - model;
                squares[c] += rest * rest;
                if let Some(sums) = own.as_mut() {
                    sums[c].iter_mut().zip(&powers).for_each(|(sum, power)| *sum += power * rest);
                }
            }
        }
        (squares, sums)
    }

    fn rests_on(
        &self,
        grid: &mut PhaseGrid,
        signals: &[&[f64]],
        coefficients: &[Vec<Complex64>],
        blocks: &[std::ops::Range<usize>],
    ) -> (Vec<f64>, Vec<Vec<Vec<Complex64>>>) {
        let models: Vec<Vec<f64>> = coefficients.iter().map(|q| grid.filled(q)).collect();
        let mut squares = vec![0.0; signals.len()];
        let mut spread = vec![grid.empty(); signals.len()];
        let mut sums = Vec::with_capacity(blocks.len());
        let ends = blocks.iter().map(|block| block.end);
        let (mut j, last) = (0, self.n_samples);
        for end in ends.chain([last]) {
            spread.iter_mut().for_each(|spread| spread.fill(0.0));
            for j in j..end {
                let weights = grid.weights(self.phase(j));
                for (c, signal) in signals.iter().enumerate() {
                    let rest = signal[j] - weights.read(&models[c]);
                    squares[c] += rest * rest;
                    weights.spread(rest, &mut spread[c]);
                }
            }
            j = end.max(j);
            sums.push(spread.iter().map(|spread| grid.sums(spread)).collect());
        }
        // What lies behind the blocks belongs to none.
        sums.truncate(blocks.len());
        (squares, sums)
    }

    /// What the harmonics leave of a signal.
    pub(crate) fn rest(&self, signal: &[f64], coefficients: &[Complex64]) -> Vec<f64> {
        let (model, _) = self.synthesize(coefficients);
        signal.iter().zip(&model).map(|(x, m)| x - m).collect()
    }

    /// The periodic signal of coefficients, and its derivative with respect to `ln ω`: `Re Σ i n ψ_j q_n e^{inψ_j}`.
    pub(crate) fn synthesize(&self, coefficients: &[Complex64]) -> (Vec<f64>, Vec<f64>) {
        if let Some(mut grid) = self.grid() {
            return self.read(&mut grid, coefficients);
        }
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

impl HarmonicFit {
    fn read(&self, grid: &mut PhaseGrid, coefficients: &[Complex64]) -> (Vec<f64>, Vec<f64>) {
        let derivative: Vec<Complex64> =
            coefficients.iter().enumerate().map(|(n, q)| Complex64::new(0.0, n as f64) * q).collect();
        let [signal, slope] = [coefficients, &derivative].map(|q| grid.filled(q));
        let both = (0..self.n_samples).map(|j| {
            let phase = self.phase(j);
            let weights = grid.weights(phase);
            (weights.read(&signal), phase * weights.read(&slope))
        });
        both.unzip()
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
            parts in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 2..9),
            periods in 1.3..7.0f64,
            step in 0.01..0.2f64
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

    /// A record that is long enough for the grid, against its sums term by term.
    #[test]
    fn long_records_have_the_same_coefficients_and_rests() {
        let (harmonics, step, n) = (60, 0.0371, 90_000);
        let fit = HarmonicFit::new(harmonics, step, n).unwrap();
        assert!(fit.grid().is_some());
        let q: Vec<Complex64> =
            (0..=harmonics).map(|k| Complex64::from_polar(1.0 / (1.0 + k as f64).powi(2), -(k as f64))).collect();
        let (model, slope) = fit.synthesize(&q);
        let noise = |j: usize| 1e-3 * ((j * j) as f64 * 0.7).sin();
        let signals: Vec<Vec<f64>> = [1.0, -2.0]
            .map(|a| model.iter().enumerate().map(|(j, x)| a * x + noise(j) * (1.0 + j as f64 / n as f64)).collect())
            .into();
        let signals: Vec<&[f64]> = signals.iter().map(Vec::as_slice).collect();
        let direct: Vec<Vec<Complex64>> = fit.term_by_term(&signals).iter().map(|sums| fit.solve(sums)).collect();
        let found = fit.coefficients(&signals);
        let far = |a: &[Complex64], b: &[Complex64]| a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(far(&found[0], &direct[0]) < 1e-12 && far(&found[1], &direct[1]) < 1e-12);
        let blocks = [0..30_000, 30_000..59_000];
        let (squares, sums) = fit.rests(&signals, &direct, &blocks);
        let (expected, expected_sums) = fit.rests_term_by_term(&signals, &direct, &blocks);
        assert!(squares.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{squares:?} {expected:?}");
        for (a, b) in sums.iter().flatten().zip(expected_sums.iter().flatten()) {
            assert!(far(a, b) < 1e-9, "{}", far(a, b));
        }
        let (mut powers, at) = (vec![Complex64::default(); harmonics + 1], 77_777);
        fit.powers(at, &mut powers);
        let own: Complex64 = q.iter().zip(&powers).enumerate().map(|(n, (q, p))| q * p * n as f64).sum();
        assert!((slope[at] + own.im * fit.phase(at)).abs() < 1e-9 * fit.phase(at).abs());
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
