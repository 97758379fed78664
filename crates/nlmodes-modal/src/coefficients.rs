use num_complex::Complex64;

/// Complex Fourier coefficients of a periodic motion of several coordinates, eq. (7):
/// `q_d(t) = Re Σ_{n=0}^{H} q_{d,n} e^{inωt}`.
///
/// Shape: coordinates × (H + 1); the unit is that of the coordinate. The mean `q_{d,0}` is real.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HarmonicCoefficients {
    n_coordinates: usize,
    n_harmonics: usize,
    values: Vec<Complex64>,
}

impl HarmonicCoefficients {
    /// All zero.
    pub fn zeros(n_coordinates: usize, n_harmonics: usize) -> Self {
        Self { n_coordinates, n_harmonics, values: vec![Complex64::default(); n_coordinates * (n_harmonics + 1)] }
    }

    /// Number of coordinates.
    pub fn n_coordinates(&self) -> usize {
        self.n_coordinates
    }

    /// Highest harmonic H.
    pub fn n_harmonics(&self) -> usize {
        self.n_harmonics
    }

    /// Coefficients `q_{d,0} … q_{d,H}` of coordinate `d`.
    ///
    /// # Panics
    /// If there is no coordinate `d`.
    pub fn of(&self, d: usize) -> &[Complex64] {
        let width = self.n_harmonics + 1;
        &self.values[d * width..(d + 1) * width]
    }

    /// As [`Self::of`], mutable.
    ///
    /// # Panics
    /// If there is no coordinate `d`.
    pub fn of_mut(&mut self, d: usize) -> &mut [Complex64] {
        let width = self.n_harmonics + 1;
        &mut self.values[d * width..(d + 1) * width]
    }

    /// The harmonics up to `n_harmonics`; all of them if there are fewer.
    pub fn truncated(&self, n_harmonics: usize) -> Self {
        let mut kept = Self::zeros(self.n_coordinates, n_harmonics.min(self.n_harmonics));
        let width = kept.n_harmonics + 1;
        (0..self.n_coordinates).for_each(|d| kept.of_mut(d).copy_from_slice(&self.of(d)[..width]));
        kept
    }

    /// Value of coordinate `d` at the phase `tau = ωt` (rad).
    pub fn value(&self, d: usize, tau: f64) -> f64 {
        self.derivative(d, tau, 0)
    }

    /// `order`-th derivative of coordinate `d` with respect to `tau = ωt`, at the phase `tau`.
    pub fn derivative(&self, d: usize, tau: f64, order: u32) -> f64 {
        let terms = self.of(d).iter().enumerate();
        terms.map(|(n, q)| (Complex64::new(0.0, n as f64).powu(order) * q * Complex64::cis(n as f64 * tau)).re).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_derivatives_are_those_of_the_series() {
        // 0.5 + 2 cos τ − 3 sin 2τ, and zero at the other coordinate.
        let mut series = HarmonicCoefficients::zeros(2, 2);
        series.of_mut(1).copy_from_slice(&[0.5.into(), 2.0.into(), Complex64::new(0.0, 3.0)]);
        for tau in [0.0, 0.7, -2.0, 9.0] {
            let (first, second) = (f64::sin_cos(tau), f64::sin_cos(2.0 * tau));
            let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-13, "{tau}: {found}");
            near(series.value(1, tau), 0.5 + 2.0 * first.1 - 3.0 * second.0);
            near(series.derivative(1, tau, 1), -2.0 * first.0 - 6.0 * second.1);
            near(series.derivative(1, tau, 2), -2.0 * first.1 + 12.0 * second.0);
            assert_eq!(series.value(0, tau), 0.0);
        }
    }

    #[test]
    fn truncated_series_have_the_first_harmonics_of_each_coordinate() {
        let mut series = HarmonicCoefficients::zeros(2, 3);
        (0..2).for_each(|d| (0..4).for_each(|n| series.of_mut(d)[n] = Complex64::new((10 * d + n) as f64, 0.5)));
        let kept = series.truncated(1);
        assert_eq!((kept.n_harmonics(), kept.of(0), kept.of(1)), (1, &series.of(0)[..2], &series.of(1)[..2]));
        assert_eq!(series.truncated(9), series);
    }
}
