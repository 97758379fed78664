//! Small pencils: reduction to a standard eigenproblem by a dense Cholesky factor.

use faer::linalg::solvers::LltError;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Par, Side};

use super::{Pencil, diagonal};
use crate::{LinalgError, Mat, add_scaled, multiply_many, symmetric_eigen};

/// Mass of a motion, over the largest that its length may have, which is rounding: of the digits with which a mass is
/// written at best.
const WEIGHTLESS: f64 = 1e-12;

/// With `K + sM = L Lᵀ`: the `count` largest eigenvalues of `L⁻¹ M L⁻ᵀ`, whose eigenvectors `u` give `φ = L⁻ᵀ u`. A
/// singular `M` has zero eigenvalues there, which are ignored, and whatever their diagonal left out if they are zero
/// but for rounding: such a vector has no mass by which it could be distinguished from the others, and would be mixed
/// into them. A few vectors more than requested are returned: rounding
/// mixes neighbouring high modes, which must not be missed at the edge of the space.
pub(super) fn invariant_subspace(pencil: &Pencil, count: usize) -> Result<Mat<f64>, LinalgError> {
    let n = pencil.mass.nrows();
    let rank = (0..n).filter(|&i| diagonal(pencil.mass, i) > 0.0).count();
    let kept = rank.min(count + count / 4 + 8);
    let k = add_scaled(pencil.stiffness, pencil.shift, pencil.mass)?.to_dense();
    let llt = k.llt(Side::Lower).map_err(|LltError::NonPositivePivot { index }| LinalgError::NotPositiveDefinite {
        what: "shifted stiffness matrix",
        column: index,
    })?;
    let l = llt.L();
    let mut c = pencil.mass.to_dense();
    solve_lower_triangular_in_place(l, c.as_mut(), Par::Seq);
    solve_lower_triangular_in_place(l, c.as_mut().transpose_mut(), Par::Seq);
    let (_, eigenvectors) = symmetric_eigen(&c)?;
    let mut vectors = Mat::from_fn(n, kept, |i, j| eigenvectors[(i, n - 1 - j)]);
    solve_upper_triangular_in_place(l.transpose(), vectors.as_mut(), Par::Seq);
    // Of these vectors themselves: the eigenvalues of motions without mass are rounding of the largest ones.
    let heaviest = (0..n).map(|i| diagonal(pencil.mass, i)).fold(0.0, f64::max);
    let carried = multiply_many(pencil.mass, &vectors);
    let weighs = |j: &usize| {
        let mass = vectors.col(*j).transpose() * carried.col(*j);
        mass > WEIGHTLESS * heaviest * vectors.col(*j).squared_norm_l2()
    };
    let heavy: Vec<usize> = (0..kept).filter(weighs).collect();
    Ok(Mat::from_fn(n, heavy.len(), |i, j| vectors[(i, heavy[j])]))
}
