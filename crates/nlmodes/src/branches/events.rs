use nlmodes_continuation::EventKind;
use nlmodes_modal::Event;

/// What an event of the continuation is to a nonlinear mode, whose parameter is the averaged kinetic energy and whose
/// watched unknown is the frequency.
pub fn event_of(kind: EventKind) -> Event {
    match kind {
        EventKind::ParameterFold => Event::Fold,
        EventKind::UnknownFold { .. } => Event::FrequencyFold,
        EventKind::BranchPoint => Event::BranchPoint,
        EventKind::PatternChange { .. } => Event::ContactChange,
        // The only kind left; the enum is open for others.
        _ => Event::Kink,
    }
}
