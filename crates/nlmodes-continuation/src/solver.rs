//! The linear systems of a continuation: `[J; cᵀ] v = w`, the Jacobian with one row below it.

use nlmodes_linalg::{DenseLu, LinalgError, Mat, SparseLu, Triplet, sparse_from_triplets};

use crate::Linearization;

/// Factors `B = [J; cᵀ]`, n + 1 equations for n + 1 unknowns, and solves with it; which one, a system says with
/// [`ParametricSystem::solver`](crate::ParametricSystem::solver).
///
/// A continuation clones it as it is, with its factors, and factors matrices of other sizes with the clones.
pub trait LinearSolver: std::fmt::Debug {
    /// Whether systems write [`Linearization::entries`], which it reads, rather than [`Linearization::jacobian`].
    fn is_sparse(&self) -> bool;

    /// Factors the Jacobian with this row below it, in place of what it had factored before.
    ///
    /// # Errors
    /// If the matrix is singular or not finite. Nothing is solved before another matrix has been factored then.
    fn factor(&mut self, at: &Linearization, row: &[f64]) -> Result<(), LinalgError>;

    /// Overwrites `v` with `B⁻¹ v`.
    fn solve_in_place(&self, v: &mut [f64]);

    /// Overwrites `v` with `B⁻ᵀ v`.
    fn solve_transposed_in_place(&self, v: &mut [f64]);

    /// Sign of `det B`: +1 or −1. Branch points are seen by it.
    fn determinant_sign(&self) -> f64;

    /// How far `B` is from singular, about linear in the distance: zero to one, such as the smallest over the largest pivot.
    fn pivot_ratio(&self) -> f64;

    /// A clone of it.
    fn cloned(&self) -> Box<dyn LinearSolver>;
}

impl Clone for Box<dyn LinearSolver> {
    fn clone(&self) -> Self {
        (**self).cloned()
    }
}

/// LU factorisation of all entries: for up to some hundred unknowns.
#[derive(Debug, Clone)]
pub struct DenseSolver {
    bordered: Mat<f64>,
    lu: DenseLu,
}

impl Default for DenseSolver {
    fn default() -> Self {
        Self { bordered: Mat::zeros(0, 0), lu: DenseLu::default() }
    }
}

impl LinearSolver for DenseSolver {
    fn is_sparse(&self) -> bool {
        false
    }

    fn factor(&mut self, at: &Linearization, row: &[f64]) -> Result<(), LinalgError> {
        let n = at.residual.len();
        if self.bordered.nrows() != n + 1 {
            self.bordered = Mat::zeros(n + 1, n + 1);
        }
        for (j, border) in row.iter().enumerate() {
            let from = at.jacobian.col(j);
            let mut to = self.bordered.col_mut(j);
            (0..n).for_each(|i| to[i] = from[i]);
            to[n] = *border;
        }
        self.lu.refactor(&self.bordered)
    }

    fn solve_in_place(&self, v: &mut [f64]) {
        self.lu.solve_in_place(v);
    }

    fn solve_transposed_in_place(&self, v: &mut [f64]) {
        self.lu.solve_transposed_in_place(v);
    }

    fn determinant_sign(&self) -> f64 {
        self.lu.determinant_sign()
    }

    fn pivot_ratio(&self) -> f64 {
        self.lu.pivot_ratio()
    }

    fn cloned(&self) -> Box<dyn LinearSolver> {
        Box::new(self.clone())
    }
}

/// LU factorisation of the entries that are not zero: for thousands of unknowns that each know a few others.
#[derive(Debug, Clone, Default)]
pub struct SparseSolver {
    entries: Vec<Triplet>,
    lu: SparseLu,
}

impl LinearSolver for SparseSolver {
    fn is_sparse(&self) -> bool {
        true
    }

    fn factor(&mut self, at: &Linearization, row: &[f64]) -> Result<(), LinalgError> {
        let n = at.residual.len();
        self.entries.clear();
        self.entries.extend_from_slice(&at.entries);
        // Zeros too, so that the pattern stays the same.
        self.entries.extend(row.iter().enumerate().map(|(j, c)| (n, j, *c)));
        self.lu.refactor(&sparse_from_triplets(n + 1, n + 1, &self.entries)?)
    }

    fn solve_in_place(&self, v: &mut [f64]) {
        self.lu.solve_in_place(v);
    }

    fn solve_transposed_in_place(&self, v: &mut [f64]) {
        self.lu.solve_transposed_in_place(v);
    }

    fn determinant_sign(&self) -> f64 {
        self.lu.determinant_sign()
    }

    fn pivot_ratio(&self) -> f64 {
        self.lu.pivot_ratio()
    }

    fn cloned(&self) -> Box<dyn LinearSolver> {
        Box::new(self.clone())
    }
}
