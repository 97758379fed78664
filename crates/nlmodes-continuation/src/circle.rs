//! What the solution set looks like on a small circle: the reduction of Lyapunov and Schmidt to one equation on a plane.

use std::f64::consts::TAU;

use nlmodes_linalg::{Mat, symmetric_eigen};

use crate::corrector::{Corrector, Hyperplane, Surface, dot};
use crate::{Linearization, ParametricSystem};

/// Newton iterations permitted for one direction.
pub(crate) const ITERATIONS: usize = 40;

/// Steps tried, each half the one before: from where an interval of contact has just closed, Newton's full step may lead far away.
pub(crate) const TRIALS: usize = 12;

/// Angles from the way back, rad, at which the circle is examined: closer where a sharp corner has its other arm.
const NEAR: [f64; 10] = [1e-5, 5e-5, 2e-4, 1e-3, 4e-3, 0.012, 0.025, 0.045, 0.07, 0.1];

/// Newton step, over the radius, below which a point of the circle counts as found.
const SETTLED: f64 = 1e-2;

/// Number of equal parts of the rest of the circle.
const PARTS: usize = 56;

/// The two right singular vectors of a Jacobian with the smallest singular values, and the left one of the second.
pub(crate) struct SingularPlane {
    pub right: [Vec<f64>; 2],
    left: Vec<f64>,
    /// The second smallest singular value over the largest, or over one where that is less.
    pub ratio: f64,
}

impl SingularPlane {
    pub fn of(jacobian: &Mat<f64>) -> Option<Self> {
        let column = |m: &Mat<f64>, k: usize| -> Vec<f64> { m.col(k).iter().copied().collect() };
        let (values, right) = symmetric_eigen(&(jacobian.transpose() * jacobian)).ok()?;
        let (_, left) = symmetric_eigen(&(jacobian * jacobian.transpose())).ok()?;
        let ratio = (values.get(1)?.max(0.0) / values.last()?.max(1.0)).sqrt();
        Some(Self { right: [column(&right, 0), column(&right, 1)], left: column(&left, 0), ratio })
    }

    /// Angle of a direction in the plane.
    pub fn angle(&self, direction: &[f64]) -> f64 {
        dot(&self.right[1], direction).atan2(dot(&self.right[0], direction))
    }
}

/// `R(z) + μ u = 0` with `a·(z − c)` given, n + 1 equations for z with the parameter μ; `b·(z − c)` is left to the surface.
struct Reduced<'a, S> {
    system: &'a mut S,
    inner: Linearization,
    plane: &'a SingularPlane,
    /// `a·z`.
    position: f64,
}

impl<S: ParametricSystem> ParametricSystem for Reduced<'_, S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.inner.residual.len() + 1
    }

    fn linearize(&mut self, x: &[f64], mu: f64, out: &mut Linearization) -> Result<(), S::Error> {
        let n = x.len() - 1;
        self.system.linearize(&x[..n], x[n], &mut self.inner)?;
        for i in 0..n {
            out.residual[i] = self.inner.residual[i] + mu * self.plane.left[i];
            (0..=n).for_each(|j| out.jacobian[(i, j)] = self.inner.jacobian[(i, j)]);
            out.jacobian[(i, n + 1)] = self.plane.left[i];
        }
        out.residual[n] = dot(&self.plane.right[0], x) - self.position;
        (0..=n).for_each(|j| out.jacobian[(n, j)] = self.plane.right[0][j]);
        out.jacobian[(n, n + 1)] = 0.0;
        Ok(())
    }
}

/// A circle in the singular plane, lifted to where all equations but one hold.
pub(crate) struct Circle<'a, S> {
    reduced: Reduced<'a, S>,
    corrector: Corrector,
    center: &'a [f64],
    radius: f64,
    /// The point found last, μ included, and its angle.
    last: Option<(f64, Vec<f64>)>,
}

impl<'a, S: ParametricSystem> Circle<'a, S> {
    pub fn new(system: &'a mut S, tolerance: f64, center: &'a [f64], radius: f64, plane: &'a SingularPlane) -> Self {
        let n = center.len() - 1;
        let reduced = Reduced { system, inner: Linearization::new(n), plane, position: 0.0 };
        let mut corrector = Corrector::new(n + 1, tolerance, ITERATIONS);
        // The sign of μ is wanted, not the point: where a third direction is nearly free too, that would not settle.
        corrector.resolution = SETTLED * radius;
        corrector.trials = TRIALS;
        Self { reduced, corrector, center, radius, last: None }
    }

    /// Points near the changes of sign of `μ(θ)`, beside the one at the angle `from`; and the evaluations spent.
    pub fn roots(mut self, from: f64) -> (Vec<Vec<f64>>, usize) {
        let n = self.center.len() - 1;
        let rest = TAU - 2.0 * NEAR[9];
        let equal = (1..PARTS).map(|k| NEAR[9] + rest * k as f64 / PARTS as f64);
        let offsets = NEAR.iter().copied().chain(equal).chain(NEAR.iter().rev().map(|d| TAU - d));
        let points: Vec<(f64, Vec<f64>)> = offsets.filter_map(|d| self.lift(from + d)).collect();
        let mut roots = Vec::new();
        for pair in points.windows(2) {
            if pair[0].1[n + 1] * pair[1].1[n + 1] <= 0.0 {
                roots.push(self.bisect(pair[0].clone(), pair[1].clone()));
            }
        }
        (roots, self.corrector.evaluations)
    }

    fn lift(&mut self, angle: f64) -> Option<(f64, Vec<f64>)> {
        let n = self.center.len() - 1;
        let [a, b] = &self.reduced.plane.right;
        let (u, v) = (self.radius * angle.cos(), self.radius * angle.sin());
        self.reduced.position = dot(a, self.center) + u;
        let across: Vec<f64> = b.iter().copied().chain([0.0]).collect();
        let surface = Surface::Plane(Hyperplane { normal: across, offset: dot(b, self.center) + v });
        let turned = self.last.as_ref().map(|(old, z)| {
            let (du, dv) = (u - self.radius * old.cos(), v - self.radius * old.sin());
            (0..=n).map(|i| z[i] + du * a[i] + dv * b[i]).chain([z[n + 1]]).collect::<Vec<f64>>()
        });
        let flat = (0..=n).map(|i| self.center[i] + u * a[i] + v * b[i]).chain([0.0]).collect();
        for guess in turned.into_iter().chain([flat]) {
            if let Ok(c) = self.corrector.correct(&mut self.reduced, &guess, &surface) {
                self.last = Some((angle, c.z.clone()));
                return Some((angle, c.z));
            }
        }
        None
    }

    /// The root between two angles, to some 1e-4 of a radian.
    fn bisect(&mut self, mut low: (f64, Vec<f64>), mut high: (f64, Vec<f64>)) -> Vec<f64> {
        let n = self.center.len() - 1;
        for _ in 0..12 {
            self.last = Some(low.clone());
            let Some(middle) = self.lift(0.5 * (low.0 + high.0)) else { break };
            if middle.1[n + 1] * low.1[n + 1] > 0.0 { low = middle } else { high = middle }
        }
        let nearer = if low.1[n + 1].abs() < high.1[n + 1].abs() { low } else { high };
        nearer.1[..=n].to_vec()
    }
}
