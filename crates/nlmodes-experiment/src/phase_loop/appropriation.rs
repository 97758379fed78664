use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use super::adaptive::AdaptiveState;
use super::error::{finite, positive};
use super::{MAX_HARMONICS, PhaseLoopError, ResponseQuantity};

/// Everything that the control of the force's higher harmonics has to know.
#[derive(Debug, Clone, PartialEq)]
pub struct AppropriationSettings {
    /// Harmonics that are controlled, 2 to this one; the fundamental is that of the phase-locked loop.
    pub harmonics: usize,
    /// Linear modes at the motion sensors, with their damping ratios: what a linear modal test before gives.
    pub modes: LinearModes,
    /// What each of these sensors measures.
    pub quantities: Vec<ResponseQuantity>,
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
    pub fn new(
        harmonics: usize,
        modes: LinearModes,
        quantities: Vec<ResponseQuantity>,
        drive: usize,
        step: f64,
        cut_off: f64,
    ) -> Self {
        Self { harmonics, modes, quantities, drive, step, cut_off, rate: 0.2 * cut_off, largest: 1.0 }
    }

    fn check(&self) -> Result<(), PhaseLoopError> {
        if !(2..=MAX_HARMONICS).contains(&self.harmonics) {
            return Err(PhaseLoopError::ControlledHarmonics { harmonics: self.harmonics, most: MAX_HARMONICS });
        }
        positive("sampling interval (s)", self.step)?;
        positive("cut-off of the detector (rad/s)", self.cut_off)?;
        positive("rate of the controlled harmonics (1/s)", self.rate)?;
        positive("largest harmonic of the force", self.largest)?;
        let (sensors, expected) = (self.quantities.len(), self.modes.n_coordinates());
        if sensors != expected || self.drive >= sensors {
            return Err(PhaseLoopError::Sensors { sensors, expected, drive: self.drive });
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
#[derive(Debug, Clone, PartialEq)]
pub struct ForceAppropriation {
    settings: AppropriationSettings,
    transfer: Vec<Complex64>,
    /// Share of an error by which a detector moves in a step.
    rate: f64,
}

impl ForceAppropriation {
    /// A controller with the answer `transfer` of the force to the drive in the harmonics 2, 3 …
    ///
    /// # Errors
    /// [`PhaseLoopError::ControlledHarmonics`], [`PhaseLoopError::Sensors`], [`PhaseLoopError::NoTransfer`] where the
    /// force does not answer, and the variants for numbers that cannot be.
    pub fn new(settings: AppropriationSettings, transfer: &[Complex64]) -> Result<Self, PhaseLoopError> {
        settings.check()?;
        for n in 2..=settings.harmonics {
            let answer = transfer.get(n - 2).copied().unwrap_or_default();
            finite("transfer of the exciter", answer.norm())?;
            if answer.norm() == 0.0 {
                return Err(PhaseLoopError::NoTransfer { harmonic: n });
            }
        }
        let rate = -(-settings.cut_off * settings.step).exp_m1();
        Ok(Self { transfer: transfer[..settings.harmonics - 1].to_vec(), settings, rate })
    }

    /// The settings.
    pub fn settings(&self) -> &AppropriationSettings {
        &self.settings
    }

    /// State before the first sample, without a drive in these harmonics.
    pub fn start(&self) -> AppropriationState {
        AppropriationState {
            harmonics: self.settings.harmonics,
            force: AdaptiveState::ZERO,
            motions: vec![AdaptiveState::ZERO; self.settings.quantities.len()],
            motion: vec![Complex64::ZERO; self.settings.quantities.len()],
            drive: [Complex64::ZERO; MAX_HARMONICS],
            wanted: [Complex64::ZERO; MAX_HARMONICS],
            limited: [false; MAX_HARMONICS],
            held: false,
        }
    }

    /// Moves on by the samples `force` and `motions`, one a sensor, that were taken at the phase `theta` of the drive
    /// with the angular frequency `omega`, rad/s. Samples that are not finite are passed over. Allocates nothing.
    ///
    /// # Panics
    /// If there is not one sample for each sensor.
    pub fn step(&self, state: &mut AppropriationState, theta: f64, omega: f64, force: f64, motions: &[f64]) {
        assert_eq!(motions.len(), state.motions.len());
        if !force.is_finite() || !motions.iter().all(|y| y.is_finite()) {
            return;
        }
        let wave = Complex64::cis(theta);
        let mut waves = [wave; MAX_HARMONICS];
        for n in 1..MAX_HARMONICS {
            waves[n] = waves[n - 1] * wave;
        }
        state.force = state.force.step(force, &waves, self.rate);
        for (detected, y) in state.motions.iter_mut().zip(motions) {
            *detected = detected.step(*y, &waves, self.rate);
        }
        if state.held {
            return;
        }
        for n in 2..=self.settings.harmonics {
            self.follow(state, n, omega);
        }
    }

    /// One harmonic: the force that is wanted, and the drive on its way there.
    fn follow(&self, state: &mut AppropriationState, n: usize, omega: f64) {
        let nu = n as f64 * omega;
        for (x, (detected, quantity)) in
            state.motion.iter_mut().zip(state.motions.iter().zip(&self.settings.quantities))
        {
            *x = detected.amplitudes[n - 1] / Complex64::new(0.0, nu).powi(i32::from(quantity.derivatives()));
        }
        let at_drive = state.motion[self.settings.drive];
        let taken = self.settings.modes.damping_form(&state.motion);
        let largest = self.settings.largest * state.force.amplitudes[0].norm();
        let size = nu * taken / at_drive.norm();
        state.limited[n - 1] = size > largest;
        state.wanted[n - 1] = match at_drive.norm() {
            x if x > 0.0 => Complex64::new(0.0, size.min(largest)) * at_drive / x,
            _ => Complex64::ZERO,
        };
        let missing = state.wanted[n - 1] - state.force.amplitudes[n - 1];
        state.drive[n - 1] += self.settings.step * self.settings.rate * missing / self.transfer[n - 2];
    }
}

/// What the control of the harmonics remembers from one sample to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct AppropriationState {
    harmonics: usize,
    force: AdaptiveState,
    motions: Vec<AdaptiveState>,
    /// Work space for the displacements at the sensors in one harmonic.
    motion: Vec<Complex64>,
    drive: [Complex64; MAX_HARMONICS],
    wanted: [Complex64; MAX_HARMONICS],
    limited: [bool; MAX_HARMONICS],
    held: bool,
}

impl AppropriationState {
    /// Complex amplitudes of the drive in the harmonics 1, 2 … N_c, in its unit; the first is zero, for it is the
    /// loop's.
    pub fn drive(&self) -> &[Complex64] {
        &self.drive[..self.harmonics]
    }

    /// Complex amplitudes of the measured force in these harmonics, N, in the frame of the drive.
    pub fn force(&self) -> &[Complex64] {
        &self.force.amplitudes[..self.harmonics]
    }

    /// Those that are wanted, N; the first is zero.
    pub fn wanted(&self) -> &[Complex64] {
        &self.wanted[..self.harmonics]
    }

    /// Whether harmonic `n` would have to be larger than permitted.
    pub fn is_limited(&self, n: usize) -> bool {
        self.limited.get(n.wrapping_sub(1)).copied().unwrap_or(false)
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

    fn control(transfer: Complex64) -> ForceAppropriation {
        let shapes = [vec![1.0, 0.8], vec![1.5, -2.0]];
        let modes = LinearModes::new(&[0.1, 0.2], &[240.0, 900.0], &[0.01, 0.003], &shapes).unwrap();
        let quantities = vec![ResponseQuantity::Displacement, ResponseQuantity::Acceleration];
        let settings = AppropriationSettings::new(3, modes, quantities, 0, STEP, 25.0);
        ForceAppropriation::new(settings, &[transfer; 2]).unwrap()
    }

    /// Samples of a force and two sensors for `duration` seconds, whose third harmonics these modal coordinates have.
    fn run(control: &ForceAppropriation, state: &mut AppropriationState, duration: f64) -> Complex64 {
        let (eta, nu) = ([Complex64::new(3e-5, 1e-5), Complex64::new(-2e-5, 4e-5)], 3.0 * OMEGA);
        let x = control.settings().modes.expand(&eta);
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
        let before = state.clone();
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
            let mut settings = good.settings().clone();
            change(&mut settings);
            ForceAppropriation::new(settings, transfer).unwrap_err()
        };
        let ones = [Complex64::ONE; 8];
        assert_eq!(refused(&|_| {}, &ones[..1]), PhaseLoopError::NoTransfer { harmonic: 3 });
        assert!(matches!(refused(&|_| {}, &[Complex64::ONE, f64::NAN.into()]), PhaseLoopError::NotFinite { .. }));
        let expected = PhaseLoopError::ControlledHarmonics { harmonics: 9, most: MAX_HARMONICS };
        assert_eq!(refused(&|s| s.harmonics = 9, &ones), expected);
        assert!(matches!(refused(&|s| s.drive = 2, &ones), PhaseLoopError::Sensors { drive: 2, .. }));
        assert!(matches!(refused(&|s| s.rate = 0.0, &ones), PhaseLoopError::NotPositive { .. }));
        assert!(matches!(refused(&|s| s.largest = f64::NAN, &ones), PhaseLoopError::NotPositive { .. }));
    }
}
