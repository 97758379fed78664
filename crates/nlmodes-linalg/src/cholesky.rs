mod blocks;
mod columns;
mod halves;
mod inverse_form;
mod numeric;
mod panels;
mod subtrees;
mod thin;

use std::sync::Arc;

use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::{MatMut, Side};

use crate::ordering::nested_dissection;
use crate::{LinalgError, Mat, SparseMatrix};
use blocks::Blocks;
use columns::Columns;

/// A pivot below this fraction of its diagonal entry is a rounding error: the matrix is singular to working precision.
const SMALLEST_PIVOT: f64 = 16.0 * f64::EPSILON;

/// The elimination order of a sparse symmetric matrix and the cost of its factorisation, from the pattern alone.
///
/// ```
/// use nlmodes_linalg::{CholeskyPlan, sparse_from_triplets};
/// let a = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)])?;
/// let plan = CholeskyPlan::new(&a, "stiffness matrix")?;
/// assert_eq!(plan.bytes(), 24); // three entries of L
/// let factor = plan.factor(&a, "stiffness matrix")?;
/// assert_eq!(factor.dim(), 2);
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct CholeskyPlan {
    kind: Kind,
}

/// Factors computed column by column, for few entries per column, and those with dense blocks.
#[derive(Debug, Clone)]
enum Kind {
    Columns(Arc<Columns>),
    Blocks(Arc<Blocks>),
}

impl Kind {
    fn factor(&self, a: &SparseMatrix, what: &'static str) -> Result<Factor, LinalgError> {
        Ok(match self {
            Self::Columns(columns) => Factor::Columns(Arc::clone(columns), columns.factor(a, what)?),
            Self::Blocks(blocks) => Factor::Blocks(Arc::clone(blocks), blocks.factor(a, what)?),
        })
    }
}

impl CholeskyPlan {
    /// Orders and analyses `a`: from 5000 rows with 16 entries each on, typical of two- and three-dimensional
    /// structures, by nested dissection of the graph of its nodes, otherwise by approximate minimum degree.
    ///
    /// # Errors
    /// [`LinalgError::Dimension`] if `a` is not square or has no row; [`LinalgError::NotFinite`];
    /// [`LinalgError::OutOfMemory`].
    pub fn new(a: &SparseMatrix, what: &'static str) -> Result<Self, LinalgError> {
        check_square(a, what)?;
        Self::analyse(a, nested_dissection(a), what)
    }

    /// Orders and analyses `a` by approximate minimum degree in all cases.
    ///
    /// # Errors
    /// As [`CholeskyPlan::new`].
    pub fn by_minimum_degree(a: &SparseMatrix, what: &'static str) -> Result<Self, LinalgError> {
        check_square(a, what)?;
        Self::analyse(a, None, what)
    }

    /// With the given order, otherwise by minimum degree.
    fn analyse(a: &SparseMatrix, order: Option<Vec<usize>>, what: &'static str) -> Result<Self, LinalgError> {
        let analysed = |ordering| factorize_symbolic_cholesky(a.symbolic(), Side::Lower, ordering, Default::default());
        let symbolic = match order {
            None => analysed(SymmetricOrdering::Amd),
            Some(order) => {
                let mut place = vec![0; order.len()];
                order.iter().enumerate().for_each(|(k, &j)| place[j] = k);
                analysed(SymmetricOrdering::Custom(PermRef::new_checked(&order, &place, order.len())))
            }
        };
        let symbolic = symbolic.map_err(|_| LinalgError::OutOfMemory { what })?;
        let columns = Columns(symbolic);
        let kind = match columns.0.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => Kind::Columns(Arc::new(columns)),
            SymbolicCholeskyRaw::Supernodal(nodes) => {
                Kind::Blocks(Arc::new(Blocks::new(nodes, (0..a.ncols()).map(|k| columns.column(k)).collect())))
            }
        };
        Ok(Self { kind })
    }

    /// Memory that the factor will take, bytes.
    pub fn bytes(&self) -> usize {
        let numbers = match &self.kind {
            Kind::Columns(columns) => columns.counts().sum(),
            Kind::Blocks(blocks) => blocks.panels.numbers(),
        };
        numbers.saturating_mul(size_of::<f64>())
    }

    /// Multiplications and additions of the numeric factorisation: two for each `l_ik l_jk`.
    pub fn flops(&self) -> f64 {
        // A column with r entries below its diagonal updates r (r + 1)/2 entries.
        let update = |entries: usize| (entries as f64 - 1.0).max(0.0) * entries as f64;
        match &self.kind {
            Kind::Columns(columns) => columns.counts().map(update).sum(),
            Kind::Blocks(blocks) => blocks.panels.rows_of_columns().map(update).sum(),
        }
    }

    /// Factors `a`, which must have the planned pattern.
    ///
    /// # Errors
    /// As [`SparseCholesky::factor`].
    ///
    /// # Panics
    /// If the pattern differs.
    pub fn factor(&self, a: &SparseMatrix, what: &'static str) -> Result<SparseCholesky, LinalgError> {
        check_square(a, what)?;
        let factor = SparseCholesky { factor: self.kind.factor(a, what)? };
        factor.check_pivots(a, what)?;
        Ok(factor)
    }
}

/// Cholesky factorisation `P A Pᵀ = L Lᵀ` of a sparse symmetric positive definite matrix.
///
/// `P` is the order of a [`CholeskyPlan`]. Structures in one dimension fill in by a few entries per row, so
/// factorisation and solution cost O(n).
///
/// ```
/// use nlmodes_linalg::{SparseCholesky, sparse_from_triplets};
/// let a = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)])?;
/// let factor = SparseCholesky::factor(&a, "stiffness matrix")?;
/// let mut x = [0.0, 1.0];
/// factor.solve_in_place(&mut x);
/// assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14);
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SparseCholesky {
    factor: Factor,
}

/// A factor of either kind.
#[derive(Debug, Clone)]
enum Factor {
    Columns(Arc<Columns>, Vec<f64>),
    Blocks(Arc<Blocks>, Vec<Mat<f64>>),
}

impl SparseCholesky {
    /// Factors `a`, reading its lower triangle; `what` names it in errors.
    ///
    /// # Errors
    /// [`LinalgError::NotPositiveDefinite`] with the column whose pivot is negative, or so small (16 machine epsilons
    /// of its diagonal entry) that the matrix is singular to working precision; [`LinalgError::Dimension`] if `a` is
    /// not square or has no row; [`LinalgError::NotFinite`]; [`LinalgError::OutOfMemory`].
    pub fn factor(a: &SparseMatrix, what: &'static str) -> Result<Self, LinalgError> {
        CholeskyPlan::new(a, what)?.factor(a, what)
    }

    /// Factors another matrix with the same pattern, keeping the ordering. After an error the factor is not usable.
    ///
    /// # Errors
    /// As [`SparseCholesky::factor`].
    ///
    /// # Panics
    /// If the pattern differs.
    pub fn refactor(&mut self, a: &SparseMatrix, what: &'static str) -> Result<(), LinalgError> {
        let plan = match &self.factor {
            Factor::Columns(columns, _) => CholeskyPlan { kind: Kind::Columns(Arc::clone(columns)) },
            Factor::Blocks(blocks, _) => CholeskyPlan { kind: Kind::Blocks(Arc::clone(blocks)) },
        };
        *self = plan.factor(a, what)?;
        Ok(())
    }

    /// Overwrites `x` with `A⁻¹ x`.
    ///
    /// # Panics
    /// If `x` has not [`SparseCholesky::dim`] entries.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.dim(), "right-hand side of a {n} x {n} system", n = self.dim());
        self.solve(MatMut::from_column_major_slice_mut(x, self.dim(), 1));
    }

    /// Overwrites every column of `x` (n × any) with `A⁻¹ x`.
    ///
    /// # Panics
    /// If `x` has not [`SparseCholesky::dim`] rows.
    pub fn solve_many(&self, x: &mut Mat<f64>) {
        assert_eq!(x.nrows(), self.dim(), "right-hand side of a {n} x {n} system", n = self.dim());
        self.solve(x.as_mut());
    }

    /// Whether the factor has dense blocks: then several right-hand sides together cost far less than one by one.
    pub(crate) fn has_dense_blocks(&self) -> bool {
        matches!(self.factor, Factor::Blocks(..))
    }

    /// Number of rows.
    pub fn dim(&self) -> usize {
        match &self.factor {
            Factor::Columns(columns, _) => columns.dim(),
            Factor::Blocks(blocks, _) => blocks.order.len(),
        }
    }

    /// Overwrites `x` with `L⁻¹ x`; its rows are in the order of elimination.
    pub(crate) fn forward(&self, x: MatMut<'_, f64>) {
        match &self.factor {
            Factor::Columns(columns, values) => columns.forward(values, x),
            Factor::Blocks(blocks, values) => blocks.halves(values).forward(x),
        }
    }

    /// Overwrites `x` with `L⁻ᵀ x`; its rows are in the order of elimination.
    pub(crate) fn backward(&self, x: MatMut<'_, f64>) {
        match &self.factor {
            Factor::Columns(columns, values) => columns.backward(values, x),
            Factor::Blocks(blocks, values) => blocks.halves(values).backward(x),
        }
    }

    /// The column of `A` that is eliminated at each step.
    pub(crate) fn order(&self) -> Vec<usize> {
        match &self.factor {
            Factor::Columns(columns, _) => (0..columns.dim()).map(|k| columns.column(k)).collect(),
            Factor::Blocks(blocks, _) => blocks.order.clone(),
        }
    }

    fn solve(&self, x: MatMut<'_, f64>) {
        match &self.factor {
            Factor::Columns(columns, values) => columns.solve(values, x),
            Factor::Blocks(blocks, values) => blocks.solve(values, x),
        }
    }

    /// `L_kk` in the order of elimination.
    fn diagonal(&self) -> Vec<f64> {
        match &self.factor {
            Factor::Columns(columns, values) => columns.diagonal(values),
            Factor::Blocks(blocks, values) => blocks.diagonal(values),
        }
    }

    /// Compares each pivot `L_kk²` with the diagonal entry that it started from.
    fn check_pivots(&self, a: &SparseMatrix, what: &'static str) -> Result<(), LinalgError> {
        for (l, column) in self.diagonal().into_iter().zip(self.order()) {
            let start = a.get(column, column).copied().unwrap_or(0.0);
            if l * l <= SMALLEST_PIVOT * start {
                return Err(LinalgError::NotPositiveDefinite { what, column });
            }
        }
        Ok(())
    }
}

fn check_square(a: &SparseMatrix, what: &'static str) -> Result<(), LinalgError> {
    let (rows, columns) = a.shape();
    if rows == 0 {
        return Err(LinalgError::Dimension { what, expected: 1, found: 0 });
    }
    if rows != columns {
        return Err(LinalgError::Dimension { what, expected: rows, found: columns });
    }
    if a.val().iter().any(|v| !v.is_finite()) {
        return Err(LinalgError::NotFinite { what });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
