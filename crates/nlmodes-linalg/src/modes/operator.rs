//! The symmetric operator whose largest eigenvalues belong to the lowest modes.

use faer::MatMut;

use super::Pencil;
use crate::threads::{in_pieces, pays, spread};
use crate::{Mat, SparseCholesky, SparseMatrix};

/// Columns that are multiplied at once: as many numbers as a line of the cache holds.
const AT_ONCE: usize = 8;

/// `C = L⁻¹ P M Pᵀ L⁻ᵀ` of the factor `P (K + sM) Pᵀ = L Lᵀ`: `C u = θ u` with `θ = 1/(λ + s)` and `φ = Pᵀ L⁻ᵀ u`.
///
/// It is symmetric, so an iteration with it needs no products with `M` to keep its vectors orthogonal. All rows are in
/// the order of elimination.
pub(super) struct Operator<'a> {
    mass: &'a SparseMatrix,
    factor: &'a SparseCholesky,
    order: Vec<usize>,
}

impl<'a> Operator<'a> {
    pub fn new(pencil: &'a Pencil<'a>) -> Self {
        Self { mass: pencil.mass, factor: &pencil.factor, order: pencil.factor.order() }
    }

    /// Overwrites `u` with `C u`.
    pub fn apply(&self, u: &mut Mat<f64>) {
        self.factor.backward(u.as_mut());
        self.press(u);
    }

    /// Overwrites `x` with `L⁻¹ P M Pᵀ x`, which is in the range of `C` for any `x`.
    pub fn press(&self, x: &mut Mat<f64>) {
        self.multiply(x.as_mut());
        self.factor.forward(x.as_mut());
    }

    /// The largest entry on the diagonal of `M`.
    pub fn heaviest(&self) -> f64 {
        (0..self.order.len()).map(|i| super::diagonal(self.mass, i)).fold(0.0, f64::max)
    }

    /// Overwrites `x` with `L⁻¹ x`.
    pub fn forward(&self, x: &mut Mat<f64>) {
        self.factor.forward(x.as_mut());
    }

    /// `P M Pᵀ x`, in place.
    pub fn multiply(&self, mut x: MatMut<'_, f64>) {
        let mut first = 0;
        while first < x.ncols() {
            // One or two columns are not worth lines of eight.
            let left = x.ncols() - first;
            let count = if left <= 2 { 1 } else { AT_ONCE.min(left) };
            let columns = x.as_mut().subcols_mut(first, count);
            match count {
                1 => self.columns::<1>(columns),
                2..=4 => self.columns::<4>(columns),
                _ => self.columns::<AT_ONCE>(columns),
            };
            first += count;
        }
    }

    /// At most `WIDTH` columns, with the numbers of a row side by side. `M` is symmetric: its columns are read as rows,
    /// so that each sum stays in registers.
    fn columns<const WIDTH: usize>(&self, x: MatMut<'_, f64>) {
        let mut rows = vec![[0.0; WIDTH]; self.order.len()];
        for (j, column) in x.as_ref().col_iter().enumerate() {
            self.order.iter().zip(column.iter()).for_each(|(&i, from)| rows[i][j] = *from);
        }
        if pays(self.mass.compute_nnz() * WIDTH) {
            spread(in_pieces(x), || (), |(), (first, piece)| self.piece(&rows, first, piece));
        } else {
            self.piece(&rows, 0, x);
        }
    }

    /// The rows of the product from `first` on.
    fn piece<const WIDTH: usize>(&self, rows: &[[f64; WIDTH]], first: usize, mut product: MatMut<'_, f64>) {
        for (k, &i) in self.order[first..first + product.nrows()].iter().enumerate() {
            let mut sum = [0.0; WIDTH];
            for (&row, m) in self.mass.symbolic().row_idx_of_col_raw(i).iter().zip(self.mass.val_of_col(i)) {
                sum.iter_mut().zip(&rows[row]).for_each(|(sum, x)| *sum += m * x);
            }
            (0..product.ncols()).for_each(|j| product[(k, j)] = sum[j]);
        }
    }

    /// Modes `φ = Pᵀ L⁻ᵀ u`, still in the order of elimination and not normalised.
    pub fn shapes(&self, mut u: Mat<f64>) -> Mat<f64> {
        self.factor.backward(u.as_mut());
        u
    }

    /// Rows in the order of elimination, from those in their own.
    pub fn permuted(&self, x: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(x.nrows(), x.ncols(), |k, j| x[(self.order[k], j)])
    }

    /// `P X` with rows in the order of elimination becomes `X`.
    pub fn restored(&self, x: &Mat<f64>) -> Mat<f64> {
        let mut own = Mat::zeros(x.nrows(), x.ncols());
        for j in 0..x.ncols() {
            let to = own.as_mut().col_mut(j);
            let to = to.try_as_col_major_mut().map(faer::ColMut::as_slice_mut);
            if let Some(to) = to {
                self.order.iter().zip(x.col(j).iter()).for_each(|(&i, from)| to[i] = *from);
            }
        }
        own
    }
}
