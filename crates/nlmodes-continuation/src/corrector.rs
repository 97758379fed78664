use nlmodes_linalg::{DenseLu, Mat};

use crate::pencil::Bordered;
use crate::record::{is_direction, is_vector};
use crate::{CorrectionFailure, Linearization, NewtonFailure, ParametricSystem};

/// Newton step below which a point counts as settled.
const RESOLUTION: f64 = 1e-9;

/// Rounding of a residual of numbers near one.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Residual over its rounding to which Newton's method goes on where directions are nearly free, and with which it may come to rest on
/// rounding: the contact that a small step would open lets a larger residual pass for a solution.
const FIRM: (f64, f64) = (8.0, 64.0);

/// Share of the shortest Newton step so far below which one counts as shorter: towards a point where curves cross, each is half the one before.
/// So many that are not shorter have come to rest.
const SHORTER: f64 = 0.7;
const IDLE: usize = 3;

/// Ratio of the pivots above which no direction is nearly free.
const REGULAR: f64 = 1e-3;

/// Newton step up to which a point is accepted at such a residual whatever the Jacobian says: sums over many modes round more than
/// most.
const COARSEST: f64 = 1e-7;

/// Largest distance by which rounding may blur a point that is accepted.
const MOST_BLURRED: f64 = 1e-5;

/// Largest rounding of a residual, over the size of its equation, that is put up with.
const MOST_ROUNDED: f64 = 1e-6;

/// Neighbours of a point at which the rounding of the residual is measured, and the least size of an unknown there.
const NEIGHBOURS: usize = 3;
const NEAR_ZERO: f64 = 1e-3;

/// Vectors of signs by which the norm of an inverse is estimated.
const PROBES: usize = 8;

/// The plane `normal · z = offset` on which a correction looks for its point.
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperplane {
    /// Normal, n + 1.
    pub normal: Vec<f64>,
    /// Offset.
    pub offset: f64,
}

impl Hyperplane {
    /// Through `point`, across `normal`.
    pub fn through(point: &[f64], normal: &[f64]) -> Self {
        Self { normal: normal.to_vec(), offset: dot(point, normal) }
    }

    /// Where coordinate `index` of `dim` has this value.
    pub fn fixing(index: usize, value: f64, dim: usize) -> Self {
        let mut normal = vec![0.0; dim];
        normal[index] = 1.0;
        Self { normal, offset: value }
    }
}

/// Where a correction looks for its point: the equation that makes n equations for n + 1 unknowns square.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Surface {
    Plane(Hyperplane),
    Sphere { center: Vec<f64>, radius: f64 },
}

impl Surface {
    fn is_plane(&self) -> bool {
        matches!(self, Self::Plane(_))
    }

    /// Signed distance of `z` from the surface, for a sphere to first order.
    fn defect(&self, z: &[f64]) -> f64 {
        match self {
            Self::Plane(plane) => dot(&plane.normal, z) - plane.offset,
            Self::Sphere { center, radius } => {
                let d = distance(z, center);
                0.5 * (d * d / radius - radius)
            }
        }
    }

    fn normal(&self, z: &[f64], into: &mut [f64]) {
        match self {
            Self::Plane(plane) => into.copy_from_slice(&plane.normal),
            Self::Sphere { center, radius } => {
                into.iter_mut().zip(z).zip(center).for_each(|((n, z), c)| *n = (z - c) / radius);
            }
        }
    }
}

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
    /// Smallest over largest pivot of the bordered Jacobian: how far the point is from one where arms meet.
    #[cfg_attr(feature = "serde", serde(with = "crate::record::any_number"))]
    pub(crate) regularity: f64,
}

impl Correction {
    /// Whether this can be a point of a system with n unknowns.
    pub(crate) fn is_of(&self, n: usize) -> bool {
        is_vector(&self.z, n + 1) && is_direction(&self.tangent, n + 1) && self.orientation.is_finite()
    }
}

/// How the lengths of Newton's steps fall.
#[derive(Debug)]
struct Progress {
    last: f64,
    least: f64,
    /// Steps in a row that were not clearly shorter than the shortest before.
    idle: usize,
}

impl Default for Progress {
    fn default() -> Self {
        Self { last: f64::INFINITY, least: f64::INFINITY, idle: 0 }
    }
}

impl Progress {
    fn step(&mut self, update: f64) {
        self.idle = if update < SHORTER * self.least { 0 } else { self.idle + 1 };
        self.least = self.least.min(update);
        self.last = update;
    }

    /// Whether this step is hardly shorter than the last.
    fn stagnates(&self, update: f64) -> bool {
        update > 0.5 * self.last
    }

    /// Whether steps do not become shorter any more.
    fn rests(&self, update: f64) -> bool {
        self.idle + usize::from(update >= SHORTER * self.least) >= IDLE
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
    bordered: Mat<f64>,
    lu: DenseLu,
    update: Vec<f64>,
    normal: Vec<f64>,
}

impl Corrector {
    /// For systems of n equations.
    pub fn new(n: usize, tolerance: f64, max_iterations: usize) -> Self {
        Self {
            tolerance,
            max_iterations,
            evaluations: 0,
            resolution: RESOLUTION,
            blur: RESOLUTION,
            rounding: vec![ROUNDING; n],
            digits: vec![0.0; n],
            trials: 4,
            linearization: Linearization::new(n),
            bordered: Mat::zeros(n + 1, n + 1),
            lu: DenseLu::default(),
            update: vec![0.0; n + 1],
            normal: vec![0.0; n + 1],
        }
    }

    pub(crate) fn evaluate<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64]) -> Result<f64, S::Error> {
        self.evaluations += 1;
        let n = z.len() - 1;
        system.linearize(&z[..n], z[n], &mut self.linearization)?;
        Ok(self.linearization.residual_norm())
    }

    /// Residual and Jacobian of the point evaluated last.
    pub(crate) fn linearization(&self) -> &Linearization {
        &self.linearization
    }

    /// Newton's method from `guess` on `surface`; a full step is halved up to three times where it would raise the residual.
    ///
    /// A point counts as found when the residual is within the tolerance and the next step would move it by less than the resolution, or by no less than the ones
    /// before since all that is left of the residual is rounding. Near a crossing a small residual alone says little about where the solution is.
    pub(crate) fn correct<S: ParametricSystem>(
        &mut self,
        system: &mut S,
        guess: &[f64],
        surface: &Surface,
    ) -> Result<Correction, CorrectionFailure> {
        let mut z = guess.to_vec();
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
                if self.rests_on_rounding(system, &z, surface, norm, update) {
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

    /// Whether Newton's method does not come further because the residual is rounded by more than was known; takes note of how much.
    fn rests_on_rounding<S: ParametricSystem>(
        &mut self,
        system: &mut S,
        z: &[f64],
        surface: &Surface,
        norm: f64,
        update: f64,
    ) -> bool {
        if norm > MOST_ROUNDED || update > MOST_BLURRED {
            return false;
        }
        let Some(measured) = self.measured_rounding(system, z) else { return false };
        self.rounding.iter_mut().zip(measured).for_each(|(known, measured)| *known = known.max(measured));
        let rests = Progress { last: 0.0, least: 0.0, idle: IDLE };
        surface.defect(z).abs() <= self.tolerance
            && self.is_within(self.tolerance, FIRM.1)
            && self.is_found(surface.is_plane().then_some(z), update, &rests, true)
    }

    /// How far each entry of the residual is from smooth over distances at which nothing but rounding changes it: the median of a few. The
    /// point is the one evaluated last again.
    fn measured_rounding<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64]) -> Option<Vec<f64>> {
        self.evaluate(system, z).ok()?;
        let at = self.linearization.clone();
        let mut signs = Signs::default();
        let mut found = vec![Vec::new(); at.residual.len()];
        for k in 1..=NEIGHBOURS {
            let near = |v: &f64| v + signs.draw() * k as f64 * 4.0 * f64::EPSILON * v.abs().max(NEAR_ZERO);
            let near: Vec<f64> = z.iter().map(near).collect();
            self.evaluate(system, &near).ok()?;
            for (i, found) in found.iter_mut().enumerate() {
                let moved = near.iter().zip(z).enumerate();
                let expected = at.residual[i] + moved.map(|(j, (a, b))| at.jacobian[(i, j)] * (a - b)).sum::<f64>();
                found.push((self.linearization.residual[i] - expected).abs());
            }
        }
        self.evaluate(system, z).ok()?;
        let median = |mut of: Vec<f64>| {
            of.sort_by(f64::total_cmp);
            of.get(NEIGHBOURS / 2).copied().filter(|rounding| *rounding <= MOST_ROUNDED)
        };
        found.into_iter().map(median).collect()
    }

    fn failure(&self, residual: f64, iterations: usize, reason: NewtonFailure) -> CorrectionFailure {
        CorrectionFailure { reason, residual, tolerance: self.tolerance, rounding: self.largest_rounding(), iterations }
    }

    fn largest_rounding(&self) -> f64 {
        self.rounding.iter().fold(0.0, |m: f64, r| m.max(*r))
    }

    /// Whether no entry of the residual is larger than this, or than this multiple of its rounding.
    fn is_within(&self, tolerance: f64, factor: f64) -> bool {
        let entries = self.linearization.residual.iter().zip(&self.rounding);
        entries.into_iter().all(|(r, rounding)| r.abs() <= tolerance.max(factor * rounding))
    }

    /// The bordered Jacobian of the point that was found last; `None` before there is one.
    pub(crate) fn border(&self) -> Option<Bordered> {
        let (jacobian, row, lu) = (self.linearization.jacobian.clone(), self.normal.clone(), self.lu.clone());
        (lu.dim() > 0).then_some(Bordered { jacobian, row, lu })
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
        (self.lu.dim() > 0).then(|| self.normal.clone())
    }

    /// The Jacobian of the point evaluated last with this row below it.
    pub(crate) fn bordered_by(&mut self, row: &[f64]) -> &Mat<f64> {
        self.normal.copy_from_slice(row);
        self.fill_bordered();
        &self.bordered
    }

    fn fill_bordered(&mut self) {
        let n = self.normal.len() - 1;
        for (j, border) in self.normal.iter().enumerate() {
            let from = self.linearization.jacobian.col(j);
            let mut to = self.bordered.col_mut(j);
            (0..n).for_each(|i| to[i] = from[i]);
            to[n] = *border;
        }
    }

    fn factor_bordered(&mut self) -> Result<(), NewtonFailure> {
        self.fill_bordered();
        self.lu.refactor(&self.bordered).map_err(|_| NewtonFailure::Singular)
    }

    fn newton_update(&mut self, surface_defect: f64) {
        let n = self.linearization.residual.len();
        self.update[..n].iter_mut().zip(&self.linearization.residual).for_each(|(u, r)| *u = -r);
        self.update[n] = surface_defect;
        self.lu.solve_in_place(&mut self.update);
    }

    /// Whether a point with this residual, within the tolerance, and this next Newton step is a solution as well as one can be known; `z` where
    /// the digits of the unknowns count. On a small sphere around a crossing they would let every point pass.
    fn is_found(&mut self, z: Option<&[f64]>, update: f64, progress: &Progress, last: bool) -> bool {
        if update <= self.resolution {
            return progress.stagnates(update) || self.is_rounding(FIRM.0) || self.lu.pivot_ratio() >= REGULAR;
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

    /// Whether no entry of the residual is larger than this multiple of its rounding, by that of the digits of the unknowns too.
    fn is_rounding(&self, factor: f64) -> bool {
        let rounding = self.rounding.iter().zip(&self.digits).map(|(rounding, digits)| rounding.max(*digits));
        self.linearization.residual.iter().zip(rounding).all(|(r, rounding)| r.abs() <= factor * rounding)
    }

    /// What the last digits of the unknowns change in each entry of the residual: no point has a smaller one but by chance.
    fn look_at_digits(&mut self, z: &[f64]) {
        let jacobian = &self.linearization.jacobian;
        for (i, digits) in self.digits.iter_mut().enumerate() {
            *digits = f64::EPSILON * z.iter().enumerate().map(|(j, z)| (jacobian[(i, j)] * z).abs()).sum::<f64>();
        }
    }

    /// How far the rounding of the residual may move the solution, by the bordered matrix that was factored last: `ε ‖B⁻¹‖`, which is
    /// `ε/σ` where a direction with the singular value σ is nearly free.
    fn blurred_by(&self) -> f64 {
        // The mean of ‖B⁻¹ s‖² over vectors of signs is the square of the norm of Frobenius.
        let mut signs = Signs::default();
        let squares: f64 = (0..PROBES)
            .map(|_| {
                let rounding = self.rounding.iter().zip(&self.digits).map(|(rounding, digits)| rounding.max(*digits));
                let mut moved: Vec<f64> = rounding.map(|r| r * signs.draw()).chain([0.0]).collect();
                self.lu.solve_in_place(&mut moved);
                dot(&moved, &moved)
            })
            .sum();
        (squares / PROBES as f64).sqrt()
    }

    /// Takes note of how well points near this one, with this tangent, are known in spite of rounding.
    pub(crate) fn look_at_rounding<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64], tangent: &[f64]) {
        self.blur = self.resolution;
        if self.evaluate(system, z).is_ok() {
            self.look_at_digits(z);
            self.normal.copy_from_slice(tangent);
            let blur = self.factor_bordered().map_or(MOST_BLURRED, |()| self.blurred_by());
            self.blur = blur.clamp(self.resolution, MOST_BLURRED);
        }
    }

    /// Whether rounding blurs points by more than the resolution where the branch is now.
    pub(crate) fn is_blurred(&self) -> bool {
        self.blur > self.resolution
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
        self.lu.solve_in_place(&mut tangent);
        let length = dot(&tangent, &tangent).sqrt();
        tangent.iter_mut().for_each(|t| *t /= length);
        let orientation = self.lu.determinant_sign();
        let (pattern, regularity) = (system.pattern(), self.lu.pivot_ratio());
        Correction { z, tangent, orientation, residual, iterations, pattern, regularity }
    }
}

/// Signs from a linear congruential generator, the same each time.
pub(crate) struct Signs(u64);

impl Default for Signs {
    fn default() -> Self {
        Self(1)
    }
}

impl Signs {
    pub fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if self.0 >> 63 == 0 { 1.0 } else { -1.0 }
    }

    /// A number between −1 and 1, to which no symmetry is known.
    pub fn draw_between(&mut self) -> f64 {
        let sign = self.draw();
        sign * ((self.0 << 1) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// `a + s b`.
pub(crate) fn along(a: &[f64], s: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + s * b).collect()
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// `σ (x − p) = 0`.
    struct Diagonal(f64);

    impl ParametricSystem for Diagonal {
        type Error = Infallible;

        fn dim(&self) -> usize {
            1
        }

        fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
            out.residual[0] = self.0 * (x[0] - p);
            (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (self.0, -self.0);
            Ok(())
        }
    }

    #[test]
    fn rounding_blurs_points_by_as_much_as_the_equations_let_it_in_any_unit() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        for unit in [1.0, 1e6, 1e-6] {
            for (sigma, is_blurred) in [(1e-6, true), (1.0, false)] {
                let mut corrector = Corrector::new(1, 1e-11, 8);
                corrector.rounding = vec![1e-12 * unit];
                corrector.look_at_rounding(&mut Diagonal(sigma * unit), &[1.0, 1.0], &[half, half]);
                assert_eq!(corrector.is_blurred(), is_blurred, "{sigma}");
                // Across the diagonal a residual of ε leaves a distance of ε/(σ √2) unknown.
                let expected = if is_blurred { half * 1e-6 } else { corrector.resolution };
                assert!((corrector.blur / expected - 1.0).abs() < 1e-9, "{} for {expected}", corrector.blur);
            }
        }
    }
}
