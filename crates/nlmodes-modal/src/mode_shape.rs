use num_complex::Complex64;

use crate::{HarmonicCoefficients, ModalError};

/// Choice of the phase at the time origin: the absolute phase of a periodic motion is arbitrary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhaseAnchor {
    /// The motion unchanged.
    None,
    /// The fundamental of this coordinate is real and positive.
    Coordinate(usize),
    /// The fundamental of a coordinate that has this phase (rad) becomes real.
    Phase(f64),
}

/// Complex mode shape per harmonic, normalised by mass on its fundamental, with the modal amplitude, eqs. (20)-(22):
/// `q(t) = Re Σ_n q̃ φ̃_n e^{inω̃t}` with `φ̃₁ᴴ M φ̃₁ = 1`.
///
/// ```
/// use nlmodes_modal::{HarmonicCoefficients, NonlinearModeShape, PhaseAnchor};
/// use num_complex::Complex64;
/// let mut motion = HarmonicCoefficients::zeros(1, 2); // mass of 4 kg
/// motion.of_mut(0)[1] = Complex64::new(0.0, 3.0);
/// motion.of_mut(0)[2] = Complex64::new(0.5, 0.0);
/// let mass = |q: &[Complex64]| 4.0 * q[0].norm_sqr();
/// let shape = NonlinearModeShape::new(&motion, mass, PhaseAnchor::Coordinate(0))?;
/// assert_eq!(shape.modal_amplitude, 6.0);
/// assert!((shape.harmonics.of(0)[1] - 0.5).norm() < 1e-15); // 1/√(4 kg), real
/// assert!((shape.harmonics.of(0)[2] + 0.5 / 6.0).norm() < 1e-15); // shifted by a quarter of a period: twice 90°
/// # Ok::<(), nlmodes_modal::ModalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NonlinearModeShape {
    /// Nonlinear modal amplitude `q̃`, m·√kg: the amplitude of the mass-normalised mode if the motion is that of a
    /// linear mode.
    pub modal_amplitude: f64,
    /// Phase `θ` of the anchor in the original motion, rad: harmonic `n` was rotated by `−nθ`, a shift in time.
    pub phase: f64,
    /// Shapes `φ̃_n`: coordinates × (H + 1), 1/√kg.
    pub harmonics: HarmonicCoefficients,
}

impl NonlinearModeShape {
    /// Normalises the motion. `mass_norm_squared` returns `qᴴ M q` (kg·m²) of the complex amplitudes of all
    /// coordinates.
    ///
    /// # Errors
    /// [`ModalError::NoFundamental`] if the motion has none, or a mass that is not positive and finite.
    ///
    /// # Panics
    /// If the anchor is not one of the coordinates.
    pub fn new(
        motion: &HarmonicCoefficients,
        mass_norm_squared: impl Fn(&[Complex64]) -> f64,
        anchor: PhaseAnchor,
    ) -> Result<Self, ModalError> {
        let squared = if motion.n_harmonics() == 0 { 0.0 } else { mass_norm_squared(&harmonic(motion, 1)) };
        if !(squared > 0.0 && squared.is_finite()) {
            return Err(ModalError::NoFundamental { squared });
        }
        let modal_amplitude = squared.sqrt();
        let phase = match anchor {
            PhaseAnchor::None => 0.0,
            PhaseAnchor::Coordinate(d) => motion.of(d)[1].arg(),
            PhaseAnchor::Phase(phase) => phase,
        };
        let mut harmonics = shifted(motion, phase);
        for d in 0..harmonics.n_coordinates() {
            harmonics.of_mut(d).iter_mut().for_each(|q| *q /= modal_amplitude);
        }
        Ok(Self { modal_amplitude, phase, harmonics })
    }
}

/// The complex amplitudes of harmonic `n` at all coordinates.
fn harmonic(motion: &HarmonicCoefficients, n: usize) -> Vec<Complex64> {
    (0..motion.n_coordinates()).map(|d| motion.of(d)[n]).collect()
}

/// The motion delayed by the phase `phase` (rad) of its fundamental: harmonic `n` rotated by `−n·phase`.
pub fn shifted(motion: &HarmonicCoefficients, phase: f64) -> HarmonicCoefficients {
    let mut motion = motion.clone();
    for d in 0..motion.n_coordinates() {
        for (n, q) in motion.of_mut(d).iter_mut().enumerate() {
            *q *= Complex64::cis(-(n as f64) * phase);
        }
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn motion(parts: &[(f64, f64)]) -> HarmonicCoefficients {
        let mut motion = HarmonicCoefficients::zeros(2, 2);
        for (i, (re, im)) in parts.iter().enumerate() {
            motion.of_mut(i / 3)[i % 3] = Complex64::new(*re, if i % 3 == 0 { 0.0 } else { *im });
        }
        motion
    }

    proptest! {
        #[test]
        fn the_fundamental_has_unit_mass_and_the_motion_comes_back(
            parts in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 6), tau in -4.0..4.0f64
        ) {
            let motion = motion(&parts);
            prop_assume!(motion.of(0)[1].norm() > 1e-3);
            let mass = |q: &[Complex64]| 2.0 * q[0].norm_sqr() + 3.0 * q[1].norm_sqr();
            let shape = NonlinearModeShape::new(&motion, mass, PhaseAnchor::Coordinate(0)).unwrap();
            prop_assert!((mass(&harmonic(&shape.harmonics, 1)) - 1.0).abs() < 1e-12);
            let anchored = shape.harmonics.of(0)[1];
            prop_assert!(anchored.im.abs() < 1e-14 && anchored.re > 0.0);
            for d in 0..2 {
                let back = shape.modal_amplitude * shape.harmonics.value(d, tau + shape.phase);
                prop_assert!((back - motion.value(d, tau)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_motion_without_a_fundamental_is_refused() {
        let still = HarmonicCoefficients::zeros(1, 3);
        let error = NonlinearModeShape::new(&still, |q| q[0].norm_sqr(), PhaseAnchor::None).unwrap_err();
        assert_eq!(error, ModalError::NoFundamental { squared: 0.0 });
        let constant = HarmonicCoefficients::zeros(1, 0);
        let error = NonlinearModeShape::new(&constant, |_| 1.0, PhaseAnchor::None).unwrap_err();
        assert_eq!(error, ModalError::NoFundamental { squared: 0.0 });
    }

    #[test]
    fn without_an_anchor_the_phase_stays_and_a_small_motion_counts_as_much_as_a_large_one() {
        for unit in [1.0, 1e-9] {
            let mut motion = HarmonicCoefficients::zeros(1, 1);
            motion.of_mut(0)[1] = Complex64::new(3.0, 4.0) * unit;
            let shape = |anchor| NonlinearModeShape::new(&motion, |q| q[0].norm_sqr(), anchor).unwrap();
            let found = shape(PhaseAnchor::None);
            assert!((found.modal_amplitude / unit - 5.0).abs() < 1e-14 && found.phase == 0.0);
            assert!((found.harmonics.of(0)[1] - Complex64::new(0.6, 0.8)).norm() < 1e-14);
            let turned = shape(PhaseAnchor::Phase(std::f64::consts::FRAC_PI_2)).harmonics.of(0)[1];
            assert!((turned - Complex64::new(0.8, -0.6)).norm() < 1e-14, "{turned}");
        }
    }
}
