use core::f64::consts::{FRAC_PI_2, PI};

use crate::error::{finite, positive};
use crate::{Gains, LockSettings, PhaseDetector, PhaseLoopError, Resonance, ResponseQuantity};

/// Everything that a loop has to know.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopSettings {
    /// Sampling interval `h`, s.
    pub step: f64,
    /// Rough knowledge of the resonance, for the gains and their limit.
    pub resonance: Resonance,
    /// Angular frequency at the start, rad/s.
    pub start: f64,
    /// Angular frequencies between which the loop may move, rad/s.
    pub range: [f64; 2],
    /// What the response sensor measures.
    pub quantity: ResponseQuantity,
    /// Target lag of the *displacement* behind the force, rad; `π/2` at phase resonance.
    pub displacement_lag: f64,
    /// How the lag is measured.
    pub detector: PhaseDetector,
    /// Cut-off `ω_c` of the detector, rad/s.
    pub cut_off: f64,
    /// Gains; left out, those of [`Gains::design`].
    pub gains: Option<Gains>,
    /// Amplitudes of force (N) and response below which there is no phase to speak of: the frequency waits.
    pub smallest: [f64; 2],
    /// When the loop counts as locked.
    pub lock: LockSettings,
}

impl LoopSettings {
    /// Displacement at 90 degrees, adaptive detector with a cut-off of `ω_0/10`, designed gains, and half to twice the
    /// frequency of the resonance as range.
    ///
    /// A slower detector filters more noise, but where contact bends the backbone strongly a slow loop loses the motion
    /// and has to climb again: on the beam of the paper at 6.5 N with `ω_0/20`, not with `ω_0/10`.
    pub fn new(resonance: Resonance, start: f64, step: f64) -> Self {
        Self {
            step,
            resonance,
            start,
            range: [0.5 * resonance.omega, 2.0 * resonance.omega],
            quantity: ResponseQuantity::default(),
            displacement_lag: FRAC_PI_2,
            detector: PhaseDetector::default(),
            cut_off: 0.1 * resonance.omega,
            gains: None,
            smallest: [0.0, 0.0],
            lock: LockSettings::default(),
        }
    }

    /// Checks all but the gains.
    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        positive("sampling interval (s)", self.step)?;
        positive("frequency of the resonance (rad/s)", self.resonance.omega)?;
        finite("damping ratio", self.resonance.damping_ratio)?;
        finite("lag (rad)", self.displacement_lag)?;
        positive("lowest frequency (rad/s)", self.range[0])?;
        positive("highest frequency (rad/s)", self.range[1])?;
        positive("lag tolerance of the lock (rad)", self.lock.tolerance)?;
        finite("duration of the lock (s)", self.lock.duration)?;
        finite("smallest force (N)", self.smallest[0])?;
        finite("smallest response", self.smallest[1])?;
        self.check_frequencies()?;
        self.check_cut_off()
    }

    fn check_frequencies(&self) -> Result<(), PhaseLoopError> {
        let (omega, [low, high]) = (self.start, self.range);
        if !(low..=high).contains(&omega) {
            return Err(PhaseLoopError::FrequencyRange { omega, low, high });
        }
        let harmonic = self.detector.highest_harmonic();
        let limit = PI / (high * harmonic as f64);
        if self.step >= limit { Err(PhaseLoopError::AboveNyquist { harmonic, omega: high, limit }) } else { Ok(()) }
    }

    /// Averaging needs a detector that is slow against the oscillation; its equations for small steps need one that is
    /// slow against the sampling.
    fn check_cut_off(&self) -> Result<(), PhaseLoopError> {
        let cut_off = positive("cut-off of the detector (rad/s)", self.cut_off)?;
        let of_drive = (0.25 * self.range[0], "a quarter of the lowest frequency");
        let of_step = (0.1 / self.step, "a tenth of the sampling rate");
        let (limit, reason) = if of_drive.0 < of_step.0 { of_drive } else { of_step };
        if cut_off > limit { Err(PhaseLoopError::CutOff { cut_off, limit, reason }) } else { Ok(()) }
    }
}
