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

    /// How far `B` is from singular, about linear in the distance: zero to one, such as the smallest over the largest
    /// pivot.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// By the first row.
    fn determinant(a: &[Vec<f64>]) -> f64 {
        let Some((first, rest)) = a.split_first() else { return 1.0 };
        let minor = |k: usize| rest.iter().map(|row| [&row[..k], &row[k + 1..]].concat()).collect::<Vec<_>>();
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        first.iter().enumerate().map(|(k, v)| sign(k) * v * determinant(&minor(k))).sum()
    }

    /// Matrices with nothing symmetric about them, some of whose entries are zero.
    #[test]
    fn dense_and_sparse_solvers_solve_with_the_matrix_and_its_transpose() {
        let n = 4;
        let mut senses = Vec::new();
        for number in 0..8 {
            let entry = |i: usize, j: usize| {
                let v =
                    (1.3 * (number + 1) as f64 + 2.7 * i as f64 + 0.9 * (j * j) as f64 + 1.7 * (i * j) as f64).sin();
                if (i + 2 * j + number).is_multiple_of(4) { 0.0 } else { v }
            };
            let b: Vec<Vec<f64>> = (0..=n).map(|i| (0..=n).map(|j| entry(i, j)).collect()).collect();
            let mut dense = Linearization::new(n);
            let mut sparse = Linearization::sparse(n);
            for (i, j) in (0..n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                dense.jacobian[(i, j)] = b[i][j];
                if b[i][j] != 0.0 {
                    // Values at one place are added.
                    sparse.entries.extend([(i, j, 0.75 * b[i][j]), (i, j, 0.25 * b[i][j])]);
                }
            }
            let solvers: [(&Linearization, Box<dyn LinearSolver>); 2] =
                [(&dense, Box::<DenseSolver>::default()), (&sparse, Box::<SparseSolver>::default())];
            for (at, mut solver) in solvers {
                solver.factor(at, &b[n]).unwrap();
                let v: Vec<f64> = (0..=n).map(|i| 1.0 - 0.4 * (i * i) as f64).collect();
                let (mut x, mut y) = (v.clone(), v.clone());
                solver.solve_in_place(&mut x);
                solver.cloned().solve_transposed_in_place(&mut y);
                let determinant = determinant(&b);
                let bound = 1e-13 / determinant.abs().min(1.0);
                assert!(bound < 1e-10, "{number}: {determinant}");
                for i in 0..=n {
                    let (row, column): (f64, f64) =
                        (0..=n).fold((0.0, 0.0), |(row, column), j| (row + b[i][j] * x[j], column + b[j][i] * y[j]));
                    assert!((row - v[i]).abs() < bound && (column - v[i]).abs() < bound, "{number}: {row} {column}");
                }
                assert_eq!(solver.determinant_sign(), determinant.signum(), "{number}");
                senses.push(determinant.signum());
            }
        }
        assert!(senses.contains(&1.0) && senses.contains(&-1.0));
    }
}
