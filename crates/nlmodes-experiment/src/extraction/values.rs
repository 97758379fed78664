//! The values of one set of Fourier coefficients: of all periods, or of a single one.

use nlmodes_modal::{
    HarmonicCoefficients, LinearDissipation, LinearModes, ModalError, NonlinearModeShape, Participation, PhaseAnchor,
    damping_coefficient,
};
use num_complex::Complex64;

use crate::extraction::layout::{Layout, Place, displacement, displacement_noise};
use crate::extraction::missing::Missing;
use crate::extraction::{ExcitationPower, ExtractionError};

/// What does not change from period to period.
#[derive(Debug, Clone)]
pub struct Method<'a> {
    pub layout: &'a Layout,
    /// Places of the mode shape, in the order of the rows of the modes.
    pub shape_places: Vec<Place>,
    pub modes: Option<LinearModes>,
    /// The modes that the places do not tell apart from these, where the forces are known.
    pub missing: Option<Missing>,
    /// Number of the mode, from 0.
    pub mode: usize,
    pub omega: f64,
    pub noise: &'a [f64],
    /// Harmonics of the shape.
    pub harmonics: usize,
    /// Harmonics of the power.
    pub power_harmonics: usize,
}

/// The values of one set of coefficients.
#[derive(Debug, Clone)]
pub struct Values {
    /// Displacement at the places of the shape.
    pub motion: HarmonicCoefficients,
    pub power: Option<ExcitationPower>,
    /// Amplitude of the fundamental of the drive-point displacement, m, and its lag behind the force, rad.
    pub drive: Option<f64>,
    pub lag: Option<f64>,
    /// Amplitude of the force's fundamental, N.
    pub force: Option<f64>,
    /// Lag of the coordinate of the mode behind the force, rad.
    pub modal_lag: Option<f64>,
    /// Share of the fundamental at all places that is in phase resonance with the force.
    pub phase_indicator: Option<f64>,
    pub modal: Option<Modal>,
}

/// Modal values of one set of coefficients.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Modal {
    pub shape: NonlinearModeShape,
    /// Modal coordinates, not normalised, m·√kg.
    pub coordinates: HarmonicCoefficients,
    pub participation: Participation,
    pub damping: Option<f64>,
    /// Power that the damping ratios take in the harmonics of the power, W.
    pub dissipated: f64,
    /// The same harmonic by harmonic of the shape, with the damping of each.
    pub dissipation: LinearDissipation,
    /// Kinetic energy of each harmonic, averaged over a period, J.
    pub harmonic_energy: Vec<f64>,
}

impl Method<'_> {
    /// Evaluates coefficients (channels × harmonics).
    pub fn values(&self, coefficients: &[Vec<Complex64>]) -> Result<Values, ExtractionError> {
        let at = |place: &Place, n: usize| displacement(place, coefficients, self.noise, self.omega, n);
        let mut motion = HarmonicCoefficients::zeros(self.shape_places.len(), self.harmonics);
        for (d, place) in self.shape_places.iter().enumerate() {
            motion.of_mut(d).iter_mut().enumerate().for_each(|(n, q)| *q = at(place, n));
        }
        let drive: Option<Vec<Complex64>> =
            self.layout.drive.as_ref().map(|place| (0..=self.power_harmonics.max(1)).map(|n| at(place, n)).collect());
        let force = self.layout.force.map(|i| &coefficients[i]);
        let power = drive.as_ref().zip(force).map(|(drive, force)| self.power(force, drive));
        let lag = drive.as_ref().zip(force).map(|(drive, force)| (force[1] / drive[1]).arg());
        let (anchor, drive) = (drive.as_ref().map(|drive| drive[1].arg()), drive.map(|drive| drive[1].norm()));
        let modal = self.modes.as_ref().map(|modes| {
            let known = |n: usize| self.known(coefficients, n);
            let dissipated = |n: usize| {
                let (motion, rest) = known(n);
                let of_rest = self.missing.as_ref().map_or(0.0, |missing| missing.dissipated(&rest, n, self.omega));
                self.dissipated(modes, &modes.project(&motion), n) + of_rest
            };
            let dissipated = (1..=self.power_harmonics).map(dissipated).sum();
            let mut low = motion.clone();
            let mut rest = 0.0;
            for n in 1..=self.harmonics {
                let (motion, missing) = known(n);
                motion.into_iter().enumerate().for_each(|(d, q)| low.of_mut(d)[n] = q);
                if n == 1 {
                    rest = missing.iter().map(Complex64::norm_sqr).sum();
                }
            }
            let motions = Motions { all: &motion, known: &low, rest };
            self.modal(modes, &motions, anchor, power.as_ref()).map(|modal| Modal { dissipated, ..modal })
        });
        let modal = modal.transpose()?;
        let modal_lag = force.zip(modal.as_ref()).map(|(force, modal)| {
            let coordinate = modal.coordinates.of(self.mode)[1];
            // A shape has the sign of its table: that of the coordinate is the one next to the drive point's motion.
            let same = lag.is_none_or(|lag| (force[1] / coordinate * Complex64::cis(-lag)).re >= 0.0);
            (force[1] / if same { coordinate } else { -coordinate }).arg()
        });
        let phase_indicator = force.and_then(|force| phase_indicator(&motion, force[1]));
        let force = force.map(|force| force[1].norm());
        Ok(Values { motion, power, drive, lag, force, modal_lag, phase_indicator, modal })
    }

    /// Displacement at the places of the shape without what missing modes add to it, and their coordinates.
    fn known(&self, coefficients: &[Vec<Complex64>], n: usize) -> (Vec<Complex64>, Vec<Complex64>) {
        let at = |place: &Place| displacement(place, coefficients, self.noise, self.omega, n);
        let mut motion: Vec<Complex64> = self.shape_places.iter().map(at).collect();
        let Some(missing) = &self.missing else { return (motion, vec![]) };
        let rest = missing.coordinates(coefficients, n, self.omega);
        motion.iter_mut().enumerate().for_each(|(d, q)| *q -= missing.at(d, &rest));
        (motion, rest)
    }

    /// Power that damping ratios take in a harmonic of modal coordinates, eq. (25), W.
    fn dissipated(&self, modes: &LinearModes, eta: &[Complex64], n: usize) -> f64 {
        let rates = modes.omegas().iter().zip(modes.damping_ratios()).map(|(omega, zeta)| zeta * omega);
        let sum: f64 = rates.zip(eta).map(|(rate, eta)| rate * eta.norm_sqr()).sum();
        (n as f64 * self.omega).powi(2) * sum
    }

    /// How much noise of the sensors adds to it, with so many samples.
    pub fn dissipated_by_noise(&self, n_samples: usize) -> f64 {
        let Some(modes) = &self.modes else { return 0.0 };
        let unit = |d: usize| {
            let place = |i: usize| Complex64::from(if i == d { 1.0 } else { 0.0 });
            modes.project(&(0..self.shape_places.len()).map(place).collect::<Vec<_>>())
        };
        let units: Vec<Vec<Complex64>> = (0..self.shape_places.len()).map(unit).collect();
        let of = |n: usize| -> f64 {
            let one = |(place, unit): (&Place, &Vec<Complex64>)| {
                // Real and imaginary part have each this variance.
                let sigma = displacement_noise(place, self.noise, self.omega, n, n_samples);
                2.0 * sigma * sigma * self.dissipated(modes, unit, n)
            };
            self.shape_places.iter().zip(&units).map(one).sum()
        };
        (1..=self.power_harmonics).map(of).sum()
    }

    /// Factor by which noise of the sensors makes the apparent power of these coefficients seem larger, with so many
    /// samples.
    pub fn apparent_by_noise(&self, coefficients: &[Vec<Complex64>], n_samples: usize) -> f64 {
        let (Some(force), Some(drive)) = (self.layout.force, &self.layout.drive) else { return 1.0 };
        let own = self.noise[force].powi(2) / n_samples as f64;
        let rate = |n: usize| (n as f64 * self.omega).powi(2);
        let motion = |n: usize| displacement(drive, coefficients, self.noise, self.omega, n).norm_sqr() * rate(n);
        // Real and imaginary part have each this variance.
        let of_force = |n: usize| [coefficients[force][n].norm_sqr(), 4.0 * own];
        let of_motion = |n: usize| {
            let sigma = displacement_noise(drive, self.noise, self.omega, n, n_samples);
            [motion(n), 2.0 * sigma * sigma * rate(n)]
        };
        let share = |of: &dyn Fn(usize) -> [f64; 2]| {
            let all = (1..=self.power_harmonics).map(of).fold([0.0, 0.0], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
            if all[1] < all[0] { (1.0 - all[1] / all[0]).sqrt().recip() } else { 1.0 }
        };
        share(&of_force) * share(&of_motion)
    }

    fn power(&self, force: &[Complex64], drive: &[Complex64]) -> ExcitationPower {
        let rate = |(n, q): (usize, &Complex64)| Complex64::new(0.0, n as f64 * self.omega) * q;
        let velocity: Vec<Complex64> = drive.iter().enumerate().map(rate).collect();
        ExcitationPower::new(force, &velocity, self.power_harmonics)
    }

    /// The phase anchor is the drive point, to which a loop locks; without one the coordinate of the mode.
    fn modal(
        &self,
        modes: &LinearModes,
        motions: &Motions<'_>,
        anchor: Option<f64>,
        power: Option<&ExcitationPower>,
    ) -> Result<Modal, ModalError> {
        let coordinates = modes.modal_coordinates(motions.known);
        let phase = anchor.unwrap_or_else(|| coordinates.of(self.mode)[1].arg());
        let fundamental: f64 = (0..modes.n_modes()).map(|k| coordinates.of(k)[1].norm_sqr()).sum();
        let of = |motion: &HarmonicCoefficients| {
            NonlinearModeShape::new(motion, |_| fundamental + motions.rest, PhaseAnchor::Phase(phase))
        };
        let shape = of(motions.all)?;
        let participation =
            Participation::new(&modes.modal_coordinates(&of(motions.known)?.harmonics), 1..=self.harmonics);
        let square = |n: usize| (0..modes.n_modes()).map(|k| coordinates.of(k)[n].norm_sqr()).sum::<f64>();
        let damping = power.map(|power| damping_coefficient(power.fundamental, shape.modal_amplitude, self.omega));
        let energy = |n: usize| 0.25 * (n as f64 * self.omega).powi(2) * square(n);
        let harmonic_energy = (0..=self.harmonics).map(energy).collect();
        let dissipation = LinearDissipation::new(modes, &coordinates, self.omega);
        Ok(Modal { shape, coordinates, participation, damping, dissipated: 0.0, dissipation, harmonic_energy })
    }
}

/// A motion, and what of it the modes of the method explain.
struct Motions<'a> {
    all: &'a HarmonicCoefficients,
    /// Without what missing modes add.
    known: &'a HarmonicCoefficients,
    /// Sum of the squares of the fundamentals of their coordinates, m²·kg.
    rest: f64,
}

/// `1 − Σ |Re x_i||x_i| / Σ |x_i|²` of the fundamentals at all places, by their phases against the force: one where all
/// of them are a quarter of a turn from it, as in a single mode at resonance. `None` without places or motion.
fn phase_indicator(motion: &HarmonicCoefficients, force: Complex64) -> Option<f64> {
    let turned = |d: usize| motion.of(d).get(1).map_or(Complex64::default(), |x| x * force.conj() / force.norm());
    let all: Vec<Complex64> = (0..motion.n_coordinates()).map(turned).collect();
    let size: f64 = all.iter().map(Complex64::norm_sqr).sum();
    let off: f64 = all.iter().map(|x| x.re.abs() * x.norm()).sum();
    (size > 0.0).then_some(1.0 - off / size)
}
