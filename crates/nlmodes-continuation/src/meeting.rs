//! The arms that meet at a regular point of a step, but for a crossing.

use crate::ParametricSystem;
use crate::arms::{Arms, outward};
use crate::corrector::Corrector;
use crate::crossing::Choice;
use crate::step::StepSettings;
use crate::vectors::{along, dot};

/// Distances, over that at which arms are looked for, at which they are looked for where one is missing there.
const FURTHER: [f64; 7] = [3.0, 10.0, 30.0, 60.0, 100.0, 200.0, 300.0];

/// Distances at which arms are looked for, descending.
pub(crate) fn radii(settings: &StepSettings) -> impl Iterator<Item = f64> + use<> {
    let least = 10.0 * settings.min;
    let first = settings.arm.max(least);
    std::iter::successors(Some(first), |r| Some(0.1 * r)).take_while(move |r| *r >= 0.99 * least)
}

/// The arms at `center`, a regular point but for a crossing, through which the branch goes along `tangent`; `None` if
/// only two meet.
///
/// Close by, what bends the arms may be below the last digits of the unknowns: arms are looked for at a distance first,
/// and taken where all of them are found again ever closer.
pub(crate) fn of_one<S: ParametricSystem>(
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

/// The same where several directions become free at once: cubic terms are drowned by rounding close by, so arms are
/// looked for at a distance first; those that lead to the center belong to it. Where some are missing, those terms may
/// not tell arms apart, as on a square of 3 × 3 nodes, whose border is a ring of eight equal ones: then further away.
pub(crate) fn of_several<S: ParametricSystem>(
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
    let most = most?;
    let further = if is_complete(&most) { None } else { further_out(system, corrector, settings, center, tangent) };
    let further = further.filter(|further| further.onward.len() >= most.onward.len());
    straight_on(further.unwrap_or(most), center, tangent)
}

/// Whether more than two arms meet and none is missing: with the way back they are even in number.
fn is_complete(arms: &Arms) -> bool {
    arms.unsearched == 0 && arms.onward.len() > 2 && arms.onward.len() % 2 == 1
}

/// All arms at the least distance beyond the usual one at which none is missing, each leads inward, and as many are
/// found further away: closer by, what tells them apart is below rounding.
fn further_out<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &[f64],
    tangent: &[f64],
) -> Option<Arms> {
    let mut closer: Option<Arms> = None;
    for share in FURTHER {
        let radius = share * settings.arm;
        let arms = Arms::around(system, corrector, center, radius, 0, &along(center, -radius, tangent));
        let arms = arms.filter(|arms| {
            is_complete(arms) && arms.followed_inward(system, corrector, center, radius, 0.1 * radius).1 == 0
        });
        match (closer, arms) {
            (Some(closer), Some(arms)) if closer.onward.len() == arms.onward.len() => return Some(closer),
            (known, arms) => closer = arms.or(known),
        }
    }
    None
}

/// Of several arms, the one that lies most ahead.
fn straight_on(arms: Arms, center: &[f64], tangent: &[f64]) -> Option<Choice> {
    let ahead = |k: &usize| dot(&outward(center, &arms.onward[*k].z), tangent);
    let own = (0..arms.onward.len()).max_by(|a, b| ahead(a).total_cmp(&ahead(b)))?;
    Some(arms.choice(center, own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arms_are_looked_for_at_a_tenth_each_down_to_ten_times_the_shortest_step() {
        for (min, arm, expected) in [
            (1e-6, 1e-3, vec![1e-3, 1e-4, 1e-5]),
            (1e-7, 1e-3, vec![1e-3, 1e-4, 1e-5, 1e-6]),
            (1e-6, 5e-4, vec![5e-4, 5e-5]),
            (1e-6, 1e-5, vec![1e-5]),
            // No closer than ten of the shortest steps.
            (1e-3, 1e-3, vec![1e-2]),
        ] {
            let found: Vec<f64> = radii(&StepSettings { min, arm, ..StepSettings::default() }).collect();
            assert_eq!(found.len(), expected.len(), "{min} {arm}: {found:?}");
            assert!(found.iter().zip(&expected).all(|(f, e)| (f / e - 1.0).abs() < 1e-12), "{found:?}");
        }
    }
}
