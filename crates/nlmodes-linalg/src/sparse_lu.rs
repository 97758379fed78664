use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::{Perm, PermRef};
use faer::sparse::linalg::colamd;
use faer::sparse::linalg::lu::simplicial::{self, SimplicialLu};
use faer::{Conj, MatMut, Par};

use crate::{LinalgError, SparseMatrix};

/// A row is full if its number of entries exceeds this multiple of the square root of the number of columns, and this
/// minimum.
const FULL: (f64, usize) = (10.0, 16);

/// Scale factor of full rows: eliminated early, one would fill all others. A power of two, so that nothing is rounded.
const HELD_BACK: f64 = 1.0 / 256.0;

/// LU factorisation with row exchanges, `P A Q = L U`, of a sparse square matrix.
///
/// Columns are eliminated in an order that keeps the factors sparse (COLAMD), rows by the largest pivot. Rows that are
/// nearly full, such as the border of a continuation, would fill all others: they are pivots only if those of the
/// others are some hundred times smaller. The order of the columns is kept by [`SparseLu::refactor`] as long as the
/// pattern is the same.
///
/// ```
/// use nlmodes_linalg::{SparseLu, sparse_from_triplets};
/// let a = sparse_from_triplets(2, 2, &[(0, 1, 2.0), (1, 0, 1.0), (1, 1, 1.0)])?;
/// let lu = SparseLu::factor(&a)?;
/// let (mut x, mut y) = ([4.0, 3.0], [1.0, 3.0]);
/// lu.solve_in_place(&mut x);
/// lu.solve_transposed_in_place(&mut y);
/// assert_eq!((x, y), ([1.0, 2.0], [1.0, 1.0]));
/// assert_eq!(lu.determinant_sign(), -1.0);
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct SparseLu {
    /// The pattern for which the column order was computed: column starts and rows.
    pattern: (Vec<usize>, Vec<usize>),
    columns: Option<Perm<usize>>,
    rows: Option<Perm<usize>>,
    /// The scale factor of each row.
    row_factors: Vec<f64>,
    factors: SimplicialLu<usize, f64>,
    sign: f64,
    pivot_ratio: f64,
}

impl SparseLu {
    /// Factors `a` (n × n).
    ///
    /// # Errors
    /// [`LinalgError::Dimension`] if `a` is not square, [`LinalgError::NotFinite`], [`LinalgError::OutOfMemory`], and
    /// [`LinalgError::Singular`] if a pivot is exactly zero.
    pub fn factor(a: &SparseMatrix) -> Result<Self, LinalgError> {
        let mut lu = Self::default();
        lu.refactor(a)?;
        Ok(lu)
    }

    /// Factors another matrix; the order of the columns is kept if the pattern is the same. After an error the factors
    /// are not usable.
    ///
    /// # Errors
    /// As [`SparseLu::factor`].
    pub fn refactor(&mut self, a: &SparseMatrix) -> Result<(), LinalgError> {
        let n = a.nrows();
        if a.ncols() != n {
            return Err(LinalgError::Dimension { what: "columns of a square matrix", expected: n, found: a.ncols() });
        }
        if a.val().iter().any(|v| !v.is_finite()) {
            return Err(LinalgError::NotFinite { what: "matrix to be factored" });
        }
        self.order(a)?;
        let Some(columns) = &self.columns else { return Err(LinalgError::OutOfMemory { what: WHAT }) };
        let scaled = self.scaled(a);
        let (mut rows, mut inverse) = (vec![0; n], vec![0; n]);
        let mut memory = memory(simplicial::factorize_simplicial_numeric_lu_scratch::<usize, f64>(n, n))?;
        let (order, stack) = (columns.as_ref(), MemStack::new(&mut memory));
        simplicial::factorize_simplicial_numeric_lu(
            &mut rows,
            &mut inverse,
            &mut self.factors,
            scaled.as_ref(),
            order,
            stack,
        )
        .map_err(|e| match e {
            faer::sparse::linalg::LuError::SymbolicSingular { index } => {
                LinalgError::Singular { what: WHAT, column: order.arrays().0[index], pivot: 0.0 }
            }
            faer::sparse::linalg::LuError::Generic(_) => LinalgError::OutOfMemory { what: WHAT },
        })?;
        let (sign, columns) = (parity(&rows) * parity(order.arrays().0), order.arrays().0.to_vec());
        self.look_at_pivots(sign, &rows, &columns)?;
        self.rows = Some(Perm::new_checked(rows.into(), inverse.into(), n));
        Ok(())
    }

    /// The column order, unless it is known.
    fn order(&mut self, a: &SparseMatrix) -> Result<(), LinalgError> {
        let (symbolic, n) = (a.symbolic(), a.ncols());
        let same = self.columns.is_some()
            && self.pattern.0.as_slice() == symbolic.col_ptr()
            && self.pattern.1.as_slice() == symbolic.row_idx();
        if same {
            return Ok(());
        }
        self.columns = None;
        // Vectors of another size are not shortened.
        self.factors = SimplicialLu::new();
        let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
        let mut memory = memory(colamd::order_scratch::<usize>(n, n, a.compute_nnz()))?;
        colamd::order(&mut order, &mut inverse, symbolic, Default::default(), MemStack::new(&mut memory))
            .map_err(|_| LinalgError::OutOfMemory { what: WHAT })?;
        let mut entries = vec![0_usize; n];
        symbolic.row_idx().iter().for_each(|&i| entries[i] += 1);
        let full = ((FULL.0 * (n as f64).sqrt()) as usize).max(FULL.1);
        self.row_factors = entries.iter().map(|count| if *count > full { HELD_BACK } else { 1.0 }).collect();
        self.pattern = (symbolic.col_ptr().to_vec(), symbolic.row_idx().to_vec());
        self.columns = Some(Perm::new_checked(order.into(), inverse.into(), n));
        Ok(())
    }

    fn scaled(&self, a: &SparseMatrix) -> SparseMatrix {
        let mut scaled = a.clone();
        let rows = self.pattern.1.iter();
        scaled.val_mut().iter_mut().zip(rows).for_each(|(v, &i)| *v *= self.row_factors[i]);
        scaled
    }

    /// Sign of the determinant and ratio of the pivots, without the scale factors of full rows.
    fn look_at_pivots(&mut self, sign: f64, rows: &[usize], columns: &[usize]) -> Result<(), LinalgError> {
        self.sign = sign;
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        let u = self.factors.u_factor_unsorted();
        for (k, &row) in rows.iter().enumerate() {
            // The diagonal entry is written last.
            let pivot = u.val_of_col(k).last().copied().unwrap_or(0.0);
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(LinalgError::Singular { what: WHAT, column: columns[k], pivot });
            }
            self.sign *= pivot.signum();
            let size = pivot.abs() / self.row_factors[row];
            (low, high) = (low.min(size), high.max(size));
        }
        self.pivot_ratio = if rows.is_empty() { 1.0 } else { low / high };
        Ok(())
    }

    /// Number of rows.
    pub fn dim(&self) -> usize {
        self.factors.nrows()
    }

    /// Overwrites `x` with `A⁻¹ x`.
    ///
    /// # Panics
    /// If `x` has not [`SparseLu::dim`] entries.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.dim(), "right-hand side of a sparse system");
        x.iter_mut().zip(&self.row_factors).for_each(|(x, factor)| *x *= factor);
        self.with_factors(x, |factors, rows, columns, x, stack| {
            factors.solve_in_place_with_conj(rows, columns, Conj::No, x, Par::Seq, stack);
        });
    }

    /// Overwrites `x` with `A⁻ᵀ x`.
    ///
    /// # Panics
    /// If `x` has not [`SparseLu::dim`] entries.
    pub fn solve_transposed_in_place(&self, x: &mut [f64]) {
        assert_eq!(x.len(), self.dim(), "right-hand side of a sparse system");
        self.with_factors(x, |factors, rows, columns, x, stack| {
            factors.solve_transpose_in_place_with_conj(rows, columns, Conj::No, x, Par::Seq, stack);
        });
        x.iter_mut().zip(&self.row_factors).for_each(|(x, factor)| *x *= factor);
    }

    fn with_factors(
        &self,
        x: &mut [f64],
        solve: impl FnOnce(
            &SimplicialLu<usize, f64>,
            PermRef<'_, usize>,
            PermRef<'_, usize>,
            MatMut<'_, f64>,
            &mut MemStack,
        ),
    ) {
        let (Some(rows), Some(columns)) = (&self.rows, &self.columns) else { return };
        let n = x.len();
        let mut memory = MemBuffer::new(simplicial::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq));
        let x = MatMut::from_column_major_slice_mut(x, n, 1);
        solve(&self.factors, rows.as_ref(), columns.as_ref(), x, MemStack::new(&mut memory));
    }

    /// Sign of `det A`: +1 or −1.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    /// Smallest over largest pivot in magnitude: a cheap indicator of near-singularity, from zero to one.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }
}

const WHAT: &str = "sparse matrix";

fn memory(needed: StackReq) -> Result<MemBuffer, LinalgError> {
    MemBuffer::try_new(needed).map_err(|_| LinalgError::OutOfMemory { what: WHAT })
}

/// Sign of a permutation.
fn parity(order: &[usize]) -> f64 {
    let mut seen = vec![false; order.len()];
    let mut sign = 1.0;
    for start in 0..order.len() {
        let mut at = order[start];
        while !seen[start] && at != start {
            seen[at] = true;
            at = order[at];
            sign = -sign;
        }
        seen[start] = true;
    }
    sign
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{DenseLu, Mat, Triplet, sparse_from_triplets};

    /// A sparse matrix with a full last row and column.
    fn bordered(n: usize, seed: u64) -> Vec<Triplet> {
        let mut state = seed | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut entries: Vec<Triplet> = Vec::new();
        for i in 0..n {
            entries.push((i, i, next()));
            entries.push((i, (7 * i + 3) % n, next()));
            entries.push((i, (5 * i + 1) % n, next()));
            entries.push((i, n - 1, next()));
            entries.push((n - 1, i, next()));
        }
        entries
    }

    fn dense(n: usize, entries: &[Triplet]) -> Mat<f64> {
        let mut a = Mat::zeros(n, n);
        entries.iter().for_each(|&(i, j, v)| a[(i, j)] += v);
        a
    }

    proptest! {
        #[test]
        fn solutions_and_signs_are_those_of_the_dense_factors(n in 1usize..120, seed in any::<u64>()) {
            let entries = bordered(n, seed);
            let full = DenseLu::factor(&dense(n, &entries)).unwrap();
            let lu = SparseLu::factor(&sparse_from_triplets(n, n, &entries).unwrap()).unwrap();
            prop_assert_eq!(lu.determinant_sign(), full.determinant_sign());
            let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let (mut x, mut y) = (b.clone(), b.clone());
            lu.solve_in_place(&mut x);
            lu.solve_transposed_in_place(&mut y);
            let (mut ax, mut ay) = (vec![0.0; n], vec![0.0; n]);
            for &(i, j, v) in &entries {
                ax[i] += v * x[j];
                ay[j] += v * y[i];
            }
            let size = |v: &[f64]| v.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
            for i in 0..n {
                prop_assert!((ax[i] - b[i]).abs() < 1e-11 * size(&x), "row {i}: {} {}", ax[i], b[i]);
                prop_assert!((ay[i] - b[i]).abs() < 1e-11 * size(&y), "column {i}: {} {}", ay[i], b[i]);
            }
        }
    }

    #[test]
    fn the_order_is_kept_for_the_same_pattern_and_found_anew_for_another() {
        let entries = bordered(40, 3);
        let halved: Vec<Triplet> = entries.iter().map(|&(i, j, v)| (i, j, 0.5 * v)).collect();
        let mut lu = SparseLu::factor(&sparse_from_triplets(40, 40, &entries).unwrap()).unwrap();
        let order = lu.columns.clone();
        let mut x = vec![1.0; 40];
        lu.solve_in_place(&mut x);
        lu.refactor(&sparse_from_triplets(40, 40, &halved).unwrap()).unwrap();
        assert_eq!(lu.columns, order);
        let mut y = vec![0.5; 40];
        lu.solve_in_place(&mut y);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() <= 1e-14 * x.abs()));
        lu.refactor(&sparse_from_triplets(2, 2, &[(0, 0, 2.0), (1, 1, -4.0)]).unwrap()).unwrap();
        let mut z = [2.0, 4.0];
        lu.solve_in_place(&mut z);
        assert_eq!((z, lu.determinant_sign(), lu.pivot_ratio()), ([1.0, -1.0], -1.0, 0.5));
    }

    #[test]
    fn singular_and_misshapen_matrices_are_refused() {
        let made = |n, m, entries: &[Triplet]| SparseLu::factor(&sparse_from_triplets(n, m, entries).unwrap());
        assert!(matches!(made(2, 2, &[(0, 0, 1.0), (1, 0, 1.0)]), Err(LinalgError::Singular { .. })));
        let equal_rows = [(0, 0, 1.0), (0, 1, 2.0), (1, 0, 1.0), (1, 1, 2.0)];
        assert!(matches!(made(2, 2, &equal_rows), Err(LinalgError::Singular { .. })));
        assert!(matches!(made(2, 3, &[(0, 0, 1.0)]), Err(LinalgError::Dimension { .. })));
    }

    #[test]
    fn a_full_row_does_not_fill_the_factors() {
        // A Laplacian on 40 × 40 nodes with a border whose entries are as large as its own.
        let (m, n) = (40, 1600);
        let mut entries: Vec<Triplet> = Vec::new();
        for i in 0..n {
            entries.push((i, i, 4.0));
            let (x, y) = (i % m, i / m);
            for (dx, dy) in [(-1_i64, 0_i64), (1, 0), (0, -1), (0, 1)] {
                let (x, y) = (x as i64 + dx, y as i64 + dy);
                if (0..m as i64).contains(&x) && (0..m as i64).contains(&y) {
                    entries.push((i, (y * m as i64 + x) as usize, -1.0));
                }
            }
            entries.push((n, i, 4.0));
            entries.push((i, n, 1.0));
        }
        let lu = SparseLu::factor(&sparse_from_triplets(n + 1, n + 1, &entries).unwrap()).unwrap();
        let filled = lu.factors.u_factor_unsorted().compute_nnz();
        assert!(filled < 30 * n, "{filled} entries");
    }
}
