//! Factors with dense blocks: their order of elimination and panels.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::reborrow::{IntoConst, ReborrowMut};
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::utils::{permute_self_adjoint_scratch, permute_self_adjoint_to_unsorted};
use faer::{MatMut, Side};

use super::halves::Halves;
use super::numeric::factorise;
use super::panels::Panels;
use crate::{LinalgError, Mat, SparseMatrix};

/// The symbolic part of a factor with dense blocks.
#[derive(Debug)]
pub(super) struct Blocks {
    pub panels: Panels,
    /// The column of the matrix that is eliminated at each step, and the step of each column.
    pub order: Vec<usize>,
    pub place: Vec<usize>,
}

impl Blocks {
    pub fn new(nodes: &SymbolicSupernodalCholesky<usize>, order: Vec<usize>) -> Self {
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &j)| place[j] = k);
        let panels = Panels::new(nodes);
        Self { panels, order, place }
    }

    /// The panels of the factor of `a`; the lower triangle is read.
    pub fn factor(&self, a: &SparseMatrix, what: &'static str) -> Result<Vec<Mat<f64>>, LinalgError> {
        let n = self.order.len();
        let below = |j: usize| a.symbolic().row_idx_of_col_raw(j).iter().filter(move |&&i| i >= j).count();
        let count = (0..n).map(below).sum();
        let (mut values, mut starts, mut rows) = (vec![0.0; count], vec![0; n + 1], vec![0; count]);
        let scratch = permute_self_adjoint_scratch::<usize>(n);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinalgError::OutOfMemory { what })?;
        let lower = permute_self_adjoint_to_unsorted(
            &mut values,
            &mut starts,
            &mut rows,
            a.as_ref(),
            PermRef::new_checked(&self.order, &self.place, n),
            Side::Lower,
            Side::Lower,
            MemStack::new(&mut memory),
        );
        factorise(&self.panels, lower.into_const())
            .map_err(|k| LinalgError::NotPositiveDefinite { what, column: self.order[k] })
    }

    pub fn halves<'a>(&'a self, values: &'a [Mat<f64>]) -> Halves<'a> {
        Halves { panels: &self.panels, values }
    }

    /// Overwrites `x` with `A⁻¹ x`, with the rows of the matrix.
    pub fn solve(&self, values: &[Mat<f64>], mut x: MatMut<'_, f64>) {
        let mut permuted = Mat::zeros(x.nrows(), x.ncols());
        for j in 0..x.ncols() {
            let (to, from) = (permuted.col_as_slice_mut(j), x.rb_mut().col_mut(j));
            to.iter_mut().zip(&self.order).for_each(|(to, &i)| *to = from[i]);
        }
        self.halves(values).forward(permuted.as_mut());
        self.halves(values).backward(permuted.as_mut());
        for j in 0..x.ncols() {
            let (mut to, from) = (x.rb_mut().col_mut(j), permuted.col_as_slice(j));
            from.iter().zip(&self.order).for_each(|(from, &i)| to[i] = *from);
        }
    }

    /// `L_kk` in the order of elimination.
    pub fn diagonal(&self, values: &[Mat<f64>]) -> Vec<f64> {
        values.iter().flat_map(|panel| (0..panel.ncols()).map(move |k| panel[(k, k)])).collect()
    }
}
