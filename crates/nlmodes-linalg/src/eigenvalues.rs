use num_complex::Complex64;

use crate::{LinalgError, Mat};

/// Eigenvalues of a dense square matrix, in no particular order.
///
/// ```
/// use nlmodes_linalg::{Mat, eigenvalues};
/// // A quarter turn.
/// let a = Mat::from_fn(2, 2, |i, j| [[0.0, -1.0], [1.0, 0.0]][i][j]);
/// assert!(eigenvalues(&a)?.iter().all(|μ| μ.re.abs() < 1e-15 && (μ.im.abs() - 1.0).abs() < 1e-15));
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError::Dimension`] if `a` is not square, [`LinalgError::NotFinite`], or [`LinalgError::ModesNotConverged`].
pub fn eigenvalues(a: &Mat<f64>) -> Result<Vec<Complex64>, LinalgError> {
    let n = a.nrows();
    if a.ncols() != n {
        return Err(LinalgError::Dimension { what: "columns of a square matrix", expected: n, found: a.ncols() });
    }
    if !a.is_all_finite() {
        return Err(LinalgError::NotFinite { what: "matrix whose eigenvalues are wanted" });
    }
    if n == 0 {
        return Ok(Vec::new());
    }
    a.eigenvalues().map_err(|_| LinalgError::ModesNotConverged { wanted: n, converged: 0, iterations: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_companion_matrix_has_the_roots_of_its_polynomial() {
        // (x − 1)(x − 2)(x² + 4) = x⁴ − 3 x³ + 6 x² − 12 x + 8
        let last = [-8.0, 12.0, -6.0, 3.0];
        let a = Mat::from_fn(4, 4, |i, j| if j == 3 { last[i] } else { f64::from(u8::from(i == j + 1)) });
        let mut found = eigenvalues(&a).unwrap();
        found.sort_by(|a, b| (a.re, a.im).partial_cmp(&(b.re, b.im)).unwrap());
        for root in [(1.0, 0.0), (2.0, 0.0), (0.0, 2.0), (0.0, -2.0)] {
            assert!(found.iter().any(|μ| (μ.re - root.0).hypot(μ.im - root.1) < 1e-12), "{root:?} in {found:?}");
        }
        assert!(matches!(eigenvalues(&Mat::zeros(2, 3)), Err(LinalgError::Dimension { .. })));
    }
}
