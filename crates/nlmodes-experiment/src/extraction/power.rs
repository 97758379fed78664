use num_complex::Complex64;

/// Power of the excitation, and how well it is appropriated to a mode, eqs. (17)-(19).
///
/// With peak amplitudes `F_n`, `V_n` of force and drive-point velocity, `P = ½ Σ Re(F_n V_n*)` is the active and
/// `S = ½ √(Σ|F_n|²) √(Σ|V_n|²)` the apparent power of the harmonics 1 … N. The indicator is `Λ = P/S`: force and velocity are those of one
/// coordinate in one direction, so a force in phase with the velocity brings power in, and +1 is perfect. The minus sign of eq. (19) belongs
/// to the opposite count of the force; near −1 the force channel is reversed.
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
    /// // Force cos θ, velocity cos θ + ½ cos 2θ.
    /// let power = ExcitationPower::new(&[0.0.into(), 1.0.into(), 0.0.into()], &[0.0.into(), 1.0.into(), 0.5.into()], 2);
    /// assert!((power.indicator() - 2.0 / 5.0_f64.sqrt()).abs() < 1e-15); // 0.894427
    /// ```
    pub fn new(force: &[Complex64], velocity: &[Complex64], harmonics: usize) -> Self {
        let harmonics = harmonics.min(force.len().min(velocity.len()).saturating_sub(1));
        let active = |n: usize| 0.5 * (force[n] * velocity[n].conj()).re;
        let square = |signal: &[Complex64]| signal[..=harmonics].iter().skip(1).map(Complex64::norm_sqr).sum::<f64>();
        let fundamental = |of: fn(f64, f64) -> f64| {
            if harmonics == 0 { 0.0 } else { of(force[1].norm(), velocity[1].norm()) }
        };
        Self {
            active: (1..=harmonics).map(active).sum(),
            fundamental: if harmonics == 0 { 0.0 } else { active(1) },
            apparent: if harmonics == 0 { 0.0 } else { 0.5 * (square(force) * square(velocity)).sqrt() },
            fundamental_apparent: fundamental(|f, v| 0.5 * f * v),
            harmonics,
        }
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
