use std::sync::Arc;

/// Derivatives of a point of a curve by a parameter, per unit of the parameter as its key has it; none where the point
/// has no such thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// Key of the parameter.
    pub parameter: Arc<str>,
    /// Its value, in the unit of the key.
    pub value: f64,
    /// The derivatives, in the order of [`GradientOf::ALL`].
    pub by: [Option<f64>; 7],
}

/// What is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GradientOf {
    /// Frequency, Hz: of a mode at constant energy, at phase resonance at constant level, of a response over the
    /// frequency at constant amplitude.
    Frequency,
    /// Amplitude of the fundamental of the first contact, m.
    Amplitude,
    /// Largest displacement of the first contact toward its stop, m.
    Peak,
    /// Largest contact force, N.
    PeakForce,
    /// Impulse of all contacts over a period, N s.
    Impulse,
    /// Level, in its unit: of a response over the level at constant amplitude.
    Level,
    /// Damping ratio of a damped mode.
    DampingRatio,
}

impl GradientOf {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Frequency, Self::Amplitude, Self::Peak, Self::PeakForce, Self::Impulse, Self::Level, Self::DampingRatio];

    /// Its name in columns: `d_<name>_d_<key>`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Amplitude => "amplitude",
            Self::Peak => "peak",
            Self::PeakForce => "peak_force",
            Self::Impulse => "impulse",
            Self::Level => "level",
            Self::DampingRatio => "damping_ratio",
        }
    }

    /// The same for a reader.
    pub fn words(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Amplitude => "amplitude",
            Self::Peak => "largest displacement",
            Self::PeakForce => "largest contact force",
            Self::Impulse => "impulse",
            Self::Level => "level",
            Self::DampingRatio => "damping ratio",
        }
    }
}

impl Gradient {
    /// The derivative of this, per unit of the parameter.
    pub fn of(&self, what: GradientOf) -> Option<f64> {
        self.by.get(what as usize).copied().flatten()
    }
}
