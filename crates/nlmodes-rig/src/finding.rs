use std::fmt;

/// What a careful experimenter should know about a level, with its value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// The lag differs from its target.
    NotLocked {
        /// Lag less target, rad.
        error: f64,
    },
    /// The frequency still drifts.
    FrequencyDrift {
        /// Relative change per second, 1/s.
        rate: f64,
    },
    /// The amplitude of the response still drifts.
    AmplitudeDrift {
        /// Relative change per second, 1/s.
        rate: f64,
    },
    /// Successive periods differ.
    Aperiodic {
        /// Root mean square difference from the mean period, relative.
        spread: f64,
    },
    /// A controlled harmonic of the force misses its target.
    HarmonicNotReached {
        /// The harmonic.
        harmonic: usize,
        /// Distance from the target amplitude, relative to the amplitude of the fundamental.
        error: f64,
    },
    /// A controlled harmonic would have to be larger than permitted: the drive point hardly moves in it.
    HarmonicLimit {
        /// The harmonic.
        harmonic: usize,
    },
    /// The loop demands a frequency outside its range.
    FrequencyLimit {
        /// Present frequency, rad/s.
        omega: f64,
    },
}

impl Finding {
    /// Short name, as used in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NotLocked { .. } => "not-locked",
            Self::FrequencyDrift { .. } => "frequency-drift",
            Self::AmplitudeDrift { .. } => "amplitude-drift",
            Self::Aperiodic { .. } => "aperiodic",
            Self::HarmonicNotReached { .. } => "harmonic-not-reached",
            Self::HarmonicLimit { .. } => "harmonic-limit",
            Self::FrequencyLimit { .. } => "frequency-limit",
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotLocked { error } => write!(f, "not locked: the lag is off by {:.3} degrees", error.to_degrees()),
            Self::FrequencyDrift { rate } => write!(f, "the frequency drifts by {:.1e} of itself a second", rate),
            Self::AmplitudeDrift { rate } => write!(f, "the amplitude drifts by {:.1e} of itself a second", rate),
            Self::Aperiodic { spread } => write!(f, "aperiodic: periods differ by {:.2} %", 100.0 * spread),
            Self::HarmonicNotReached { harmonic, error } => {
                write!(f, "harmonic {harmonic} of the force is off by {:.2} % of the fundamental", 100.0 * error)
            }
            Self::HarmonicLimit { harmonic } => {
                write!(
                    f,
                    "harmonic {harmonic} of the force would have to be larger than the fundamental: the drive point \
                     hardly moves in it"
                )
            }
            Self::FrequencyLimit { omega } => {
                write!(f, "the loop stands at the end of its range, {:.3} Hz", omega / std::f64::consts::TAU)
            }
        }
    }
}
