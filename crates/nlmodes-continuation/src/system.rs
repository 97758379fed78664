use nlmodes_linalg::Mat;

use crate::{Boundary, Scaling};

/// Residual and Jacobian of a [`ParametricSystem`] at a point.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Linearization {
    /// `R(x, p)`, n.
    pub residual: Vec<f64>,
    /// `[∂R/∂x, ∂R/∂p]`, n × (n + 1).
    pub jacobian: Mat<f64>,
    /// What is large for a derivative of each equation, n: one unless the system writes something else. Beside it is judged whether a
    /// direction is nearly free; equations that are small as a whole do not make it so.
    pub sizes: Vec<f64>,
}

impl Linearization {
    /// Room for a system of n equations.
    pub fn new(n: usize) -> Self {
        Self { residual: vec![0.0; n], jacobian: Mat::zeros(n, n + 1), sizes: vec![1.0; n] }
    }

    /// Largest entry of the residual in magnitude; infinite if any entry is not finite.
    pub fn residual_norm(&self) -> f64 {
        let largest = self.residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        if self.residual.iter().all(|r| r.is_finite()) { largest } else { f64::INFINITY }
    }
}

/// n equations `R(x, p) = 0` for n unknowns and a parameter.
///
/// The system may keep work space and remember the point that it was evaluated at last.
pub trait ParametricSystem {
    /// What an evaluation can fail with.
    type Error: std::error::Error + 'static;

    /// Number of equations and unknowns n.
    fn dim(&self) -> usize;

    /// Writes residual and Jacobian at `(x, p)`; every entry of `out` must be written.
    ///
    /// # Errors
    /// If the residual does not exist there. The continuation then tries a shorter step.
    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Self::Error>;

    /// What is large for each unknown and each equation. Where this is not given, all unknowns have one size, found from the starting
    /// point, and each equation that of its largest derivative there; unknowns of different kinds need sizes of their own.
    fn scaling(&self) -> Option<Scaling> {
        None
    }

    /// The smooth piece of a piecewise smooth system on which the point evaluated last lies; equal numbers, equal pieces.
    fn pattern(&self) -> u64 {
        0
    }

    /// The boundary between the pieces of two points `z = (x, p)` that differ in one thing only: a function that is positive at `from` and
    /// negative at `to`, and smooth between them. By it a change of the pattern is located in a few evaluations; without, by halving a step.
    ///
    /// None where the pieces are the same, differ in more than one thing, or the system does not know.
    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let _ = (from, to);
        None
    }

    /// Told of every point from which the branch goes on, not of events within a step; for systems with a moving phase condition or warm starts.
    fn accepted(&mut self, x: &[f64], p: f64) {
        let _ = (x, p);
    }
}
