use std::fmt;

/// What happens at a point of a branch.
///
/// Tables, figures and scenes name events by [`Event::name`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Event {
    /// Grazing: the linear mode just touches a stop, and the branch starts here.
    Grazing,
    /// Lift-off: a stop that presses at rest is about to be left by the linear mode, and the branch starts here.
    LiftOff,
    /// The branch starts elsewhere.
    Start,
    /// The parameter along the branch turns: the averaged kinetic energy of a nonlinear mode, frequency or force level
    /// of a response.
    Fold,
    /// The frequency of a nonlinear mode turns.
    FrequencyFold,
    /// More than two half-branches meet.
    BranchPoint,
    /// The tangent of the branch jumps.
    Kink,
    /// The sequence of closed contacts within a period changes.
    ContactChange,
    /// Beyond this point the motion is unstable where it was stable, or vice versa.
    StabilityChange,
    /// A Floquet multiplier passes −1.
    PeriodDoubling,
    /// A pair of complex Floquet multipliers passes the unit circle.
    NeimarkSacker,
    /// From here on the branch has demonstrably left its nonlinear mode for that of another linear mode.
    OtherMode,
    /// The previous point again, with another number of harmonics.
    Harmonics,
    /// As [`Event::Harmonics`], where the branch is not shown to be the same.
    HarmonicsUnproven,
    /// More harmonics were tried here without success.
    HarmonicsNoHelp,
    /// From here on the requested accuracy is not reached.
    AccuracyLimit,
    /// The base point of an internal-resonance branch that was skipped: the last point before it.
    TongueFoot,
    /// The first point after an internal-resonance branch that was skipped.
    Resumed,
}

impl Event {
    /// All events.
    pub const ALL: [Self; 18] = [
        Self::Grazing,
        Self::LiftOff,
        Self::Start,
        Self::Fold,
        Self::FrequencyFold,
        Self::BranchPoint,
        Self::Kink,
        Self::ContactChange,
        Self::StabilityChange,
        Self::PeriodDoubling,
        Self::NeimarkSacker,
        Self::OtherMode,
        Self::Harmonics,
        Self::HarmonicsUnproven,
        Self::HarmonicsNoHelp,
        Self::AccuracyLimit,
        Self::TongueFoot,
        Self::Resumed,
    ];

    /// Its name in tables, in lower case with hyphens.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Grazing => "grazing",
            Self::LiftOff => "lift-off",
            Self::Start => "start",
            Self::Fold => "fold",
            Self::FrequencyFold => "frequency-fold",
            Self::BranchPoint => "branch-point",
            Self::Kink => "kink",
            Self::ContactChange => "contact-change",
            Self::StabilityChange => "stability-change",
            Self::PeriodDoubling => "period-doubling",
            Self::NeimarkSacker => "neimark-sacker",
            Self::OtherMode => "other-mode",
            Self::Harmonics => "harmonics",
            Self::HarmonicsUnproven => "harmonics-unproven",
            Self::HarmonicsNoHelp => "harmonics-no-help",
            Self::AccuracyLimit => "accuracy-limit",
            Self::TongueFoot => "tongue-foot",
            Self::Resumed => "resumed",
        }
    }

    /// The event with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|event| event.name() == name)
    }

    /// Whether a branch may have a kink here, since the set of closed contacts changes or branches intersect: no curve
    /// is smooth across it.
    #[must_use]
    pub const fn is_corner(self) -> bool {
        matches!(self, Self::Kink | Self::ContactChange | Self::BranchPoint)
    }

    /// The names of these events, separated by spaces, as in the column `event`.
    pub fn names(events: &[Self]) -> String {
        events.iter().map(|event| event.name()).collect::<Vec<_>>().join(" ")
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_event_is_found_by_its_name() {
        for event in Event::ALL {
            assert_eq!(Event::from_name(event.name()), Some(event));
        }
        assert_eq!(Event::from_name("Fold"), None);
    }
}
