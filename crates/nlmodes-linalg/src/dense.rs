use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

use crate::{LinalgError, Mat};

/// From this size on faer's blocked elimination is faster than column by column, by a factor of two at 70 and five at
/// 300 rows.
const BLOCKED: usize = 56;

/// Number of rows above which faer's blocked product is faster than row by row.
const BLOCKED_PRODUCT: usize = 16;

/// `C += α A B` for matrices row by row in slices: `a` is m × k, rows of `b` (k × n) and of `c` (m × n) are `stride ≥
/// n` apart.
///
/// # Panics
/// If a slice is shorter than its matrix.
///
/// ```
/// let mut c = [1.0, 1.0, 7.0, 1.0, 1.0];
/// nlmodes_linalg::add_product(2.0, &[1.0, 2.0, 3.0, 4.0], &[1.0, 0.0, 7.0, 0.0, 1.0], &mut c, [2, 2, 2], 3);
/// assert_eq!(c, [3.0, 5.0, 7.0, 7.0, 9.0]);
/// ```
pub fn add_product(factor: f64, a: &[f64], b: &[f64], c: &mut [f64], [m, k, n]: [usize; 3], stride: usize) {
    if m.min(k).min(n) < BLOCKED_PRODUCT {
        for i in 0..m {
            let row = &mut c[i * stride..][..n];
            for (l, a) in a[i * k..(i + 1) * k].iter().enumerate() {
                let weight = factor * a;
                row.iter_mut().zip(&b[l * stride..][..n]).for_each(|(c, b)| *c += weight * b);
            }
        }
        return;
    }
    // Transposed: faer's mutable constructor is for columns.
    matmul(
        MatMut::from_column_major_slice_with_stride_mut(c, n, m, stride),
        Accum::Add,
        MatRef::from_column_major_slice_with_stride(b, n, k, stride),
        MatRef::from_column_major_slice(&a[..m * k], k, m),
        factor,
        Par::Seq,
    );
}

/// Column `j` of a matrix.
///
/// # Panics
/// If there is no such column.
pub fn column(a: &Mat<f64>, j: usize) -> &[f64] {
    a.col(j).try_as_col_major().expect("columns of a Mat are contiguous").as_slice()
}

/// Column `j` of a matrix, to be changed.
///
/// # Panics
/// If there is no such column.
pub fn column_mut(a: &mut Mat<f64>, j: usize) -> &mut [f64] {
    a.col_mut(j).try_as_col_major_mut().expect("columns of a Mat are contiguous").as_slice_mut()
}

/// LU factorisation with row exchanges, `P A = L U`, of a dense square matrix.
///
/// Intended for the bordered systems of a continuation, with tens to hundreds of unknowns, factored once and solved for
/// a few right-hand sides. Storage is reused by [`DenseLu::refactor`].
///
/// ```
/// use nlmodes_linalg::{DenseLu, Mat};
/// let a = Mat::from_fn(2, 2, |i, j| [[0.0, 2.0], [1.0, 1.0]][i][j]);
/// let lu = DenseLu::factor(&a)?;
/// let mut x = [4.0, 3.0];
/// lu.solve_in_place(&mut x);
/// assert_eq!(x, [1.0, 2.0]);
/// assert_eq!(lu.determinant_sign(), -1.0);
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct DenseLu {
    n: usize,
    /// Column-major factors, unit lower triangle below the diagonal.
    lu: Vec<f64>,
    /// Row exchanged with row `k` at step `k`.
    exchanges: Vec<usize>,
    sign: f64,
}

impl DenseLu {
    /// Factors `a` (n × n).
    ///
    /// # Errors
    /// [`LinalgError::Dimension`] if `a` is not square, [`LinalgError::NotFinite`], and
    /// [`LinalgError::Singular`] if a pivot is exactly zero.
    pub fn factor(a: &Mat<f64>) -> Result<Self, LinalgError> {
        let mut lu = Self::default();
        lu.refactor(a)?;
        Ok(lu)
    }

    /// Factors another matrix, reusing the storage. After an error the factors are not usable.
    ///
    /// # Errors
    /// As [`DenseLu::factor`].
    pub fn refactor(&mut self, a: &Mat<f64>) -> Result<(), LinalgError> {
        let n = a.nrows();
        if a.ncols() != n {
            return Err(LinalgError::Dimension { what: "columns of a square matrix", expected: n, found: a.ncols() });
        }
        self.n = n;
        self.lu.clear();
        for j in 0..n {
            self.lu.extend(a.col(j).iter());
        }
        if self.lu.iter().any(|v| !v.is_finite()) {
            return Err(LinalgError::NotFinite { what: "matrix to be factored" });
        }
        self.exchanges.clear();
        self.sign = 1.0;
        if n < BLOCKED { (0..n).try_for_each(|k| self.eliminate_column(k)) } else { self.eliminate_blocks() }
    }

    /// Elimination by blocks of columns.
    fn eliminate_blocks(&mut self) -> Result<(), LinalgError> {
        let n = self.n;
        let (mut rows, mut places) = (vec![0_usize; n], vec![0_usize; n]);
        let mut memory = MemBuffer::try_new(lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()))
            .map_err(|_| LinalgError::OutOfMemory { what: "dense matrix" })?;
        lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.lu, n, n),
            &mut rows,
            &mut places,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        self.exchange_into(&rows);
        for k in 0..n {
            let pivot = self.lu[k * n + k];
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(LinalgError::Singular { what: "dense matrix", column: k, pivot });
            }
            self.sign *= pivot.signum();
        }
        Ok(())
    }

    /// The sequence of exchanges that moves row `rows[k]` to position `k`.
    fn exchange_into(&mut self, rows: &[usize]) {
        let mut at: Vec<usize> = (0..rows.len()).collect();
        let mut place = at.clone();
        for (k, &row) in rows.iter().enumerate() {
            let p = place[row];
            self.exchanges.push(p);
            if p != k {
                self.sign = -self.sign;
            }
            at.swap(k, p);
            place[at[p]] = p;
        }
    }

    /// One step of right-looking elimination: pivot, scale column `k`, update the columns to its right.
    fn eliminate_column(&mut self, k: usize) -> Result<(), LinalgError> {
        let n = self.n;
        let (done, right) = self.lu.split_at_mut((k + 1) * n);
        let column = &mut done[k * n..];
        let mut p = k;
        for i in k + 1..n {
            if column[i].abs() > column[p].abs() {
                p = i;
            }
        }
        let pivot = column[p];
        if pivot == 0.0 {
            return Err(LinalgError::Singular { what: "dense matrix", column: k, pivot });
        }
        self.exchanges.push(p);
        if p != k {
            self.sign = -self.sign;
            column.swap(p, k);
        }
        if pivot < 0.0 {
            self.sign = -self.sign;
        }
        let inverse = 1.0 / pivot;
        column[k + 1..].iter_mut().for_each(|v| *v *= inverse);
        for other in right.chunks_exact_mut(n) {
            other.swap(p, k);
            let factor = other[k];
            if factor != 0.0 {
                for (v, l) in other[k + 1..].iter_mut().zip(&column[k + 1..]) {
                    *v -= factor * l;
                }
            }
        }
        // The columns to the left have finished multipliers, which are exchanged too.
        for j in 0..k {
            done.swap(j * n + p, j * n + k);
        }
        Ok(())
    }

    /// Number of rows.
    pub fn dim(&self) -> usize {
        self.n
    }

    /// Overwrites `x` with `A⁻¹ x`.
    ///
    /// # Panics
    /// If `x` has not [`DenseLu::dim`] entries.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        let n = self.n;
        assert_eq!(x.len(), n, "right-hand side of a {n} x {n} system");
        for (k, &p) in self.exchanges.iter().enumerate() {
            x.swap(k, p);
        }
        for k in 0..n {
            let xk = x[k];
            for (v, l) in x[k + 1..].iter_mut().zip(&self.lu[k * n + k + 1..(k + 1) * n]) {
                *v -= xk * l;
            }
        }
        for k in (0..n).rev() {
            x[k] /= self.lu[k * n + k];
            let xk = x[k];
            for (v, u) in x[..k].iter_mut().zip(&self.lu[k * n..k * n + k]) {
                *v -= xk * u;
            }
        }
    }

    /// `A⁻¹ B`, for the columns of `b` (n × any).
    ///
    /// # Panics
    /// If `b` has another number of rows.
    pub fn solve_columns(&self, b: &Mat<f64>) -> Mat<f64> {
        let mut x = b.clone();
        for k in 0..x.ncols() {
            let mut column: Vec<f64> = x.col(k).iter().copied().collect();
            self.solve_in_place(&mut column);
            x.col_mut(k).iter_mut().zip(&column).for_each(|(x, v)| *x = *v);
        }
        x
    }

    /// Overwrites `x` with `A⁻ᵀ x`.
    ///
    /// # Panics
    /// If `x` has not [`DenseLu::dim`] entries.
    pub fn solve_transposed_in_place(&self, x: &mut [f64]) {
        let n = self.n;
        assert_eq!(x.len(), n, "right-hand side of a {n} x {n} system");
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for k in 0..n {
            let column = &self.lu[k * n..(k + 1) * n];
            x[k] = (x[k] - dot(&x[..k], &column[..k])) / column[k];
        }
        for k in (0..n).rev() {
            x[k] -= dot(&x[k + 1..], &self.lu[k * n + k + 1..(k + 1) * n]);
        }
        for (k, &p) in self.exchanges.iter().enumerate().rev() {
            x.swap(k, p);
        }
    }

    /// Sign of `det A`: +1 or −1.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    /// Smallest over largest pivot in magnitude: a cheap indicator of near-singularity, from zero to one.
    pub fn pivot_ratio(&self) -> f64 {
        let pivots = (0..self.n).map(|k| self.lu[k * self.n + k].abs());
        let (low, high) = pivots.fold((f64::INFINITY, 0.0_f64), |(l, h), p| (l.min(p), h.max(p)));
        if self.n == 0 { 1.0 } else { low / high }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Small integers, so that sums are exact; rows of other matrices in between are unchanged.
        #[test]
        fn products_by_blocks_and_by_rows_are_the_sums(
            m in 1usize..40, k in 1usize..40, n in 1usize..40, apart in 0usize..5,
        ) {
            let stride = n + apart;
            let number = |i: usize| (i * 7919 % 13) as f64 - 6.0;
            let a: Vec<f64> = (0..m * k).map(number).collect();
            let b: Vec<f64> = (0..(k - 1) * stride + n).map(|i| number(i + 3)).collect();
            let before: Vec<f64> = (0..(m - 1) * stride + n).map(|i| number(i + 5)).collect();
            let mut c = before.clone();
            add_product(0.5, &a, &b, &mut c, [m, k, n], stride);
            for (at, (c, before)) in c.iter().zip(&before).enumerate() {
                let (i, j) = (at / stride, at % stride);
                let sum: f64 = (0..k).filter(|_| j < n).map(|l| a[i * k + l] * b[l * stride + j]).sum();
                prop_assert_eq!(*c, before + 0.5 * sum);
            }
        }

        #[test]
        fn solution_reproduces_the_right_hand_side(n in 1usize..120, seed in any::<u64>()) {
            let mut state = seed | 1;
            let mut next = || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            };
            let a = Mat::from_fn(n, n, |i, j| next() + if i == j { 2.0 } else { 0.0 });
            let b: Vec<f64> = (0..n).map(|_| next()).collect();
            let mut x = b.clone();
            let lu = DenseLu::factor(&a).unwrap();
            lu.solve_in_place(&mut x);
            let mut y = b.clone();
            lu.solve_transposed_in_place(&mut y);
            // What is left of a nearly singular matrix is small beside its large solution.
            let within = |x: &[f64]| 1e-12 * (1.0 + x.iter().map(|x| x.abs()).sum::<f64>());
            for i in 0..n {
                let ax: f64 = (0..n).map(|j| a[(i, j)] * x[j]).sum();
                prop_assert!((ax - b[i]).abs() < within(&x), "row {i}: {ax} vs {}", b[i]);
                let ay: f64 = (0..n).map(|j| a[(j, i)] * y[j]).sum();
                prop_assert!((ay - b[i]).abs() < within(&y), "column {i}: {ay} vs {}", b[i]);
            }
        }
    }

    #[test]
    fn blocks_give_the_sign_of_the_determinant_and_name_a_singular_column() {
        let n = 2 * BLOCKED;
        // A cycle of n rows is n − 1 exchanges.
        let cycle = Mat::from_fn(n, n, |i, j| if (i + 1) % n == j { 1.0 } else { 0.0 });
        assert_eq!(DenseLu::factor(&cycle).unwrap().determinant_sign(), -1.0);
        let mut diagonal = Mat::from_fn(n, n, |i, j| if i == j { 1.0 + i as f64 } else { 0.0 });
        diagonal[(3, 3)] = -1.0;
        assert_eq!(DenseLu::factor(&diagonal).unwrap().determinant_sign(), -1.0);
        diagonal[(7, 7)] = 0.0;
        assert!(matches!(DenseLu::factor(&diagonal), Err(LinalgError::Singular { column: 7, .. })));
    }

    #[test]
    fn determinant_sign_counts_exchanges_and_negative_pivots() {
        let permutation = Mat::from_fn(3, 3, |i, j| if (i + 1) % 3 == j { 1.0 } else { 0.0 });
        assert_eq!(DenseLu::factor(&permutation).unwrap().determinant_sign(), 1.0);
        let reflected = Mat::from_fn(3, 3, |i, j| if i != j { 0.0 } else { [-1.0, 2.0, 3.0][i] });
        assert_eq!(DenseLu::factor(&reflected).unwrap().determinant_sign(), -1.0);
    }

    #[test]
    fn singular_and_misshapen_matrices_are_refused() {
        assert!(matches!(DenseLu::factor(&Mat::zeros(2, 2)), Err(LinalgError::Singular { column: 0, .. })));
        assert!(matches!(DenseLu::factor(&Mat::zeros(2, 3)), Err(LinalgError::Dimension { .. })));
        assert!(matches!(DenseLu::factor(&Mat::full(1, 1, f64::NAN)), Err(LinalgError::NotFinite { .. })));
    }
}
