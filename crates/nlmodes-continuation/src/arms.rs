//! Arms of the solution set that leave a small sphere, and which of them continues the branch.

use std::f64::consts::PI;

use crate::ParametricSystem;
use crate::corrector::{Correction, Corrector, Surface};
use crate::crossing::Choice;
use crate::sphere::Sphere;
use crate::vectors::{along, distance, dot};

/// Distance below which two arms are one: over the radius, and over the resolution of points.
const DISTINCT: (f64, f64) = (1e-3, 100.0);

/// Newton iterations permitted for one arm.
const ITERATIONS: usize = 40;

/// Steps tried, each half the one before: from where an interval of contact has just closed, Newton's full step may
/// lead far away.
const TRIALS: usize = 12;

/// Most arms that are joined in pairs: the ways to do so grow with the factorial.
const MOST_PAIRED: usize = 14;

/// Most curves that are followed on one sphere with one equation given up.
const MOST_CURVES: usize = 24;

/// Solutions at the distance `radius` from `center`.
#[derive(Debug, Clone)]
pub(crate) struct Arms {
    /// Unit vector towards the arm on which the branch came.
    pub back: Vec<f64>,
    /// The others; their tangents point outward.
    pub onward: Vec<Correction>,
    /// Curves on the sphere that were not followed, or not to their end.
    pub unsearched: usize,
}

impl Arms {
    /// All arms around `center`, for a branch that came near `back`; `nesting` tells the sphere of a corner of a curve
    /// on another.
    ///
    /// What is nearly free to move at `center` is a space of m dimensions, and on a small sphere there are m − 1
    /// equations that its Jacobian there hardly knows. With one of them given up the solutions on the sphere are curves
    /// through arms, and each curve that closes passes an even number of them. So curves are followed from each arm
    /// that is found, each of these equations given up in turn.
    pub fn around<S: ParametricSystem>(
        system: &mut S,
        corrector: &mut Corrector,
        center: &[f64],
        radius: f64,
        nesting: usize,
        back: &[f64],
    ) -> Option<Self> {
        corrector.evaluate(system, center).ok()?;
        let free = corrector.singular_directions()?;
        let (tolerance, resolution) = (corrector.tolerance, corrector.resolution.max(corrector.blur));
        let mut own = searching(system, corrector, center.len() - 1);
        let surface = Surface::Sphere { center: center.to_vec(), radius };
        let back = own.correct(system, back, &surface).ok()?;
        let sphere = Sphere { center, radius, tolerance, resolution, rounding: &corrector.rounding, nesting };
        let mut search = Search { system, own, surface, sphere, arms: vec![back], spent: 0, unsearched: 0 };
        if nesting > 0 {
            search.along(&free.left[..free.left.len().min(2)]);
        } else {
            search.along(&free.left);
            if search.arms.len() % 2 == 1 {
                search.along(&mixed(&free.left));
            }
        }
        corrector.evaluations += search.own.evaluations + search.spent;
        let unsearched = search.unsearched;
        let mut arms = search.arms.into_iter();
        let back = outward(center, &arms.next()?.z);
        Some(Self { back, onward: arms.collect(), unsearched })
    }

    /// As a choice of which one is the branch's own.
    pub fn choice(self, center: &[f64], own: usize) -> Choice {
        Choice { z: center.to_vec(), back: self.back, arms: self.onward, own, unsearched: self.unsearched }
    }

    /// These arms as they are found ever closer to the center, down to the distance `least`, without those that are
    /// not; and how many these are.
    pub fn followed_inward<S: ParametricSystem>(
        &self,
        system: &mut S,
        corrector: &mut Corrector,
        center: &[f64],
        radius: f64,
        least: f64,
    ) -> (Self, usize) {
        let mut own = searching(system, corrector, center.len() - 1);
        let mut closer = |arm: &Correction, radius: f64| {
            let guess = along(center, radius, &outward(center, &arm.z));
            let surface = Surface::Sphere { center: center.to_vec(), radius };
            own.correct(system, &guess, &surface).ok().filter(|c| distance(&c.z, &guess) < 0.3 * radius)
        };
        let radii = || std::iter::successors(Some(0.1 * radius), |r| Some(0.1 * r)).take_while(|r| *r >= 0.99 * least);
        let mut inward = |arm: &Correction| radii().try_fold(arm.clone(), |arm, radius| closer(&arm, radius));
        let onward: Vec<Correction> = self.onward.iter().filter_map(&mut inward).collect();
        let lost = self.onward.len() - onward.len();
        // The way back leads to the center: the branch came along it.
        let back = self.onward.first().and_then(|any| {
            let back = Correction { z: along(center, radius, &self.back), ..any.clone() };
            Some(outward(center, &inward(&back)?.z))
        });
        let back = back.unwrap_or_else(|| self.back.clone());
        corrector.evaluations += own.evaluations;
        (Self { back, onward, unsearched: self.unsearched }, lost)
    }

    /// Index of the arm that continues the branch.
    ///
    /// The arms are joined in pairs to curves so that these turn least in all. At a crossing with a smooth curve that
    /// leaves the branch its own continuation, be it bent by more than the turn-off: the curve that goes straight on
    /// belongs to the others.
    pub fn partner(&self, center: &[f64]) -> Option<usize> {
        let mut directions = vec![self.back.clone()];
        directions.extend(self.onward.iter().map(|arm| outward(center, &arm.z)));
        if directions.len() > MOST_PAIRED {
            // Too many to join all of them.
            let straight =
                (1..directions.len()).min_by(|i, j| bend(&directions, 0, *i).total_cmp(&bend(&directions, 0, *j)));
            return straight.map(|k| k - 1);
        }
        best_partner(&directions).map(|k| k - 1)
    }
}

/// A corrector like another one that goes on for longer, for systems with n unknowns: a search for arms begins further
/// from them.
pub(crate) fn searching<S: ParametricSystem>(system: &S, like: &Corrector, n: usize) -> Corrector {
    let mut own = Corrector::with_solver(system.solver(), n, like.tolerance, ITERATIONS);
    (own.trials, own.resolution, own.blur) = (TRIALS, like.resolution, like.blur);
    own.rounding.clone_from(&like.rounding);
    own
}

/// Sums and differences of neighbours.
fn mixed(left: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let half = 0.5_f64.sqrt();
    let mix = |pair: &[Vec<f64>], sign: f64| pair[0].iter().zip(&pair[1]).map(|(a, b)| half * (a + sign * b)).collect();
    left.windows(2).flat_map(|pair| [mix(pair, 1.0), mix(pair, -1.0)]).collect()
}

/// The arms of a sphere as they are found; the first one is the way back.
struct Search<'a, S> {
    system: &'a mut S,
    own: Corrector,
    surface: Surface,
    sphere: Sphere<'a>,
    arms: Vec<Correction>,
    /// Evaluations by others than `own`.
    spent: usize,
    /// Curves that were not followed, or not to their end.
    unsearched: usize,
}

impl<S: ParametricSystem> Search<'_, S> {
    /// Follows curves from all arms, with each of these equations given up in turn, until one more of them brings no
    /// arm that was not known before. Arms that a curve has passed do not start another.
    fn along(&mut self, left: &[Vec<f64>]) {
        for left in left {
            let before = self.arms.len();
            let mut covered = Vec::new();
            for _ in 0..MOST_CURVES {
                let Some(a) = (0..self.arms.len()).find(|a| !covered.contains(a)) else { break };
                covered.push(a);
                let track = self.sphere.arms_along(self.system, &self.arms[a].z, left);
                self.spent += track.evaluations;
                self.unsearched += usize::from(!track.closed);
                for guess in track.arms {
                    covered.extend(self.take(&guess));
                }
            }
            self.unsearched += (0..self.arms.len()).filter(|a| !covered.contains(a)).count();
            let nothing_new = before > 1 && self.arms.len() == before;
            if nothing_new || (self.sphere.nesting > 0 && self.arms.len() > 1) {
                break;
            }
        }
    }

    /// Number of the arm near `guess`, if there is one.
    fn take(&mut self, guess: &[f64]) -> Option<usize> {
        let radius = self.sphere.radius;
        let arm = self.own.correct(self.system, guess, &self.surface).ok()?;
        let blurred = (DISTINCT.0 * radius).max(DISTINCT.1 * self.sphere.resolution);
        if let Some(known) = self.arms.iter().position(|known| distance(&known.z, &arm.z) <= blurred) {
            return Some(known);
        }
        (distance(&arm.z, guess) < 0.3 * radius).then(|| {
            self.arms.push(arm);
            self.arms.len() - 1
        })
    }
}

/// Unit vector from the center to a point.
pub(crate) fn outward(center: &[f64], point: &[f64]) -> Vec<f64> {
    let length = distance(point, center);
    along(&vec![0.0; center.len()], 1.0 / length, &along(point, -1.0, center))
}

/// The partner of arm 0 where the arms are joined in pairs with the least sum of turns; an odd one among the others
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

/// Turn in coming in along one arm and going out along another, rad.
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
    fn arms_are_joined_in_pairs_with_the_least_turns_in_all() {
        // Two curves that cross: each goes straight on, whatever the order of the arms.
        assert_eq!(best_partner(&at(&[0.0, 60.0, 180.0, 240.0])), Some(2));
        assert_eq!(best_partner(&at(&[0.0, 180.0, 60.0, 240.0])), Some(1));
        // Three of them.
        assert_eq!(best_partner(&at(&[10.0, 70.0, 130.0, 190.0, 250.0, 310.0])), Some(3));
        // Turns of 20° and 50° are less than 10° and 80°: the straightest way for the first would leave the others a
        // sharp corner.
        assert_eq!(best_partner(&at(&[0.0, 170.0, 300.0, 200.0])), Some(3));
        // An odd one stays alone, and one arm has no partner.
        assert_eq!(best_partner(&at(&[0.0, 90.0, 175.0])), Some(2));
        assert_eq!(best_partner(&at(&[0.0])), None);
    }

    fn star(degrees: &[f64]) -> Arms {
        let [back, rest @ ..] = &at(degrees)[..] else { unreachable!() };
        let arm = |direction: &Vec<f64>| Correction {
            z: along(&[2.0, -1.0], 1e-3, direction),
            tangent: direction.clone(),
            orientation: 1.0,
            residual: 0.0,
            iterations: 1,
            pattern: 0,
            regularity: 1.0,
        };
        Arms { back: back.clone(), onward: rest.iter().map(arm).collect(), unsearched: 0 }
    }

    /// The partner among the arms without the way back, of few arms and of more than are joined in pairs.
    #[test]
    fn a_branch_goes_on_along_the_arm_that_continues_it() {
        let center = [2.0, -1.0];
        assert_eq!(star(&[180.0, 0.0]).partner(&center), Some(0));
        assert_eq!(star(&[180.0, 90.0, 5.0, 270.0]).partner(&center), Some(1));
        assert_eq!(star(&[10.0]).partner(&center), None);
        let many: Vec<f64> = (0..=MOST_PAIRED + 2).map(|k| 7.0 * k as f64).collect();
        let wanted = many.iter().map(|angle| (angle - 180.0).abs()).enumerate().skip(1);
        let (expected, _) = wanted.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert_eq!(star(&many).partner(&center), Some(expected - 1));
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
            // Two curves that touch, and two of whose arms have the same direction.
            let [back, _, ahead, _] = crossing;
            let touching = [back.clone(), back, ahead.clone(), ahead];
            assert_ne!(best_partner(&touching), Some(1), "{angle}");
        }
        assert!(rounded_up > 10, "{rounded_up}");
    }

    /// `x² = p²`.
    struct Cross;

    impl ParametricSystem for Cross {
        type Error = std::convert::Infallible;

        fn dim(&self) -> usize {
            1
        }

        fn linearize(&mut self, x: &[f64], p: f64, out: &mut crate::Linearization) -> Result<(), Self::Error> {
            out.residual[0] = x[0] * x[0] - p * p;
            (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (2.0 * x[0], -2.0 * p);
            Ok(())
        }
    }

    #[test]
    fn an_arm_has_the_number_in_which_it_was_found_whenever_it_is_found_again() {
        let (center, radius, tolerance) = ([0.0; 2], 1e-3, 1e-11);
        let toward = |degrees: f64| along(&center, radius, &at(&[degrees])[0]);
        let surface = Surface::Sphere { center: center.to_vec(), radius };
        let mut own = Corrector::new(1, tolerance, ITERATIONS);
        let back = own.correct(&mut Cross, &toward(225.0), &surface).unwrap();
        let rounding = own.rounding.clone();
        let sphere =
            Sphere { center: &center, radius, tolerance, resolution: own.resolution, rounding: &rounding, nesting: 0 };
        let mut search = Search { system: &mut Cross, own, surface, sphere, arms: vec![back], spent: 0, unsearched: 0 };
        for (degrees, number) in [(46.0, 1), (44.0, 1), (222.0, 0), (-44.0, 2), (137.0, 3), (45.0, 1), (-46.0, 2)] {
            assert_eq!(search.take(&toward(degrees)), Some(number), "{degrees}°");
        }
        let wanted = at(&[225.0, 45.0, -45.0, 135.0]);
        assert_eq!(search.arms.len(), wanted.len());
        for (arm, wanted) in search.arms.iter().zip(&wanted) {
            assert!(distance(&outward(&center, &arm.z), wanted) < 1e-6, "{:?}", arm.z);
        }
    }

    #[test]
    fn sums_and_differences_of_unit_vectors_are_unit_vectors_across_each_other() {
        let found = mixed(&[vec![1.0, 0.0, 0.0], vec![0.0, 0.0, 1.0], vec![0.0, 1.0, 0.0]]);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let expected = [[half, 0.0, half], [half, 0.0, -half], [0.0, half, half], [0.0, -half, half]];
        assert_eq!(found.len(), 4);
        for (a, b) in found.iter().zip(expected) {
            assert!(distance(a, &b) < 1e-15, "{a:?} {b:?}");
        }
    }
}
