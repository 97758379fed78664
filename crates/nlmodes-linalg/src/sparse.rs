use faer::sparse::{CreationError, SparseColMat, Triplet as FaerTriplet};

use crate::{LinalgError, Mat, sparse_from_columns};

/// A sparse matrix in compressed columns.
pub type SparseMatrix = SparseColMat<usize, f64>;

/// One entry `(row, column, value)`; entries at the same position are added.
pub type Triplet = (usize, usize, f64);

/// Builds a sparse matrix from entries in any order.
///
/// ```
/// use nlmodes_linalg::sparse_from_triplets;
/// let a = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 0, 2.0), (0, 0, 3.0)])?;
/// assert_eq!((a[(0, 0)], a[(1, 0)]), (4.0, 2.0));
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError::Dimension`] for an index outside the matrix (`found` is the index, `expected` the number of rows or
/// columns that it must stay below), [`LinalgError::NotFinite`], [`LinalgError::OutOfMemory`].
pub fn sparse_from_triplets(rows: usize, columns: usize, entries: &[Triplet]) -> Result<SparseMatrix, LinalgError> {
    if entries.iter().any(|e| !e.2.is_finite()) {
        return Err(LinalgError::NotFinite { what: "list of matrix entries" });
    }
    let entries: Vec<_> = entries.iter().map(|&(i, j, v)| FaerTriplet::new(i, j, v)).collect();
    SparseColMat::try_new_from_triplets(rows, columns, &entries).map_err(|e| match e {
        CreationError::OutOfBounds { row, .. } if row >= rows => {
            LinalgError::Dimension { what: "row index of a matrix entry", expected: rows, found: row }
        }
        CreationError::OutOfBounds { col, .. } => {
            LinalgError::Dimension { what: "column index of a matrix entry", expected: columns, found: col }
        }
        CreationError::Generic(_) => LinalgError::OutOfMemory { what: "sparse matrix" },
    })
}

/// All stored entries of `a`, column by column.
pub fn triplets(a: &SparseMatrix) -> impl Iterator<Item = Triplet> + '_ {
    a.triplet_iter().map(|t| (t.row, t.col, *t.val))
}

/// `A x`.
///
/// # Panics
/// If `x` has not as many entries as `a` has columns.
pub fn multiply(a: &SparseMatrix, x: &[f64]) -> Vec<f64> {
    assert_eq!(x.len(), a.ncols(), "entries of x in A x");
    let (rows, mut y) = (a.symbolic(), vec![0.0; a.nrows()]);
    for (j, &xj) in x.iter().enumerate() {
        for (&i, v) in rows.row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
            y[i] += v * xj;
        }
    }
    y
}

/// `max |x_i|`; zero for an empty slice.
pub fn max_norm(x: impl IntoIterator<Item = f64>) -> f64 {
    x.into_iter().fold(0.0, |largest, x| f64::max(largest, x.abs()))
}

/// Columns that are multiplied at once: as many numbers as a line of the cache holds.
const AT_ONCE: usize = 8;

/// `A X` for a dense `X` (columns of `a` × any), several columns at once.
///
/// # Panics
/// If `x` has not as many rows as `a` has columns.
pub fn multiply_many(a: &SparseMatrix, x: &Mat<f64>) -> Mat<f64> {
    assert_eq!(x.nrows(), a.ncols(), "rows of X in A X");
    let mut product = Mat::zeros(a.nrows(), x.ncols());
    let first = match x.ncols() % AT_ONCE {
        // Few columns are not worth the copies.
        few @ 1..=2 => {
            (0..few).for_each(|c| multiply_column(a, x, c, &mut product));
            few
        }
        _ => 0,
    };
    (first..x.ncols()).step_by(AT_ONCE).for_each(|c| multiply_columns(a, x, c, &mut product));
    product
}

fn multiply_column(a: &SparseMatrix, x: &Mat<f64>, c: usize, product: &mut Mat<f64>) {
    let from: Vec<f64> = x.col(c).iter().copied().collect();
    product.col_mut(c).iter_mut().zip(multiply(a, &from)).for_each(|(to, from)| *to = from);
}

/// Columns `first` and those after it, with the numbers of a row side by side.
fn multiply_columns(a: &SparseMatrix, x: &Mat<f64>, first: usize, product: &mut Mat<f64>) {
    let columns = first..(first + AT_ONCE).min(x.ncols());
    let mut from = vec![[0.0; AT_ONCE]; a.ncols()];
    let mut to = vec![[0.0; AT_ONCE]; a.nrows()];
    for (k, c) in columns.clone().enumerate() {
        from.iter_mut().zip(x.col(c).iter()).for_each(|(to, from)| to[k] = *from);
    }
    for (j, from) in from.iter().enumerate() {
        for (&i, v) in a.symbolic().row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
            to[i].iter_mut().zip(from).for_each(|(to, from)| *to += v * from);
        }
    }
    for (k, c) in columns.enumerate() {
        product.col_mut(c).iter_mut().zip(&to).for_each(|(to, from)| *to = from[k]);
    }
}

/// `Aᵀ X` for a dense `X` (rows of `a` × any): columns of `a` × any.
///
/// # Panics
/// If `x` has not as many rows as `a`.
pub fn multiply_transposed(a: &SparseMatrix, x: &Mat<f64>) -> Mat<f64> {
    assert_eq!(x.nrows(), a.nrows(), "rows of X in Aᵀ X");
    Mat::from_fn(a.ncols(), x.ncols(), |i, c| {
        let rows = a.symbolic().row_idx_of_col_raw(i);
        rows.iter().zip(a.val_of_col(i)).map(|(&row, v)| v * x[(row, c)]).sum()
    })
}

/// `xᵀ A y`.
///
/// # Panics
/// If the sizes are inconsistent.
pub fn bilinear(x: &[f64], a: &SparseMatrix, y: &[f64]) -> f64 {
    let ay = multiply(a, y);
    assert_eq!(x.len(), ay.len(), "rows of a bilinear form");
    x.iter().zip(&ay).map(|(x, y)| x * y).sum()
}

/// `A + s B`, two matrices of the same size.
///
/// # Errors
/// [`LinalgError::Dimension`] if `b` is larger than `a`, [`LinalgError::NotFinite`] if `s` is not finite.
pub fn add_scaled(a: &SparseMatrix, s: f64, b: &SparseMatrix) -> Result<SparseMatrix, LinalgError> {
    if b.nrows() > a.nrows() || b.ncols() > a.ncols() {
        let (what, expected, found) = if b.nrows() > a.nrows() {
            ("rows of a sum of matrices", a.nrows(), b.nrows())
        } else {
            ("columns of a sum of matrices", a.ncols(), b.ncols())
        };
        return Err(LinalgError::Dimension { what, expected, found });
    }
    let most = a.compute_nnz() + b.compute_nnz();
    let (mut starts, mut rows, mut values) = (vec![0], Vec::with_capacity(most), Vec::with_capacity(most));
    for j in 0..a.ncols() {
        let of_b =
            if j < b.ncols() { (b.symbolic().row_idx_of_col_raw(j), b.val_of_col(j)) } else { (&[][..], &[][..]) };
        add_columns((a.symbolic().row_idx_of_col_raw(j), a.val_of_col(j)), s, of_b, |row, value| {
            rows.push(row);
            values.push(value);
        });
        starts.push(rows.len());
    }
    sparse_from_columns(a.nrows(), a.ncols(), starts, rows, values)
}

/// `a + s b` of two columns given by ascending rows and values.
fn add_columns(a: (&[usize], &[f64]), s: f64, b: (&[usize], &[f64]), mut push: impl FnMut(usize, f64)) {
    let (mut p, mut q) = (0, 0);
    while p < a.0.len() || q < b.0.len() {
        let (i, j) = (a.0.get(p).copied().unwrap_or(usize::MAX), b.0.get(q).copied().unwrap_or(usize::MAX));
        let of_a = if i <= j { Some(a.1[p]) } else { None };
        let of_b = if j <= i { Some(s * b.1[q]) } else { None };
        push(i.min(j), of_a.unwrap_or(0.0) + of_b.unwrap_or(0.0));
        p += usize::from(of_a.is_some());
        q += usize::from(of_b.is_some());
    }
}

/// Submatrix with the given rows and columns, in the given order.
///
/// ```
/// use nlmodes_linalg::{select, sparse_from_triplets};
/// let a = sparse_from_triplets(3, 3, &[(0, 0, 1.0), (1, 2, 2.0), (2, 2, 3.0)])?;
/// let b = select(&a, &[2, 1], &[2])?;
/// assert_eq!((b.nrows(), b.ncols(), b[(0, 0)], b[(1, 0)]), (2, 1, 3.0, 2.0));
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError::Dimension`] for an index outside the matrix.
pub fn select(a: &SparseMatrix, rows: &[usize], columns: &[usize]) -> Result<SparseMatrix, LinalgError> {
    let below = |what, indices: &[usize], expected| match indices.iter().find(|&&i| i >= expected) {
        Some(&found) => Err(LinalgError::Dimension { what, expected, found }),
        None => Ok(()),
    };
    below("selected row", rows, a.nrows())?;
    below("selected column", columns, a.ncols())?;
    // A row that is selected twice appears twice, so that each old row has a list of new ones.
    let mut places = vec![Vec::new(); a.nrows()];
    rows.iter().enumerate().for_each(|(new, &old)| places[old].push(new));
    let mut entries = Vec::new();
    for (new_j, &j) in columns.iter().enumerate() {
        for (&i, &v) in a.symbolic().row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
            entries.extend(places[i].iter().map(|&new_i| (new_i, new_j, v)));
        }
    }
    sparse_from_triplets(rows.len(), columns.len(), &entries)
}

/// The first entry that differs from its mirror image by more than rounding explains, as
/// `(row, column, a_ij, a_ji)`; none if `a` is symmetric.
///
/// The difference is measured against `√|a_ii a_jj|` and against the entries themselves, `1e-10` of the larger: a scale
/// that does not mix the units of displacements and rotations.
pub fn asymmetry(a: &SparseMatrix) -> Option<(usize, usize, f64, f64)> {
    let diagonal =
        |k: usize| if k < a.nrows().min(a.ncols()) { a.get(k, k).copied().unwrap_or(0.0).abs() } else { 0.0 };
    let diagonal: Vec<f64> = (0..a.nrows().max(a.ncols())).map(diagonal).collect();
    // Row `j` of column `i` is looked for with `j` ascending, so that one pass through each column finds all mirror
    // images.
    let mut next = vec![0; a.ncols()];
    triplets(a).find_map(|(i, j, v)| {
        let mirrored = if i < a.ncols() && j < a.nrows() { entry_at(a, i, j, &mut next[i]) } else { 0.0 };
        let scale = (diagonal[i] * diagonal[j]).sqrt().max(v.abs()).max(mirrored.abs());
        ((v - mirrored).abs() > 1e-10 * scale).then_some((i, j, v, mirrored))
    })
}

/// The entry in `row` of `column`, searched from entry `next` of the column on.
fn entry_at(a: &SparseMatrix, column: usize, row: usize, next: &mut usize) -> f64 {
    let rows = a.symbolic().row_idx_of_col_raw(column);
    while rows.get(*next).is_some_and(|&r| r < row) {
        *next += 1;
    }
    if rows.get(*next) == Some(&row) { a.val_of_col(column)[*next] } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> SparseMatrix {
        sparse_from_triplets(3, 2, &[(0, 0, 1.0), (2, 0, -2.0), (1, 1, 4.0), (1, 1, 1.0)]).unwrap()
    }

    #[test]
    fn entries_at_one_place_are_added() {
        assert_eq!(triplets(&sample()).collect::<Vec<_>>(), [(0, 0, 1.0), (2, 0, -2.0), (1, 1, 5.0)]);
    }

    #[test]
    fn bad_entries_are_refused_with_their_index() {
        let row = sparse_from_triplets(2, 2, &[(5, 1, 1.0)]).unwrap_err();
        assert_eq!(row, LinalgError::Dimension { what: "row index of a matrix entry", expected: 2, found: 5 });
        let column = sparse_from_triplets(2, 2, &[(1, 7, 1.0)]).unwrap_err();
        assert_eq!(column, LinalgError::Dimension { what: "column index of a matrix entry", expected: 2, found: 7 });
        assert!(matches!(sparse_from_triplets(1, 1, &[(0, 0, f64::NAN)]), Err(LinalgError::NotFinite { .. })));
    }

    #[test]
    fn product_and_sum_agree_with_hand_calculation() {
        assert_eq!(multiply(&sample(), &[2.0, 3.0]), [2.0, 15.0, -4.0]);
        assert_eq!(bilinear(&[1.0, 1.0, 1.0], &sample(), &[2.0, 3.0]), 13.0);
        let sum = add_scaled(&sample(), 0.5, &sample()).unwrap();
        assert_eq!(triplets(&sum).map(|t| t.2).collect::<Vec<_>>(), [1.5, -3.0, 7.5]);
    }

    #[test]
    fn the_largest_number_counts_whatever_its_sign_and_its_size() {
        assert_eq!((max_norm([1e-9, -3e-9, 2e-9]), max_norm([-0.5, 7.0]), max_norm([])), (3e-9, 7.0, 0.0));
    }

    #[test]
    fn sums_of_different_patterns_have_the_entries_of_both() {
        let b = sparse_from_triplets(2, 1, &[(1, 0, 3.0)]).unwrap();
        let sum = add_scaled(&sample(), 2.0, &b).unwrap();
        assert_eq!(triplets(&sum).collect::<Vec<_>>(), [(0, 0, 1.0), (1, 0, 6.0), (2, 0, -2.0), (1, 1, 5.0)]);
        assert!(matches!(add_scaled(&b, 1.0, &sample()), Err(LinalgError::Dimension { expected: 2, found: 3, .. })));
        assert!(matches!(add_scaled(&b, f64::NAN, &b), Err(LinalgError::NotFinite { .. })));
    }

    #[test]
    fn many_columns_are_multiplied_as_one_is() {
        let x = |columns: usize| Mat::from_fn(2, columns, |i, j| (i + 3 * j) as f64 - 4.0);
        for columns in [0, 1, 2, 3, 8, 9, 10, 11, 17] {
            let product = multiply_many(&sample(), &x(columns));
            assert_eq!((product.nrows(), product.ncols()), (3, columns));
            for j in 0..columns {
                let y = multiply(&sample(), &[x(columns)[(0, j)], x(columns)[(1, j)]]);
                assert!((0..3).all(|i| product[(i, j)] == y[i]));
            }
        }
    }

    #[test]
    fn selection_keeps_the_asked_order_and_refuses_what_is_outside() {
        let a = select(&sample(), &[2, 0], &[1, 0]).unwrap();
        assert_eq!(triplets(&a).collect::<Vec<_>>(), [(0, 1, -2.0), (1, 1, 1.0)]);
        assert!(matches!(select(&sample(), &[3], &[0]), Err(LinalgError::Dimension { expected: 3, found: 3, .. })));
        assert!(matches!(select(&sample(), &[0], &[2]), Err(LinalgError::Dimension { expected: 2, found: 2, .. })));
    }

    #[test]
    fn asymmetry_is_measured_against_the_diagonal() {
        let near = 1e3 + 1e-9;
        let a = sparse_from_triplets(2, 2, &[(0, 0, 1e6), (0, 1, 1e3), (1, 0, near), (1, 1, 2.0)]).unwrap();
        assert_eq!(asymmetry(&a), None);
        let b = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 0, 1e-3), (1, 1, 1.0)]).unwrap();
        assert_eq!(asymmetry(&b), Some((1, 0, 1e-3, 0.0)));
    }
}
