use num_complex::Complex64;

/// Power of the excitation, and how well it is appropriated to a mode, eqs. (17)-(19).
///
/// With peak amplitudes `F_n`, `V_n` of force and drive-point velocity, `P = ½ Σ Re(F_n V_n*)` is the active and
/// `S = ½ √(Σ|F_n|²) √(Σ|V_n|²)` the apparent power of the harmonics 1 … N. The indicator is `Λ = P/S`: force and
/// velocity are those of one coordinate in one direction, so a force in phase with the velocity brings power in, and +1
/// is perfect. The minus sign of eq. (19) belongs to the opposite count of the force; near −1 the force channel is
/// reversed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ExcitationPower {
    /// Active power `P`, W: brought in by the force.
    pub active: f64,
    /// Active power of the fundamental `P₁`, W.
    pub fundamental: f64,
    /// Apparent power `S`, W.
    pub apparent: f64,
    /// Apparent power of the fundamental, W.
    pub fundamental_apparent: f64,
    /// Number of harmonics N in the sums: without it the indicator means nothing.
    pub harmonics: usize,
}

impl ExcitationPower {
    /// Of the coefficients `F_0 … F_H` of the force (N) and `V_0 … V_H` of the velocity (m/s), up to `harmonics`.
    ///
    /// ```
    /// use nlmodes_experiment::extraction::ExcitationPower;
    /// use num_complex::Complex64;
    /// // Force cos θ, velocity cos θ + ½ cos 2θ.
    /// let [force, velocity] = [[0.0, 1.0, 0.0], [0.0, 1.0, 0.5]].map(|parts| parts.map(Complex64::from));
    /// let power = ExcitationPower::new(&force, &velocity, 2);
    /// assert!((power.indicator() - 2.0 / 5.0_f64.sqrt()).abs() < 1e-15); // 0.894427
    /// ```
    pub fn new(force: &[Complex64], velocity: &[Complex64], harmonics: usize) -> Self {
        let harmonics = harmonics.min(force.len().min(velocity.len()).saturating_sub(1));
        let powers = |harmonics: usize| {
            let pairs = || force.iter().zip(velocity).skip(1).take(harmonics);
            let active: f64 = pairs().map(|(f, v)| (f * v.conj()).re).sum();
            let squares: [f64; 2] =
                [pairs().map(|(f, _)| f.norm_sqr()).sum(), pairs().map(|(_, v)| v.norm_sqr()).sum()];
            (0.5 * active, 0.5 * squares[0].sqrt() * squares[1].sqrt())
        };
        let ((active, apparent), (fundamental, fundamental_apparent)) = (powers(harmonics), powers(harmonics.min(1)));
        Self { active, fundamental, apparent, fundamental_apparent, harmonics }
    }

    /// Power-based mode indicator `Λ = P/S` from −1 to 1; NaN without force or motion.
    pub fn indicator(&self) -> f64 {
        self.active / self.apparent
    }

    /// Power factor of the fundamental alone, from −1 to 1.
    pub fn fundamental_factor(&self) -> f64 {
        self.fundamental / self.fundamental_apparent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_indicator_depends_on_the_harmonics_and_says_how_many() {
        let force = [0.0, 1.0, 0.0].map(Complex64::from);
        let velocity = [5.0, 1.0, 0.5].map(Complex64::from);
        let both = ExcitationPower::new(&force, &velocity, 2);
        assert!((both.indicator() - 0.894_427_190_999_916).abs() < 1e-15);
        let first = ExcitationPower::new(&force, &velocity, 1);
        assert_eq!((first.indicator(), first.harmonics), (1.0, 1));
        let more = ExcitationPower::new(&force, &velocity, 50);
        assert_eq!(more, both);
        let reversed = ExcitationPower::new(&force.map(|f| -f), &velocity, 2);
        assert!((reversed.indicator() + 0.894_427_190_999_916).abs() < 1e-15);
        assert!(ExcitationPower::new(&[], &[], 3).indicator().is_nan());
    }

    /// The fundamental has `½|F₁||V₁| cos φ`, however many other harmonics are in the sums.
    #[test]
    fn apparent_powers_are_products_of_effective_values() {
        for (size, turn) in [(1.0, 0.0), (1e-6, 0.7), (2e3, -2.0)] {
            let force = [7.0.into(), Complex64::new(3.0, 4.0) * size, Complex64::new(0.0, 12.0) * size];
            let velocity =
                [1.0.into(), Complex64::from_polar(2.0, turn) * force[1] / 5.0 / size, Complex64::new(1.5, 0.0)];
            for harmonics in [1, 2] {
                let power = ExcitationPower::new(&force, &velocity, harmonics);
                assert!((power.fundamental_apparent - 5.0 * size).abs() < 1e-14 * size, "{power:?}");
                assert!((power.fundamental_factor() - turn.cos()).abs() < 1e-14, "{power:?}");
                // 5 and 12 of the force make 13, 2 and 1.5 of the velocity 2.5.
                let expected = if harmonics == 1 { 5.0 } else { 0.5 * 13.0 * 2.5 };
                assert!((power.apparent - expected * size).abs() < 1e-13 * size, "{power:?}");
            }
        }
        let none = ExcitationPower::new(&[7.0.into()], &[1.0.into()], 3);
        assert_eq!((none.active, none.fundamental, none.apparent, none.fundamental_apparent), (0.0, 0.0, 0.0, 0.0));
    }

    #[test]
    fn active_power_is_the_mean_of_force_times_velocity() {
        let force = [0.0.into(), Complex64::new(1.0, 0.4), Complex64::new(-0.3, 0.2)];
        let velocity = [0.0.into(), Complex64::new(0.2, 1.0), Complex64::new(0.1, -0.5)];
        let n = 32;
        let at = |q: &[Complex64], tau: f64| -> f64 {
            q.iter().enumerate().map(|(k, q)| (q * Complex64::cis(k as f64 * tau)).re).sum()
        };
        let instants = (0..n).map(|j| std::f64::consts::TAU * f64::from(j) / f64::from(n));
        let mean: f64 = instants.map(|tau| at(&force, tau) * at(&velocity, tau)).sum::<f64>() / f64::from(n);
        assert!((ExcitationPower::new(&force, &velocity, 2).active - mean).abs() < 1e-15);
    }
}
