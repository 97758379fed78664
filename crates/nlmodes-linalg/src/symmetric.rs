use faer::Side;

use crate::{LinalgError, Mat};

/// Eigenvalues, ascending, and orthonormal eigenvectors (columns) of a dense symmetric matrix; the lower triangle is read.
///
/// # Errors
/// [`LinalgError::Dimension`] if `a` is not square, [`LinalgError::NotFinite`], or [`LinalgError::ModesNotConverged`].
pub fn symmetric_eigen(a: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), LinalgError> {
    let n = a.nrows();
    if a.ncols() != n {
        return Err(LinalgError::Dimension { what: "columns of a symmetric matrix", expected: n, found: a.ncols() });
    }
    if !a.is_all_finite() {
        return Err(LinalgError::NotFinite { what: "symmetric matrix" });
    }
    let failed = |_| LinalgError::ModesNotConverged { wanted: n, converged: 0, iterations: 0 };
    let eigen = a.self_adjoint_eigen(Side::Lower).map_err(failed)?;
    Ok((eigen.S().column_vector().iter().copied().collect(), eigen.U().to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotated_diagonal_is_found_again() {
        let (c, s) = (0.6, 0.8);
        let a =
            Mat::from_fn(2, 2, |i, j| [[c * c + 4.0 * s * s, -3.0 * c * s], [-3.0 * c * s, s * s + 4.0 * c * c]][i][j]);
        let (values, vectors) = symmetric_eigen(&a).unwrap();
        assert!((values[0] - 1.0).abs() < 1e-14 && (values[1] - 4.0).abs() < 1e-14);
        assert!(
            (vectors[(0, 0)] * s - vectors[(1, 0)] * -c).abs() < 1e-14
                || (vectors[(0, 0)] * s - vectors[(1, 0)] * c).abs() < 1e-14
        );
        assert!(matches!(symmetric_eigen(&Mat::zeros(2, 3)), Err(LinalgError::Dimension { .. })));
    }
}
