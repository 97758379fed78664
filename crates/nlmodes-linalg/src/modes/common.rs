//! Motions that neither of the two matrices feels.

use super::openness::Known;
use super::written::{Entries, Written};
use super::{FEW, Modes, Pencil, diagonal};
use crate::{LinalgError, Mat, SparseCholesky, SparseMatrix, add_scaled, multiply_transposed, sparse_from_triplets};

/// Shares of the diagonal that make a matrix definite which rounding has left without that, the smallest first.
const LIFTS: [f64; 5] = [1e-12, 1e-10, 1e-8, 1e-6, 1e-4];

/// A direction that such a motion moves by less than this share of its length is not felt.
const UNFELT: f64 = 1e-6;

/// Motions with neither stiffness nor mass, as far as the digits of the matrices tell: `K z = 0` and `M z = 0`.
///
/// Elements with too few points of integration have them (hourglass motions), for stiffness and mass are both sums over
/// these points.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CommonMotions {
    /// The motions `z`, one a column (n × motions).
    pub shapes: Mat<f64>,
    /// As many rows as there are motions; holding these leaves none of them.
    pub rows: Vec<usize>,
    /// What the rows weigh; the motions are orthonormal by it.
    weight: Vec<f64>,
}

impl CommonMotions {
    /// Those of the pencil of `stiffness` and `mass`, as far as what was written tells.
    ///
    /// `K + sM` with an `s` that weighs both, over its own diagonal, has them as eigenvectors with eigenvalues that are
    /// not distinguished from zero.
    ///
    /// # Errors
    /// As [`Pencil::new`].
    pub fn of(stiffness: &SparseMatrix, mass: &SparseMatrix, written: &Written) -> Result<Self, LinalgError> {
        let shift = Known::new(stiffness, mass, written).mean_shift();
        let (sum, origin) = (add_scaled(stiffness, shift, mass)?, written.origin_of_sum(shift)?);
        let weight = diagonal_of(&sum)?;
        let shapes = null_space(written.sum(&sum, origin.as_ref()), &weight)?;
        let weight: Vec<f64> = (0..sum.nrows()).map(|i| diagonal(&weight, i)).collect();
        Ok(Self { rows: rows(&shapes, &weight), shapes, weight })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The stiffness with springs to the ground at [`rows`](Self::rows): all that is asked of the pencil but these
    /// motions stays as it was, since each motion has one that differs by them alone and leaves these rows at rest.
    ///
    /// # Errors
    /// [`LinalgError::OutOfMemory`].
    pub fn held(&self, stiffness: &SparseMatrix) -> Result<SparseMatrix, LinalgError> {
        let springs: Vec<_> = self.rows.iter().map(|&i| (i, i, diagonal(stiffness, i))).collect();
        add_scaled(stiffness, 1.0, &sparse_from_triplets(stiffness.nrows(), stiffness.ncols(), &springs)?)
    }

    /// Takes their share out of each column, in the mean square by the weights of the rows.
    pub fn take_out_of(&self, vectors: &mut Mat<f64>) {
        let weighted = Mat::from_fn(vectors.nrows(), vectors.ncols(), |i, j| self.weight[i] * vectors[(i, j)]);
        let share = self.shapes.transpose() * weighted;
        *vectors -= &self.shapes * share;
    }

    /// The first of these directions (n × any) that is moved, in a motion in which no row moves more than by one.
    pub fn felt_by(&self, directions: &SparseMatrix) -> Option<usize> {
        let seen = multiply_transposed(directions, &self.shapes);
        let largest = |z: usize| self.shapes.col(z).iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let length = |i: usize| directions.val_of_col(i).iter().map(|v| v * v).sum::<f64>().sqrt();
        (0..directions.ncols()).find(|&i| (0..self.len()).any(|z| seen[(i, z)].abs() > UNFELT * length(i) * largest(z)))
    }
}

/// That there are such motions, if there are.
pub(super) fn refuse(
    stiffness: &SparseMatrix,
    mass: &SparseMatrix,
    written: &Written,
) -> Result<Option<LinalgError>, LinalgError> {
    let motions = CommonMotions::of(stiffness, mass, written)?.len();
    Ok((motions > 0).then_some(LinalgError::NeitherStiffnessNorMass { motions }))
}

/// Whether a matrix with this factor may be singular but for its last digits; the factor comes back.
pub(super) fn nearly_singular(a: Entries<'_>, factor: SparseCholesky) -> Result<(bool, SparseCholesky), LinalgError> {
    let weight = diagonal_of(a.matrix)?;
    let pencil = Pencil { stiffness: a.matrix, mass: &weight, shift: 0.0, factor, written: None };
    let known = Known { stiffness: a, mass: Entries::exact(&weight) };
    // Where the iteration does not end, no eigenvalue is so much smaller than the others that it could be zero.
    let suspect = pencil.solve(1).is_ok_and(|lowest| !lowest.eigenvalues.is_empty() && known.is_suspect(&lowest, 0));
    Ok((suspect, pencil.into_factor()))
}

/// Vectors with `A z = 0`, as far as the digits tell, orthonormal by `weight`.
fn null_space(entries: Entries<'_>, weight: &SparseMatrix) -> Result<Mat<f64>, LinalgError> {
    let a = entries.matrix;
    let (mut lifted, mut lift) = (add_scaled(a, LIFTS[0], weight)?, LIFTS[0]);
    let mut factor = SparseCholesky::factor(&lifted, "weighted stiffness matrix");
    for next in LIFTS.into_iter().skip(1) {
        if factor.is_err() {
            (lifted, lift) = (add_scaled(a, next, weight)?, next);
            factor = SparseCholesky::factor(&lifted, "weighted stiffness matrix");
        }
    }
    let pencil = Pencil { stiffness: &lifted, mass: weight, shift: 0.0, factor: factor?, written: None };
    let known = Known { stiffness: entries, mass: Entries::exact(weight) };
    let mut count = FEW;
    loop {
        let lifted = pencil.solve(count.min(a.nrows()))?;
        let eigenvalues = lifted.eigenvalues.iter().map(|value| value - lift).collect();
        let modes = Modes { eigenvalues, vectors: lifted.vectors };
        let found = known.openness(&modes).strainless;
        if found < modes.eigenvalues.len() || modes.eigenvalues.len() < count {
            return Ok(modes.vectors.subcols(0, found).to_owned());
        }
        count *= 2;
    }
}

fn diagonal_of(a: &SparseMatrix) -> Result<SparseMatrix, LinalgError> {
    let entries: Vec<_> = (0..a.nrows()).map(|i| (i, i, diagonal(a, i))).collect();
    sparse_from_triplets(a.nrows(), a.ncols(), &entries)
}

/// Rows that determine the combination of the columns, by elimination with the largest pivot each time.
fn rows(shapes: &Mat<f64>, weight: &[f64]) -> Vec<usize> {
    let mut left = Mat::from_fn(shapes.nrows(), shapes.ncols(), |i, j| shapes[(i, j)] * weight[i].sqrt());
    let mut rows = Vec::new();
    for step in 0..left.ncols() {
        let entries = (0..left.nrows()).flat_map(|i| (step..left.ncols()).map(move |j| (i, j)));
        let Some((row, column)) = entries.max_by(|a, b| left[*a].abs().total_cmp(&left[*b].abs())) else { break };
        for i in 0..left.nrows() {
            (left[(i, step)], left[(i, column)]) = (left[(i, column)], left[(i, step)]);
        }
        for j in step + 1..left.ncols() {
            let factor = left[(row, j)] / left[(row, step)];
            (0..left.nrows()).for_each(|i| left[(i, j)] -= factor * left[(i, step)]);
        }
        rows.push(row);
    }
    rows
}
