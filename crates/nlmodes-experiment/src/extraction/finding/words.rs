//! Findings in words.

use std::fmt;

use crate::extraction::Finding;

impl Finding {
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
            Self::SampleRateUncertain { .. } => "sampling-rate-uncertain",
            Self::WrongScale { .. } => "wrong-scale",
            Self::ReversedChannel { .. } => "reversed-channel",
            Self::ExchangedChannels { .. } => "exchanged-channels",
            Self::ShapeDisagrees { .. } => "shape-disagrees",
            Self::Quadrature { .. } => "quadrature",
            Self::NoSignal { .. } => "no-signal",
            Self::Transient { .. } => "transient",
            Self::ChannelUnused { .. } => "channel-unused",
            Self::FarFromModes { .. } => "far-from-modes",
            Self::Offset { .. } => "offset",
            Self::CellRings { .. } => "cell-rings",
            Self::CellLate { .. } => "cell-late",
            Self::CellDisagrees { .. } => "cell-disagrees",
            Self::ContactCurved { .. } => "contact-curved",
            Self::GapElsewhere { .. } => "gap-elsewhere",
            Self::DisplacementDrift { .. } => "displacement-drift",
            Self::LostSamples { .. } => "lost-samples",
            Self::NotPeriodic { .. } => "not-periodic",
            Self::Recorded(remark) => remark.name(),
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
                "channel \"{channel}\": {:.2} % of its root mean square is not periodic, strongest at \
                    {strongest_hz:.2} Hz",
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
                "channel \"{channel}\": {samples} of its samples are no finite numbers, the first is sample {first}; \
                    it is left out"
            ),
            Self::Skew { channel, delay, uncertainty, samples, degrees, against } => write!(
                f,
                "channel \"{channel}\" is {:.1} µs ± {:.1} µs {} against {against}: {:.2} samples, {:.2}° of the \
                    fundamental",
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
                "the force takes power out (mode indicator {pbmif:.4} from {harmonics} harmonics): is its channel \
                    reversed?"
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
            Self::SampleRateUncertain { rate_hz, relative } => write!(
                f,
                "the file tells the sampling rate of {rate_hz:.6} Hz to {relative:.1e} only, and with it all \
                    frequencies; declare it if it is known"
            ),
            Self::WrongScale { channel, factor, uncertainty, against, declared, likely, alternatives } => {
                scale(f, channel, [*factor, *uncertainty], against)?;
                likely.map_or(Ok(()), |unit| write!(f, ": declared in {declared}, are its numbers in {unit}?"))?;
                or(f, alternatives)
            }
            Self::ReversedChannel { channel, against, alternatives } => {
                write!(f, "channel \"{channel}\" has the opposite sign of {against}: is it reversed?")?;
                or(f, alternatives)
            }
            Self::ExchangedChannels { channels: [a, b] } => {
                write!(f, "channels \"{a}\" and \"{b}\" fit the others in each other's place: are they exchanged?")
            }
            Self::ShapeDisagrees { channel, factor, degrees, against } => write!(
                f,
                "the responses do not fit together; channel \"{channel}\" is furthest off: {factor:.3} times what \
                    {against} give, turned by {degrees:.1}°"
            ),
            Self::Quadrature { channel, degrees, share } => write!(
                f,
                "{:.1} % of the fundamental is in quadrature, channel \"{channel}\" {degrees:.1}° off: more than one \
                    mode takes part",
                100.0 * share
            ),
            Self::NoSignal { channel } => {
                write!(
                    f,
                    "channel \"{channel}\" holds no signal at the frequency, only noise or a constant; it is left out"
                )
            }
            Self::Transient { damping, uncertainty, from_force } => {
                let (way, ratio) = if *damping < 0.0 { ("grows", "growth") } else { ("decays", "decay") };
                write!(
                    f,
                    "the vibration {way}: the {ratio} alone has a damping ratio of {damping:.6} ± {uncertainty:.1e}"
                )?;
                from_force.map_or(Ok(()), |force| write!(f, ", the power of the force {force:.6}"))
            }
            Self::ChannelUnused { channel, reason } => write!(f, "channel \"{channel}\": {reason}"),
            Self::FarFromModes { frequency_hz, nearest_hz } => write!(
                f,
                "the frequency of {frequency_hz:.6} Hz is far from all linear modes, the nearest one has \
                    {nearest_hz:.6} Hz: a time axis or frequencies in another unit?"
            ),
            Self::Offset { channel, offset, peak } => write!(
                f,
                "channel \"{channel}\" rests at {offset:.4e} N, not at zero (its peak is {peak:.4e} N): contact and \
                    stiffness depend on it"
            ),
            Self::CellRings { channel, share, frequency_hz } => write!(
                f,
                "channel \"{channel}\" shows a force while the contact is open, {:.1} % of its peak and strongest at \
                 {frequency_hz:.0} Hz: the force cell rings, or feels its own mass",
                100.0 * share
            ),
            Self::CellLate { channel, delay } => write!(
                f,
                "channel \"{channel}\" is {:.1} µs late against the displacement at the stop, which would give out \
                    energy: a \
                 channel that is late, or a slow force cell; stiffness and gap depend on it",
                1e6 * delay
            ),
            Self::CellDisagrees { channel, peak, balance, uncertainty } => write!(
                f,
                "channel \"{channel}\" has a peak of {peak:.4} N, the balance of the linear modes gives {balance:.4} N \
                    ± {uncertainty:.2} N: a force cell that saturates or is off in scale, or linear modes that are not \
                    those of the structure"
            ),
            Self::ContactCurved { channel, exponent } => {
                let cause = if *exponent > 1.0 {
                    "the contact stiffens as it is pressed, as that of Hertz (1.5)"
                } else {
                    "the contact softens, or the force cell saturates"
                };
                write!(
                    f,
                    "channel \"{channel}\" goes with the displacement into the stop to the power of {exponent:.2}: \
                        {cause}; the \
                     contact stiffness is a mean slope"
                )
            }
            Self::GapElsewhere { declared, found, uncertainty } => write!(
                f,
                "the force begins at a displacement of {found:.4e} m ± {uncertainty:.1e} m, the stop is declared at \
                    {declared} m: \
                 a gap that has changed, or the scale or the zero of the displacement"
            ),
            Self::DisplacementDrift { channel, change } => write!(
                f,
                "the mean of channel \"{channel}\" drifts by {:+.2} µm over the periods; the drift is taken out",
                1e6 * change
            ),
            Self::LostSamples { channel, samples, from, to } => {
                let way = if *samples < 0.0 { "occur twice" } else { "are lost" };
                let of = channel.as_ref().map_or(String::new(), |name| format!(" of channel \"{name}\" alone"));
                write!(
                    f,
                    "{} samples{of} {way} between samples {from} and {to}; the longer part beside them is used",
                    samples.abs()
                )
            }
            Self::NotPeriodic { scatter } => write!(
                f,
                "the fundamental changes from period to period by {:.0} % of its size: a random vibration, or one of \
                    several \
                 frequencies, has none",
                100.0 * scatter
            ),
            Self::Recorded(remark) => remark.fmt(f),
            Self::PositionWithoutShape { channel, position } => {
                write!(
                    f,
                    "channel \"{channel}\" at {position} m: the linear modes have no row there; it is left out of the \
                        shape"
                )
            }
        }
    }
}

fn scale(f: &mut fmt::Formatter<'_>, channel: &str, [factor, uncertainty]: [f64; 2], against: &str) -> fmt::Result {
    let (times, way) = if factor.abs() < 1.0 { (1.0 / factor.abs(), "small") } else { (factor.abs(), "large") };
    let error = times * uncertainty / factor.abs();
    write!(f, "channel \"{channel}\" is {times:.4} ± {error:.1e} times too {way} against {against}")?;
    if factor < 0.0 { write!(f, ", and reversed") } else { Ok(()) }
}

fn or(f: &mut fmt::Formatter<'_>, alternatives: &[String]) -> fmt::Result {
    if alternatives.is_empty() { Ok(()) } else { write!(f, " (or it is {})", alternatives.join(", or ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_said_in_the_units_of_their_words() {
        let name = || "x".to_owned();
        let scale = |factor: f64, uncertainty: f64| Finding::WrongScale {
            channel: name(),
            factor,
            uncertainty,
            against: "others".into(),
            declared: "N".into(),
            likely: None,
            alternatives: vec![],
        };
        let skew = |delay: f64| Finding::Skew {
            channel: name(),
            delay,
            uncertainty: 1e-7,
            samples: delay * 2e4,
            degrees: delay * 1e4,
            against: "y".into(),
        };
        let transient = |damping: f64| Finding::Transient { damping, uncertainty: 1e-5, from_force: Some(0.002) };
        let words = [
            (Finding::AmplitudeDrift { relative: -0.01 }, "drifts by -1.000 %"),
            (
                Finding::FrequencyDrift { change_hz: 0.02, relative: 5e-4 },
                "+2.000e-2 Hz over the periods (+5.00e-4 relative)",
            ),
            (
                Finding::Aperiodic { channel: name(), ratio: 0.034, strongest_hz: 61.5 },
                ": 3.40 % of its root mean square is not periodic, strongest at 61.50 Hz",
            ),
            (
                Finding::Quadrature { channel: name(), degrees: 12.5, share: 0.123 },
                "12.3 % of the fundamental is in quadrature, channel \"x\" 12.5° off",
            ),
            (skew(-2e-5), "20.0 µs ± 0.1 µs early against y: 0.40 samples, 0.20° of"),
            (skew(2e-5), "20.0 µs ± 0.1 µs late against y"),
            // What is 0.001 of what it should be is 1000 times too small, with the same relative error.
            (scale(1e-3, 2e-5), "is 1000.0000 ± 2.0e1 times too small against others"),
            (scale(-50.0, 0.5), "is 50.0000 ± 5.0e-1 times too large against others, and reversed"),
            (
                transient(-0.01),
                "the vibration grows: the growth alone has a damping ratio of -0.010000 ± 1.0e-5, the power of the \
                    force 0.002000",
            ),
            (transient(0.01), "the vibration decays: the decay alone has a damping ratio of 0.010000"),
        ];
        for (finding, expected) in words {
            let said = finding.to_string();
            assert!(said.contains(expected), "{said}");
        }
        assert!([50.0, 0.05, 1e-3].iter().all(|factor| !scale(*factor, 0.5).to_string().contains("reversed")));
        assert!(scale(-0.05, 1e-3).to_string().contains("reversed"));
        assert!(!scale(50.0, 0.5).to_string().contains("(or it is"));
    }
}
