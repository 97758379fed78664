//! Last digits: modes from a nearly invariant subspace, by the quotient of the inverse.

use super::{Modes, Pencil};
use crate::{LinalgError, Mat, multiply, multiply_many};

/// Off-diagonal entries below this share of their diagonal are rounding.
const NEGLIGIBLE: f64 = 2.0 * f64::EPSILON;

const MOST_SWEEPS: usize = 40;

/// The lowest `count` modes of the pencil in the space of the columns of `x`, which come in the order of ascending λ.
///
/// `G = (MX)ᵀ (K + sM)⁻¹ (MX)` with M-orthonormal `X` is nearly diagonal, with entries of very different size. Jacobi rotations
/// respect that: each of its eigenvalues `θ = 1/(λ + s)` comes out with a small relative error.
pub(super) fn rayleigh_ritz(pencil: &Pencil, mut x: Mat<f64>, count: usize) -> Result<Modes, LinalgError> {
    orthonormalise(pencil, &mut x);
    let mass_x = multiply_many(pencil.mass, &x);
    let mut y = mass_x.clone();
    pencil.factor.solve_many(&mut y);
    let mut g = mass_x.transpose() * &y;
    let rotation = diagonalise(&mut g);
    let rotated = &x * &rotation;
    let mut order: Vec<usize> = (0..g.nrows()).filter(|&i| g[(i, i)] > 0.0).collect();
    order.sort_by(|&i, &j| g[(j, j)].total_cmp(&g[(i, i)]));
    order.truncate(count);
    let eigenvalues = order.iter().map(|&i| (1.0 / g[(i, i)] - pencil.shift).max(0.0)).collect();
    let vectors = Mat::from_fn(rotated.nrows(), order.len(), |i, j| rotated[(i, order[j])]);
    Ok(Modes { eigenvalues, vectors })
}

/// Gram-Schmidt in the inner product of `M`, twice, from the lowest mode on: it is the high ones that carry traces of the low.
fn orthonormalise(pencil: &Pencil, x: &mut Mat<f64>) {
    for j in 0..x.ncols() {
        for _ in 0..2 {
            let (done, mut rest) = x.as_mut().split_at_col_mut(j);
            let mut v = rest.as_mut().col_mut(0);
            let current: Vec<f64> = v.as_ref().iter().copied().collect();
            let mv = multiply(pencil.mass, &current);
            let norm = current.iter().zip(&mv).map(|(v, mv)| v * mv).sum::<f64>().sqrt();
            let overlap = done.as_ref().transpose() * faer::ColRef::from_slice(&mv);
            v -= done.as_ref() * overlap;
            v *= if norm > 0.0 { 1.0 / norm } else { 0.0 };
        }
    }
    // What was taken away shortened the vectors by rounding only; the second pass has normalised them.
}

/// Cyclic Jacobi iteration: makes the symmetric `g` diagonal and returns the product of the rotations.
fn diagonalise(matrix: &mut Mat<f64>) -> Mat<f64> {
    let n = matrix.nrows();
    let mut g: Vec<Vec<f64>> = (0..n).map(|j| matrix.col(j).iter().copied().collect()).collect();
    let mut product: Vec<Vec<f64>> = (0..n).map(|j| (0..n).map(|i| f64::from(i == j)).collect()).collect();
    for _ in 0..MOST_SWEEPS {
        let mut quiet = true;
        for (p, q) in (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q))) {
            let off = 0.5 * (g[q][p] + g[p][q]);
            if off.abs() > NEGLIGIBLE * (g[p][p] * g[q][q]).abs().sqrt() {
                let (cos, sin) = rotation(g[p][p], off, g[q][q]);
                rotate_columns(&mut g, p, q, cos, sin);
                rotate_rows(&mut g, p, q, cos, sin);
                rotate_columns(&mut product, p, q, cos, sin);
                quiet = false;
            }
        }
        if quiet {
            break;
        }
    }
    *matrix = Mat::from_fn(n, n, |i, j| g[j][i]);
    Mat::from_fn(n, n, |i, j| product[j][i])
}

/// Cosine and sine that make `[a b; b d]` diagonal, of the smaller of the two angles.
fn rotation(a: f64, b: f64, d: f64) -> (f64, f64) {
    let slope = (d - a) / (2.0 * b);
    let tangent = slope.signum() / (slope.abs() + slope.hypot(1.0));
    let cos = 1.0 / tangent.hypot(1.0);
    (cos, cos * tangent)
}

/// Of a matrix that is given by its columns, `p` before `q`.
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
