use faer::sparse::{SparseColMat, SymbolicSparseColMat};

use crate::{LinalgError, SparseMatrix};

/// A sparse matrix from its compressed columns, without copying them: column `j` has the values `values[p]` in rows
/// `row_indices[p]`, `column_starts[j] ≤ p < column_starts[j + 1]`, rows ascending.
///
/// ```
/// use nlmodes_linalg::sparse_from_columns;
/// let a = sparse_from_columns(3, 2, vec![0, 2, 3], vec![0, 2, 1], vec![1.0, 2.0, 3.0])?;
/// assert_eq!((a[(0, 0)], a[(2, 0)], a[(1, 1)]), (1.0, 2.0, 3.0));
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError::Dimension`] if lengths disagree, column starts descend, a row is outside, or rows do not ascend;
/// [`LinalgError::NotFinite`].
pub fn sparse_from_columns(
    rows: usize,
    columns: usize,
    column_starts: Vec<usize>,
    row_indices: Vec<usize>,
    values: Vec<f64>,
) -> Result<SparseMatrix, LinalgError> {
    let same = |what, expected, found| {
        if expected == found { Ok(()) } else { Err(LinalgError::Dimension { what, expected, found }) }
    };
    same("column starts of a sparse matrix", columns + 1, column_starts.len())?;
    same("first column start of a sparse matrix", 0, column_starts[0])?;
    same("last column start of a sparse matrix", row_indices.len(), column_starts[columns])?;
    same("values of a sparse matrix", row_indices.len(), values.len())?;
    for pair in column_starts.windows(2) {
        if pair[1] < pair[0] || pair[1] > row_indices.len() {
            return Err(LinalgError::Dimension { what: "column start", expected: pair[0], found: pair[1] });
        }
        let column = &row_indices[pair[0]..pair[1]];
        if let Some(two) = column.windows(2).find(|two| two[0] >= two[1]) {
            return Err(LinalgError::Dimension { what: "row after another", expected: two[0] + 1, found: two[1] });
        }
        if let Some(&found) = column.last().filter(|row| **row >= rows) {
            return Err(LinalgError::Dimension { what: "row index of a matrix entry", expected: rows, found });
        }
    }
    if values.iter().any(|value| !value.is_finite()) {
        return Err(LinalgError::NotFinite { what: "list of matrix entries" });
    }
    let symbolic = SymbolicSparseColMat::new_checked(rows, columns, column_starts, None, row_indices);
    Ok(SparseColMat::new(symbolic, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_that_do_not_fit_are_refused() {
        let made = |starts: &[usize], rows: &[usize], values: &[f64]| {
            sparse_from_columns(2, 2, starts.to_vec(), rows.to_vec(), values.to_vec())
        };
        assert!(made(&[0, 1, 2], &[0, 1], &[1.0, 2.0]).is_ok());
        let wrong = [
            made(&[0, 1], &[0], &[1.0]),
            made(&[1, 1, 2], &[0, 1], &[1.0, 2.0]),
            made(&[0, 1, 3], &[0, 1], &[1.0, 2.0]),
            made(&[0, 1, 2], &[0, 1], &[1.0]),
            made(&[0, 2, 1], &[0], &[1.0]),
            made(&[0, 2, 2], &[1, 0], &[1.0, 2.0]),
            made(&[0, 1, 2], &[0, 2], &[1.0, 2.0]),
            made(&[0, 5, 2], &[0, 1], &[1.0, 2.0]),
        ];
        assert!(wrong.iter().all(|r| matches!(r, Err(LinalgError::Dimension { .. }))));
        assert!(matches!(made(&[0, 1, 1], &[0], &[f64::NAN]), Err(LinalgError::NotFinite { .. })));
    }
}
