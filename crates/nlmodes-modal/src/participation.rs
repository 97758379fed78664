use std::ops::RangeInclusive;

use num_complex::Complex64;

use crate::HarmonicCoefficients;

/// Participation of the linear modes in a nonlinear one, eq. (30): `v = Σ_n Re(Φ⁻¹ φ̃_n e^{−inθ})`.
///
/// Complex shapes of several harmonics have no sum before a time origin is chosen. Here the phase `nθ` that a shift in time gives to
/// harmonic `n` is taken out first, with `θ` the phase of the fundamental at the anchor: `v` then holds the modal coordinates, over the
/// modal amplitude, at the instant when the fundamental of the anchor is at its peak. What is left out is the part in quadrature.
#[derive(Debug, Clone, PartialEq)]
pub struct Participation {
    /// Factors `v_k`, one a linear mode.
    pub factors: Vec<f64>,
    /// The same sum in quadrature, zero for a motion in which all harmonics peak together.
    pub quadrature: Vec<f64>,
    /// The harmonics in the sum.
    pub harmonics: RangeInclusive<usize>,
}

impl Participation {
    /// Sums the harmonics of the modal coordinates `Φ⁻¹ φ̃_n` (modes × (H + 1), of a mode shape with its phase anchor).
    ///
    /// Harmonics beyond H are not there to be summed; the range in the result says which were.
    pub fn new(modal: &HarmonicCoefficients, harmonics: RangeInclusive<usize>) -> Self {
        let (first, last) = (*harmonics.start(), (*harmonics.end()).min(modal.n_harmonics()));
        let sum = |k: usize| -> Complex64 { modal.of(k).iter().take(last + 1).skip(first).sum() };
        let sums: Vec<Complex64> = (0..modal.n_coordinates()).map(sum).collect();
        Self {
            factors: sums.iter().map(|v| v.re).collect(),
            quadrature: sums.iter().map(|v| v.im).collect(),
            harmonics: first..=last,
        }
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
