use num_complex::Complex64;

/// Which motions are admitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Symmetry {
    /// Motions that are even in time (monophase): cosine coefficients only. The reduced system is square without a phase anchor.
    #[default]
    Even,
    /// Any periodic motion: cosine and sine coefficients, a phase anchor, and an unfolding term that vanishes on solutions.
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

    /// Index of the sine coefficient of harmonic `n ≥ 1`, if there is one.
    pub fn sine(&self, n: usize) -> Option<usize> {
        (self.symmetry == Symmetry::None).then_some(self.n_harmonics + n)
    }

    /// The coefficient that the derivative by τ brings to coefficient `m`, and its factor.
    pub(crate) fn turned(&self, m: usize) -> Option<(usize, f64)> {
        let (n, is_sine) = self.harmonic(m);
        let sine = (n > 0).then(|| self.sine(n)).flatten()?;
        Some(if is_sine { (n, -(n as f64)) } else { (sine, n as f64) })
    }

    /// Writes the complex coefficient `z = c_n − i s_n` into a series.
    pub(crate) fn put(&self, z: Complex64, n: usize, real: &mut [f64]) {
        real[n] = z.re;
        if let (true, Some(sine)) = (n > 0, self.sine(n)) {
            real[sine] = -z.im;
        }
    }

    /// Complex coefficients `c_n − i s_n` of eq. (7).
    pub fn to_complex(&self, real: &[f64], complex: &mut [Complex64]) {
        for (n, z) in complex.iter_mut().enumerate() {
            let s = if n == 0 { 0.0 } else { self.sine(n).map_or(0.0, |i| real[i]) };
            *z = Complex64::new(real[n], -s);
        }
    }

    /// Coefficients of a series with more harmonics, or fewer, of the same symmetry: those that both have, the others zero.
    pub fn resized(&self, real: &[f64], to: RealSeries) -> Vec<f64> {
        let mut other = vec![0.0; to.width()];
        for n in 0..=self.n_harmonics.min(to.n_harmonics) {
            other[n] = real[n];
            if let (true, Some(from), Some(to)) = (n > 0, self.sine(n), to.sine(n)) {
                other[to] = real[from];
            }
        }
        other
    }

    /// Matrix of "multiply by `χ(τ)`, keep the harmonics up to H" on the coefficients, from the averages
    /// `(1/2π) ∫ χ e^{−ikτ} dτ = C_k − i S_k`, k = 0 … 2H. Row-major, width × width.
    pub fn multiplication(&self, averages: &[Complex64], matrix: &mut [f64]) {
        let width = self.width();
        if self.symmetry == Symmetry::Even {
            return self.even_multiplication(averages, matrix);
        }
        let h = self.n_harmonics;
        // C_k and S_k, k = −H … 2H: a row takes stretches of them that begin m before and m behind.
        let below = averages[1..=h].iter().rev();
        let cosines: Vec<f64> = below.clone().chain(averages).map(|z| z.re).collect();
        let sines: Vec<f64> = below.map(|z| z.im).chain([0.0]).chain(averages[1..].iter().map(|z| -z.im)).collect();
        for (i, row) in matrix.chunks_exact_mut(width).enumerate() {
            let (m, row_is_sine) = self.harmonic(i);
            let scale = if m == 0 { 0.5 } else { 1.0 };
            let (of_cosines, of_sines) = row.split_at_mut(h + 1);
            if row_is_sine {
                fill(of_cosines, around(&sines, h, m), |near, far| far - near);
                fill(of_sines, around(&cosines, h + 1, m), |near, far| near - far);
            } else {
                fill(of_cosines, around(&cosines, h, m), |near, far| scale * (near + far));
                fill(of_sines, around(&sines, h + 1, m), |near, far| scale * (far + near));
            }
        }
    }

    /// Toeplitz and Hankel part, `C_|m−n| + C_m+n`, as two stretches of the averages mirrored about `C_0`.
    fn even_multiplication(&self, averages: &[Complex64], matrix: &mut [f64]) {
        let (width, h) = (self.width(), self.n_harmonics);
        let mirrored: Vec<f64> = averages[1..=h].iter().rev().chain(averages).map(|z| z.re).collect();
        for (m, row) in matrix.chunks_exact_mut(width).enumerate() {
            let scale = if m == 0 { 0.5 } else { 1.0 };
            let (toeplitz, hankel) = (&mirrored[h - m..h - m + width], &mirrored[h + m..h + m + width]);
            row.iter_mut().zip(toeplitz.iter().zip(hankel)).for_each(|(r, (t, s))| *r = scale * (t + s));
        }
    }

    /// Coefficients of `χ(τ)` itself.
    pub fn coefficients_of(&self, averages: &[Complex64], out: &mut [f64]) {
        for (i, value) in out.iter_mut().enumerate() {
            let (n, is_sine) = self.harmonic(i);
            let scale = if n == 0 { 1.0 } else { 2.0 };
            *value = scale * if is_sine { -averages[n].im } else { averages[n].re };
        }
    }
}

/// What begins `m` before `first`, and `m` behind it.
fn around(all: &[f64], first: usize, m: usize) -> (&[f64], &[f64]) {
    (&all[first - m..], &all[first + m..])
}

fn fill(row: &mut [f64], (near, far): (&[f64], &[f64]), entry: impl Fn(f64, f64) -> f64) {
    row.iter_mut().zip(near.iter().zip(far)).for_each(|(to, (near, far))| *to = entry(*near, *far));
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
        let mut matrix = vec![0.0; w * w];
        series.multiplication(&averages, &mut matrix);
        for i in 0..w {
            let (k, is_sine) = series.harmonic(i);
            let expected = if is_sine { -z[k].im } else { z[k].re };
            let product: f64 = (0..w).map(|j| matrix[i * w + j] * b[j]).sum();
            assert!((product - expected).abs() < 1e-13, "row {i}: {product} vs {expected}");
        }
    }
}
