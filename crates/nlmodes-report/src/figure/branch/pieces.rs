//! Segments of a branch that are drawn alike.

use crate::palette;
use crate::svg::Stroke;
use nlmodes_modal::{Event, ModalPoint, tongues};

/// Maximum number of internal-resonance branches drawn as strongly as the backbone.
const FEW_TONGUES: usize = 3;

/// The indices of the points at which a curve through them may have a kink.
pub(in crate::figure) fn corners<'p>(points: impl IntoIterator<Item = &'p ModalPoint>) -> Vec<usize> {
    let is_corner = |point: &ModalPoint| point.events.iter().any(|event| event.is_corner());
    points.into_iter().enumerate().filter(|(_, point)| is_corner(point)).map(|(index, _)| index).collect()
}

/// Stability of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::figure) enum State {
    /// It is stable, or stability was not requested.
    Stable,
    Unstable,
    Unknown,
}

impl State {
    /// Of a motion that is stable or not, if this is known, on a curve that was judged or not.
    pub fn of(stable: Option<bool>, is_judged: bool) -> Self {
        match stable {
            Some(false) => Self::Unstable,
            None if is_judged => Self::Unknown,
            _ => Self::Stable,
        }
    }

    pub fn class(self) -> &'static str {
        match self {
            Self::Stable => "branch",
            Self::Unstable => "branch unstable",
            Self::Unknown => "branch stability-unknown",
        }
    }

    /// A line as it is where stable, dotted where unstable; thin where unknown, if it is known for other points.
    pub fn stroke(self, stroke: Stroke) -> Stroke {
        match self {
            Self::Stable => stroke,
            Self::Unstable => Stroke::short_dashed(stroke.color, stroke.width),
            Self::Unknown => Stroke::solid(stroke.color, 0.45 * stroke.width),
        }
    }
}

/// A segment without gaps.
pub(super) struct Piece<'p> {
    pub points: &'p [ModalPoint],
    pub state: State,
    /// Whether it belongs to one of many internal-resonance branches, over which the backbone is drawn.
    pub is_behind: bool,
}

impl Piece<'_> {
    /// Line style as part of the branch with this number.
    pub fn stroke(&self, index: usize) -> Stroke {
        let stroke = self.state.stroke(branch_stroke(index));
        if self.is_behind { Stroke { width: 0.5 * stroke.width, ..stroke } } else { stroke }
    }
}

/// Segments of a branch that are drawn alike, without gaps between them except for skipped ones; from back to front.
///
/// The segment up to a change ends at its point, where the next one begins.
pub(super) fn pieces(points: &[ModalPoint]) -> Vec<Piece<'_>> {
    let judged = points.iter().any(|point| point.stability.is_some());
    let tongues = tongues(points);
    let many = tongues.iter().filter(|tongue| !tongue.skipped).count() > FEW_TONGUES;
    let on_tongue = |index: usize| {
        let holds = |start: usize, end: Option<usize>| start <= index && end.is_none_or(|end| index <= end);
        many && tongues.iter().any(|tongue| !tongue.skipped && holds(tongue.start, tongue.end))
    };
    let stable = |index: usize| points[index].stability.and_then(|stability| stability.stable);
    let look = |index: usize| (State::of(stable(index), judged), on_tongue(index));
    let (mut found, mut start) = (Vec::new(), 0);
    let piece = |start: usize, end: usize| {
        let (state, is_behind) = look(start);
        Piece { points: &points[start..end], state, is_behind }
    };
    for (end, point) in points.iter().enumerate().skip(1) {
        if point.has_event(Event::Resumed) {
            found.push(piece(start, end));
            start = end;
        } else if look(end - 1) != look(end) {
            // A curve of one state reaches to the point at which the other begins.
            found.push(piece(start, end + 1));
            start = end;
        }
    }
    if start < points.len() {
        found.push(piece(start, points.len()));
    }
    found.sort_by_key(|piece| !piece.is_behind);
    found
}

/// The line of the branch with this number.
pub(super) fn branch_stroke(index: usize) -> Stroke {
    Stroke::solid(palette::curve(index), 2.0)
}
