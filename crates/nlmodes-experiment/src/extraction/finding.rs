mod words;

use crate::records::Remark;

/// What a careful experimenter wants to know about a record, with its number.
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
        /// What cannot be had without it, or what is there.
        consequence: String,
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
    /// The sampling rate is known to few digits.
    SampleRateUncertain {
        /// The rate, Hz.
        rate_hz: f64,
        /// Its largest relative error.
        relative: f64,
    },
    /// A channel whose numbers are too large or too small by a factor against what they must agree with.
    WrongScale {
        /// Name of the channel.
        channel: String,
        /// Its values over those that are expected; negative if it is reversed too.
        factor: f64,
        /// Standard error of the factor.
        uncertainty: f64,
        /// What it was compared with.
        against: String,
        /// Its unit as declared.
        declared: String,
        /// The unit in which its numbers would fit.
        likely: Option<&'static str>,
        /// What explains it as well.
        alternatives: Vec<String>,
    },
    /// A response of the wrong sign.
    ReversedChannel {
        /// Name of the channel.
        channel: String,
        /// What it was compared with.
        against: String,
        /// Channels whose reversal explains it as well.
        alternatives: Vec<String>,
    },
    /// Two channels that fit in each other's place.
    ExchangedChannels {
        /// Their names.
        channels: [String; 2],
    },
    /// The responses fit neither each other nor the linear modes, and no single cause explains it.
    ShapeDisagrees {
        /// Name of the channel that is furthest off.
        channel: String,
        /// Its fundamental over the expected one.
        factor: f64,
        /// Its phase against the expected one, degrees.
        degrees: f64,
        /// What it was compared with.
        against: String,
    },
    /// The structure does not move in phase: more than one mode takes part in the fundamental.
    Quadrature {
        /// Name of the channel with the largest part in quadrature.
        channel: String,
        /// Its phase against the drive point, or against the motion of all, degrees.
        degrees: f64,
        /// Share of the fundamental that is in quadrature.
        share: f64,
    },
    /// A channel that does not change, or holds nothing but noise at the frequency.
    NoSignal {
        /// Name of the channel.
        channel: String,
    },
    /// The vibration grows or decays, and its own energy is not small against what the force brings in.
    Transient {
        /// Damping ratio that the decay alone has; negative for growth.
        damping: f64,
        /// Its standard error.
        uncertainty: f64,
        /// Damping coefficient from the power of the force, eq. (28), where there is a force.
        from_force: Option<f64>,
    },
    /// A channel that is described, but not used, or not as described.
    ChannelUnused {
        /// Name of the channel.
        channel: String,
        /// Why.
        reason: &'static str,
    },
    /// The record vibrates far from all linear modes.
    FarFromModes {
        /// Frequency of the record, Hz.
        frequency_hz: f64,
        /// That of the nearest linear mode, Hz.
        nearest_hz: f64,
    },
    /// The force at the stop does not rest at zero.
    Offset {
        /// Name of the channel.
        channel: String,
        /// Where it rests, N.
        offset: f64,
        /// Its largest value, N.
        peak: f64,
    },
    /// A force cell that rings: it shows forces while the contact is open.
    CellRings {
        /// Name of the channel.
        channel: String,
        /// Root mean square of the force while open, over its peak.
        share: f64,
        /// Where it is strongest, Hz.
        frequency_hz: f64,
    },
    /// A force at the stop that comes after the displacement that makes it: a late channel or a slow cell.
    CellLate {
        /// Name of the channel.
        channel: String,
        /// By how much, s.
        delay: f64,
    },
    /// The peak of the force at the stop is not the one that the balance of the linear modes gives.
    CellDisagrees {
        /// Name of the channel.
        channel: String,
        /// Its peak, N.
        peak: f64,
        /// Peak by the balance, N.
        balance: f64,
        /// Standard error of the difference, N.
        uncertainty: f64,
    },
    /// The force at the stop is no straight line over the displacement.
    ContactCurved {
        /// Name of the channel.
        channel: String,
        /// Exponent of the force over the displacement into the stop.
        exponent: f64,
    },
    /// The force begins elsewhere than at the declared gap.
    GapElsewhere {
        /// Declared gap, m.
        declared: f64,
        /// Where the force begins, m.
        found: f64,
        /// Its standard error, m.
        uncertainty: f64,
    },
    /// A displacement whose mean drifts over the periods; the drift is taken out.
    DisplacementDrift {
        /// Name of the channel.
        channel: String,
        /// Change from the begin to the end, m.
        change: f64,
    },
    /// Samples that the recorder lost, or has twice.
    LostSamples {
        /// Name of the channel, where the others have lost none.
        channel: Option<String>,
        /// How many, but for whole periods; negative where samples occur twice.
        samples: f64,
        /// They are lost behind this sample, from 0 …
        from: usize,
        /// … and before this one; the longer of the parts beside is used.
        to: usize,
    },
    /// A vibration that is not periodic at all: random, or of several frequencies.
    NotPeriodic {
        /// Scatter of the fundamental from period to period about a smooth course, over its size.
        scatter: f64,
    },
    /// What came up while the record was read.
    Recorded(Remark),
    /// A sensor at a place for which the linear modes have no row.
    PositionWithoutShape {
        /// Name of the channel.
        channel: String,
        /// Its position, m.
        position: f64,
    },
}

impl Finding {
    /// Whether it says that the numbers of this channel are not what they should be.
    pub fn spoils(&self, name: &str) -> bool {
        match self {
            Self::Clipped { channel, .. }
            | Self::WrongScale { channel, .. }
            | Self::ReversedChannel { channel, .. }
            | Self::Offset { channel, .. }
            | Self::CellRings { channel, .. }
            | Self::CellLate { channel, .. }
            | Self::CellDisagrees { channel, .. }
            | Self::LostSamples { channel: Some(channel), .. } => channel == name,
            _ => false,
        }
    }

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
}
