//! Factors with few entries a column, as faer computes them.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::simplicial::SymbolicSimplicialCholesky;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymbolicCholeskyRaw};
use faer::sparse::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_lower_triangular_transpose_in_place,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::{LinalgError, SparseMatrix};

/// The symbolic part of a factor by columns.
#[derive(Debug)]
pub(super) struct Columns(pub SymbolicCholesky<usize>);

impl Columns {
    /// The numbers of the factor of `a`; the lower triangle is read.
    pub fn factor(&self, a: &SparseMatrix, what: &'static str) -> Result<Vec<f64>, LinalgError> {
        let (par, params) = (Par::Seq, Spec::default());
        let scratch = self.0.factorize_numeric_llt_scratch::<f64>(par, params);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinalgError::OutOfMemory { what })?;
        let stack = MemStack::new(&mut memory);
        let mut values = vec![0.0; self.0.len_val()];
        self.0
            .factorize_numeric_llt(&mut values, a.as_ref(), Side::Lower, Default::default(), par, stack, params)
            .map_err(|LltError::NonPositivePivot { index }| {
                // faer counts from one, in its own order.
                LinalgError::NotPositiveDefinite { what, column: self.column(index.saturating_sub(1)) }
            })?;
        Ok(values)
    }

    /// Number of rows.
    pub fn dim(&self) -> usize {
        self.0.nrows()
    }

    /// Column of the matrix that is eliminated at step `k`.
    pub fn column(&self, k: usize) -> usize {
        match self.0.perm() {
            Some(perm) => perm.arrays().0.get(k).copied().unwrap_or(k),
            None => k,
        }
    }

    /// Number of entries of each column of the factor.
    pub fn counts(&self) -> impl Iterator<Item = usize> + '_ {
        self.simplicial().into_iter().flat_map(|s| s.col_ptr().windows(2).map(|pair| pair[1] - pair[0]))
    }

    /// Overwrites `x` with `A⁻¹ x`.
    pub fn solve(&self, values: &[f64], x: MatMut<'_, f64>) {
        let mut memory = MemBuffer::new(self.0.solve_in_place_scratch::<f64>(x.ncols(), Par::Seq));
        let factor = LltRef::<usize, f64>::new(&self.0, values);
        factor.solve_in_place_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut memory));
    }

    /// Overwrites `x` with `L⁻¹ x`; its rows are in the order of elimination.
    pub fn forward(&self, values: &[f64], x: MatMut<'_, f64>) {
        if let Some(s) = self.simplicial() {
            solve_lower_triangular_in_place(SparseColMatRef::new(s.factor(), values), Conj::No, x, Par::Seq);
        }
    }

    /// Overwrites `x` with `L⁻ᵀ x`; its rows are in the order of elimination.
    pub fn backward(&self, values: &[f64], x: MatMut<'_, f64>) {
        if let Some(s) = self.simplicial() {
            solve_lower_triangular_transpose_in_place(SparseColMatRef::new(s.factor(), values), Conj::No, x, Par::Seq);
        }
    }

    /// `L_kk` in the order of elimination.
    pub fn diagonal(&self, values: &[f64]) -> Vec<f64> {
        self.simplicial()
            .into_iter()
            .flat_map(|s| s.col_ptr()[..s.ncols()].iter().map(|&first| values[first]))
            .collect()
    }

    /// `None` does not occur: plans with dense blocks are of the other kind.
    fn simplicial(&self) -> Option<&SymbolicSimplicialCholesky<usize>> {
        match self.0.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => Some(simplicial),
            SymbolicCholeskyRaw::Supernodal(_) => None,
        }
    }
}
