//! How a branch goes on where no step ahead exists: at corners of a piecewise smooth curve, and at crossings.

use crate::ParametricSystem;
use crate::arms::{Arms, outward};
use crate::corrector::{Correction, Corrector};
use crate::crossing::Choice;
use crate::onsets;
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

/// The way on from `foot`; `way_back` gives the point of the branch behind it at a distance, and `nesting` is zero but for curves on spheres.
pub(crate) fn pass<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    nesting: usize,
    foot: &Foot,
    way_back: impl Fn(f64) -> Vec<f64>,
) -> Option<Passage> {
    if nesting == 0
        && let Some(arms) = onsets::arms(system, corrector, settings, foot, &way_back(10.0 * settings.min))
        && let Some(own) = arms.partner(&foot.z)
    {
        match arms.onward.as_slice() {
            [only] if only.orientation * foot.orientation > 0.0 => return Some(Passage::Corner(only.clone())),
            [_] => {}
            _ => return Some(Passage::Crossing(arms.choice(&foot.z, own))),
        }
    }
    let next = across_boundary(system, corrector, settings, foot, NEARLY_FREE);
    if let Some(next) = next.or_else(|| short_step(system, corrector, settings, foot)) {
        return Some(Passage::Corner(next));
    }
    let mut crossing = None;
    for radius in radii(settings).take(if nesting > 0 { 1 } else { usize::MAX }) {
        let Some(arms) = Arms::around(system, corrector, &foot.z, radius, nesting, &way_back(radius)) else { continue };
        // Of two arms, one is the way back and the other the way on, whatever happens in between; det [J; tᵀ] confirms it.
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

/// Distances at which arms are looked for, descending.
fn radii(settings: &StepSettings) -> impl Iterator<Item = f64> + use<> {
    let least = 10.0 * settings.min;
    let first = settings.arm.max(least);
    std::iter::successors(Some(first), |r| Some(0.1 * r)).take_while(move |r| *r >= 0.99 * least)
}

/// The arms at `center`, a regular point but for a crossing, through which the branch goes along `tangent`; `None` if only two meet.
///
/// Close by, what bends the arms may be below the last digits of the unknowns: arms are looked for at a distance first, and taken where all of
/// them are found again ever closer.
pub(crate) fn crossing<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &[f64],
    tangent: &[f64],
) -> Option<Choice> {
    let least = 10.0 * settings.min;
    let mut closest = None;
    for radius in radii(settings) {
        let back = along(center, -radius, tangent);
        closest = Arms::around(system, corrector, center, radius, 0, &back);
        // With the way back they are even in number.
        if let Some(arms) = &closest
            && arms.onward.len() > 2
            && arms.onward.len() % 2 == 1
        {
            let (inward, lost) = arms.followed_inward(system, corrector, center, radius, least);
            if lost == 0 {
                return straight_on(inward, center, tangent);
            }
        }
    }
    straight_on(closest.filter(|arms| arms.onward.len() > 2)?, center, tangent)
}

/// The same where several directions become free at once: cubic terms are drowned by rounding close by, so arms are looked for at a distance
/// first; those that lead to the center belong to it.
pub(crate) fn crossing_of_several<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &[f64],
    tangent: &[f64],
) -> Option<Choice> {
    let least = 10.0 * settings.min;
    let mut most: Option<Arms> = None;
    for radius in radii(settings) {
        let back = along(center, -radius, tangent);
        let Some(arms) = Arms::around(system, corrector, center, radius, 0, &back) else { continue };
        let more = arms.onward.len() > most.as_ref().map_or(2, |most| most.onward.len());
        let mut leading_inward = || {
            let (inward, _) = arms.followed_inward(system, corrector, center, radius, least);
            inward.onward.len()
        };
        if more && leading_inward() > 2 {
            most = Some(arms);
        }
        // With the way back they are even in number, unless one is missing.
        if most.as_ref().is_some_and(|most| most.onward.len() % 2 == 1) {
            break;
        }
    }
    straight_on(most?, center, tangent)
}

/// Of several arms, the one that lies most ahead.
fn straight_on(arms: Arms, center: &[f64], tangent: &[f64]) -> Option<Choice> {
    let ahead = |k: &usize| dot(&outward(center, &arms.onward[*k].z), tangent);
    let own = (0..arms.onward.len()).max_by(|a, b| ahead(a).total_cmp(&ahead(b)))?;
    Some(arms.choice(center, own))
}

/// Shares of the shortest step with which a corner is tried.
const SHORT: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// A step below the shortest onto the next smooth piece, that passes all tests: what looks like a corner may be a tight bend, of a
/// contact that is far stiffer than what moves it.
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

/// Moves the foot towards the corner ahead of it, by steps below the shortest, as far as they can be shown to stay on the branch and
/// lead to points that are `permitted`; false where they lead on and on, with no corner in their way.
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
