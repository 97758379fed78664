use crate::{HarmonicCoefficients, LinearModes};

/// Nonlinear modal damping coefficient `δ̃ = P₁/(q̃² ω̃³)`, eq. (28), from the balance of the fundamental's power, eq.
/// (27).
///
/// `fundamental_power` in W, `modal_amplitude` in m·√kg, `omega` in rad/s; the result is a dimensionless damping ratio.
pub fn damping_coefficient(fundamental_power: f64, modal_amplitude: f64, omega: f64) -> f64 {
    fundamental_power / (modal_amplitude.powi(2) * omega.powi(3))
}

/// Power that the damping ratios of linear modes dissipate in a periodic motion, harmonic by harmonic, eqs. (25), (26).
///
/// With `Φᵀ D Φ = diag(2 ζ_k ω_k)` and the modal coordinates `η_{k,n}` the summand of eq. (25) is `P_n = ½ (nω)² Σ_k 2
/// ζ_k ω_k |η_{k,n}|²`, in W, and eq. (26) gives `δ̃_n = Σ_k ζ_k ω_k |η_{k,n}|² / (ω q̃²)`. The difference from the
/// active power of the excitation (eq. 24) is dissipated elsewhere: at the contact, or in modes that are not included.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LinearDissipation {
    /// Power `P_n` of the harmonics 1, 2, …, W.
    pub power: Vec<f64>,
    /// Damping coefficients `δ̃_n` of the harmonics 1, 2, … (eq. 26).
    pub coefficients: Vec<f64>,
}

impl LinearDissipation {
    /// Of the modal coordinates `modal` (modes × (H + 1), m·√kg) at the frequency `omega` (rad/s).
    ///
    /// # Panics
    /// If the number of rows of `modal` is not the number of modes.
    pub fn new(modes: &LinearModes, modal: &HarmonicCoefficients, omega: f64) -> Self {
        assert_eq!(modal.n_coordinates(), modes.n_modes());
        let rates = modes.omegas().iter().zip(modes.damping_ratios()).map(|(omega, zeta)| zeta * omega);
        let rates: Vec<f64> = rates.collect();
        let fundamental: f64 = (0..modes.n_modes()).map(|k| modal.of(k).get(1).map_or(0.0, |q| q.norm_sqr())).sum();
        let weighted =
            |n: usize| -> f64 { rates.iter().enumerate().map(|(k, rate)| rate * modal.of(k)[n].norm_sqr()).sum() };
        let harmonics = 1..=modal.n_harmonics();
        Self {
            power: harmonics.clone().map(|n| (n as f64 * omega).powi(2) * weighted(n)).collect(),
            coefficients: harmonics.map(|n| weighted(n) / (omega * fundamental)).collect(),
        }
    }

    /// Power of all harmonics, eq. (25), W.
    pub fn total(&self) -> f64 {
        self.power.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;

    #[test]
    fn a_linear_mode_at_resonance_has_its_own_damping_ratio() {
        let modes = LinearModes::new(&[1.0], &[250.0], &[0.0019], &[vec![1.8]]).unwrap();
        let mut modal = HarmonicCoefficients::zeros(1, 1);
        modal.of_mut(0)[1] = Complex64::new(0.0, 4e-4);
        let dissipation = LinearDissipation::new(&modes, &modal, 250.0);
        assert!((dissipation.coefficients[0] - 0.0019).abs() < 1e-16);
        assert!((damping_coefficient(dissipation.total(), 4e-4, 250.0) - 0.0019).abs() < 1e-15);
    }

    #[test]
    fn power_is_the_mean_of_the_damping_force_times_velocity() {
        let modes = LinearModes::new(&[0.0, 1.0], &[10.0, 35.0], &[0.02, 0.01], &[vec![1.0, 0.3], vec![-0.2, 1.0]]);
        let modes = modes.unwrap();
        let mut modal = HarmonicCoefficients::zeros(2, 3);
        for (k, n, q) in [(0, 1, 1.0), (0, 2, 0.2), (1, 1, -0.1), (1, 3, 0.4)] {
            modal.of_mut(k)[n] = Complex64::from_polar(q, 0.3 * n as f64 + k as f64);
        }
        let omega = 11.0;
        let n_t = 64;
        let mut mean = 0.0;
        for j in 0..n_t {
            let tau = std::f64::consts::TAU * j as f64 / n_t as f64;
            for k in 0..2 {
                let speed = omega * modal.derivative(k, tau, 1);
                mean += 2.0 * modes.damping_ratios()[k] * modes.omegas()[k] * speed * speed / n_t as f64;
            }
        }
        let total = LinearDissipation::new(&modes, &modal, omega).total();
        assert!((total - mean).abs() < 1e-12 * mean, "{total} {mean}");
    }
}
