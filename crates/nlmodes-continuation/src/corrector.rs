//! The corrector: Newton's method on a surface across the branch.

mod progress;
mod rounding;
mod surface;

pub use surface::Hyperplane;
pub(crate) use surface::Surface;

use progress::Progress;

use crate::pencil::Bordered;
use crate::record::{is_direction, is_vector};
use crate::singular::SingularDirections;
use crate::vectors::{along, dot};
use crate::{CorrectionFailure, DenseSolver, LinearSolver, Linearization, NewtonFailure, ParametricSystem};

/// Newton step below which a point counts as settled.
const RESOLUTION: f64 = 1e-9;

/// Rounding of a residual of numbers near one.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Residual over its rounding to which Newton's method goes on where directions are nearly free, and with which it may
/// come to rest on rounding: the contact that a small step would open lets a larger residual pass for a solution.
const FIRM: (f64, f64) = (8.0, 64.0);

/// Ratio of the pivots above which no direction is nearly free.
const REGULAR: f64 = 1e-3;

/// Newton step up to which a point is accepted at such a residual whatever the Jacobian says: sums over many modes
/// round more than most.
const COARSEST: f64 = 1e-7;

/// Largest distance by which rounding may blur a point that is accepted.
const MOST_BLURRED: f64 = 1e-5;

/// Iterations after which deflated Newton's method has lost its way: where it comes to a solution it mostly does so in
/// less than ten.
const DEFLATIONS: usize = 12;

/// A converged correction.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Correction {
    /// The point, n + 1.
    pub z: Vec<f64>,
    /// Unit tangent there, n + 1, pointing to the side of the surface to which its normal points.
    pub tangent: Vec<f64>,
    /// Sign of `det [J; tᵀ]`.
    pub orientation: f64,
    /// Largest entry of the residual in magnitude.
    #[cfg_attr(feature = "serde", serde(with = "crate::record::any_number"))]
    pub residual: f64,
    /// Newton steps taken.
    pub iterations: usize,
    /// Smooth piece of the system at the point.
    pub pattern: u64,
    /// Smallest over largest pivot of the bordered Jacobian: how far the point is from one where half-branches meet.
    #[cfg_attr(feature = "serde", serde(with = "crate::record::any_number"))]
    pub(crate) regularity: f64,
}

impl Correction {
    /// Whether this can be a point of a system with n unknowns.
    pub(crate) fn is_of(&self, n: usize) -> bool {
        is_vector(&self.z, n + 1) && is_direction(&self.tangent, n + 1) && self.orientation.is_finite()
    }
}

/// Newton's method on a hyperplane or a sphere, with its work space.
#[derive(Debug)]
pub struct Corrector {
    /// Residual, largest entry, at which a point counts as found if the next Newton step would not move it.
    pub tolerance: f64,
    /// Newton steps permitted.
    pub max_iterations: usize,
    pub(crate) evaluations: usize,
    /// Newton step below which a point counts as settled.
    pub(crate) resolution: f64,
    /// How well points are known in spite of rounding where the branch is now; at least the resolution.
    pub(crate) blur: f64,
    /// Rounding of each entry of the residual, as large as it was found so far.
    pub(crate) rounding: Vec<f64>,
    /// That by the last digits of the unknowns, where it was looked at last.
    digits: Vec<f64>,
    /// Steps tried, each half the one before, until the residual does not rise.
    pub(crate) trials: usize,
    linearization: Linearization,
    solver: Box<dyn LinearSolver>,
    /// Whether a matrix has been factored.
    factored: bool,
    update: Vec<f64>,
    normal: Vec<f64>,
}

impl Corrector {
    /// For systems of n equations whose solver is dense.
    pub fn new(n: usize, tolerance: f64, max_iterations: usize) -> Self {
        Self::with_solver(Box::<DenseSolver>::default(), n, tolerance, max_iterations)
    }

    /// For systems of n equations with this solver.
    pub fn with_solver(solver: Box<dyn LinearSolver>, n: usize, tolerance: f64, max_iterations: usize) -> Self {
        Self {
            tolerance,
            max_iterations,
            evaluations: 0,
            resolution: RESOLUTION,
            blur: RESOLUTION,
            rounding: vec![ROUNDING; n],
            digits: vec![0.0; n],
            trials: 4,
            linearization: Linearization::for_solver(&*solver, n),
            solver,
            factored: false,
            update: vec![0.0; n + 1],
            normal: vec![0.0; n + 1],
        }
    }

    pub(crate) fn evaluate<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64]) -> Result<f64, S::Error> {
        self.evaluations += 1;
        let n = z.len() - 1;
        self.linearization.entries.clear();
        system.linearize(&z[..n], z[n], &mut self.linearization)?;
        Ok(self.linearization.residual_norm())
    }

    /// Residual and Jacobian of the point evaluated last.
    pub(crate) fn linearization(&self) -> &Linearization {
        &self.linearization
    }

    /// Newton's method from `guess` on `surface`; a full step is halved up to three times where it would raise the
    /// residual.
    ///
    /// A point counts as found when the residual is within the tolerance and the next step would move it by less than
    /// the resolution, or by no less than the ones before since all that is left of the residual is rounding. Near a
    /// branch point a small residual alone says little about where the solution is.
    pub(crate) fn correct<S: ParametricSystem>(
        &mut self,
        system: &mut S,
        guess: &[f64],
        surface: &Surface,
    ) -> Result<Correction, CorrectionFailure> {
        let mut z = guess.to_vec();
        self.update.fill(f64::INFINITY);
        let mut norm =
            self.evaluate(system, &z).map_err(|_| self.failure(f64::INFINITY, 0, NewtonFailure::NoResidual))?;
        let mut progress = Progress::default();
        for iteration in 0..=self.max_iterations {
            if !norm.is_finite() {
                return Err(self.failure(norm, iteration, NewtonFailure::NotFinite));
            }
            let defect = surface.defect(&z);
            surface.normal(&z, &mut self.normal);
            self.factor_bordered().map_err(|reason| self.failure(norm, iteration, reason))?;
            self.newton_update(-defect);
            let (update, far) = (dot(&self.update, &self.update).sqrt(), norm.max(defect.abs()));
            let last = iteration == self.max_iterations;
            let small = defect.abs() <= self.tolerance && self.is_within(self.tolerance, FIRM.0);
            if small && self.is_found(surface.is_plane().then_some(&z), update, &progress, last) {
                return Ok(self.finish(system, z, norm, iteration));
            }
            let next = if last { None } else { self.advance(system, &z, far) };
            let Some((trial, trial_norm)) = next else {
                // Where the Jacobian is nearly singular no step lowers a residual that is there already: on a sphere
                // within the tolerance, in a step, beside whose end events are located, to the last digit.
                let is_there = !last && small && (norm <= f64::EPSILON || !surface.is_plane());
                if is_there || self.rests_on_rounding(system, &z, surface, norm, update) {
                    return Ok(self.finish(system, z, norm, iteration));
                }
                let reason = if last { NewtonFailure::TooManyIterations } else { NewtonFailure::NoDescent };
                return Err(self.failure(norm, iteration, reason));
            };
            progress.step(update);
            (z, norm) = (trial, trial_norm);
        }
        Err(self.failure(norm, self.max_iterations, NewtonFailure::TooManyIterations))
    }

    /// A point near a solution on `surface` other than those that are `known`, within `near` of it: Newton's method on
    /// the residual times `M(z) = Π (1 + ρ²/|z − z_k|²)`, ρ the `width` within which it is led away from them. Its step
    /// is that without M, d, times `1/(1 − d · ∇ ln M)`.
    pub(crate) fn deflated<S: ParametricSystem>(
        &mut self,
        system: &mut S,
        mut z: Vec<f64>,
        surface: &Surface,
        known: &[&[f64]],
        width: f64,
        near: f64,
    ) -> Option<Vec<f64>> {
        let radius = surface.radius()?;
        for _ in 0..=DEFLATIONS {
            if !self.evaluate(system, &z).ok()?.is_finite() {
                return None;
            }
            surface.normal(&z, &mut self.normal);
            self.factor_bordered().ok()?;
            self.newton_update(-surface.defect(&z));
            let length = dot(&self.update, &self.update).sqrt();
            let grows = known.iter().map(|known| {
                let apart = along(&z, -1.0, known);
                let square = dot(&apart, &apart);
                -2.0 * width * width * dot(&apart, &self.update) / (square * (square + width * width))
            });
            let factor = 1.0 / (1.0 - grows.sum::<f64>());
            if length <= near && factor > 0.0 {
                return Some(z);
            }
            // No further than across the sphere.
            let factor = factor.clamp(-radius / length, radius / length);
            z = along(&z, factor, &self.update);
        }
        None
    }

    fn failure(&self, residual: f64, iterations: usize, reason: NewtonFailure) -> CorrectionFailure {
        CorrectionFailure {
            reason,
            residual,
            tolerance: self.tolerance,
            rounding: self.largest_rounding(),
            iterations,
            moves: dot(&self.update, &self.update).sqrt(),
        }
    }

    /// The bordered Jacobian of the point that was found last; `None` before there is one.
    pub(crate) fn border(&self) -> Option<Bordered> {
        let (at, row, solver) = (&self.linearization, &self.normal, &self.solver);
        self.factored.then(|| Bordered { at: at.clone(), row: row.clone(), solver: solver.clone() })
    }

    /// The bordered Jacobian at a known point, with this row below it.
    pub(crate) fn border_at<S: ParametricSystem>(
        &mut self,
        system: &mut S,
        z: &[f64],
        row: &[f64],
    ) -> Option<Bordered> {
        self.evaluate(system, z).ok()?;
        self.normal.copy_from_slice(row);
        self.factor_bordered().ok()?;
        self.border()
    }

    /// The row below the Jacobian that was factored last; `None` before there is one.
    pub(crate) fn border_row(&self) -> Option<Vec<f64>> {
        self.factored.then(|| self.normal.clone())
    }

    /// The directions in which the Jacobian leaves the point evaluated last nearly free.
    pub(crate) fn singular_directions(&self) -> Option<SingularDirections> {
        SingularDirections::of(&self.linearization, &*self.solver)
    }

    fn factor_bordered(&mut self) -> Result<(), NewtonFailure> {
        self.factored = true;
        self.solver.factor(&self.linearization, &self.normal).map_err(|_| NewtonFailure::Singular)
    }

    fn newton_update(&mut self, surface_defect: f64) {
        let n = self.linearization.residual.len();
        self.update[..n].iter_mut().zip(&self.linearization.residual).for_each(|(u, r)| *u = -r);
        self.update[n] = surface_defect;
        self.solver.solve_in_place(&mut self.update);
    }

    /// Whether a point with this residual, within the tolerance, and this next Newton step is a solution as well as one
    /// can be known; `z` where the digits of the unknowns count. On a small sphere around a branch point they would let
    /// every point pass.
    fn is_found(&mut self, z: Option<&[f64]>, update: f64, progress: &Progress, last: bool) -> bool {
        if update <= self.resolution {
            return progress.stagnates(update) || self.is_rounding(FIRM.0) || self.solver.pivot_ratio() >= REGULAR;
        }
        let rests = progress.stagnates(update) || last;
        if update > self.blur && !(rests && update <= MOST_BLURRED) {
            return false;
        }
        z.into_iter().for_each(|z| self.look_at_digits(z));
        if !self.is_rounding(FIRM.1) {
            return false;
        }
        update <= self.blur || (z.is_some() && progress.rests(update)) || update <= self.blurred_by().max(COARSEST)
    }

    /// The longest of four halved steps that does not raise the residual much; a semismooth residual may rise a little.
    fn advance<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64], norm: f64) -> Option<(Vec<f64>, f64)> {
        let mut best: Option<(Vec<f64>, f64)> = None;
        let mut factor = 1.0;
        let permitted = self.tolerance.max(FIRM.0 * self.largest_rounding());
        for _ in 0..self.trials {
            let trial: Vec<f64> = z.iter().zip(&self.update).map(|(a, d)| a + factor * d).collect();
            if let Ok(trial_norm) = self.evaluate(system, &trial) {
                if trial_norm <= norm.max(permitted) {
                    return Some((trial, trial_norm));
                }
                if trial_norm.is_finite() && best.as_ref().is_none_or(|(_, b)| trial_norm < *b) {
                    best = Some((trial, trial_norm));
                }
            }
            factor *= 0.5;
        }
        let (trial, _) = best.filter(|(_, b)| *b < 10.0 * norm)?;
        let again = self.evaluate(system, &trial).ok()?;
        Some((trial, again))
    }

    /// Tangent and orientation at the point evaluated last, whose bordered matrix is factored.
    fn finish<S: ParametricSystem>(&mut self, system: &S, z: Vec<f64>, residual: f64, iterations: usize) -> Correction {
        let n = z.len() - 1;
        let mut tangent = vec![0.0; n + 1];
        tangent[n] = 1.0;
        self.solver.solve_in_place(&mut tangent);
        let length = dot(&tangent, &tangent).sqrt();
        tangent.iter_mut().for_each(|t| *t /= length);
        let orientation = self.solver.determinant_sign();
        let (pattern, regularity) = (system.pattern(), self.solver.pivot_ratio());
        Correction { z, tangent, orientation, residual, iterations, pattern, regularity }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// One equation of one unknown, with its derivative; the parameter stays.
    struct One(fn(f64) -> [f64; 2]);

    impl ParametricSystem for One {
        type Error = Infallible;

        fn dim(&self) -> usize {
            1
        }

        fn linearize(&mut self, x: &[f64], _: f64, out: &mut Linearization) -> Result<(), Infallible> {
            let [value, slope] = (self.0)(x[0]);
            out.residual[0] = value;
            (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (slope, 0.0);
            Ok(())
        }
    }

    fn from(of: fn(f64) -> [f64; 2], x: f64, iterations: usize) -> Result<Correction, CorrectionFailure> {
        let plane = Surface::Plane(Hyperplane::fixing(1, 0.0, 2));
        Corrector::new(1, 1e-11, iterations).correct(&mut One(of), &[x, 0.0], &plane)
    }

    #[test]
    fn a_failure_says_why_how_far_it_came_and_how_far_it_would_go() {
        // Towards √2 Newton's method halves a large number, then the digits double.
        let root = |x: f64| [x * x - 2.0, 2.0 * x];
        let found = from(root, 64.0, 20).unwrap();
        assert!((found.z[0] - 2_f64.sqrt()).abs() < 1e-14 && found.iterations < 12);
        let failure = from(root, 64.0, 2).unwrap_err();
        // From 64 to 32.016 and 16.039, with a residual of 255 and the next step to 8.08.
        assert_eq!((failure.reason, failure.iterations), (NewtonFailure::TooManyIterations, 2));
        assert!((failure.residual - 255.251).abs() < 1e-3 && (failure.moves - 7.957).abs() < 1e-3, "{failure:?}");
        // No root, and next to the bottom of the parabola no step that does not lead far up.
        let failure = from(|x| [x * x + 1.0, 2.0 * x], 1e-3, 8).unwrap_err();
        assert_eq!((failure.reason, failure.iterations), (NewtonFailure::NoDescent, 0));
        assert!((failure.moves / 500.0 - 1.0).abs() < 0.01, "{failure:?}");
        // Beside a point that solves the equation to the last digit such steps do not count.
        let found = from(|x| [x * x + 3e-18, 2.0 * x], 1e-17, 8).unwrap();
        assert!((found.z[0] - 1e-17).abs() < 1e-20 && found.residual < 4e-18);
        let failure = from(|_| [1.0, 0.0], 1.0, 8).unwrap_err();
        assert_eq!(failure.reason, NewtonFailure::Singular);
        let failure = from(|x| [f64::NAN * x, 1.0], 1.0, 8).unwrap_err();
        assert_eq!(failure.reason, NewtonFailure::NotFinite);
    }
}
