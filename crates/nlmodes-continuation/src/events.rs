use crate::corrector::{Correction, Corrector};
use crate::step::{Foot, reach};
use crate::{EventKind, ParametricSystem};

/// An event within a step, at the distance `s` along the foot's tangent.
pub(crate) struct Located {
    pub s: f64,
    pub kind: EventKind,
    pub point: Correction,
}

/// Finds and locates what lies between `foot` and `end`, ascending in distance.
pub(crate) fn locate<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    watched: &[usize],
    foot: (&Foot, f64),
    end: &Correction,
    h: f64,
) -> Vec<Located> {
    let (foot, orientation) = foot;
    let n = end.z.len() - 1;
    let mut found = Vec::new();
    let folds = std::iter::once((n, EventKind::ParameterFold))
        .chain(watched.iter().map(|&index| (index, EventKind::UnknownFold { index })));
    for (i, kind) in folds {
        if foot.tangent[i] * end.tangent[i] < 0.0 {
            found.extend(root(system, corrector, foot, end, h, kind, foot.tangent[i], |c| c.tangent[i]));
        }
    }
    if orientation * end.orientation < 0.0 {
        let kind = EventKind::BranchPoint;
        found.extend(root(system, corrector, foot, end, h, kind, orientation, |c| c.orientation));
    }
    if foot.pattern != end.pattern {
        let kind = EventKind::PatternChange { from: foot.pattern, to: end.pattern };
        let side = |c: &Correction| if c.pattern == foot.pattern { 1.0 } else { -1.0 };
        found.extend(root(system, corrector, foot, end, h, kind, 1.0, side));
    }
    found.sort_by(|a, b| a.s.total_cmp(&b.s));
    found
}

/// Where `test` changes its sign: secant steps, kept within the bracket by bisection.
#[allow(clippy::too_many_arguments)]
fn root<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    foot: &Foot,
    end: &Correction,
    h: f64,
    kind: EventKind,
    at_foot: f64,
    test: impl Fn(&Correction) -> f64,
) -> Option<Located> {
    let (mut low, mut f_low) = (0.0, at_foot);
    let (mut high, mut f_high) = (h, test(end));
    let mut best: Option<Correction> = None;
    for k in 0..60 {
        if high - low <= 1e-10 * h.max(1e-3) {
            break;
        }
        let secant = low + (high - low) * f_low / (f_low - f_high);
        let s = if k % 3 == 2 { 0.5 * (low + high) } else { secant.clamp(low, high) };
        let Ok(c) = reach(system, corrector, foot, s) else { break };
        let f = test(&c);
        if f * at_foot > 0.0 {
            (low, f_low) = (s, f);
        } else {
            (high, f_high) = (s, f);
        }
        let done = f.abs() < 1e-12;
        best = Some(c);
        if done {
            (low, high) = (s, s);
        }
    }
    best.map(|point| Located { s: 0.5 * (low + high), kind, point })
}
