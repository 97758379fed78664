//! How a branch goes on where no step ahead exists: at corners of a piecewise smooth curve, and at crossings.

use nlmodes_linalg::DenseLu;

use crate::ParametricSystem;
use crate::arms::Arms;
use crate::circle::SingularPlane;
use crate::corrector::{Correction, Corrector, along, distance, dot};
use crate::step::{Foot, StepSettings, reach, step};

/// Second smallest over largest singular value above which a Jacobian has no other direction nearly free.
const REGULAR: f64 = 1e-3;

/// Shortest step towards a corner.
const NEAREST: f64 = 1e-10;

/// Most steps towards a corner.
const APPROACH: usize = 24;

/// A way on.
#[derive(Debug, Clone)]
pub(crate) struct Passage {
    /// First point beyond, with its tangent in the direction of travel.
    pub next: Correction,
    /// Number of arms that meet, the way back included.
    pub n_arms: usize,
}

/// The way on from `foot`; `way_back` gives the point of the branch behind it at a distance.
pub(crate) fn pass<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &Foot,
    way_back: impl Fn(f64) -> Vec<f64>,
) -> Option<Passage> {
    if let Some(next) = across_boundary(system, corrector, settings, foot, REGULAR) {
        return Some(Passage { next, n_arms: 2 });
    }
    let mut crossing = None;
    for radius in radii(settings) {
        let Some(arms) = Arms::around(system, corrector, &foot.z, radius, &way_back(radius)) else { continue };
        // Of two arms, one is the way back and the other the way on, whatever happens in between; det [J; tᵀ] confirms it.
        if let [next] = arms.onward.as_slice()
            && next.orientation * foot.orientation > 0.0
        {
            return Some(Passage { next: next.clone(), n_arms: 2 });
        }
        if !arms.onward.is_empty() {
            crossing = Some(arms);
        }
    }
    let Some(arms) = crossing else {
        let next = across_boundary(system, corrector, settings, foot, 0.0)?;
        return Some(Passage { next, n_arms: 2 });
    };
    let next = arms.onward[arms.partner(&foot.z)?].clone();
    Some(Passage { next, n_arms: 1 + arms.onward.len() })
}

/// Distances at which arms are looked for, descending.
fn radii(settings: &StepSettings) -> impl Iterator<Item = f64> + use<> {
    let least = 10.0 * settings.min;
    let first = settings.arm.max(least);
    std::iter::successors(Some(first), |r| Some(0.1 * r)).take_while(move |r| *r >= 0.99 * least)
}

/// Whether more than two arms meet at `center`, a regular point but for a crossing, through which the branch goes along `tangent`.
pub(crate) fn is_crossing<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &Correction,
) -> bool {
    let radius = 10.0 * settings.min;
    let back = along(&center.z, -radius, &center.tangent);
    Arms::around(system, corrector, &center.z, radius, &back).is_some_and(|arms| arms.onward.len() > 2)
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
    let here = SingularPlane::of(corrector.jacobian())?;
    corrector.evaluate(system, &along(&foot.z, 10.0 * settings.min, &foot.tangent)).ok()?;
    let there = SingularPlane::of(corrector.jacobian())?;
    if system.pattern() == foot.pattern || here.ratio.min(there.ratio) < regular {
        return None;
    }
    let mut tangent = there.right[0].clone();
    let sign = DenseLu::factor(corrector.bordered_by(&tangent)).ok()?.determinant_sign();
    tangent.iter_mut().for_each(|t| *t *= sign * foot.orientation);
    let beyond = Foot { tangent, ..foot.clone() };
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

/// Moves the foot towards the corner ahead of it, by steps below the shortest, as far as they can be shown to stay on the branch.
pub(crate) fn approach<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &mut Foot,
) {
    let mut h = 0.5 * settings.min;
    for _ in 0..APPROACH {
        if h < NEAREST {
            break;
        }
        match step(system, corrector, settings, foot, h) {
            Ok(end) if end.orientation * foot.orientation > 0.0 && end.pattern == foot.pattern => {
                *foot = Foot::from(&end)
            }
            _ => h *= 0.4,
        }
    }
}
