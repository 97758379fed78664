use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

use crate::ModalError;

/// Samples of one period and the Fourier coefficients of eq. (7), both ways, by fast Fourier transform (eq. 14).
///
/// Sample `j` of `N` is at the phase `τ_j = 2π j / N`.
///
/// ```
/// use nlmodes_modal::HarmonicBasis;
/// use num_complex::Complex64;
/// let mut basis = HarmonicBasis::new(2, 16)?;
/// let coefficients = [0.5.into(), 0.0.into(), Complex64::new(0.0, -3.0)]; // 0.5 + 3 sin 2τ
/// let (mut samples, mut back) = (vec![0.0; 16], vec![Complex64::default(); 3]);
/// basis.synthesize(&coefficients, &mut samples);
/// assert!((samples[2] - 3.5).abs() < 1e-14);
/// basis.analyze(&samples, &mut back);
/// assert!((back[2] - coefficients[2]).norm() < 1e-14);
/// # Ok::<(), nlmodes_modal::ModalError>(())
/// ```
#[derive(Clone)]
pub struct HarmonicBasis {
    n_harmonics: usize,
    n_samples: usize,
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
    buffer: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl fmt::Debug for HarmonicBasis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "HarmonicBasis({} harmonics, {} samples)", self.n_harmonics, self.n_samples)
    }
}

impl HarmonicBasis {
    /// Harmonics 0 to `n_harmonics`, `n_samples` per period.
    ///
    /// # Errors
    /// [`ModalError::TooFewSamples`] with fewer than `2 n_harmonics + 1` samples.
    pub fn new(n_harmonics: usize, n_samples: usize) -> Result<Self, ModalError> {
        let needed = 2 * n_harmonics + 1;
        if n_samples < needed {
            return Err(ModalError::TooFewSamples { harmonics: n_harmonics, samples: n_samples, needed });
        }
        let mut planner = FftPlanner::new();
        let forward = planner.plan_fft_forward(n_samples);
        let inverse = planner.plan_fft_inverse(n_samples);
        let scratch = forward.get_inplace_scratch_len().max(inverse.get_inplace_scratch_len());
        Ok(Self {
            n_harmonics,
            n_samples,
            forward,
            inverse,
            buffer: vec![Complex64::default(); n_samples],
            scratch: vec![Complex64::default(); scratch],
        })
    }

    /// Highest harmonic H.
    pub fn n_harmonics(&self) -> usize {
        self.n_harmonics
    }

    /// Samples per period N.
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// Samples `q(τ_j) = Re Σ q_n e^{inτ_j}` of the H + 1 coefficients `q_n`.
    ///
    /// # Panics
    /// If a slice has not H + 1 or N entries.
    pub fn synthesize(&mut self, coefficients: &[Complex64], samples: &mut [f64]) {
        assert_eq!((coefficients.len(), samples.len()), (self.n_harmonics + 1, self.n_samples));
        self.buffer.fill(Complex64::default());
        self.buffer[..coefficients.len()].copy_from_slice(coefficients);
        self.inverse.process_with_scratch(&mut self.buffer, &mut self.scratch);
        samples.iter_mut().zip(&self.buffer).for_each(|(s, z)| *s = z.re);
    }

    /// Samples of the motion and of its derivative `dq/dτ`, from one transform.
    ///
    /// # Panics
    /// If a slice has not H + 1 or N entries.
    pub fn synthesize_with_slope(&mut self, coefficients: &[Complex64], samples: &mut [f64], slopes: &mut [f64]) {
        assert_eq!((coefficients.len(), samples.len()), (self.n_harmonics + 1, self.n_samples));
        let n = self.n_samples;
        self.buffer.fill(Complex64::default());
        // Two real series as real and imaginary part: each is written with its conjugate-symmetric half.
        for (k, q) in coefficients.iter().enumerate() {
            let slope = Complex64::new(-q.im, q.re) * k as f64;
            let (half, half_slope) = (q * 0.5, slope * 0.5);
            self.buffer[k] += half + Complex64::i() * half_slope;
            self.buffer[(n - k) % n] += half.conj() + Complex64::i() * half_slope.conj();
        }
        self.inverse.process_with_scratch(&mut self.buffer, &mut self.scratch);
        for ((s, d), z) in samples.iter_mut().zip(slopes).zip(&self.buffer) {
            (*s, *d) = (z.re, z.im);
        }
    }

    /// Coefficients `q_0 … q_H` of N samples: `q_n = (2/N) Σ_j q(τ_j) e^{−inτ_j}`, half of that for the mean.
    ///
    /// # Panics
    /// If a slice has not H + 1 or N entries.
    pub fn analyze(&mut self, samples: &[f64], coefficients: &mut [Complex64]) {
        assert_eq!((coefficients.len(), samples.len()), (self.n_harmonics + 1, self.n_samples));
        self.buffer.iter_mut().zip(samples).for_each(|(z, s)| *z = Complex64::new(*s, 0.0));
        self.forward.process_with_scratch(&mut self.buffer, &mut self.scratch);
        let scale = 2.0 / self.n_samples as f64;
        coefficients.iter_mut().zip(&self.buffer).for_each(|(q, z)| *q = z * scale);
        coefficients[0] *= 0.5;
    }

    /// Averages `(1/N) Σ_j s_j e^{−ikτ_j}` for k = 0 … `averages.len() − 1`, also beyond N (the sums repeat).
    ///
    /// # Panics
    /// If `samples` has not N entries.
    pub fn averages(&mut self, samples: &[f64], averages: &mut [Complex64]) {
        assert_eq!(samples.len(), self.n_samples);
        self.buffer.iter_mut().zip(samples).for_each(|(z, s)| *z = Complex64::new(*s, 0.0));
        self.forward.process_with_scratch(&mut self.buffer, &mut self.scratch);
        let scale = 1.0 / self.n_samples as f64;
        averages.iter_mut().enumerate().for_each(|(k, q)| *q = self.buffer[k % self.n_samples] * scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn synthesis_matches_the_sum_and_analysis_inverts_it(
            parts in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 1..12), extra in 0usize..20
        ) {
            let h = parts.len() - 1;
            let n = 2 * h + 1 + extra;
            let mut q: Vec<Complex64> = parts.iter().map(|&(re, im)| Complex64::new(re, im)).collect();
            q[0].im = 0.0;
            let mut basis = HarmonicBasis::new(h, n).unwrap();
            prop_assert_eq!((basis.n_harmonics(), basis.n_samples()), (h, n));
            let (mut s, mut d, mut only) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            basis.synthesize_with_slope(&q, &mut s, &mut d);
            basis.synthesize(&q, &mut only);
            for j in 0..n {
                let tau = std::f64::consts::TAU * j as f64 / n as f64;
                let sum: f64 = q.iter().enumerate().map(|(k, q)| (q * Complex64::cis(k as f64 * tau)).re).sum();
                let slope: f64 = q.iter().enumerate()
                    .map(|(k, q)| (Complex64::new(0.0, k as f64) * q * Complex64::cis(k as f64 * tau)).re).sum();
                prop_assert!((s[j] - sum).abs() < 1e-12 && (only[j] - sum).abs() < 1e-12);
                prop_assert!((d[j] - slope).abs() < 1e-11);
            }
            let mut back = vec![Complex64::default(); h + 1];
            basis.analyze(&s, &mut back);
            for (a, b) in q.iter().zip(&back) {
                prop_assert!((a - b).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn averages_are_the_sums_also_beyond_the_number_of_samples() {
        let samples = [0.3, -1.2, 2.0, 0.7, -0.4, 5.0, 0.01];
        let mut averages = vec![Complex64::default(); 10];
        HarmonicBasis::new(2, 7).unwrap().averages(&samples, &mut averages);
        for (k, average) in averages.iter().enumerate() {
            let term = |(j, s): (usize, &f64)| Complex64::cis(-std::f64::consts::TAU * (k * j) as f64 / 7.0) * *s / 7.0;
            let sum: Complex64 = samples.iter().enumerate().map(term).sum();
            assert!((average - sum).norm() < 1e-14, "{k}: {average} {sum}");
        }
    }

    #[test]
    fn too_few_samples_are_refused() {
        assert_eq!(
            HarmonicBasis::new(3, 6).unwrap_err(),
            ModalError::TooFewSamples { harmonics: 3, samples: 6, needed: 7 }
        );
    }
}
