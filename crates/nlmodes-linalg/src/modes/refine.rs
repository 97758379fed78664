//! Refinement of modes from a nearly invariant subspace, by the quotient of the inverse.

use faer::linalg::solvers::LltError;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Par, Side};

use super::operator::Operator;
use crate::Mat;

/// Off-diagonal entries below this fraction of their diagonal are rounding errors.
const NEGLIGIBLE: f64 = 2.0 * f64::EPSILON;

/// Off-diagonal entries below this fraction of their diagonal entries, and of the difference of these, are removed by
/// one simultaneous first-order correction, whose remainder is of second order.
const SMALL: f64 = 1e-8;

const MOST_SWEEPS: usize = 40;

/// A vector of which less than this fraction remains after orthogonalisation is orthogonalised column by column.
const DEPENDENT: f64 = 1e-3;
/// The same applies if `φᵀMφ` is below this fraction of the largest possible for its length: it may be rounding.
const WEIGHTLESS: f64 = 1e-10;

/// The lowest `count` λ of the pencil in the space of the columns of `x`, which are in the order of ascending λ, and
/// their modes; rows in the order of elimination.
///
/// `G = (MX)ᵀ (K + sM)⁻¹ (MX) = Zᵀ Z`, `Z = L⁻¹ M X`, with M-orthonormal `X` is nearly diagonal, with entries of very
/// different size. Jacobi rotations, and first-order corrections for small angles, preserve this: each of its
/// eigenvalues `θ = 1/(λ + s)` has a small relative error.
pub(super) fn rayleigh_ritz(operator: &Operator, mut x: Mat<f64>, count: usize, shift: f64) -> (Vec<f64>, Mat<f64>) {
    let mut z = orthonormalise(operator, &mut x);
    operator.forward(&mut z);
    let mut g = z.transpose() * &z;
    drop(z);
    let rotation = diagonalise(&mut g);
    let mut order: Vec<usize> = (0..g.nrows()).filter(|&i| g[(i, i)] > 0.0).collect();
    order.sort_by(|&i, &j| g[(j, j)].total_cmp(&g[(i, i)]));
    order.truncate(count);
    let eigenvalues = order.iter().map(|&i| (1.0 / g[(i, i)] - shift).max(0.0)).collect();
    let rotation = Mat::from_fn(rotation.nrows(), order.len(), |i, j| rotation[(i, order[j])]);
    (eigenvalues, x * rotation)
}

/// Makes the columns M-orthonormal, from the lowest mode on, since the high modes contain traces of the low ones.
/// Returns `M X`.
fn orthonormalise(operator: &Operator, x: &mut Mat<f64>) -> Mat<f64> {
    let (mut mass_x, heaviest) = (x.clone(), operator.heaviest());
    operator.multiply(mass_x.as_mut());
    // The first pass removes the components, the second the rounding errors.
    for _ in 0..2 {
        let Some(r) = triangular(&*x, &mass_x, heaviest) else {
            one_by_one(operator, x);
            mass_x.copy_from(&*x);
            operator.multiply(mass_x.as_mut());
            return mass_x;
        };
        for columns in [&mut *x, &mut mass_x] {
            solve_lower_triangular_in_place(r.as_ref(), columns.as_mut().transpose_mut(), Par::Seq);
        }
    }
    mass_x
}

/// `Rᵀ` of `Xᵀ M X = Rᵀ R`; `None` if a column is nearly a combination of previous ones, or has hardly any mass.
fn triangular(x: &Mat<f64>, mass_x: &Mat<f64>, heaviest: f64) -> Option<Mat<f64>> {
    let gram = x.transpose() * mass_x;
    let heavy = |j: usize| gram[(j, j)] > WEIGHTLESS * heaviest * x.col(j).squared_norm_l2();
    if !(0..x.ncols()).all(heavy) {
        return None;
    }
    let length: Vec<f64> = (0..gram.nrows()).map(|j| gram[(j, j)].sqrt()).collect();
    let scaled = Mat::from_fn(gram.nrows(), gram.ncols(), |i, j| gram[(i, j)] / (length[i] * length[j]));
    let factor = scaled.llt(Side::Lower).map_err(|LltError::NonPositivePivot { .. }| ()).ok()?;
    let l = factor.L();
    let independent = (0..l.nrows()).all(|j| l[(j, j)] > DEPENDENT);
    independent.then(|| Mat::from_fn(l.nrows(), l.ncols(), |i, j| if i < j { 0.0 } else { length[i] * l[(i, j)] }))
}

/// Gram-Schmidt in the inner product of `M`, twice.
fn one_by_one(operator: &Operator, x: &mut Mat<f64>) {
    for j in 0..x.ncols() {
        for _ in 0..2 {
            let (done, mut rest) = x.as_mut().split_at_col_mut(j);
            let mut v = rest.as_mut().col_mut(0);
            let mut mv = v.as_ref().as_mat().to_owned();
            operator.multiply(mv.as_mut());
            let norm = (v.as_ref().transpose() * mv.col(0)).sqrt();
            let overlap = done.as_ref().transpose() * mv.col(0);
            v -= done.as_ref() * overlap;
            v *= if norm > 0.0 { 1.0 / norm } else { 0.0 };
        }
    }
    // The removed components shortened the vectors by rounding only; the second pass has normalised them.
}

/// Makes the symmetric `g` diagonal and returns the matrix of its eigenvectors.
fn diagonalise(matrix: &mut Mat<f64>) -> Mat<f64> {
    let n = matrix.nrows();
    let mut g: Vec<Vec<f64>> = (0..n).map(|j| matrix.col(j).iter().copied().collect()).collect();
    let mut product: Vec<Vec<f64>> = (0..n).map(|j| (0..n).map(|i| f64::from(i == j)).collect()).collect();
    let turned = rotate(&mut g, &mut product);
    let diagonal: Vec<f64> = (0..n).map(|i| g[i][i]).collect();
    let mut values = diagonal.clone();
    let mut correction = Mat::identity(n, n);
    for (p, q) in (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q))) {
        let off = 0.5 * (g[q][p] + g[p][q]);
        if off.abs() > NEGLIGIBLE * (diagonal[p] * diagonal[q]).abs().sqrt() {
            let angle = off / (diagonal[q] - diagonal[p]);
            (correction[(p, q)], correction[(q, p)]) = (angle, -angle);
            (values[p], values[q]) = (values[p] - angle * off, values[q] + angle * off);
        }
    }
    *matrix = Mat::from_fn(n, n, |i, j| if i == j { values[i] } else { 0.0 });
    if turned { Mat::from_fn(n, n, |i, j| product[j][i]) * correction } else { correction }
}

/// Cyclic Jacobi iteration, until all off-diagonal entries are small; the rotations are accumulated in `product`.
/// Returns whether there were any.
fn rotate(g: &mut [Vec<f64>], product: &mut [Vec<f64>]) -> bool {
    let n = g.len();
    for sweep in 0..MOST_SWEEPS {
        let mut quiet = true;
        for (p, q) in (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q))) {
            let off = 0.5 * (g[q][p] + g[p][q]);
            let size = (g[p][p] * g[q][q]).abs().sqrt();
            if off.abs() > (SMALL * size.min((g[p][p] - g[q][q]).abs())).max(NEGLIGIBLE * size) {
                let (cos, sin) = rotation(g[p][p], off, g[q][q]);
                rotate_columns(g, p, q, cos, sin);
                rotate_rows(g, p, q, cos, sin);
                rotate_columns(product, p, q, cos, sin);
                quiet = false;
            }
        }
        if quiet {
            return sweep > 0;
        }
    }
    true
}

/// Cosine and sine that make `[a b; b d]` diagonal, of the smaller of the two angles.
fn rotation(a: f64, b: f64, d: f64) -> (f64, f64) {
    let slope = (d - a) / (2.0 * b);
    let tangent = slope.signum() / (slope.abs() + slope.hypot(1.0));
    let cos = 1.0 / tangent.hypot(1.0);
    (cos, cos * tangent)
}

/// For a matrix given by its columns, `p` before `q`.
fn rotate_columns(a: &mut [Vec<f64>], p: usize, q: usize, cos: f64, sin: f64) {
    let (before, behind) = a.split_at_mut(q);
    for (u, v) in before[p].iter_mut().zip(&mut behind[0]) {
        (*u, *v) = (cos * *u - sin * *v, sin * *u + cos * *v);
    }
}

fn rotate_rows(a: &mut [Vec<f64>], p: usize, q: usize, cos: f64, sin: f64) {
    for column in a {
        let (u, v) = (column[p], column[q]);
        (column[p], column[q]) = (cos * u - sin * v, sin * u + cos * v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jacobi_rotations_keep_the_relative_accuracy_of_graded_matrices() {
        let scale = [1.0, 1e-4, 1e-9];
        let mut g = Mat::from_fn(3, 3, |i, j| scale[i] * scale[j] * if i == j { 1.0 } else { 0.1 });
        let rotations = diagonalise(&mut g);
        // Leading minors of the scaled matrix give the eigenvalues up to the square of the ratio of the scales.
        let minors = [1.0, 0.99, 1.0 + 2e-3 - 3e-2];
        assert!((g[(1, 1)] / (1e-8 * minors[1] / minors[0]) - 1.0).abs() < 1e-8);
        assert!((g[(2, 2)] / (1e-18 * minors[2] / minors[1]) - 1.0).abs() < 1e-9);
        let product = rotations.transpose() * &rotations;
        assert!((0..3).all(|i| (0..3).all(|j| (product[(i, j)] - f64::from(i == j)).abs() < 1e-15)));
    }
}
