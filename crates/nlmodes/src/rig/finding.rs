use std::fmt;

use nlmodes_experiment::phase_loop::{SteadyCriteria, TestOutput, TestState};

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
    /// The controlled amplitude of force or response differs from its level.
    LevelNotReached {
        /// Amplitude over level, less one.
        deviation: f64,
    },
    /// The level was held for too short a time to judge it.
    HeldTooShort {
        /// Windows that there were.
        windows: usize,
        /// Windows that are needed.
        needed: usize,
    },
    /// The drive would have to be larger than its limit.
    DriveLimit,
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
    /// What was wrong with a level when its record began, `held`, by these criteria; `state` is that of the control.
    pub(crate) fn of_hold(held: &TestOutput, criteria: &SteadyCriteria, state: &TestState) -> Vec<Self> {
        if held.settled {
            return Vec::new();
        }
        let (found, missed, harmonics) = (&held.drifts, criteria.missed(&held.drifts), state.harmonics());
        let (windows, needed) = (found.windows, criteria.windows);
        let limited: Vec<usize> = (1..=harmonics.force().len()).filter(|n| harmonics.is_limited(*n)).collect();
        let off = |index: usize| (harmonics.wanted()[index] - harmonics.force()[index]).norm_sqr();
        let worst =
            (1..harmonics.force().len()).max_by(|a, b| off(*a).total_cmp(&off(*b))).map_or(1, |index| index + 1);
        let judged = windows > 0;
        let mut findings: Vec<Self> = [
            (windows < needed, Self::HeldTooShort { windows, needed }),
            (judged && missed.lag, Self::NotLocked { error: found.lag_error }),
            (judged && missed.frequency, Self::FrequencyDrift { rate: found.frequency_drift }),
            (judged && missed.amplitude, Self::AmplitudeDrift { rate: found.amplitude_drift }),
            (judged && missed.level, Self::LevelNotReached { deviation: found.amplitude_deviation }),
            (judged && missed.spread, Self::Aperiodic { spread: found.spread }),
            (
                judged && missed.harmonics && !limited.contains(&worst),
                Self::HarmonicNotReached { harmonic: worst, error: found.harmonic_error },
            ),
            (held.frequency_at_limit, Self::FrequencyLimit { omega: held.omega }),
            (held.drive_at_limit, Self::DriveLimit),
        ]
        .into_iter()
        .filter_map(|(wrong, finding)| wrong.then_some(finding))
        .collect();
        findings.extend(limited.into_iter().map(|harmonic| Self::HarmonicLimit { harmonic }));
        findings
    }

    /// A lag that went away in the record of a level that had settled, `error` in the mean. One record alone is noisier
    /// than the hold: three times its tolerance.
    pub(crate) fn of_record(held: &TestOutput, criteria: &SteadyCriteria, error: f64) -> Option<Self> {
        let within = error.abs() <= 3.0 * (criteria.lag + criteria.confidence * held.drifts.lag_noise);
        (held.settled && !within).then_some(Self::NotLocked { error })
    }

    /// Short name, as used in tables.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NotLocked { .. } => "not-locked",
            Self::FrequencyDrift { .. } => "frequency-drift",
            Self::AmplitudeDrift { .. } => "amplitude-drift",
            Self::LevelNotReached { .. } => "level-not-reached",
            Self::HeldTooShort { .. } => "held-too-short",
            Self::DriveLimit => "drive-limit",
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
            Self::LevelNotReached { deviation } => {
                write!(f, "the controlled amplitude is {:.2} % off its level", 100.0 * deviation)
            }
            Self::HeldTooShort { windows, needed } => {
                write!(f, "held too short to be judged: {windows} windows of {needed}")
            }
            Self::DriveLimit => write!(f, "the drive would have to be larger than its limit"),
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
                write!(f, "the loop is at the end of its range, {:.3} Hz", omega / std::f64::consts::TAU)
            }
        }
    }
}
