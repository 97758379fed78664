use nlmodes_continuation::EventKind;

/// Name of an event in tables and figures; lengths and frequencies of the problem are behind it.
///
/// | name | what happens |
/// | --- | --- |
/// | `grazing` | the linear mode touches a stop for the first time (given by the study, not by the continuation) |
/// | `fold` | the averaged kinetic energy turns |
/// | `frequency-fold` | the frequency turns |
/// | `branch-point` | other branches cross |
/// | `kink` | the branch has a corner |
/// | `contact-change` | the sequence of closed contacts within a period changes |
/// | `other-mode` | the branch has left its nonlinear mode for that of another linear mode (given by the study) |
/// | `harmonics`, `harmonics-unproven`, `accuracy-limit` | the number of harmonics changes, and what comes of an [`super::Accuracy`] (given by the study) |
pub fn event_name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::ParameterFold => "fold",
        EventKind::UnknownFold { .. } => "frequency-fold",
        EventKind::BranchPoint => "branch-point",
        EventKind::Kink => "kink",
        EventKind::PatternChange { .. } => "contact-change",
        _ => "event",
    }
}
