//! How a branch goes on where no step ahead exists: at corners of a piecewise smooth curve, and at crossings.

use crate::ParametricSystem;
use crate::arms::Arms;
use crate::corrector::{Correction, Corrector};
use crate::crossing::Choice;
use crate::meeting::radii;
use crate::onsets;
use crate::pencil::GROWN_NEAR;
use crate::singular::NEARLY_FREE;
use crate::step::{Foot, StepSettings, reach, step};
use crate::vectors::{along, distance, dot};

/// Shortest step towards a corner, over the shortest one elsewhere.
const NEAREST: f64 = 1e-4;

/// First step towards a corner, over the shortest one elsewhere.
pub(crate) const APPROACHING: f64 = 0.5;

/// Most steps towards a corner.
const APPROACH: usize = 24;

/// A way on.
#[derive(Debug, Clone)]
pub(crate) enum Passage {
    /// The only one: its first point, with its tangent in the direction of travel.
    Corner(Correction),
    /// One of several.
    Crossing(Choice),
}

/// The way on from `foot`; `way_back` gives the point of the branch behind it at a distance, and `nesting` is zero but
/// for curves on spheres.
pub(crate) fn pass<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    nesting: usize,
    foot: &Foot,
    way_back: impl Fn(f64) -> Vec<f64>,
) -> Option<Passage> {
    let boundaries = if nesting == 0 { onsets::boundaries_at(system, settings, foot) } else { Vec::new() };
    let behind = way_back(10.0 * settings.min);
    if let Some(arms) = onsets::arms(system, corrector, settings, foot, &boundaries, &behind)
        && let Some(own) = arms.partner(&foot.z)
    {
        match arms.onward.as_slice() {
            [only] if only.orientation * foot.orientation > 0.0 => return Some(Passage::Corner(only.clone())),
            [_] => {}
            _ => return Some(Passage::Crossing(arms.choice(&foot.z, own))),
        }
    }
    let next = across_boundary(system, corrector, settings, foot, NEARLY_FREE)
        .or_else(|| short_step(system, corrector, settings, foot))
        .or_else(|| regular_corner(system, corrector, settings, foot, &boundaries, &behind));
    if let Some(next) = next {
        return Some(Passage::Corner(next));
    }
    let mut crossing = None;
    for radius in radii(settings).take(if nesting > 0 { 1 } else { usize::MAX }) {
        let Some(arms) = Arms::around(system, corrector, &foot.z, radius, nesting, &way_back(radius)) else { continue };
        // Of two arms, one is the way back and the other the way on, whatever happens in between; det [J; tᵀ] confirms
        // it.
        if let [next] = arms.onward.as_slice()
            && next.orientation * foot.orientation > 0.0
        {
            return Some(Passage::Corner(next.clone()));
        }
        if arms.onward.is_empty() {
            continue;
        }
        if nesting == 0 && arms.onward.len() > 1 && arms.onward.len() % 2 == 1 {
            // Arms that all are found again ever closer meet here; with the way back they are even in number.
            let (inward, lost) = arms.followed_inward(system, corrector, &foot.z, radius, 10.0 * settings.min);
            if lost == 0 {
                crossing = Some(inward);
                break;
            }
        }
        crossing = Some(arms);
    }
    let Some(arms) = crossing else {
        let next = across_boundary(system, corrector, settings, foot, 0.0)?;
        return Some(Passage::Corner(next));
    };
    let own = arms.partner(&foot.z)?;
    match arms.onward.as_slice() {
        [only] => Some(Passage::Corner(only.clone())),
        _ => Some(Passage::Crossing(arms.choice(&foot.z, own))),
    }
}

/// Shares of the shortest step with which a corner is tried.
const SHORT: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// A step below the shortest onto the next smooth piece, that passes all tests: what looks like a corner may be a tight
/// bend, of a contact that is far stiffer than what moves it.
fn short_step<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &Foot,
) -> Option<Correction> {
    SHORT.into_iter().find_map(|share| {
        let end = step(system, corrector, settings, foot, share * settings.min).ok()?;
        (end.orientation * foot.orientation > 0.0 && end.pattern != foot.pattern).then_some(end)
    })
}

/// The first point on the next smooth piece, where neither piece is near a crossing.
///
/// There the tangent follows from the Jacobian beyond, and its sense from `det [J; tᵀ]`, which keeps its sign across a
/// corner: so the way on is known however sharp the corner is.
fn across_boundary<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &Foot,
    regular: f64,
) -> Option<Correction> {
    corrector.evaluate(system, &foot.z).ok()?;
    let here = corrector.singular_directions()?;
    corrector.evaluate(system, &along(&foot.z, 10.0 * settings.min, &foot.tangent)).ok()?;
    let there = corrector.singular_directions()?;
    if system.pattern() == foot.pattern || here.ratio.min(there.ratio) < regular {
        return None;
    }
    let mut tangent = there.tangent.clone();
    let sign = corrector.orientation_along(&tangent)?;
    tangent.iter_mut().for_each(|t| *t *= sign * foot.orientation);
    let beyond = Foot { tangent, behind: None, ..foot.clone() };
    [30.0, 10.0, 3.0].into_iter().find_map(|share| {
        let h = share * settings.min;
        let end = reach(system, corrector, &beyond, h).ok()?;
        let credible = distance(&end.z, &along(&foot.z, h, &beyond.tangent)) < 0.3 * h
            && dot(&end.tangent, &beyond.tangent) > 0.9
            && end.orientation * foot.orientation > 0.0
            && end.pattern != foot.pattern;
        credible.then_some(end)
    })
}

/// The same where directions are nearly free all along the branch, and no more so at the corner: through a point on one
/// boundary, on neither side of which the Jacobian becomes singular, leads one way.
pub(crate) fn regular_corner<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &Foot,
    boundaries: &[Vec<f64>],
    behind: &[f64],
) -> Option<Correction> {
    if boundaries.len() > 1 {
        return None;
    }
    let ahead = along(&foot.z, 10.0 * settings.min, &foot.tangent);
    system.boundary(behind, &ahead)?;
    let at = corrector.border_at(system, &foot.z, &foot.tangent)?;
    let before = corrector.border_at(system, behind, &foot.tangent)?;
    if at.is_singular_beside(&before, GROWN_NEAR) {
        return None;
    }
    let next = across_boundary(system, corrector, settings, foot, 0.0)?;
    let beyond = corrector.border_at(system, &next.z, &next.tangent)?;
    let close = along(&foot.z, settings.min, &next.tangent);
    let close = corrector.border_at(system, &close, &next.tangent)?;
    (system.pattern() == next.pattern && !close.is_singular_beside(&beyond, GROWN_NEAR)).then_some(next)
}

/// Moves the foot towards the corner ahead of it, by steps below the shortest, as far as they can be shown to stay on
/// the branch and lead to points that are `permitted`; false where they lead on and on, with no corner in their way.
pub(crate) fn approach<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &mut Foot,
    permitted: impl Fn(&[f64]) -> bool,
) -> bool {
    let mut h = APPROACHING * settings.min;
    for _ in 0..APPROACH {
        if h < NEAREST * settings.min {
            break;
        }
        match step(system, corrector, settings, foot, h) {
            Ok(end) if end.orientation * foot.orientation > 0.0 && end.pattern == foot.pattern && permitted(&end.z) => {
                *foot = Foot::from(&end)
            }
            _ => h *= 0.4,
        }
    }
    h < APPROACHING * settings.min
}

/// The point of a branch about `radius` behind its foot, from its points and tangents, the latest first.
pub(crate) fn way_back<'p>(
    points: impl Iterator<Item = (Vec<f64>, &'p [f64])>,
    foot: &'p Foot,
    radius: f64,
) -> Vec<f64> {
    let inside = points.take_while(|(z, _)| distance(z, &foot.z) < 0.9 * radius).last();
    let (z, tangent) = inside.unwrap_or_else(|| (foot.z.clone(), &foot.tangent));
    // z − s t lies on the sphere: s² − 2 s t·d + d·d − r² = 0 with d = z − foot.
    let d = along(&z, -1.0, &foot.z);
    let on = dot(tangent, &d);
    let s = on + (on * on - dot(&d, &d) + radius * radius).max(0.0).sqrt();
    along(&z, -s, tangent)
}
