use thiserror::Error;

/// Why a loop is refused.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum PhaseLoopError {
    /// A setting that has to be positive and finite is not.
    #[error("{what} must be positive and finite, not {value}")]
    NotPositive {
        /// The setting, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A setting is not a number.
    #[error("{what} must be finite, not {value}")]
    NotFinite {
        /// The setting, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The start or the resonance is outside of the frequencies that the loop may use.
    #[error("the starting frequency {omega} rad/s is not between {low} and {high} rad/s")]
    FrequencyRange {
        /// Start, rad/s.
        omega: f64,
        /// Lower end, rad/s.
        low: f64,
        /// Upper end, rad/s.
        high: f64,
    },
    /// The detector would follow the oscillation itself.
    #[error("a detector cut-off of {cut_off} rad/s is too high: at most {limit} rad/s ({reason})")]
    CutOff {
        /// Cut-off, rad/s.
        cut_off: f64,
        /// Highest that is accepted, rad/s.
        limit: f64,
        /// Where that limit comes from.
        reason: &'static str,
    },
    /// Too many harmonics for the detector.
    #[error("{harmonics} harmonics in the phase detector: 1 to {most}")]
    Harmonics {
        /// Wanted.
        harmonics: usize,
        /// Most.
        most: usize,
    },
    /// Too few harmonics to control, or too many.
    #[error("{harmonics} controlled harmonics: 2 to {most}, the first being that of the loop")]
    ControlledHarmonics {
        /// Wanted.
        harmonics: usize,
        /// Most.
        most: usize,
    },
    /// Not one sensor for each coordinate of the linear modes, or none at the drive point.
    #[error("{sensors} motion sensors, of which number {drive} at the drive point, for modes at {expected} places")]
    Sensors {
        /// Sensors.
        sensors: usize,
        /// Coordinates of the modes.
        expected: usize,
        /// The declared drive point, from zero.
        drive: usize,
    },
    /// Too few windows to judge noise, or too many.
    #[error("{windows} windows for a steady level: {least} to {most}")]
    Windows {
        /// Wanted.
        windows: usize,
        /// Least.
        least: usize,
        /// Most.
        most: usize,
    },
    /// A setting that must not be negative is, or is not finite.
    #[error("{what} must not be negative and must be finite, not {value}")]
    Negative {
        /// The setting, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number that represents a choice has no meaning.
    #[error("{what} has no choice {code}: 0 to {most}")]
    Code {
        /// The setting.
        what: &'static str,
        /// Its value.
        code: u32,
        /// Highest that has a meaning.
        most: u32,
    },
    /// A level needs more drive than the limit permits.
    #[error("a level of {level} (N or V) is above the largest drive of {limit}")]
    AboveLimit {
        /// The level, N or V.
        level: f64,
        /// The limit, N or V.
        limit: f64,
    },
    /// More of something than there is room for: a fixed number keeps the loop free of allocation.
    #[error("{given} {what}: at most {most}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// Given.
        given: usize,
        /// Most.
        most: usize,
    },
    /// The force does not answer to the drive.
    #[error("harmonic {harmonic} of the force does not answer to the drive")]
    NoTransfer {
        /// The harmonic.
        harmonic: usize,
    },
    /// The highest harmonic of the detector is not sampled.
    #[error(
        "harmonic {harmonic} of {omega} rad/s is above half the sampling frequency: the step must be below {limit} s"
    )]
    AboveNyquist {
        /// The harmonic.
        harmonic: usize,
        /// Highest drive frequency, rad/s.
        omega: f64,
        /// Longest step, s.
        limit: f64,
    },
    /// Gains beyond the limit of Routh.
    #[error(
        "unstable gains: at a proportional gain of {proportional} 1/s the integral gain must lie between 0 and {limit} \
            1/s², \
         not at {integral} 1/s²"
    )]
    UnstableGains {
        /// Proportional gain `K_p`, 1/s.
        proportional: f64,
        /// Integral gain `K_i`, 1/s².
        integral: f64,
        /// Largest stable integral gain, 1/s²; zero where there is none.
        limit: f64,
    },
}

/// `value` if it is positive and finite.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, PhaseLoopError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(PhaseLoopError::NotPositive { what, value }) }
}

/// `value` if it is finite.
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, PhaseLoopError> {
    if value.is_finite() { Ok(value) } else { Err(PhaseLoopError::NotFinite { what, value }) }
}

/// `value` if it is finite and not negative.
pub(crate) fn not_negative(what: &'static str, value: f64) -> Result<f64, PhaseLoopError> {
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(PhaseLoopError::Negative { what, value }) }
}
