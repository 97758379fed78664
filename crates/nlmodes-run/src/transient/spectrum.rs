//! Amplitude spectra of histories.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rustfft::FftPlanner;

/// Amplitudes of a history without its mean, at multiples of the inverse of its length: a window of Hann, scaled so
/// that a line between them reads its amplitude, to 15 % at worst.
pub fn spectrum(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    if n < 2 {
        return Vec::new();
    }
    let mean = values.iter().sum::<f64>() / n as f64;
    let hann = |k: usize| 1.0 - (TAU * k as f64 / n as f64).cos();
    let mut all: Vec<Complex64> =
        values.iter().enumerate().map(|(k, v)| Complex64::from((v - mean) * hann(k))).collect();
    FftPlanner::new().plan_fft_forward(n).process(&mut all);
    all[..=n / 2].iter().map(|z| 2.0 * z.norm() / n as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_beside_a_mean_reads_its_amplitude_at_its_line() {
        let of = |lines: f64| (0..400).map(|k| 5.0 + 3.0 * (TAU * lines * f64::from(k) / 400.0).cos()).collect();
        let values: Vec<f64> = of(20.0);
        let found = spectrum(&values);
        assert_eq!(found.len(), 201);
        assert!((found[20] - 3.0).abs() < 1e-12 && found[30] < 1e-12 && found[0] < 1e-12);
        // Halfway between two lines.
        let between: Vec<f64> = of(20.5);
        let found = spectrum(&between);
        assert!((found[20] / 3.0 - 0.849).abs() < 1e-3, "{}", found[20]);
    }
}
