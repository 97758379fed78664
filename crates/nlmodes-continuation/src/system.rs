use nlmodes_linalg::{Mat, Triplet};

use crate::{Boundary, DenseSolver, LinearSolver, Scaling};

/// Residual and Jacobian of a [`ParametricSystem`] at a point.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Linearization {
    /// `R(x, p)`, n.
    pub residual: Vec<f64>,
    /// `[∂R/∂x, ∂R/∂p]`, n × (n + 1). Without rows and columns where the solver of the system is sparse.
    pub jacobian: Mat<f64>,
    /// The same where the solver is sparse: rows, columns and values of what is not zero, in any order; values at one
    /// place are added. Empty before each evaluation. An entry that may become zero is better written always: so the
    /// order of elimination need not be found anew.
    pub entries: Vec<Triplet>,
    /// What is large for a derivative of each equation, n: one unless the system writes something else. Beside it is
    /// judged whether a direction is nearly free; equations that are small as a whole do not make it so.
    pub sizes: Vec<f64>,
}

impl Linearization {
    /// Room for a system of n equations whose solver is dense.
    pub fn new(n: usize) -> Self {
        Self { jacobian: Mat::zeros(n, n + 1), ..Self::sparse(n) }
    }

    /// Room for a system of n equations whose solver is sparse.
    pub fn sparse(n: usize) -> Self {
        Self { residual: vec![0.0; n], jacobian: Mat::zeros(0, 0), entries: Vec::new(), sizes: vec![1.0; n] }
    }

    /// Room for a system of n equations with this solver.
    pub fn for_solver(solver: &dyn LinearSolver, n: usize) -> Self {
        if solver.is_sparse() { Self::sparse(n) } else { Self::new(n) }
    }

    /// `J v`.
    pub(crate) fn times(&self, v: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.residual.len()];
        self.each(|i, j, value| product[i] += value * v[j]);
        product
    }

    /// Calls `visit` with row, column and value of each entry, column by column where all are stored.
    pub(crate) fn each(&self, mut visit: impl FnMut(usize, usize, f64)) {
        for j in 0..self.jacobian.ncols() {
            self.jacobian.col(j).iter().enumerate().for_each(|(i, value)| visit(i, j, *value));
        }
        self.entries.iter().for_each(|&(i, j, value)| visit(i, j, value));
    }

    /// Multiplies each entry by a factor that may depend on its row and column.
    pub(crate) fn scale_entries(&mut self, factor: impl Fn(usize, usize) -> f64) {
        for j in 0..self.jacobian.ncols() {
            self.jacobian.col_mut(j).iter_mut().enumerate().for_each(|(i, value)| *value *= factor(i, j));
        }
        self.entries.iter_mut().for_each(|(i, j, value)| *value *= factor(*i, *j));
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

    /// Writes residual and Jacobian at `(x, p)`; every entry of `out` must be written, of [`Linearization::entries`]
    /// those that are not zero.
    ///
    /// # Errors
    /// If the residual does not exist there. The continuation then tries a shorter step.
    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Self::Error>;

    /// The solver of the linear systems, and with it how the Jacobian is stored: dense unless the system chooses
    /// another, such as [`SparseSolver`](crate::SparseSolver).
    fn solver(&self) -> Box<dyn LinearSolver> {
        Box::<DenseSolver>::default()
    }

    /// What is large for each unknown and each equation. Where this is not given, all unknowns have one size, found
    /// from the starting point, and each equation that of its largest derivative there; unknowns of different kinds
    /// need sizes of their own.
    ///
    /// At a start where all unknowns and the parameter are zero the sizes are those by which they move along the curve
    /// while the Jacobian changes by its own size, at the cost of a few evaluations. Where it does not change, nothing
    /// tells more than how the two compare: the larger of both sizes is one then, and both are where one moves by less
    /// than 1e-10 of the other.
    fn scaling(&self) -> Option<Scaling> {
        None
    }

    /// The smooth piece of a piecewise smooth system on which the point evaluated last lies; equal numbers, equal
    /// pieces.
    fn pattern(&self) -> u64 {
        0
    }

    /// The smooth piece on which the point `z = (x, p)` lies, [`pattern`](Self::pattern), where that is known at less
    /// expense than by an evaluation of residual and Jacobian; else None. By it a piece is seen that a step enters and
    /// leaves again.
    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        let _ = z;
        None
    }

    /// The boundary between the pieces of two points `z = (x, p)` that differ in one thing only: a function that is
    /// positive at `from` and negative at `to`, and smooth between them. By it a change of the pattern is located in a
    /// few evaluations; without, by halving a step.
    ///
    /// None where the pieces are the same, differ in more than one thing, or the system does not know.
    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let _ = (from, to);
        None
    }

    /// Notified of every point from which the branch goes on, not of events within a step; for systems with a moving
    /// phase condition or warm starts.
    fn accepted(&mut self, x: &[f64], p: f64) {
        let _ = (x, p);
    }
}
