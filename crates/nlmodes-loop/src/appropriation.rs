use num_complex::Complex64;

use crate::adaptive::AdaptiveState;
use crate::error::{finite, positive};
use crate::harmonics::powers;
use crate::math::{cis, norm};
use crate::{MAX_HARMONICS, MAX_SENSORS, ModalFilter, PhaseLoopError, ResponseQuantity};

/// Everything that the control of the force's higher harmonics has to know.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppropriationSettings {
    /// Harmonics that are controlled, 2 to this one; the fundamental is that of the phase-locked loop.
    pub harmonics: usize,
    /// Linear modes at the motion sensors, with their damping: what a linear modal test before gives.
    pub modes: ModalFilter,
    /// What each of these sensors measures; those beyond the last sensor mean nothing.
    pub quantities: [ResponseQuantity; MAX_SENSORS],
    /// Index of the drive point.
    pub drive: usize,
    /// Sampling interval, s.
    pub step: f64,
    /// Cut-off `ω_c` of the detectors, rad/s.
    pub cut_off: f64,
    /// Rate `κ` at which the drive follows, 1/s: slower than the detectors.
    pub rate: f64,
    /// Largest amplitude of a harmonic of the force, as a share of its fundamental.
    pub largest: f64,
}

impl AppropriationSettings {
    /// A fifth of the cut-off as rate, and no harmonic of the force larger than its fundamental.
    ///
    /// # Errors
    /// [`PhaseLoopError::Sensors`] if there is not one quantity for each sensor of the modes.
    pub fn new(
        harmonics: usize,
        modes: ModalFilter,
        quantities: &[ResponseQuantity],
        drive: usize,
        step: f64,
        cut_off: f64,
    ) -> Result<Self, PhaseLoopError> {
        if quantities.len() != modes.sensors() {
            return Err(PhaseLoopError::Sensors { sensors: quantities.len(), expected: modes.sensors(), drive });
        }
        let mut all = [ResponseQuantity::default(); MAX_SENSORS];
        all.iter_mut().zip(quantities).for_each(|(mine, given)| *mine = *given);
        Ok(Self { harmonics, modes, quantities: all, drive, step, cut_off, rate: 0.2 * cut_off, largest: 1.0 })
    }

    fn check(&self) -> Result<(), PhaseLoopError> {
        if !(2..=MAX_HARMONICS).contains(&self.harmonics) {
            return Err(PhaseLoopError::ControlledHarmonics { harmonics: self.harmonics, most: MAX_HARMONICS });
        }
        positive("sampling interval (s)", self.step)?;
        positive("cut-off of the detector (rad/s)", self.cut_off)?;
        positive("rate of the controlled harmonics (1/s)", self.rate)?;
        positive("largest harmonic of the force", self.largest)?;
        let sensors = self.modes.sensors();
        if self.drive >= sensors {
            return Err(PhaseLoopError::Sensors { sensors, expected: sensors, drive: self.drive });
        }
        Ok(())
    }
}

/// Force appropriation in the loop: harmonics of the force beyond the first that put into each harmonic of the motion
/// the power which the linear damping takes out of it.
///
/// ```text
/// η_n = Φ⁺ x_n                                            modal coordinates, from all motion sensors
/// F*_n = iν Σ_k 2 ζ_k ω_k |η_k,n|² / X̄_n ,   ν = nω        in phase with the velocity of the drive point, n = 2 … N_c
/// U̇_n = κ (F*_n − F_n) / G_n                               drive, U = Re Σ U_n e^{inθ}
/// ```
///
/// `X_n` is the displacement of the drive point, `F_n` the measured force and `G_n` how the force answers to the drive,
/// N or N/V, measured beforehand with the exciter on the structure. With `N_c = 1` there is the phase-locked loop
/// alone, under which a force sensor shows whatever harmonics the exciter has.
///
/// At a drive point without motion in harmonic `n`, `F*_n` is unbounded; it is then limited to the largest permitted
/// one, and the state [indicates this](AppropriationState::is_limited). Shapes and units: amplitudes in SI units, one
/// per harmonic.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceAppropriation {
    settings: AppropriationSettings,
    /// `G_n`, with one for the fundamental.
    transfer: [Complex64; MAX_HARMONICS],
    /// Share of an error by which a detector moves in a step.
    rate: f64,
}

impl ForceAppropriation {
    /// None: a place in memory where nothing is controlled.
    pub(crate) const NONE: Self = Self {
        settings: AppropriationSettings {
            harmonics: 0,
            modes: ModalFilter::NONE,
            quantities: [ResponseQuantity::Displacement; MAX_SENSORS],
            drive: 0,
            step: 0.0,
            cut_off: 0.0,
            rate: 0.0,
            largest: 0.0,
        },
        transfer: [Complex64::ONE; MAX_HARMONICS],
        rate: 0.0,
    };

    /// A controller with the answer `transfer` of the force to the drive in the harmonics 2, 3 …
    ///
    /// # Errors
    /// [`PhaseLoopError::ControlledHarmonics`], [`PhaseLoopError::Sensors`], [`PhaseLoopError::NoTransfer`] where the
    /// force does not answer, and the variants for numbers that cannot be.
    pub fn new(settings: AppropriationSettings, transfer: &[Complex64]) -> Result<Self, PhaseLoopError> {
        settings.check()?;
        let mut answers = [Complex64::ONE; MAX_HARMONICS];
        for (index, mine) in answers.iter_mut().enumerate().take(settings.harmonics).skip(1) {
            *mine = transfer.get(index - 1).copied().unwrap_or_default();
            if finite("transfer of the exciter", norm(*mine))? == 0.0 {
                return Err(PhaseLoopError::NoTransfer { harmonic: index + 1 });
            }
        }
        let rate = -libm::expm1(-settings.cut_off * settings.step);
        Ok(Self { transfer: answers, settings, rate })
    }

    /// The settings.
    pub fn settings(&self) -> &AppropriationSettings {
        &self.settings
    }

    /// State before the first sample, without a drive in these harmonics.
    pub fn start(&self) -> AppropriationState {
        AppropriationState { harmonics: self.settings.harmonics, ..AppropriationState::ZERO }
    }

    /// Moves on by the samples `force` and `motions`, one a sensor, that were taken at the phase `theta` of the drive
    /// with the angular frequency `omega`, rad/s. Samples that are not finite are passed over, and so is a sample
    /// without one motion for each sensor.
    pub fn step(&self, state: &mut AppropriationState, theta: f64, omega: f64, force: f64, motions: &[f64]) {
        let Some(motions) = motions.get(..self.settings.modes.sensors()) else { return };
        if !force.is_finite() || !motions.iter().all(|y| y.is_finite()) {
            return;
        }
        let waves = powers(cis(theta));
        state.force = state.force.step(force, &waves, self.rate);
        for (detected, y) in state.motions.iter_mut().zip(motions) {
            *detected = detected.step(*y, &waves, self.rate);
        }
        if state.held {
            return;
        }
        for (index, transfer) in self.transfer.iter().enumerate().take(self.settings.harmonics).skip(1) {
            self.follow(state, index, omega, *transfer);
        }
    }

    /// One harmonic, with its index from zero: the force that is wanted, and the drive on its way there.
    fn follow(&self, state: &mut AppropriationState, index: usize, omega: f64, transfer: Complex64) {
        let nu = (index + 1) as f64 * omega;
        let turn = Complex64::new(0.0, nu);
        let at = |detected: &AdaptiveState| detected.amplitudes.get(index).copied().unwrap_or_default();
        let sensors = state.motions.iter().zip(&self.settings.quantities).take(self.settings.modes.sensors());
        for (x, (detected, quantity)) in state.motion.iter_mut().zip(sensors) {
            *x = match quantity {
                ResponseQuantity::Displacement => at(detected),
                ResponseQuantity::Velocity => at(detected) / turn,
                ResponseQuantity::Acceleration => at(detected) / (turn * turn),
            };
        }
        let at_drive = state.motion.get(self.settings.drive).copied().unwrap_or_default();
        let taken = self.settings.modes.damping_form(&state.motion);
        let [fundamental, ..] = state.force.amplitudes;
        let largest = self.settings.largest * norm(fundamental);
        let size = nu * taken / norm(at_drive);
        let wanted = match norm(at_drive) {
            x if x > 0.0 => Complex64::new(0.0, size.min(largest)) * at_drive / x,
            _ => Complex64::ZERO,
        };
        let missing = wanted - at(&state.force);
        let change = self.settings.step * self.settings.rate * missing / transfer;
        let places = (state.wanted.get_mut(index), state.limited.get_mut(index), state.drive.get_mut(index));
        if let (Some(mine), Some(limited), Some(drive)) = places {
            *mine = wanted;
            *limited = size > largest;
            *drive += change;
        }
    }
}

/// What the control of the harmonics remembers from one sample to the next.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppropriationState {
    harmonics: usize,
    force: AdaptiveState,
    motions: [AdaptiveState; MAX_SENSORS],
    /// Work space for the displacements at the sensors in one harmonic.
    motion: [Complex64; MAX_SENSORS],
    drive: [Complex64; MAX_HARMONICS],
    wanted: [Complex64; MAX_HARMONICS],
    limited: [bool; MAX_HARMONICS],
    held: bool,
}

impl AppropriationState {
    /// Nothing is controlled, and nothing has been measured.
    pub(crate) const ZERO: Self = Self {
        harmonics: 0,
        force: AdaptiveState::ZERO,
        motions: [AdaptiveState::ZERO; MAX_SENSORS],
        motion: [Complex64::ZERO; MAX_SENSORS],
        drive: [Complex64::ZERO; MAX_HARMONICS],
        wanted: [Complex64::ZERO; MAX_HARMONICS],
        limited: [false; MAX_HARMONICS],
        held: false,
    };

    /// Complex amplitudes of the drive in the harmonics 1, 2 … N_c, in its unit; the first is zero, for it is the
    /// loop's.
    pub fn drive(&self) -> &[Complex64] {
        self.drive.get(..self.harmonics).unwrap_or_default()
    }

    /// Complex amplitudes of the measured force in these harmonics, N, in the frame of the drive.
    pub fn force(&self) -> &[Complex64] {
        self.force.amplitudes.get(..self.harmonics).unwrap_or_default()
    }

    /// Those that are wanted, N; the first is zero.
    pub fn wanted(&self) -> &[Complex64] {
        self.wanted.get(..self.harmonics).unwrap_or_default()
    }

    /// Whether harmonic `n` would have to be larger than permitted.
    pub fn is_limited(&self, n: usize) -> bool {
        self.limited.get(n.wrapping_sub(1)).copied().unwrap_or(false)
    }

    /// Whether any would have to be.
    pub(crate) fn has_limit(&self) -> bool {
        self.limited.contains(&true)
    }

    /// What is missing of each controlled harmonic, relative to the fundamental of the force.
    pub(crate) fn missing(&self) -> [Complex64; MAX_HARMONICS] {
        let [fundamental, ..] = self.force.amplitudes;
        let mut missing = [Complex64::ZERO; MAX_HARMONICS];
        let both = self.wanted().iter().zip(self.force());
        missing.iter_mut().zip(both).skip(1).for_each(|(mine, (wanted, found))| *mine = wanted - found);
        missing.map(|z| if z == Complex64::ZERO { z } else { z / norm(fundamental) })
    }

    /// The same state with the drive fixed at `drive` in the harmonics 1, 2 …, as for measuring the transfer function
    /// of the force.
    #[must_use]
    pub fn held_at(mut self, drive: &[Complex64]) -> Self {
        self.drive = [Complex64::ZERO; MAX_HARMONICS];
        self.drive.iter_mut().zip(drive).for_each(|(mine, given)| *mine = *given);
        self.held = true;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OMEGA: f64 = 250.0;
    const STEP: f64 = 1e-4;
    /// Rows are sensors, columns modes, 1/√kg.
    const SHAPES: [[f64; 2]; 2] = [[1.0, 0.8], [1.5, -2.0]];

    fn control(transfer: Complex64) -> ForceAppropriation {
        // Φ⁺ of the two shapes (1, 1.5) and (0.8, −2).
        let determinant = SHAPES[0][0] * SHAPES[1][1] - SHAPES[0][1] * SHAPES[1][0];
        let rows =
            [[SHAPES[1][1], -SHAPES[0][1]], [-SHAPES[1][0], SHAPES[0][0]]].map(|row| row.map(|x| x / determinant));
        let modes = ModalFilter::new(2).unwrap();
        let modes = modes.with_mode(&rows[0], 240.0, 0.01).unwrap().with_mode(&rows[1], 900.0, 0.003).unwrap();
        let quantities = [ResponseQuantity::Displacement, ResponseQuantity::Acceleration];
        let settings = AppropriationSettings::new(3, modes, &quantities, 0, STEP, 25.0).unwrap();
        ForceAppropriation::new(settings, &[transfer; 2]).unwrap()
    }

    /// Samples of a force and two sensors for `duration` seconds, whose third harmonics these modal coordinates have.
    fn run(control: &ForceAppropriation, state: &mut AppropriationState, duration: f64) -> Complex64 {
        let (eta, nu) = ([Complex64::new(3e-5, 1e-5), Complex64::new(-2e-5, 4e-5)], 3.0 * OMEGA);
        let x = SHAPES.map(|row| eta[0] * row[0] + eta[1] * row[1]);
        for k in 0..(duration / STEP).round() as usize {
            let theta = OMEGA * STEP * k as f64;
            let third = Complex64::cis(3.0 * theta);
            let motions = [1e-3 * theta.cos() + (x[0] * third).re, -(x[1] * third).re * nu * nu];
            let force = -2.0 * theta.sin() + (Complex64::new(0.0, 0.05) * third).re;
            control.step(state, theta, OMEGA, force, &motions);
        }
        let taken = 0.02 * 240.0 * eta[0].norm_sqr() + 0.006 * 900.0 * eta[1].norm_sqr();
        Complex64::new(0.0, nu * taken) / x[0].conj()
    }

    #[test]
    fn the_power_that_damping_takes_is_asked_for_and_the_drive_goes_there_at_its_rate() {
        for transfer in [Complex64::ONE, Complex64::new(-3.0, 4.0)] {
            let control = control(transfer);
            let mut state = control.start();
            let expected = run(&control, &mut state, 1.0);
            assert!((state.wanted()[2] - expected).norm() < 1e-6 * expected.norm(), "{} {expected}", state.wanted()[2]);
            let found = state.force()[2];
            assert!((found - Complex64::new(0.0, 0.05)).norm() < 1e-7 && !state.is_limited(3));
            // The force does not follow here: the drive continues at κ (F* − F)/G.
            let before = state.drive()[2];
            run(&control, &mut state, 0.5);
            let rate = (state.drive()[2] - before) / 0.5;
            let wanted = 5.0 * (expected - found) / transfer;
            assert!((rate - wanted).norm() < 1e-3 * wanted.norm(), "{rate} {wanted}");
            assert_eq!(state.drive()[0], Complex64::ZERO);
        }
    }

    #[test]
    fn samples_that_are_no_numbers_change_nothing_and_a_held_drive_stays() {
        let control = control(Complex64::ONE);
        let mut state = control.start();
        run(&control, &mut state, 0.2);
        let before = state;
        control.step(&mut state, 0.3, OMEGA, f64::NAN, &[0.0, 0.0]);
        control.step(&mut state, 0.3, OMEGA, 0.0, &[0.0, f64::INFINITY]);
        assert_eq!(state, before);
        let tones = [Complex64::ZERO, Complex64::new(0.1, 0.0)];
        let mut held = control.start().held_at(&tones);
        run(&control, &mut held, 0.2);
        assert_eq!((held.drive()[1], held.drive()[2]), (tones[1], Complex64::ZERO));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let good = control(Complex64::ONE);
        let refused = |change: &dyn Fn(&mut AppropriationSettings), transfer: &[Complex64]| {
            let mut settings = *good.settings();
            change(&mut settings);
            ForceAppropriation::new(settings, transfer).unwrap_err()
        };
        let ones = [Complex64::ONE; 8];
        assert_eq!(refused(&|_| {}, &ones[..1]), PhaseLoopError::NoTransfer { harmonic: 3 });
        assert!(matches!(refused(&|_| {}, &[Complex64::ONE, f64::NAN.into()]), PhaseLoopError::NotFinite { .. }));
        let expected = PhaseLoopError::ControlledHarmonics { harmonics: 9, most: MAX_HARMONICS };
        assert_eq!(refused(&|s| s.harmonics = 9, &ones), expected);
        assert!(matches!(refused(&|s| s.drive = 2, &ones), PhaseLoopError::Sensors { drive: 2, .. }));
        let short = AppropriationSettings::new(3, good.settings().modes, &[], 0, STEP, 25.0);
        assert_eq!(short, Err(PhaseLoopError::Sensors { sensors: 0, expected: 2, drive: 0 }));
        let many = PhaseLoopError::TooMany { what: "motion sensors", given: 33, most: MAX_SENSORS };
        assert_eq!(ModalFilter::new(33), Err(many));
        assert!(matches!(refused(&|s| s.rate = 0.0, &ones), PhaseLoopError::NotPositive { .. }));
        assert!(matches!(refused(&|s| s.largest = f64::NAN, &ones), PhaseLoopError::NotPositive { .. }));
    }
}
