use std::ops::RangeInclusive;

use num_complex::Complex64;

use crate::{HarmonicCoefficients, ModalError, ModalPoint, NonlinearModeShape, PhaseAnchor};

/// Participation of the linear modes in a nonlinear one, eq. (30): `v = Σ_n Re(Φ⁻¹ φ̃_n e^{−inθ})`.
///
/// The sum of complex shapes of several harmonics depends on the time origin. Here the phase `nθ` that a time shift
/// gives to harmonic `n` is removed first, where `θ` is the phase of the fundamental at the anchor: `v` then has the
/// modal coordinates, divided by the modal amplitude, at the instant of the peak of the fundamental at the anchor. The
/// part in quadrature is omitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Participation {
    /// Factors `v_k`, one per linear mode.
    pub factors: Vec<f64>,
    /// The same sum in quadrature, zero for a motion in which all harmonics peak together.
    pub quadrature: Vec<f64>,
    /// The harmonics in the sum.
    pub harmonics: RangeInclusive<usize>,
    /// Share of each linear mode in the averaged kinetic energy, 0 to 1, over all harmonics; it is defined even if the
    /// motion has no fundamental. Empty if unknown.
    pub energy_shares: Vec<f64>,
}

impl Participation {
    /// Of the motion of a point with the mass-normalised modal coordinates `modal` (modes × (H + 1), m·√kg), with all
    /// harmonics but the mean in the sum; the phase of `anchor`, the fundamental of the first contact, is taken out.
    /// NaN where a motion has no fundamental to be normalised by, as the pure second mode on the tip of an
    /// internal-resonance branch.
    ///
    /// # Errors
    /// [`ModalError::NoFundamental`] if the modal amplitude is not finite.
    pub fn of_point(point: &ModalPoint, modal: &HarmonicCoefficients, anchor: Complex64) -> Result<Self, ModalError> {
        let (amplitude, harmonics) = (point.modal_amplitude, 1..=modal.n_harmonics());
        let found = if amplitude == 0.0 {
            let none = vec![f64::NAN; modal.n_coordinates()];
            Self { factors: none.clone(), quadrature: none, harmonics, energy_shares: Vec::new() }
        } else {
            // Where the anchor's fundamental vanishes, as on the tip of an internal-resonance branch, there is no phase
            // to take out.
            let phase = if anchor.norm() > 0.0 { PhaseAnchor::Phase(anchor.arg()) } else { PhaseAnchor::None };
            let shape = NonlinearModeShape::new(modal, |_| amplitude * amplitude, phase)?;
            Self::new(&shape.harmonics, harmonics)
        };
        Ok(found.with_energy_shares(modal, point.omega, point.kinetic_energy))
    }

    /// Sums the harmonics of the modal coordinates `Φ⁻¹ φ̃_n` (modes × (H + 1), of a mode shape with its phase anchor).
    ///
    /// Harmonics beyond H cannot be included; the range in the result states which were.
    pub fn new(modal: &HarmonicCoefficients, harmonics: RangeInclusive<usize>) -> Self {
        let (first, last) = (*harmonics.start(), (*harmonics.end()).min(modal.n_harmonics()));
        let sum = |k: usize| -> Complex64 { modal.of(k).iter().take(last + 1).skip(first).sum() };
        let sums: Vec<Complex64> = (0..modal.n_coordinates()).map(sum).collect();
        Self {
            factors: sums.iter().map(|v| v.re).collect(),
            quadrature: sums.iter().map(|v| v.im).collect(),
            harmonics: first..=last,
            energy_shares: Vec::new(),
        }
    }

    /// Adds the shares of the modes, whose mass-normalised coordinates are `modal` (m·√kg), in the averaged kinetic
    /// energy (J) of a motion of angular frequency `omega` (rad/s): `Σ_n (nω)² |η_k,n|² / 4E_av`.
    pub fn with_energy_shares(self, modal: &HarmonicCoefficients, omega: f64, kinetic_energy: f64) -> Self {
        let of = |k: usize| {
            let harmonics = modal.of(k).iter().enumerate();
            let kinetic: f64 = harmonics.map(|(n, eta)| 0.25 * (n as f64 * omega).powi(2) * eta.norm_sqr()).sum();
            kinetic / kinetic_energy
        };
        Self { energy_shares: (0..modal.n_coordinates()).map(of).collect(), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LinearModes, NonlinearModeShape, PhaseAnchor};

    fn modes() -> LinearModes {
        let shapes = [vec![0.5, -0.4], vec![1.2, 0.9], vec![2.0, 2.1]];
        LinearModes::new(&[0.1, 0.2, 0.3], &[10.0, 60.0], &[0.0, 0.0], &shapes).unwrap()
    }

    fn participation(motion: &HarmonicCoefficients) -> Participation {
        let modes = modes();
        let shape =
            NonlinearModeShape::new(motion, |q| modes.mass_norm_squared(q), PhaseAnchor::Coordinate(2)).unwrap();
        Participation::new(&modes.modal_coordinates(&shape.harmonics), 1..=9)
    }

    fn motion(eta: [[Complex64; 3]; 2]) -> HarmonicCoefficients {
        let mut motion = HarmonicCoefficients::zeros(3, 2);
        for (n, (first, second)) in eta[0].iter().zip(eta[1]).enumerate() {
            let q = modes().expand(&[*first, second]);
            q.iter().enumerate().for_each(|(d, q)| motion.of_mut(d)[n] = *q);
        }
        motion
    }

    #[test]
    fn a_linear_mode_takes_part_alone_and_its_amplitude_is_the_modal_amplitude() {
        let zero = Complex64::default();
        let motion = motion([[zero, Complex64::from_polar(3e-4, 0.7), zero], [zero; 3]]);
        let modes = modes();
        let shape = NonlinearModeShape::new(&motion, |q| modes.mass_norm_squared(q), PhaseAnchor::None).unwrap();
        assert!((shape.modal_amplitude - 3e-4).abs() < 1e-17);
        let v = participation(&motion);
        assert!((v.factors[0] - 1.0).abs() < 1e-14 && v.factors[1].abs() < 1e-14, "{v:?}");
        assert_eq!(v.harmonics, 1..=2);
    }

    #[test]
    fn shares_in_the_energy_are_those_of_the_modes_and_sum_to_one() {
        for (unit, omega) in [(1.0, 10.0), (1e-4, 3e3)] {
            let mut modal = HarmonicCoefficients::zeros(2, 3);
            // Mode 1 in the fundamental, mode 2 three times as fast with a third of its amplitude and more.
            modal.of_mut(0)[1] = Complex64::new(0.6, 0.8) * unit;
            modal.of_mut(1)[3] = Complex64::new(0.0, 0.5) * unit;
            let energy = 0.25 * (omega * unit).powi(2) * (1.0 + 9.0 * 0.25);
            let found = Participation::new(&modal, 1..=3).with_energy_shares(&modal, omega, energy);
            assert!((found.energy_shares[0] - 1.0 / 3.25).abs() < 1e-14);
            assert!((found.energy_shares.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn only_the_harmonics_that_are_asked_for_are_in_the_sum() {
        let mut modal = HarmonicCoefficients::zeros(1, 3);
        modal
            .of_mut(0)
            .iter_mut()
            .zip([1.0, 10.0, 100.0, 1000.0])
            .for_each(|(q, value)| *q = Complex64::new(value, -value));
        for (range, sum) in [(1..=1, 10.0), (0..=2, 111.0), (2..=3, 1100.0), (2..=9, 1100.0)] {
            let found = Participation::new(&modal, range.clone());
            assert_eq!((found.factors[0], found.quadrature[0]), (sum, -sum), "{range:?}");
        }
    }

    #[test]
    fn the_sum_does_not_depend_on_the_time_origin() {
        let eta = |shift: f64| {
            let turn = |n: f64, q: f64| Complex64::from_polar(q, n * shift);
            [[0.1.into(), turn(1.0, 2.0), turn(2.0, 0.3)], [0.0.into(), turn(1.0, -0.1), turn(2.0, 0.2)]]
        };
        let q1 = (4.0f64 + 0.01).sqrt();
        for shift in [0.0, 0.4, -2.9] {
            let v = participation(&motion(eta(shift)));
            assert!((v.factors[0] - 2.3 / q1).abs() < 1e-13, "{v:?}");
            assert!((v.factors[1] - 0.1 / q1).abs() < 1e-13, "{v:?}");
            assert!(v.quadrature.iter().all(|x| x.abs() < 1e-13), "{v:?}");
        }
    }
}
