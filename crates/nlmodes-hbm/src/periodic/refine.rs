use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_linalg::{DenseLu, Mat};

use super::motion::PeriodicMotion;
use super::system::PeriodicSystem;
use crate::double::Double;
use crate::{HbmError, Symmetry};

/// A solution with more digits than its unknowns have.
///
/// A rigid stop turns the last digit of the gaps into forces that are far above the last digit of the others: what such
/// forces do to the balance of power is seen. So unknowns keep what lies below their last digit, and contact forces
/// follow from both.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Refined {
    /// The unknowns.
    pub x: Vec<f64>,
    /// The parameter.
    pub p: f64,
    /// Largest scaled residual.
    pub residual: f64,
    /// What lies below the last digit of each unknown; empty where nothing is kept.
    rest: Vec<f64>,
}

/// Most evaluations, and the shortest share of a step of Newton's method that is tried.
const STEPS: usize = 20;
const SHORTEST: f64 = 0.05;

impl PeriodicSystem {
    /// The solution near `(x, p)` to rounding, by steps of Newton's method across `border` (n + 1): along it the
    /// unknowns and the parameter stay. The best of the iterates, with its residual, where these do not converge.
    pub fn refine(&mut self, x: &[f64], p: f64, border: &[f64]) -> Refined {
        let n = self.dim();
        let mut best = Refined { x: x.to_vec(), p, residual: f64::INFINITY, rest: Vec::new() };
        let mut at = Linearization::new(n);
        let mut z: Vec<Double> = x.iter().chain([&p]).map(|v| Double::of(*v)).collect();
        let (mut from, mut step, mut share) = (z.clone(), vec![0.0; n + 1], 1.0);
        for _ in 0..STEPS {
            let high: Vec<f64> = z.iter().map(|z| z.high).collect();
            if self.keeps_rest() {
                self.rest = z[..n].iter().map(|z| z.low).collect();
            }
            let is_evaluated = self.linearize(&high[..n], high[n], &mut at).is_ok();
            let rest = std::mem::take(&mut self.rest);
            if is_evaluated && at.residual_norm() < best.residual {
                best = Refined { x: high[..n].to_vec(), p: high[n], residual: at.residual_norm(), rest };
                let square = Mat::from_fn(n + 1, n + 1, |i, j| if i < n { at.jacobian[(i, j)] } else { border[j] });
                let Ok(lu) = DenseLu::factor(&square) else { break };
                step = at.residual.iter().copied().chain([0.0]).collect();
                lu.solve_in_place(&mut step);
                (from, share) = (z, 1.0);
            } else if share > SHORTEST {
                // Where an interval of contact begins or vanishes, the full step may lead too far.
                share *= 0.25;
            } else {
                break;
            }
            z = from.iter().zip(&step).map(|(z, step)| *z - Double::of(share * step)).collect();
        }
        self.rest.clear();
        best
    }

    /// The motion of a refined solution.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn refined_motion(&mut self, at: &Refined) -> Result<PeriodicMotion, HbmError> {
        self.rest.clone_from(&at.rest);
        let motion = self.motion(&at.x, at.p);
        self.rest.clear();
        motion
    }

    /// Keeps what lies below the last digits of a refined solution, until
    /// [`keep_nothing_below`](Self::keep_nothing_below).
    pub(super) fn keep_below(&mut self, at: &Refined) {
        self.rest.clone_from(&at.rest);
    }

    pub(super) fn keep_nothing_below(&mut self) {
        self.rest.clear();
    }

    /// Whether what lies below the last digits has a meaning: motions that are even in time do no work, and samples are
    /// no better than their number.
    fn keeps_rest(&self) -> bool {
        self.series().symmetry == Symmetry::None && !self.operator.is_sampled()
    }

    /// The gaps without contact forces of the coefficients `x` with twice the digits; `moved` is what the load
    /// [adds](Self::load_gaps).
    pub(super) fn fine_gaps(&self, x: &[f64], moved: &[f64]) -> Vec<Double> {
        let (unit, width) = (Double::of(self.unit()), self.series().width());
        let (c, d) = (self.structure.n_contacts(), self.response.n_coordinates());
        let coefficient = |k: usize| Double { high: x[k], low: self.rest[k] } * unit;
        let coefficients: Vec<Double> = (0..d * width).map(coefficient).collect();
        let mut gaps = vec![Double::ZERO; c * width];
        gaps.iter_mut().zip(moved).for_each(|(gap, moved)| *gap = Double::of(*moved));
        for i in 0..c {
            let gap = &mut gaps[i * width..(i + 1) * width];
            gap[0] = gap[0] + Double::of(self.structure.gaps()[i]);
            for j in (0..d).filter(|j| self.gap_map[i * d + j] != 0.0) {
                let factor = Double::of(self.gap_map[i * d + j]);
                gap.iter_mut().zip(&coefficients[j * width..]).for_each(|(y, x)| *y = *y + factor * *x);
            }
        }
        gaps
    }
}
