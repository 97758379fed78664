use faer::Side;

use crate::{LinalgError, Mat, max_norm};

/// Eigenvalues, ascending, and orthonormal eigenvectors (columns) of a dense symmetric matrix; the lower triangle is
/// read.
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
    // The solver below subtracts one from the size.
    if n == 0 {
        return Ok((Vec::new(), Mat::zeros(0, 0)));
    }
    let scale = scale(a);
    let scaled = Mat::from_fn(n, n, |i, j| scale * a[(i, j)]);
    let failed = |_| LinalgError::ModesNotConverged { wanted: n, converged: 0, iterations: 0 };
    let eigen = scaled.self_adjoint_eigen(Side::Lower).map_err(failed)?;
    Ok((eigen.S().column_vector().iter().map(|value| value / scale).collect(), eigen.U().to_owned()))
}

/// A power of two that scales the largest entry to order one: the iteration neglects values relative to one, whatever
/// the units.
fn scale(a: &Mat<f64>) -> f64 {
    let largest = max_norm((0..a.ncols()).flat_map(|j| a.col(j).iter().copied()));
    if largest > 0.0 { 2f64.powf(-largest.log2().floor().clamp(-1000.0, 1000.0)) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_without_rows_has_no_eigenvalues() {
        let (values, vectors) = symmetric_eigen(&Mat::zeros(0, 0)).unwrap();
        assert!(values.is_empty() && vectors.ncols() == 0);
    }

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

    #[test]
    fn small_and_large_matrices_are_as_accurate_as_those_near_one() {
        // A chain of n masses between walls: λ = 4 sin²(r π / (2n + 2)).
        let n = 200;
        for size in [1.0, 1e-19, 3e-140, 7e120] {
            let a = Mat::from_fn(n, n, |i, j| size * [2.0, -1.0].get(i.abs_diff(j)).copied().unwrap_or(0.0));
            let (values, vectors) = symmetric_eigen(&a).unwrap();
            for (r, value) in values.iter().enumerate() {
                let angle = (r + 1) as f64 * std::f64::consts::PI / (2 * n + 2) as f64;
                assert!((value / size - 4.0 * angle.sin().powi(2)).abs() < 1e-13, "{size:e}, {r}: {value:e}");
                let rest = &a * vectors.col(r) - *value * vectors.col(r);
                assert!(rest.iter().all(|v| (v / size).abs() < 1e-13), "{size:e}, {r}");
            }
        }
    }
}
