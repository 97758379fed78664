//! What rounding leaves unknown: of a residual, and by that of a point.

use super::progress::{IDLE, Progress};
use super::surface::Surface;
use super::{Corrector, FIRM, MOST_BLURRED};
use crate::ParametricSystem;
use crate::signs::Signs;
use crate::vectors::{along, dot};

/// Neighbours of a point at which the rounding of the residual is measured, and the least size of an unknown there.
const NEIGHBOURS: usize = 3;

const NEAR_ZERO: f64 = 1e-3;

/// Rounding that is reckoned with, over that of a few neighbours.
const DOUBTFUL: f64 = 4.0;

/// Vectors of signs by which the norm of an inverse is estimated.
const PROBES: usize = 8;

/// Largest rounding of a residual, over the size of its equation, that is put up with.
const MOST_ROUNDED: f64 = 1e-6;

impl Corrector {
    /// Whether Newton's method does not come further because the residual is rounded by more than was known; takes note
    /// of how much.
    pub(super) fn rests_on_rounding<S: ParametricSystem>(
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

    /// Takes the rounding of the residual near a point from the residual itself, where it is less than was assumed.
    pub(crate) fn measure_rounding<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64]) {
        let Some(measured) = self.measured_rounding(system, z) else { return };
        self.rounding.iter_mut().zip(measured).for_each(|(known, measured)| *known = known.min(DOUBTFUL * measured));
    }

    /// How far each entry of the residual is from smooth over distances at which nothing but rounding changes it: the
    /// median of a few. The point is the one evaluated last again.
    fn measured_rounding<S: ParametricSystem>(&mut self, system: &mut S, z: &[f64]) -> Option<Vec<f64>> {
        self.evaluate(system, z).ok()?;
        let at = self.linearization.clone();
        let mut signs = Signs::default();
        let mut found = vec![Vec::new(); at.residual.len()];
        for k in 1..=NEIGHBOURS {
            let near = |v: &f64| v + signs.draw() * k as f64 * 4.0 * f64::EPSILON * v.abs().max(NEAR_ZERO);
            let near: Vec<f64> = z.iter().map(near).collect();
            self.evaluate(system, &near).ok()?;
            let linear = at.times(&along(&near, -1.0, z));
            for (i, found) in found.iter_mut().enumerate() {
                found.push((self.linearization.residual[i] - (at.residual[i] + linear[i])).abs());
            }
        }
        self.evaluate(system, z).ok()?;
        let median = |mut of: Vec<f64>| {
            of.sort_by(f64::total_cmp);
            of.get(NEIGHBOURS / 2).copied().filter(|rounding| *rounding <= MOST_ROUNDED)
        };
        found.into_iter().map(median).collect()
    }

    pub(super) fn largest_rounding(&self) -> f64 {
        self.rounding.iter().fold(0.0, |m: f64, r| m.max(*r))
    }

    /// Whether no entry of the residual is larger than this, or than this multiple of its rounding.
    pub(super) fn is_within(&self, tolerance: f64, factor: f64) -> bool {
        let entries = self.linearization.residual.iter().zip(&self.rounding);
        entries.into_iter().all(|(r, rounding)| r.abs() <= tolerance.max(factor * rounding))
    }

    /// Whether no entry of the residual is larger than this multiple of its rounding, by that of the digits of the
    /// unknowns too.
    pub(super) fn is_rounding(&self, factor: f64) -> bool {
        let rounding = self.rounding.iter().zip(&self.digits).map(|(rounding, digits)| rounding.max(*digits));
        self.linearization.residual.iter().zip(rounding).all(|(r, rounding)| r.abs() <= factor * rounding)
    }

    /// What the last digits of the unknowns change in each entry of the residual: no point has a smaller one but by
    /// chance.
    pub(super) fn look_at_digits(&mut self, z: &[f64]) {
        let digits = &mut self.digits;
        digits.fill(0.0);
        self.linearization.each(|i, j, value| digits[i] += (value * z[j]).abs());
        digits.iter_mut().for_each(|digits| *digits *= f64::EPSILON);
    }

    /// How far the rounding of the residual may move the solution, by the bordered matrix that was factored last:
    /// `ε ‖B⁻¹‖`, which is `ε/σ` where a direction with the singular value σ is nearly free.
    pub(super) fn blurred_by(&self) -> f64 {
        // The mean of ‖B⁻¹ s‖² over vectors of signs is the square of the norm of Frobenius.
        let mut signs = Signs::default();
        let squares: f64 = (0..PROBES)
            .map(|_| {
                let rounding = self.rounding.iter().zip(&self.digits).map(|(rounding, digits)| rounding.max(*digits));
                let mut moved: Vec<f64> = rounding.map(|r| r * signs.draw()).chain([0.0]).collect();
                self.solver.solve_in_place(&mut moved);
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
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::Linearization;

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
