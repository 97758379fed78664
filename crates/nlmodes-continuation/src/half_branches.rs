//! Half-branches: what leaves a point at which the tangent is not unique, each found at one distance from it.

use std::f64::consts::PI;

use crate::ParametricSystem;
use crate::corrector::{Correction, Corrector, Hyperplane, Surface};
use crate::crossing::Choice;
use crate::signs::Signs;
use crate::vectors::{along, distance, dot};

/// Distance below which two half-branches are one: over the radius, and over the resolution of points.
const DISTINCT: (f64, f64) = (1e-3, 100.0);

/// Distance of a half-branch from its candidate, over the radius, up to which that is confirmed.
const CONFIRMED: f64 = 0.3;

/// Newton iterations permitted for one half-branch, and shares of a step tried, each half the one before: a candidate
/// lies further from the branch than the prediction of a step.
const ITERATIONS: usize = 40;
const TRIALS: usize = 12;

/// The same from where deflated Newton's method has come.
const NEAR: (usize, usize) = (10, 4);

/// Distances from those that are known, over the radius, within which it is led away from them, in turn: two may leave
/// in almost the same direction.
const WIDTHS: [f64; 2] = [0.3, 0.03];

/// Newton step, over the radius, below which deflated Newton's method has reached a candidate.
const REACHED: f64 = 1e-2;

/// Distance from a half-branch that is known, over the radius, within which no search starts.
const NEAR_KNOWN: f64 = 0.02;

/// Starts in a row without a half-branch, over the free directions, after which a search has come to an end: where one
/// is missing, and where none need be.
const IDLE: [usize; 2] = [8, 4];

/// Most half-branches that are joined in pairs: the ways to do so grow with the factorial.
const MOST_PAIRED: usize = 14;

/// Half-branches that leave a point.
#[derive(Debug, Clone)]
pub(crate) struct HalfBranches {
    /// Unit vector towards that on which the branch came.
    pub back: Vec<f64>,
    /// The others; their tangents point outward.
    pub onward: Vec<Correction>,
    /// Dimension of the kernel of the Jacobian.
    pub kernel: usize,
    /// Whether there are no others: not where they were found by a search.
    pub complete: bool,
    /// Whether the Jacobian tells each from its neighbours; else this is the branch itself alone.
    pub isolated: bool,
    /// Whether as many leave with one sign of `det [J; tᵀ]` as with the other.
    pub balanced: bool,
}

impl HalfBranches {
    /// As a choice of which one continues the branch.
    pub fn choice(self, center: &[f64], own: usize) -> Choice {
        let Self { back, onward, kernel, complete, .. } = self;
        Choice { z: center.to_vec(), back, arms: onward, own, kernel, complete }
    }

    /// Index of the one that goes on most nearly opposite to the way back.
    pub fn straightest(&self, center: &[f64]) -> Option<usize> {
        let turned = |k: &usize| dot(&outward(center, &self.onward[*k].z), &self.back);
        (0..self.onward.len()).min_by(|a, b| turned(a).total_cmp(&turned(b)))
    }

    /// Index of the one that continues the branch through a kink: all are joined in pairs to curves so that these turn
    /// least in all. Where they are too many for that, the straightest.
    pub fn partner(&self, center: &[f64]) -> Option<usize> {
        if self.onward.len() >= MOST_PAIRED {
            return self.straightest(center);
        }
        let onward = self.onward.iter().map(|found| outward(center, &found.z));
        best_partner(&std::iter::once(self.back.clone()).chain(onward).collect::<Vec<_>>()).map(|k| k - 1)
    }
}

/// Solutions at the distance `radius` from `center`, as they are found.
pub(crate) struct Sphere<'a, S> {
    pub system: &'a mut S,
    pub corrector: Corrector,
    center: &'a [f64],
    surface: Surface,
    pub radius: f64,
    /// Whether candidates are confirmed on planes across them, on which rounding counts as in any step: no singular
    /// point is near that would let every point pass.
    pub is_flat: bool,
    pub found: Vec<Correction>,
}

impl<'a, S: ParametricSystem> Sphere<'a, S> {
    /// With a corrector like another one that goes on for longer.
    pub fn new(system: &'a mut S, like: &Corrector, center: &'a [f64], radius: f64) -> Self {
        let mut corrector = Corrector::with_solver(system.solver(), center.len() - 1, like.tolerance, ITERATIONS);
        (corrector.trials, corrector.resolution, corrector.blur) = (TRIALS, like.resolution, like.blur);
        corrector.rounding.clone_from(&like.rounding);
        let surface = Surface::Sphere { center: center.to_vec(), radius };
        Self { system, corrector, center, surface, radius, is_flat: false, found: Vec::new() }
    }

    fn apart(&self) -> f64 {
        (DISTINCT.0 * self.radius).max(DISTINCT.1 * self.corrector.resolution.max(self.corrector.blur))
    }

    fn is_known(&self, z: &[f64]) -> bool {
        self.found.iter().any(|known| distance(&known.z, z) <= self.apart())
    }

    /// The solution in this direction, where there is one.
    pub fn confirmed(&mut self, direction: &[f64]) -> Option<Correction> {
        let guess = along(self.center, self.radius, direction);
        let flat = self.is_flat.then(|| Surface::Plane(Hyperplane::through(&guess, direction)));
        let found = self.corrector.correct(self.system, &guess, flat.as_ref().unwrap_or(&self.surface)).ok()?;
        (distance(&found.z, &guess) < CONFIRMED * self.radius).then_some(found)
    }

    /// Takes note of the solution in this direction; whether it is one that was not known.
    pub fn take(&mut self, direction: &[f64]) -> bool {
        let found = self.confirmed(direction).filter(|found| !self.is_known(&found.z));
        found.map(|found| self.found.push(found)).is_some()
    }

    /// Looks for solutions from starts in the span of `kernel`, by Newton's method on a residual from which those that
    /// are known are divided out, until many starts in a row lead to no other or so many evaluations are spent. False
    /// as soon as one is found that the Jacobian does not tell from its neighbours: its regularity is below `isolated`.
    pub fn search(&mut self, kernel: &[Vec<f64>], budget: usize, isolated: f64) -> bool {
        let mut starts = Starts { kernel, signs: Signs::default(), queue: Vec::new(), paired: 0, idle: 0 };
        let most = self.corrector.evaluations + budget;
        (self.corrector.max_iterations, self.corrector.trials) = NEAR;
        while self.corrector.evaluations < most && starts.idle <= IDLE[usize::from(self.is_balanced())] * kernel.len() {
            if self.found.iter().any(|found| found.regularity < isolated) {
                return false;
            }
            let guess = along(self.center, self.radius, &starts.next(self.center, &self.found));
            let known: Vec<&[f64]> = self.found.iter().map(|found| found.z.as_slice()).collect();
            if !guess[0].is_finite() || known.iter().any(|known| distance(known, &guess) <= NEAR_KNOWN * self.radius) {
                continue;
            }
            let [width, near] = [WIDTHS[starts.idle % 2], REACHED].map(|share| share * self.radius);
            let near = self.corrector.deflated(self.system, guess, &self.surface, &known, width, near);
            if near.is_some_and(|near| !self.is_known(&near) && self.take(&outward(self.center, &near))) {
                starts.idle = 0;
            }
        }
        true
    }

    /// Whether as many leave with one sign of `det [J; tᵀ]` as with the other, `t` pointing outward: so it is where
    /// none is missing.
    pub fn is_balanced(&self) -> bool {
        self.found.iter().map(|found| found.orientation).sum::<f64>() == 0.0
    }

    /// Whether all lie on one smooth piece.
    pub fn is_smooth(&self) -> bool {
        self.found.windows(2).all(|pair| pair[0].pattern == pair[1].pattern)
    }

    /// Leaves out those that are not found again ever closer to the center, down to the distance `least` or that at
    /// which their regularity is below `isolated`: they belong to another point.
    pub fn keep_those_that_lead_to_center(&mut self, least: f64, isolated: f64) {
        let (all, radius) = (std::mem::take(&mut self.found), self.radius);
        let closer = std::iter::successors(Some(0.1 * radius), |r| Some(0.1 * r)).take_while(|r| *r >= 0.99 * least);
        let closer: Vec<f64> = closer.collect();
        let mut leads = |found: &Correction| {
            let mut nearest = found.clone();
            closer.iter().all(|radius| {
                if nearest.regularity < isolated {
                    return true;
                }
                let direction = outward(self.center, &nearest.z);
                self.radius = *radius;
                self.surface = Surface::Sphere { center: self.center.to_vec(), radius: *radius };
                self.confirmed(&direction).map(|found| nearest = found).is_some()
            })
        };
        let kept: Vec<Correction> = all.into_iter().filter(|found| leads(found)).collect();
        self.radius = radius;
        self.surface = Surface::Sphere { center: self.center.to_vec(), radius };
        self.found = kept;
    }

    /// What was found, the way back being the one next to the direction `back`; `None` where none leads to that side.
    pub fn finish(mut self, back: &[f64], kernel: usize, complete: bool) -> Option<HalfBranches> {
        let balanced = self.is_balanced();
        let toward = |k: &usize| dot(&outward(self.center, &self.found[*k].z), back);
        let own = (0..self.found.len()).max_by(|a, b| toward(a).total_cmp(&toward(b)))?;
        if toward(&own) <= 0.0 {
            return None;
        }
        let back = outward(self.center, &self.found.remove(own).z);
        Some(HalfBranches {
            back,
            onward: self.found,
            kernel,
            complete: complete && balanced,
            isolated: true,
            balanced,
        })
    }
}

/// Directions from which half-branches are searched.
struct Starts<'k> {
    kernel: &'k [Vec<f64>],
    signs: Signs,
    /// Those that follow from half-branches, as many as this of which have been looked at.
    queue: Vec<Vec<f64>>,
    paired: usize,
    /// Directions drawn by lot since the last half-branch was found.
    idle: usize,
}

impl Starts<'_> {
    /// The next one: opposite to a half-branch or between two, for what leaves on one side often does so on others;
    /// else drawn by lot. Not a number between two that are opposite.
    fn next(&mut self, center: &[f64], found: &[Correction]) -> Vec<f64> {
        while let Some(new) = found.get(self.paired) {
            let own = outward(center, &new.z);
            let between = |other: &Correction| unit(along(&own, 1.0, &outward(center, &other.z)));
            self.queue.extend(found[..self.paired].iter().map(between));
            self.queue.push(own.iter().map(|v| -v).collect());
            self.paired += 1;
        }
        self.queue.pop().unwrap_or_else(|| {
            self.idle += 1;
            let weights: Vec<f64> = self.kernel.iter().map(|_| self.signs.draw_between()).collect();
            unit(self.kernel.iter().zip(weights).fold(vec![0.0; center.len()], |sum, (k, w)| along(&sum, w, k)))
        })
    }
}

/// Unit vector from one point to another.
pub(crate) fn outward(center: &[f64], point: &[f64]) -> Vec<f64> {
    let length = distance(point, center);
    along(&vec![0.0; center.len()], 1.0 / length, &along(point, -1.0, center))
}

pub(crate) fn unit(v: Vec<f64>) -> Vec<f64> {
    let length = dot(&v, &v).sqrt();
    v.into_iter().map(|v| v / length).collect()
}

/// The partner of half-branch 0 where all are joined in pairs with the least sum of turns; an odd one among the others
/// stays alone.
fn best_partner(directions: &[Vec<f64>]) -> Option<usize> {
    let sum = |&k: &usize| {
        let others: Vec<usize> = (1..directions.len()).filter(|&i| i != k).collect();
        bend(directions, 0, k) + least_sum(directions, &others)
    };
    (1..directions.len()).min_by(|i, j| sum(i).total_cmp(&sum(j)))
}

fn least_sum(directions: &[Vec<f64>], open: &[usize]) -> f64 {
    let Some((&first, rest)) = open.split_first() else { return 0.0 };
    let alone = if open.len() % 2 == 1 { least_sum(directions, rest) } else { f64::INFINITY };
    (0..rest.len()).fold(alone, |best, k| {
        let others: Vec<usize> = rest.iter().copied().filter(|o| *o != rest[k]).collect();
        best.min(bend(directions, first, rest[k]) + least_sum(directions, &others))
    })
}

/// Turn in coming in along one half-branch and going out along another, rad.
fn bend(directions: &[Vec<f64>], i: usize, j: usize) -> f64 {
    PI - dot(&directions[i], &directions[j]).clamp(-1.0, 1.0).acos()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(degrees: &[f64]) -> Vec<Vec<f64>> {
        degrees.iter().map(|d| vec![d.to_radians().cos(), d.to_radians().sin()]).collect()
    }

    #[test]
    fn half_branches_are_joined_in_pairs_with_the_least_turns_in_all() {
        // Two curves that cross: each goes straight on, whatever their order.
        assert_eq!(best_partner(&at(&[0.0, 60.0, 180.0, 240.0])), Some(2));
        assert_eq!(best_partner(&at(&[0.0, 180.0, 60.0, 240.0])), Some(1));
        // Three of them.
        assert_eq!(best_partner(&at(&[10.0, 70.0, 130.0, 190.0, 250.0, 310.0])), Some(3));
        // Turns of 20° and 50° are less than 10° and 80°: the straightest way for the first would leave the others a
        // sharp corner.
        assert_eq!(best_partner(&at(&[0.0, 170.0, 300.0, 200.0])), Some(3));
        // An odd one stays alone, and one alone has no partner.
        assert_eq!(best_partner(&at(&[0.0, 90.0, 175.0])), Some(2));
        assert_eq!(best_partner(&at(&[0.0])), None);
    }

    /// Of unit vectors the products may be rounded beyond one.
    #[test]
    fn a_branch_goes_straight_on_whatever_the_rounding_of_its_directions() {
        let mut rounded_up = 0;
        for angle in 0..3600 {
            let angle = 0.1 * f64::from(angle) + 0.0123;
            let [back, aside] = [at(&[angle])[0].clone(), at(&[angle + 100.0])[0].clone()];
            let (ahead, other) = (back.iter().map(|v| -v).collect(), aside.iter().map(|v| -v).collect());
            rounded_up += usize::from(dot(&back, &back) > 1.0);
            let crossing = [back.clone(), aside, ahead, other];
            assert_eq!(best_partner(&crossing), Some(2), "{angle}");
            // Two curves that touch, and two of whose half-branches have the same direction.
            let [back, _, ahead, _] = crossing;
            let touching = [back.clone(), back, ahead.clone(), ahead];
            assert_ne!(best_partner(&touching), Some(1), "{angle}");
        }
        assert!(rounded_up > 10, "{rounded_up}");
    }
}
