//! Arms of the solution set that leave a point where no step ahead exists: corners of a piecewise smooth curve, and crossings.

use std::f64::consts::TAU;

use nlmodes_linalg::{Mat, symmetric_eigen};

use crate::corrector::{Correction, Corrector, Hyperplane, Surface, along, distance, dot};
use crate::step::Foot;
use crate::{Linearization, ParametricSystem};

/// Directions tried around a point.
const FAN: usize = 64;

/// Newton iterations permitted for one direction.
const ITERATIONS: usize = 25;

/// All solutions found at the distance `radius` from the foot that are there, in about the same direction, at an eighth of it too.
///
/// All arms of a crossing are tangent to the plane of the two right singular vectors of the Jacobian with the smallest singular
/// values, and at a corner that plane holds what is nearly free to move. So the equations are reduced to one, `μ(θ) = 0`, for the
/// angle θ in that plane (Lyapunov-Schmidt, on a circle): its changes of sign are the arms, be they smooth or not.
pub(crate) fn around<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    foot: &Foot,
    radius: f64,
) -> Vec<Correction> {
    if corrector.evaluate(system, &foot.z).is_err() {
        return Vec::new();
    }
    let Some(plane) = SingularPlane::of(corrector.jacobian()) else { return Vec::new() };
    let near = solutions_at(system, corrector, foot, radius / 8.0, &plane);
    let mut arms = solutions_at(system, corrector, foot, radius, &plane);
    let same_direction = |arm: &Correction, other: &Correction| dot(&outward(foot, arm), &outward(foot, other)) > 0.9;
    arms.retain(|arm| near.iter().any(|other| same_direction(arm, other)));
    arms
}

/// The solutions on the sphere around the foot that the reduced equation shows.
fn solutions_at<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    foot: &Foot,
    radius: f64,
    plane: &SingularPlane,
) -> Vec<Correction> {
    let mut own = Corrector::new(foot.z.len() - 1, corrector.tolerance, ITERATIONS);
    let mut found: Vec<Correction> = Vec::new();
    for guess in reduced_roots(system, corrector.tolerance, foot, radius, plane) {
        let surface = Surface::Sphere { center: foot.z.clone(), radius };
        let Ok(arm) = own.correct(system, &guess, &surface) else { continue };
        if found.iter().all(|other| distance(&other.z, &arm.z) > 0.05 * radius) {
            found.push(arm);
        }
    }
    corrector.evaluations += own.evaluations;
    found
}

/// The two smallest right singular vectors of the Jacobian, and the left one of the second.
struct SingularPlane {
    right: [Vec<f64>; 2],
    left: Vec<f64>,
}

impl SingularPlane {
    fn of(jacobian: &Mat<f64>) -> Option<Self> {
        let column = |m: &Mat<f64>, k: usize| -> Vec<f64> { m.col(k).iter().copied().collect() };
        let (_, right) = symmetric_eigen(&(jacobian.transpose() * jacobian)).ok()?;
        let (_, left) = symmetric_eigen(&(jacobian * jacobian.transpose())).ok()?;
        (right.ncols() >= 2).then(|| Self { right: [column(&right, 0), column(&right, 1)], left: column(&left, 0) })
    }

    fn direction(&self, θ: f64) -> Vec<f64> {
        self.right[0].iter().zip(&self.right[1]).map(|(a, b)| θ.cos() * a + θ.sin() * b).collect()
    }
}

/// `R(z) + μ u = 0` with z at the angle θ and at the distance r in the singular plane; unknowns (z, μ), parameter θ.
struct Reduced<'a, S> {
    system: &'a mut S,
    inner: Linearization,
    center: &'a [f64],
    radius: f64,
    plane: &'a SingularPlane,
}

impl<S: ParametricSystem> ParametricSystem for Reduced<'_, S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.center.len() + 1
    }

    fn linearize(&mut self, x: &[f64], θ: f64, out: &mut Linearization) -> Result<(), S::Error> {
        let n = self.center.len() - 1;
        self.system.linearize(&x[..n], x[n], &mut self.inner)?;
        let moved: Vec<f64> = x.iter().zip(self.center).map(|(z, c)| z - c).collect();
        let [along, across] = [self.plane.direction(θ), self.plane.direction(θ + TAU / 4.0)];
        for i in 0..n {
            out.residual[i] = self.inner.residual[i] + x[n + 1] * self.plane.left[i];
            (0..=n).for_each(|j| out.jacobian[(i, j)] = self.inner.jacobian[(i, j)]);
            out.jacobian[(i, n + 1)] = self.plane.left[i];
            out.jacobian[(i, n + 2)] = 0.0;
        }
        let [on, off] = [dot(&along, &moved), dot(&across, &moved)];
        (out.residual[n], out.residual[n + 1]) = ((on - self.radius) / self.radius, off / self.radius);
        for j in 0..=n {
            (out.jacobian[(n, j)], out.jacobian[(n + 1, j)]) = (along[j] / self.radius, across[j] / self.radius);
        }
        (out.jacobian[(n, n + 1)], out.jacobian[(n + 1, n + 1)]) = (0.0, 0.0);
        (out.jacobian[(n, n + 2)], out.jacobian[(n + 1, n + 2)]) = (off / self.radius, -on / self.radius);
        Ok(())
    }
}

/// Points near the changes of sign of `μ(θ)`.
fn reduced_roots<S: ParametricSystem>(
    system: &mut S,
    tolerance: f64,
    foot: &Foot,
    radius: f64,
    plane: &SingularPlane,
) -> Vec<Vec<f64>> {
    let n = foot.z.len() - 1;
    let mut reduced = Reduced { system, inner: Linearization::new(n), center: &foot.z, radius, plane };
    let mut corrector = Corrector::new(n + 2, tolerance, ITERATIONS);
    let mut solve = |θ: f64, near: Option<&[f64]>| -> Option<(f64, Vec<f64>)> {
        let mut guess = along(&foot.z, radius, &reduced.plane.direction(θ));
        guess.extend([0.0, θ]);
        let fixed = Surface::Plane(Hyperplane::fixing(n + 2, θ, n + 3));
        let straight = corrector.correct(&mut reduced, &guess, &fixed);
        let found = straight.or_else(|failure| {
            let mut other = near.ok_or(failure)?.to_vec();
            other[n + 2] = θ;
            corrector.correct(&mut reduced, &other, &fixed)
        });
        found.ok().map(|c| (θ, c.z))
    };
    let mut circle: Vec<(f64, Vec<f64>)> = Vec::new();
    for k in 0..=FAN {
        let near = circle.last().map(|(_, z)| z.clone());
        circle.extend(solve(TAU * k as f64 / FAN as f64, near.as_deref()));
    }
    let mut roots = Vec::new();
    for pair in circle.windows(2) {
        let (mut low, mut high) = (pair[0].clone(), pair[1].clone());
        if low.1[n + 1] * high.1[n + 1] > 0.0 {
            continue;
        }
        for _ in 0..40 {
            let Some(middle) = solve(0.5 * (low.0 + high.0), Some(&low.1)) else { break };
            if middle.1[n + 1] * low.1[n + 1] > 0.0 { low = middle } else { high = middle }
        }
        let nearer = if low.1[n + 1].abs() < high.1[n + 1].abs() { low } else { high };
        roots.push(nearer.1[..=n].to_vec());
    }
    roots
}

/// Unit vector from the foot to an arm.
fn outward(foot: &Foot, arm: &Correction) -> Vec<f64> {
    let length = distance(&arm.z, &foot.z);
    arm.z.iter().zip(&foot.z).map(|(a, c)| (a - c) / length).collect()
}

/// Turn of the direction of travel, rad, in going on along `arm`.
pub(crate) fn turn(foot: &Foot, arm: &Correction) -> f64 {
    dot(&foot.tangent, &outward(foot, arm)).clamp(-1.0, 1.0).acos()
}

/// The arm that continues the branch, and the number of arms in all.
///
/// The arms are joined in pairs to curves so that these turn least in all. At a crossing with a smooth curve that leaves the
/// branch its own continuation, be it bent by more than the turn-off: the curve that goes straight on belongs to the others.
pub(crate) fn continuation_of(foot: &Foot, mut arms: Vec<Correction>) -> Option<(Correction, usize)> {
    let came_from = (0..arms.len()).max_by(|&i, &j| turn(foot, &arms[i]).total_cmp(&turn(foot, &arms[j])))?;
    let mut directions: Vec<Vec<f64>> = arms.iter().map(|arm| outward(foot, arm)).collect();
    let count = if turn(foot, &arms[came_from]) > 2.0 {
        directions.swap(0, came_from);
        arms.swap(0, came_from);
        arms.len()
    } else {
        // The way back was not found: it is known all the same.
        directions.insert(0, foot.tangent.iter().map(|t| -t).collect());
        arms.insert(0, arms[0].clone());
        directions.len()
    };
    let partner = best_partner(&directions)?;
    Some((arms.swap_remove(partner), count))
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
    std::f64::consts::PI - dot(&directions[i], &directions[j]).clamp(-1.0, 1.0).acos()
}
