use std::fmt;

use crate::InternalResonance;

/// Why a branch ended.
///
/// Tables and summaries name reasons by [`EndReason::name`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum EndReason {
    /// The requested largest energy is reached.
    MaxEnergy,
    /// The requested smallest energy is reached.
    MinEnergy,
    /// The frequency left the requested window.
    FrequencyWindow,
    /// The requested largest level is reached.
    Limit,
    /// Another bound of the unknowns is reached.
    Bound,
    /// The branch returned to its start.
    Closed,
    /// The branch reached a point from which its continuation is already known.
    Joined,
    /// The branch has the maximum number of points.
    MaxPoints,
    /// The computation was cancelled.
    Stopped,
    /// No step could be shown to stay on the branch.
    NoStep,
    /// Newton's method found no further point.
    NoConvergence,
    /// There was no initial point.
    NoStart,
    /// The backbone beyond an internal-resonance branch was not found.
    Tongue,
    /// The branch had left its nonlinear mode for another.
    OtherMode,
    /// These points were measured, read or given, not computed by continuation.
    Given,
    /// A reason without a name; see the message.
    Unknown,
}

impl EndReason {
    /// Its name in tables, in lower case with hyphens.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MaxEnergy => "max-energy",
            Self::MinEnergy => "min-energy",
            Self::FrequencyWindow => "frequency-window",
            Self::Limit => "limit",
            Self::Bound => "bound",
            Self::Closed => "closed",
            Self::Joined => "joined",
            Self::MaxPoints => "max-points",
            Self::Stopped => "stopped",
            Self::NoStep => "no-step",
            Self::NoConvergence => "no-convergence",
            Self::NoStart => "no-start",
            Self::Tongue => "tongue",
            Self::OtherMode => "other-mode",
            Self::Given => "given",
            Self::Unknown => "unknown",
        }
    }
}

impl fmt::Display for EndReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Why a branch ended, and whether it ended as requested.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchEnd {
    /// The reason at its last point, after that at its first point if it was followed in both directions.
    pub reasons: Vec<EndReason>,
    /// The message for the user.
    pub message: String,
    /// False if the computation ended before one of the requested limits.
    pub complete: bool,
}

impl BranchEnd {
    /// The same with a word about points whose stability was left out, since the time for it was used up.
    pub fn without_stability(mut self, points: usize) -> Self {
        self.message += &match points {
            0 => String::new(),
            1 => "; the stability of one point was left out, its time was used up".to_owned(),
            n => format!("; the stability of {n} points was left out, its time was used up"),
        };
        self
    }

    /// Whether its message has it that the branch ended on this internal-resonance branch.
    pub fn is_on(&self, resonance: InternalResonance) -> bool {
        self.message.contains(&format!("internal-resonance branch {resonance},"))
    }

    /// The end of a branch that was followed in one direction.
    pub fn new(reason: EndReason, message: impl Into<String>, complete: bool) -> Self {
        Self { reasons: vec![reason], message: message.into(), complete }
    }

    /// The end of points that were measured, read or given, with a message to this effect.
    pub fn given(message: impl Into<String>) -> Self {
        Self::new(EndReason::Given, message, true)
    }

    /// Whether this is the reason at one of its ends.
    pub fn has(&self, reason: EndReason) -> bool {
        self.reasons.contains(&reason)
    }

    /// Names of the reasons, separated by spaces.
    pub fn names(&self) -> String {
        self.reasons.iter().map(|reason| reason.name()).collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_about_the_internal_resonance_that_it_names_and_no_other() {
        let at = |harmonic, mode| InternalResonance { harmonic, mode };
        let message = "the energy was reached; on the internal-resonance branch 2:mode 2, which was followed: none";
        let end = BranchEnd::new(EndReason::MaxEnergy, message.to_owned(), true);
        assert!(end.is_on(at(2, 2)) && !end.is_on(at(12, 2)) && !end.is_on(at(2, 21)) && !end.is_on(at(2, 1)));
    }

    #[test]
    fn a_branch_that_was_followed_both_ways_has_two_reasons() {
        let end = BranchEnd {
            reasons: vec![EndReason::Given, EndReason::OtherMode],
            ..BranchEnd::new(EndReason::Given, "read from a file", true)
        };
        assert!(end.has(EndReason::Given) && end.has(EndReason::OtherMode) && !end.has(EndReason::Unknown));
        assert_eq!(end.names(), "given other-mode");
    }
}
