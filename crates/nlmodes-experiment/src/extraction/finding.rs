use std::fmt;

/// What a careful experimenter wants to be told about a record, with its number.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// Fewer periods than asked for, or than are needed at all.
    TooShort {
        /// Whole periods in the record.
        periods: f64,
        /// Periods asked for or needed.
        wanted: usize,
    },
    /// The frequency drifts over the periods.
    FrequencyDrift {
        /// Change from the first period to the last, Hz.
        change_hz: f64,
        /// The same over the frequency.
        relative: f64,
    },
    /// The amplitude of the fundamental drifts over the periods.
    AmplitudeDrift {
        /// Change from the first period to the last, over the amplitude.
        relative: f64,
    },
    /// What is left without the harmonics is large.
    Aperiodic {
        /// Name of the channel.
        channel: String,
        /// Its root mean square over that of the signal without its mean.
        ratio: f64,
        /// Frequency at which it is strongest, Hz.
        strongest_hz: f64,
    },
    /// The signal stays at its limit.
    Clipped {
        /// Name of the channel.
        channel: String,
        /// Samples at the limit.
        samples: usize,
        /// The limit in SI units.
        limit: f64,
    },
    /// A channel that was described or is needed is not there.
    ChannelMissing {
        /// Name or role.
        channel: String,
        /// What cannot be had without it.
        consequence: &'static str,
    },
    /// The sampling rate of the file is not the declared one.
    SamplingRatesDisagree {
        /// Declared, Hz.
        declared: f64,
        /// Found, Hz.
        found: f64,
    },
    /// Numbers that are missing or infinite; the channel is left out.
    NotANumber {
        /// Name of the channel.
        channel: String,
        /// How many.
        samples: usize,
        /// Number of the first one, from 0.
        first: usize,
    },
    /// A channel is late or early against those it must agree with.
    Skew {
        /// Name of the channel.
        channel: String,
        /// By how much it is late, s.
        delay: f64,
        /// Standard error, s.
        uncertainty: f64,
        /// The same over the sampling interval.
        samples: f64,
        /// Angle of the fundamental, degrees.
        degrees: f64,
        /// What it was compared with.
        against: String,
    },
    /// There are fewer positions with a sensor than linear modes.
    FewerSensorsThanModes {
        /// Positions.
        sensors: usize,
        /// Linear modes given; as many as sensors are used.
        modes: usize,
    },
    /// Harmonics that the sampling rate cannot carry.
    AboveNyquist {
        /// Harmonics asked for.
        wanted: usize,
        /// Harmonics used.
        used: usize,
    },
    /// The force takes power out of the structure: its channel is reversed.
    ReversedForce {
        /// Power-based mode indicator.
        pbmif: f64,
        /// Number of harmonics in it.
        harmonics: usize,
    },
    /// The lag is not that of phase resonance.
    NotLocked {
        /// Lag of the displacement behind the force, degrees.
        lag_deg: f64,
        /// Lag at phase resonance, degrees.
        target_deg: f64,
    },
    /// The phase of the oscillator runs at another frequency than the record.
    FrequencyDisagrees {
        /// From the phase channel, Hz.
        phase_hz: f64,
        /// From the record itself, Hz.
        record_hz: f64,
    },
    /// A sensor at a place for which the linear modes have no row.
    PositionWithoutShape {
        /// Name of the channel.
        channel: String,
        /// Its position, m.
        position: f64,
    },
}

impl Finding {
    /// Names of findings, each once, separated by spaces.
    pub fn names<'a>(findings: impl IntoIterator<Item = &'a Self>) -> String {
        let mut names: Vec<&str> = Vec::new();
        for finding in findings {
            if !names.contains(&finding.name()) {
                names.push(finding.name());
            }
        }
        names.join(" ")
    }

    /// Short name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::TooShort { .. } => "too-short",
            Self::FrequencyDrift { .. } => "frequency-drift",
            Self::AmplitudeDrift { .. } => "amplitude-drift",
            Self::Aperiodic { .. } => "aperiodic",
            Self::Clipped { .. } => "clipped",
            Self::ChannelMissing { .. } => "channel-missing",
            Self::SamplingRatesDisagree { .. } => "sampling-rates-disagree",
            Self::NotANumber { .. } => "not-a-number",
            Self::Skew { .. } => "skew",
            Self::FewerSensorsThanModes { .. } => "fewer-sensors-than-modes",
            Self::AboveNyquist { .. } => "above-nyquist",
            Self::ReversedForce { .. } => "reversed-force",
            Self::NotLocked { .. } => "not-locked",
            Self::FrequencyDisagrees { .. } => "frequency-disagrees",
            Self::PositionWithoutShape { .. } => "position-without-shape",
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort { periods, wanted } => {
                write!(f, "the record holds {periods:.2} periods, {wanted} are wanted")
            }
            Self::FrequencyDrift { change_hz, relative } => {
                write!(f, "the frequency drifts by {change_hz:+.3e} Hz over the periods ({relative:+.2e} relative)")
            }
            Self::AmplitudeDrift { relative } => {
                write!(f, "the amplitude of the fundamental drifts by {:+.3} % over the periods", 100.0 * relative)
            }
            Self::Aperiodic { channel, ratio, strongest_hz } => write!(
                f,
                "channel \"{channel}\": {:.2} % of its root mean square is not periodic, strongest at {strongest_hz:.2} Hz",
                100.0 * ratio
            ),
            Self::Clipped { channel, samples, limit } => {
                write!(f, "channel \"{channel}\": {samples} samples stay at the limit of {limit:.6e} (SI units)")
            }
            Self::ChannelMissing { channel, consequence } => {
                write!(f, "channel \"{channel}\" is missing: {consequence}")
            }
            Self::SamplingRatesDisagree { declared, found } => {
                write!(f, "the record has a sampling rate of {found} Hz, declared are {declared} Hz")
            }
            Self::NotANumber { channel, samples, first } => write!(
                f,
                "channel \"{channel}\": {samples} of its samples are no finite numbers, the first is sample {first}; it is left out"
            ),
            Self::Skew { channel, delay, uncertainty, samples, degrees, against } => write!(
                f,
                "channel \"{channel}\" is {:.1} µs ± {:.1} µs {} against {against}: {:.2} samples, {:.2}° of the fundamental",
                1e6 * delay.abs(),
                1e6 * uncertainty,
                if *delay < 0.0 { "early" } else { "late" },
                samples.abs(),
                degrees.abs()
            ),
            Self::FewerSensorsThanModes { sensors, modes } => write!(
                f,
                "{modes} linear modes, but sensors at {sensors} positions only: the first {sensors} modes are used"
            ),
            Self::AboveNyquist { wanted, used } => {
                write!(f, "{wanted} harmonics reach beyond half the sampling rate: {used} are used")
            }
            Self::ReversedForce { pbmif, harmonics } => write!(
                f,
                "the force takes power out (mode indicator {pbmif:.4} from {harmonics} harmonics): is its channel reversed?"
            ),
            Self::NotLocked { lag_deg, target_deg } => {
                write!(
                    f,
                    "the displacement lags the force by {lag_deg:.3}°, not by the {target_deg}° of phase resonance"
                )
            }
            Self::FrequencyDisagrees { phase_hz, record_hz } => {
                write!(f, "the phase of the oscillator runs at {phase_hz:.6} Hz, the response at {record_hz:.6} Hz")
            }
            Self::PositionWithoutShape { channel, position } => {
                write!(
                    f,
                    "channel \"{channel}\" at {position} m: the linear modes have no row there; it is left out of the shape"
                )
            }
        }
    }
}
