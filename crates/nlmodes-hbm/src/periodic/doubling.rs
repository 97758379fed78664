use std::f64::consts::{PI, TAU};

use nlmodes_linalg::{DenseLu, Mat};
use num_complex::Complex64;

use super::system::PeriodicSystem;
use crate::{HbmError, PatternInterval};

/// Samples of a turn for each harmonic, and steps of inverse iteration.
const SAMPLES: usize = 24;
const ITERATIONS: usize = 3;

impl PeriodicSystem {
    /// The disturbance of the motion with the unknowns `x` whose multiplier is nearest to −1: it changes its sign from
    /// period to period.
    ///
    /// ```text
    /// M v = −v ,   δη(τ) = Re Σ_k δη_k e^{ikτ/2} ,   k = 1, 3, 5 … `highest`
    /// δη_k = (1/π) ∫_0^{2π} δη(τ) e^{−ikτ/2} dτ
    /// ```
    ///
    /// Modal coordinates (m) harmonic by harmonic of half the frequency, even ones zero; of size one.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there, or a factorisation fails.
    pub fn doubling_disturbance(&mut self, x: &[f64], p: f64, highest: usize) -> Result<Vec<Vec<Complex64>>, HbmError> {
        let at = self.solve(x, p)?;
        let laws = self.law_motion(x, at.omega);
        let m = self.structure.n_modes();
        let intervals: Vec<PatternInterval> = self.operator.intervals().to_vec();
        let mut flows = Vec::with_capacity(intervals.len());
        let mut monodromy = Mat::<f64>::identity(self.n_states(), self.n_states());
        for interval in &intervals {
            let width = interval.to - interval.from;
            let parts = 2 * ((0.5 * width / TAU * (SAMPLES * (highest + 1)) as f64).ceil() as usize).max(1);
            let part = PatternInterval { to: interval.from + width / parts as f64, ..*interval };
            // Between two instants nothing changes but the slopes of laws.
            let different = if self.structure.laws().is_empty() { 1 } else { parts };
            let at_part = |j: usize| {
                let by = j as f64 * width / parts as f64;
                PatternInterval { from: part.from + by, to: part.to + by, ..part }
            };
            let steps = (0..different).map(|j| self.step(&self.operator, &laws, &at_part(j), at));
            let steps = steps.collect::<Result<Vec<_>, _>>()?;
            (0..parts).for_each(|j| monodromy = &steps[j % different] * &monodromy);
            flows.push((*interval, parts, steps));
        }
        let mut state = opposite(&monodromy)?;
        let mut sums = vec![vec![Complex64::default(); m]; highest + 1];
        for (interval, parts, steps) in &flows {
            let width = (interval.to - interval.from) / *parts as f64;
            for j in 0..=*parts {
                // Simpson's rule.
                let weight = match j {
                    0 => 1.0,
                    j if j == *parts => 1.0,
                    j if j % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                let tau = interval.from + width * j as f64;
                for (k, sum) in sums.iter_mut().enumerate().skip(1).step_by(2) {
                    let factor = Complex64::cis(-0.5 * k as f64 * tau) * (weight * width / (3.0 * PI));
                    sum.iter_mut().zip(&state).for_each(|(sum, z)| *sum += factor * *z);
                }
                if j < *parts {
                    state = times(&steps[j % steps.len()], &state);
                }
            }
        }
        let size = sums.iter().flatten().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
        sums.iter_mut().flatten().for_each(|z| *z /= size);
        Ok(sums)
    }

    /// Coefficients of the unknowns for modal coordinates (m each, harmonic by harmonic), without what contact forces
    /// add statically.
    pub fn coefficients_of(&self, eta: &[Vec<Complex64>]) -> Vec<f64> {
        let (series, unit) = (self.series(), self.unit());
        let width = series.width();
        let mut x = vec![0.0; self.n_coefficients()];
        for k in 0..self.structure.n_modes() {
            for (j, share) in self.response.of_mode(k).into_iter().enumerate().filter(|(_, share)| *share != 0.0) {
                let x = &mut x[j * width..(j + 1) * width];
                for (n, eta) in eta.iter().enumerate().take(series.n_harmonics + 1) {
                    let z = eta[k] * (share / unit);
                    x[n] += z.re;
                    if let Some(sine) = series.sine(n) {
                        x[sine] -= z.im;
                    }
                }
            }
        }
        x
    }
}

/// The eigenvector whose eigenvalue is nearest to −1, by inverse iteration.
fn opposite(monodromy: &Mat<f64>) -> Result<Vec<f64>, HbmError> {
    let n = monodromy.nrows();
    // Beside the eigenvalue, which may be −1 to the last digit.
    let shift = 1.0 + 1e-9;
    let shifted = Mat::from_fn(n, n, |i, j| monodromy[(i, j)] + if i == j { shift } else { 0.0 });
    let lu = DenseLu::factor(&shifted)
        .map_err(|source| HbmError::Linalg { what: "the disturbance at a period doubling", source })?;
    let mut v: Vec<f64> = (0..n).map(|i| (1.0 + 1.7 * i as f64).cos()).collect();
    for _ in 0..ITERATIONS {
        lu.solve_in_place(&mut v);
        let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        v.iter_mut().for_each(|v| *v /= size);
    }
    Ok(v)
}

fn times(a: &Mat<f64>, v: &[f64]) -> Vec<f64> {
    (0..a.nrows()).map(|i| v.iter().enumerate().map(|(j, v)| a[(i, j)] * v).sum()).collect()
}
