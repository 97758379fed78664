use std::{ops::Range, sync::Arc};

use nlmodes_linalg::Mat;

use crate::{
    ClosedBlock, LcpError, kernel,
    sample::Sample,
    scaled::Scaled,
    tile::{self, Tile},
};

/// The matrix `A` of a family of contact problems, checked and scaled once.
///
/// Row `i` of `g = A λ + b` is the gap of contact `i`; `A` (c × c, m/N) is the compliance of the body at the contacts,
/// for instance `Wᵀ K_NN⁻¹ W`, eqs. (11) and (13). A stop with the stiffness `k_c` of eq. (3) is the same problem with
/// `1/k_c` added to the diagonal: `g` is then the gap plus the (positive) compression of the stop.
///
/// Cloning is cheap compared with construction: the scaled matrix is shared.
#[derive(Debug, Clone)]
pub struct LcpMatrix {
    a: Mat<f64>,
    scaled: Arc<Scaled>,
}

impl LcpMatrix {
    /// Checks `a` (c × c, m/N): finite, symmetric, positive semidefinite.
    ///
    /// Symmetric means `|A_ij − A_ji| ≤ 1e-10 √(A_ii A_jj)`; the mean of both is used. Positive semidefinite means that
    /// `A + 1e-13 c I` has a Cholesky factor once the diagonal of `A` is scaled to one: singular matrices of redundant
    /// contacts pass, whichever way they are rounded. A contact without compliance must have a row of zeros.
    ///
    /// # Errors
    /// [`LcpError::NotSquare`], [`LcpError::NotFinite`], [`LcpError::NotSymmetric`],
    /// [`LcpError::NotPositiveSemidefinite`], with the offending entry.
    pub fn new(a: &Mat<f64>) -> Result<Self, LcpError> {
        let c = a.nrows();
        if a.ncols() != c {
            return Err(LcpError::NotSquare { rows: c, columns: a.ncols() });
        }
        if (0..c).any(|j| !kernel::all_finite(a.col_as_slice(j))) {
            return Err(LcpError::NotFinite { what: "the contact matrix" });
        }
        let mut mean = a.clone();
        make_symmetric(&mut mean)?;
        let mut scaled = Scaled::new(&mean);
        if !scaled.is_finite() {
            return Err(LcpError::NotFinite { what: "the scaled contact matrix" });
        }
        scaled.check_semidefinite(&mean)?;
        Ok(Self { a: mean, scaled: Arc::new(scaled) })
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.a.nrows()
    }

    /// `A`, c × c, m/N, exactly symmetric.
    pub fn a(&self) -> &Mat<f64> {
        &self.a
    }

    pub(crate) fn scaled(&self) -> &Arc<Scaled> {
        &self.scaled
    }

    /// Derivative `dλ/db` (c × c, N/m) with the contacts of `closed` kept closed and all others open:
    /// `dλ_a = −A_aa⁻¹ db_a`. Where closed contacts are redundant, that of an independent subset.
    ///
    /// The subset is chosen by Cholesky factorisation with diagonal pivoting, to be well conditioned; `dg/db = I + A
    /// dλ/db` does not depend on the choice as long as the gaps of the omitted contacts remain closed. At a degenerate
    /// contact (`g = λ = 0`) open and closed both give a valid generalised derivative.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `closed` has not c entries.
    pub fn sensitivity(&self, closed: &[bool]) -> Result<Mat<f64>, LcpError> {
        let block = self.closed_block(closed)?;
        let mut derivative = Mat::zeros(self.n_contacts(), self.n_contacts());
        let (mut right, mut forces) = (vec![0.0; self.n_contacts()], vec![0.0; self.n_contacts()]);
        for &j in block.contacts() {
            right[j] = 1.0;
            block.forces(&right, &mut forces)?;
            right[j] = 0.0;
            for &i in block.contacts() {
                derivative[(i, j)] = forces[i];
            }
        }
        Ok(derivative)
    }

    /// The factored block `A_aa` of the contacts of `closed`: an independent subset where they are redundant.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `closed` has not c entries.
    pub fn closed_block(&self, closed: &[bool]) -> Result<ClosedBlock, LcpError> {
        self.check_length("closed contacts", closed.len())?;
        Ok(ClosedBlock::new(self.scaled.clone(), closed))
    }

    /// Gaps `g = A λ + b` (c, m) of the forces `lambda` (c, N).
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if one of the slices has not c entries.
    pub fn gaps(&self, b: &[f64], lambda: &[f64], gaps: &mut [f64]) -> Result<(), LcpError> {
        self.check_length("b", b.len())?;
        self.check_length("lambda", lambda.len())?;
        self.check_length("gaps", gaps.len())?;
        gaps.copy_from_slice(b);
        kernel::add_columns(lambda, |j| self.a.col_as_slice(j), gaps);
        Ok(())
    }

    /// The judge: scaled complementarity violation of `lambda` for the right-hand side `b`, computed outside every
    /// solver.
    ///
    /// With `D = diag(A)^-1/2`: `max |min(D⁻¹ λ, D g)| / max |D b|`, where `g = A λ + b` is recomputed in all rows.
    /// Dimensionless; zero for an exact solution, infinite if anything is not finite or has the wrong length. It is
    /// deliberately relative to `b`: relative to `|A| |λ|`, huge forces would make any gap look small. If rounding of
    /// `A λ` may hide 1e-3 or more, that value is the violation, since a gap of zero proves nothing then.
    pub fn violation(&self, b: &[f64], lambda: &[f64]) -> f64 {
        let c = self.n_contacts();
        let mut sample = Sample::new(self);
        if b.len() != c || lambda.len() != c || sample.load(b).is_err() {
            return f64::INFINITY;
        }
        sample.load_forces(lambda);
        sample.judge().violation()
    }

    pub(crate) fn check_length(&self, what: &'static str, found: usize) -> Result<(), LcpError> {
        let expected = self.n_contacts();
        if found == expected { Ok(()) } else { Err(LcpError::Dimension { what, expected, found }) }
    }
}

/// Replaces `a` by the mean of itself and its transpose, if both agree within rounding.
fn make_symmetric(a: &mut Mat<f64>) -> Result<(), LcpError> {
    let root: Vec<f64> = (0..a.nrows()).map(|i| a[(i, i)].abs().sqrt()).collect();
    tile::pairs(a.nrows()).try_for_each(|(rows, columns)| {
        let mut tile = Tile::transposed(a, columns.clone(), rows.clone());
        let mut asymmetric = 0;
        for (column, transposed) in columns.clone().zip(tile.columns()) {
            let values = &a.col_as_slice(column)[rows.clone()];
            asymmetric += average(values, transposed, &root[rows.clone()], 1e-10 * root[column]);
        }
        if asymmetric > 0 {
            return Err(asymmetry(a, &root, rows, columns));
        }
        tile.write(a, rows.clone(), columns.clone());
        tile.write_transposed(a, columns, rows);
        Ok(())
    })
}

/// Replaces transposed entries by the mean of both. Returns the number that differ by more than `limit` times their
/// root.
fn average(values: &[f64], transposed: &mut [f64], root: &[f64], limit: f64) -> u64 {
    let mut wrong = 0;
    for ((value, transposed), root) in values.iter().zip(transposed).zip(root) {
        wrong += u64::from((value - *transposed).abs() > limit * root);
        // Half of the smallest number is zero.
        *transposed = if *value == *transposed { *value } else { 0.5 * value + 0.5 * *transposed };
    }
    wrong
}

/// The first pair of entries in a tile that differ.
fn asymmetry(a: &Mat<f64>, root: &[f64], rows: Range<usize>, columns: Range<usize>) -> LcpError {
    // An entry above the diagonal comes first.
    let mut pairs =
        rows.flat_map(|column| columns.clone().filter(move |row| *row < column).map(move |row| (row, column)));
    let differs = |&(i, j): &(usize, usize)| (a[(i, j)] - a[(j, i)]).abs() > 1e-10 * root[i] * root[j];
    let (row, column) = pairs.find(differs).unwrap_or_default();
    LcpError::NotSymmetric { row, column, value: a[(row, column)], transposed: a[(column, row)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[f64]]) -> Result<LcpMatrix, LcpError> {
        LcpMatrix::new(&Mat::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]))
    }

    #[test]
    fn matrices_that_are_none_of_contact_are_refused_with_the_reason() {
        assert_eq!(matrix(&[&[1.0, 0.0]]).unwrap_err(), LcpError::NotSquare { rows: 1, columns: 2 });
        assert_eq!(matrix(&[&[f64::NAN]]).unwrap_err(), LcpError::NotFinite { what: "the contact matrix" });
        let asymmetric = matrix(&[&[1.0, 0.5], &[0.4, 1.0]]).unwrap_err();
        assert_eq!(asymmetric, LcpError::NotSymmetric { row: 0, column: 1, value: 0.5, transposed: 0.4 });
        for indefinite in [[[1.0, 2.0], [2.0, 1.0]], [[0.0, 1.0], [1.0, 1.0]], [[1.0, 0.0], [0.0, -1e-9]]] {
            let error = matrix(&[&indefinite[0], &indefinite[1]]).unwrap_err();
            assert!(matches!(error, LcpError::NotPositiveSemidefinite { contact: 1, .. }), "{error}");
        }
    }

    #[test]
    fn singular_matrices_pass_whichever_way_they_are_rounded() {
        for rounding in [-1e-16, 0.0, 1e-16] {
            assert!(matrix(&[&[1e-9, 1e-9], &[1e-9, 1e-9 * (1.0 + rounding)]]).is_ok());
        }
        assert!(matrix(&[&[0.0, 0.0], &[0.0, 1.0]]).is_ok());
    }

    #[test]
    fn the_violation_is_relative_to_b_and_without_unit() {
        for unit in [1.0, 1e-13, 2.5e9] {
            let a = matrix(&[&[2.0 * unit, 0.0], &[0.0, 1.0 * unit]]).unwrap();
            assert!(a.violation(&[-1.0, 3.0], &[0.5 / unit, 0.0]) < 1e-15);
            approx::assert_relative_eq!(a.violation(&[-1.0, 3.0], &[0.0, 0.0]), 0.5f64.sqrt() / 3.0, epsilon = 1e-12);
            assert_eq!(a.violation(&[f64::NAN, 3.0], &[0.0, 0.0]), f64::INFINITY);
            assert_eq!(a.violation(&[1.0, 3.0], &[0.0, f64::NAN]), f64::INFINITY);
            assert_eq!(a.violation(&[1.0], &[0.0]), f64::INFINITY);
        }
    }

    #[test]
    fn gaps_are_those_of_the_forces() {
        let a = matrix(&[&[2.0, 1.0, 0.5], &[1.0, 3.0, 0.25], &[0.5, 0.25, 1.0]]).unwrap();
        let mut gaps = [0.0; 3];
        a.gaps(&[-1.0, 2.0, 4.0], &[1.0, 0.0, 2.0], &mut gaps).unwrap();
        assert_eq!(gaps, [2.0, 3.5, 6.5]);
        assert!(a.gaps(&[-1.0; 2], &[0.0; 3], &mut gaps).is_err());
        assert!(a.gaps(&[-1.0; 3], &[0.0; 2], &mut gaps).is_err());
        assert!(a.gaps(&[-1.0; 3], &[0.0; 3], &mut gaps[..2]).is_err());
    }

    #[test]
    fn sensitivities_agree_with_differences_of_the_forces_in_the_block() {
        let a = matrix(&[&[2.0, 1.0, 0.3], &[1.0, 3.0, 0.2], &[0.3, 0.2, 1.0]]).unwrap();
        let derivative = a.sensitivity(&[true, true, false]).unwrap();
        let determinant = 5.0;
        approx::assert_relative_eq!(derivative[(0, 0)], -3.0 / determinant, epsilon = 1e-14);
        approx::assert_relative_eq!(derivative[(0, 1)], 1.0 / determinant, epsilon = 1e-14);
        approx::assert_relative_eq!(derivative[(1, 1)], -2.0 / determinant, epsilon = 1e-14);
        assert!((0..3).all(|k| derivative[(2, k)] == 0.0 && derivative[(k, 2)] == 0.0));
        assert!(a.sensitivity(&[true]).is_err());
    }

    #[test]
    fn sensitivities_of_redundant_contacts_are_those_of_one_of_them() {
        let a = matrix(&[&[4.0, 4.0], &[4.0, 4.0]]).unwrap();
        let derivative = a.sensitivity(&[true, true]).unwrap();
        let sum: f64 = (0..2).flat_map(|i| (0..2).map(move |j| (i, j))).map(|at| derivative[at]).sum();
        assert_eq!(sum, -0.25);
    }
}
