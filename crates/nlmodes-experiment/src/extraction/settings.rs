use nlmodes_modal::LinearModes;

/// What is to be extracted from a record.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtractionSettings {
    /// Number of the mode that is excited, from 1: of the linear modes for the anchor where there is no drive point.
    pub mode: usize,
    /// Periods to take, from the end of the record; `None`: as many as there are.
    pub periods: Option<usize>,
    /// Harmonics of the mode shape and of the participation.
    pub harmonics: usize,
    /// Harmonics of the power-based mode indicator; `None`: all below half the sampling rate, 1000 at most.
    pub pbmif_harmonics: Option<usize>,
    /// A first guess of the frequency, rad/s; `None`: from the record.
    pub omega: Option<f64>,
    /// Whether a phase channel gives the frequency, where there is one; else the record itself does.
    pub frequency_from_phase: bool,
    /// Mass-normalised linear modes at the positions of the response channels.
    pub linear_modes: Option<LinearModes>,
    /// How well they are known.
    pub mode_errors: ModeErrors,
    /// Relative standard error of the excited mode's shape at each position that is part of those of modal amplitude
    /// and damping; zero: none.
    pub shape_error: f64,
    /// The stop, for restitution and contact stiffness.
    pub stop: Option<Stop>,
    /// From where on something is worth telling.
    pub tolerances: Tolerances,
}

impl Default for ExtractionSettings {
    /// First mode, all periods, 20 harmonics, the indicator from all that there are, frequency from the phase channel
    /// or the record.
    fn default() -> Self {
        Self {
            mode: 1,
            periods: None,
            harmonics: 20,
            pbmif_harmonics: None,
            omega: None,
            frequency_from_phase: true,
            linear_modes: None,
            mode_errors: ModeErrors::default(),
            shape_error: 0.0,
            stop: None,
            tolerances: Tolerances::default(),
        }
    }
}

/// Standard errors of linear modes, relative; what is derived from the modes beside the motion has them in its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeErrors {
    /// Of eigenfrequencies: 1e-3.
    pub frequency: f64,
    /// Of damping ratios: 0.1.
    pub damping: f64,
    /// Of shapes, at each position: 0.01.
    pub shape: f64,
}

impl Default for ModeErrors {
    fn default() -> Self {
        Self { frequency: 1e-3, damping: 0.1, shape: 0.01 }
    }
}

/// Where the stop is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Position along the structure, m.
    pub position: f64,
    /// Clearance at rest, m.
    pub gap: f64,
    /// Whether it is on the positive side.
    pub positive: bool,
}

/// From where on something is worth telling. What depends on noise must also exceed five standard errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Drift of the frequency over the periods, relative: 1e-5.
    pub frequency_drift: f64,
    /// Drift of the fundamental's amplitude over the periods, relative: 2e-3.
    pub amplitude_drift: f64,
    /// Aperiodic part of the reference and of the force, over the signal: 0.02.
    pub aperiodic: f64,
    /// Skew between channels, over the sampling interval: 0.5.
    pub skew: f64,
    /// Deviation of the lag from that of phase resonance, degrees: 1.
    pub lag_deg: f64,
    /// Error of the sampling rate, relative: 2e-5.
    pub sample_rate: f64,
    /// Share of the fundamental in quadrature: 0.1.
    pub quadrature: f64,
    /// Power factor of the fundamental below which the force counts as reversed: −0.5.
    pub reversed: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            frequency_drift: 1e-5,
            amplitude_drift: 2e-3,
            aperiodic: 0.02,
            skew: 0.5,
            lag_deg: 1.0,
            sample_rate: 2e-5,
            quadrature: 0.1,
            reversed: -0.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text for each of them.
    #[test]
    fn tolerances_are_those_that_their_words_say() {
        let words = include_str!("settings.rs");
        let said = |name: &str| -> f64 {
            let before = words.split(&format!("pub {name}: f64,")).next().unwrap().trim_end();
            let number = before.lines().last().unwrap().trim_end_matches('.').rsplit(": ").next().unwrap();
            number.replace('−', "-").parse().unwrap()
        };
        let found = Tolerances::default();
        let all = [
            ("frequency_drift", found.frequency_drift),
            ("amplitude_drift", found.amplitude_drift),
            ("aperiodic", found.aperiodic),
            ("skew", found.skew),
            ("lag_deg", found.lag_deg),
            ("sample_rate", found.sample_rate),
            ("quadrature", found.quadrature),
            ("reversed", found.reversed),
        ];
        for (name, value) in all {
            assert_eq!(said(name), value, "{name}");
        }
    }
}
