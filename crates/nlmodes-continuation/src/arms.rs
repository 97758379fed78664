//! Arms of the solution set that leave a small sphere, and which of them continues the branch.

use std::f64::consts::PI;

use crate::ParametricSystem;
use crate::circle::{Circle, ITERATIONS, SingularPlane, TRIALS};
use crate::corrector::{Correction, Corrector, Surface, along, distance, dot};

/// Distance below which two arms are one: over the radius, and where rounding blurs them.
const DISTINCT: (f64, f64) = (1e-3, 1e-7);

/// Solutions at the distance `radius` from `center`.
#[derive(Debug, Clone)]
pub(crate) struct Arms {
    /// Unit vector towards the arm on which the branch came.
    pub back: Vec<f64>,
    /// The others; their tangents point outward.
    pub onward: Vec<Correction>,
}

impl Arms {
    /// All arms around `center`, for a branch that came near `back`.
    ///
    /// All arms of a crossing are tangent to the plane of the two right singular vectors of the Jacobian with the smallest singular
    /// values, and at a corner that plane holds what is nearly free to move. So the equations are reduced to one, `μ(θ) = 0`, for
    /// the angle θ in that plane (Lyapunov-Schmidt, on a circle): its changes of sign are the arms, be they smooth or not.
    pub fn around<S: ParametricSystem>(
        system: &mut S,
        corrector: &mut Corrector,
        center: &[f64],
        radius: f64,
        back: &[f64],
    ) -> Option<Self> {
        corrector.evaluate(system, center).ok()?;
        let plane = SingularPlane::of(corrector.jacobian())?;
        let mut own = Corrector::new(center.len() - 1, corrector.tolerance, ITERATIONS);
        own.trials = TRIALS;
        let surface = Surface::Sphere { center: center.to_vec(), radius };
        let back = own.correct(system, back, &surface).map_or_else(|_| back.to_vec(), |c| c.z);
        let (guesses, spent) = Circle::new(system, corrector.tolerance, center, radius, &plane)
            .roots(plane.angle(&outward(center, &back)));
        let mut onward: Vec<Correction> = Vec::new();
        for guess in guesses {
            let Ok(arm) = own.correct(system, &guess, &surface) else { continue };
            let known = onward.iter().map(|o| &o.z).chain([&back]);
            if distance(&arm.z, &guess) < 0.3 * radius
                && known.into_iter().all(|z| distance(z, &arm.z) > (DISTINCT.0 * radius).max(DISTINCT.1))
            {
                onward.push(arm);
            }
        }
        corrector.evaluations += own.evaluations + spent;
        Some(Self { back: outward(center, &back), onward })
    }

    /// Index of the arm that continues the branch.
    ///
    /// The arms are joined in pairs to curves so that these turn least in all. At a crossing with a smooth curve that leaves the
    /// branch its own continuation, be it bent by more than the turn-off: the curve that goes straight on belongs to the others.
    pub fn partner(&self, center: &[f64]) -> Option<usize> {
        let mut directions = vec![self.back.clone()];
        directions.extend(self.onward.iter().map(|arm| outward(center, &arm.z)));
        best_partner(&directions).map(|k| k - 1)
    }
}

/// Unit vector from the center to a point.
pub(crate) fn outward(center: &[f64], point: &[f64]) -> Vec<f64> {
    let length = distance(point, center);
    along(&vec![0.0; center.len()], 1.0 / length, &along(point, -1.0, center))
}

/// The partner of arm 0 where the arms are joined in pairs with the least sum of turns; an odd one among the others stays alone.
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
