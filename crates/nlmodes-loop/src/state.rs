use num_complex::Complex64;

use crate::detector::DetectorState;

/// What a loop remembers from one sample to the next: a value, without anything on the heap.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopState {
    pub(crate) theta: f64,
    pub(crate) omega: f64,
    pub(crate) integral: f64,
    pub(crate) lag: f64,
    /// Zero where it is not measurable.
    pub(crate) error: f64,
    pub(crate) within: f64,
    pub(crate) measurable: bool,
    pub(crate) locked: bool,
    pub(crate) held: bool,
    pub(crate) at_limit: bool,
    pub(crate) detector: DetectorState,
}

impl LoopState {
    /// Phase `θ` at which to drive now, rad, in [0, 2π): the drive is `A cos θ`, and moves on with [`Self::omega`].
    pub fn drive_phase(&self) -> f64 {
        self.theta
    }

    /// Angular frequency `ω`, rad/s, from this sample to the next.
    pub fn omega(&self) -> f64 {
        self.omega
    }

    /// Measured lag `ψ` of the response behind the force, rad, in (−π, π] around the target.
    pub fn lag(&self) -> f64 {
        self.lag
    }

    /// Target less lag, rad; none while force or response are too small to have a phase.
    pub fn error(&self) -> Option<f64> {
        self.measurable.then_some(self.error)
    }

    /// Complex amplitudes `F_1`, `X_1` of force and response in the frame of the drive, in the units of the signals.
    pub fn fundamentals(&self) -> [Complex64; 2] {
        self.detector.fundamentals()
    }

    /// Whether the lag error has been within its tolerance for the required time.
    pub fn is_locked(&self) -> bool {
        self.locked
    }

    /// Whether the frequency is at an end of its range.
    pub fn is_at_limit(&self) -> bool {
        self.at_limit
    }

    /// Whether the frequency is frozen.
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// The same state with the frequency frozen (`true`) or controlled (`false`). Phases are measured in either case.
    pub fn hold_frequency(self, held: bool) -> Self {
        Self { held, ..self }
    }

    /// The same state with the frequency frozen at `omega`, rad/s, as for a generator without phase control.
    pub fn hold_frequency_at(self, omega: f64) -> Self {
        Self { held: true, omega, ..self }
    }
}
