use std::ops::RangeInclusive;

use num_complex::Complex64;

/// Which motions are admitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Symmetry {
    /// Motions that are even in time (monophase): cosine coefficients only. The reduced system is square without a
    /// phase anchor.
    #[default]
    Even,
    /// Any periodic motion: cosine and sine coefficients, a phase anchor, and an unfolding term that vanishes on
    /// solutions.
    None,
}

/// A real Fourier series `b(τ) = c_0 + Σ c_n cos nτ + s_n sin nτ`, stored as `c_0 … c_H (s_1 … s_H)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RealSeries {
    /// Which coefficients there are.
    pub symmetry: Symmetry,
    /// Highest harmonic H.
    pub n_harmonics: usize,
}

impl RealSeries {
    /// Real coefficients a coordinate: H + 1 or 2 H + 1.
    pub fn width(&self) -> usize {
        match self.symmetry {
            Symmetry::Even => self.n_harmonics + 1,
            Symmetry::None => 2 * self.n_harmonics + 1,
        }
    }

    /// Harmonic of coefficient `m`, and whether it is that of a sine.
    pub fn harmonic(&self, m: usize) -> (usize, bool) {
        if m <= self.n_harmonics { (m, false) } else { (m - self.n_harmonics, true) }
    }

    /// Index of the sine coefficient of harmonic `n`, if there is one; the mean has none.
    pub fn sine(&self, n: usize) -> Option<usize> {
        (self.symmetry == Symmetry::None && n > 0).then_some(self.n_harmonics + n)
    }

    /// The coefficient that the derivative by τ brings to coefficient `m`, and its factor.
    pub(crate) fn turned(&self, m: usize) -> Option<(usize, f64)> {
        let (n, is_sine) = self.harmonic(m);
        let sine = self.sine(n)?;
        Some(if is_sine { (n, -(n as f64)) } else { (sine, n as f64) })
    }

    /// Writes the complex coefficient `z = c_n − i s_n` into a series.
    pub(crate) fn put(&self, z: Complex64, n: usize, real: &mut [f64]) {
        real[n] = z.re;
        if let Some(sine) = self.sine(n) {
            real[sine] = -z.im;
        }
    }

    /// Complex coefficients `c_n − i s_n` of eq. (7).
    pub fn to_complex(&self, real: &[f64], complex: &mut [Complex64]) {
        for (n, z) in complex.iter_mut().enumerate() {
            *z = Complex64::new(real[n], -self.sine(n).map_or(0.0, |i| real[i]));
        }
    }

    /// Coefficients of a series with more harmonics, or fewer, of the same symmetry: those that both have, the others
    /// zero.
    pub fn resized(&self, real: &[f64], to: RealSeries) -> Vec<f64> {
        let mut other = vec![0.0; to.width()];
        for n in 0..=self.n_harmonics.min(to.n_harmonics) {
            other[n] = real[n];
            if let (Some(from), Some(to)) = (self.sine(n), to.sine(n)) {
                other[to] = real[from];
            }
        }
        other
    }

    /// Matrix of "multiply by `χ(τ)`, keep the harmonics up to H" on the coefficients, from the averages
    /// `(1/2π) ∫ χ e^{−ikτ} dτ = C_k − i S_k`, k = 0 … 2H. Row-major, width × width.
    pub fn multiplication(&self, averages: &[Complex64]) -> Vec<f64> {
        let (width, h) = (self.width(), self.n_harmonics);
        if self.symmetry == Symmetry::Even {
            return self.even_multiplication(averages);
        }
        // C_k and S_k, k = −H … 2H: a row takes parts of them that begin m before and m behind.
        let below = averages[1..=h].iter().rev();
        let cosines: Vec<f64> = below.clone().chain(averages).map(|z| z.re).collect();
        let sines: Vec<f64> = below.map(|z| z.im).chain([0.0]).chain(averages[1..].iter().map(|z| -z.im)).collect();
        let mut matrix = Vec::with_capacity(width * width);
        for i in 0..width {
            let (m, row_is_sine) = self.harmonic(i);
            let scale = if m == 0 { 0.5 } else { 1.0 };
            let (of_cosines, of_sines) = (h..=2 * h, h + 1..=2 * h);
            if row_is_sine {
                matrix.extend(around(&sines, of_cosines, m).map(|(near, far)| far - near));
                matrix.extend(around(&cosines, of_sines, m).map(|(near, far)| near - far));
            } else {
                matrix.extend(around(&cosines, of_cosines, m).map(|(near, far)| scale * (near + far)));
                matrix.extend(around(&sines, of_sines, m).map(|(near, far)| scale * (near + far)));
            }
        }
        matrix
    }

    /// Toeplitz and Hankel part, `C_|m−n| + C_m+n`, as two parts of the averages mirrored about `C_0`.
    fn even_multiplication(&self, averages: &[Complex64]) -> Vec<f64> {
        let (width, h) = (self.width(), self.n_harmonics);
        let mirrored: Vec<f64> = averages[1..=h].iter().rev().chain(averages).map(|z| z.re).collect();
        let mut matrix = Vec::with_capacity(width * width);
        for m in 0..width {
            let scale = if m == 0 { 0.5 } else { 1.0 };
            matrix.extend(around(&mirrored, h..=2 * h, m).map(|(toeplitz, hankel)| scale * (toeplitz + hankel)));
        }
        matrix
    }

    /// Coefficients of `χ(τ)` itself.
    pub fn coefficients_of(&self, averages: &[Complex64]) -> Vec<f64> {
        let coefficient = |i: usize| {
            let (n, is_sine) = self.harmonic(i);
            let scale = if n == 0 { 1.0 } else { 2.0 };
            scale * if is_sine { -averages[n].im } else { averages[n].re }
        };
        (0..self.width()).map(coefficient).collect()
    }
}

/// The values `m` before these places, and `m` behind them.
fn around(all: &[f64], at: RangeInclusive<usize>, m: usize) -> impl Iterator<Item = (f64, f64)> {
    all[at.start() - m..=at.end() - m].iter().copied().zip(all[at.start() + m..=at.end() + m].iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes_modal::HarmonicBasis;

    #[test]
    fn multiplication_by_an_indicator_matches_the_product_in_time() {
        let (h, n) = (4, 256);
        let mut basis = HarmonicBasis::new(h, n).unwrap();
        let indicator: Vec<f64> = (0..n).map(|j| if (30..90).contains(&j) { 1.0 } else { 0.0 }).collect();
        let mut averages = vec![Complex64::default(); 2 * h + 1];
        basis.averages(&indicator, &mut averages);
        let series = RealSeries { symmetry: Symmetry::None, n_harmonics: h };
        let w = series.width();
        let b: Vec<f64> = (0..w).map(|i| (1.3 * i as f64 + 0.4).sin()).collect();
        let mut z = vec![Complex64::default(); h + 1];
        series.to_complex(&b, &mut z);
        let mut samples = vec![0.0; n];
        basis.synthesize(&z, &mut samples);
        samples.iter_mut().zip(&indicator).for_each(|(s, i)| *s *= i);
        basis.analyze(&samples, &mut z);
        let matrix = series.multiplication(&averages);
        for i in 0..w {
            let (k, is_sine) = series.harmonic(i);
            let expected = if is_sine { -z[k].im } else { z[k].re };
            let product: f64 = (0..w).map(|j| matrix[i * w + j] * b[j]).sum();
            assert!((product - expected).abs() < 1e-13, "row {i}: {product} vs {expected}");
        }
    }
}
