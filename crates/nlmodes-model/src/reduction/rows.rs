use nlmodes_linalg::{LinalgError, Mat, SparseMatrix, multiply_many, multiply_transposed, sparse_from_triplets};

use crate::reduction::residual::{blocks, dense_columns};
use crate::reduction::{OpenModes, ReductionError};

/// A load `f` that acts on the structure, as the reduced equations need it: `η̈ + Ω² η = Yᵀ λ + p`,
/// `g = g₀ + Y η + A λ + a`.
///
/// `f` may vary in time by a factor; all of this goes with it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModalLoad {
    /// `p = Φᵀ f`, m, N/√kg.
    pub modal: Vec<f64>,
    /// `a = Wᵀ K⁻¹ f − Y Ω⁻² Φᵀ f`, c, m: what the modes left out add to the gaps.
    pub gaps: Vec<f64>,
    /// `K⁻¹ f − Φ Ω⁻² Φᵀ f`, n: what they add to the displacement.
    pub residual: Vec<f64>,
}

/// Displacements of chosen places, or other linear functionals of `q`, in reduced coordinates:
/// `Lᵀ q = modes · η + forces · λ`, and what [`ModalLoad::residual`] adds under a load.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResponseRows {
    /// `Lᵀ Φ`, k × m.
    pub modes: Mat<f64>,
    /// `Lᵀ [K⁻¹ W − Φ Ω⁻² Yᵀ]`, k × c.
    pub forces: Mat<f64>,
}

impl ResponseRows {
    /// Value of functional `row` for modal coordinates `eta` (m) and contact forces `lambda` (c).
    ///
    /// # Panics
    /// If there is no such row.
    pub fn value(&self, row: usize, eta: &[f64], lambda: &[f64]) -> f64 {
        let sum = |a: &Mat<f64>, x: &[f64]| x.iter().enumerate().map(|(j, x)| a[(row, j)] * x).sum::<f64>();
        sum(&self.modes, eta) + sum(&self.forces, lambda)
    }
}

impl OpenModes {
    /// The reduced form of the load `force` (n).
    ///
    /// # Errors
    /// [`ReductionError::Dimension`], [`ReductionError::NotFinite`].
    pub fn load(&self, force: &[f64]) -> Result<ModalLoad, ReductionError> {
        let (expected, found) = (self.n_dofs(), force.len());
        if expected != found {
            return Err(ReductionError::Dimension { what: "entries of the load", expected, found });
        }
        if let Some((index, &value)) = force.iter().enumerate().find(|(_, f)| !f.is_finite()) {
            return Err(ReductionError::NotFinite { what: "entry of the load", index, value });
        }
        let column = Mat::from_fn(expected, 1, |i, _| force[i]);
        let modal = self.shapes.transpose() * &column;
        let residual = self.residual.beside(&self.shapes).answer(column);
        let gaps = multiply_transposed(&self.directions, &residual);
        let list = |a: &Mat<f64>| a.col(0).iter().copied().collect();
        Ok(ModalLoad { modal: list(&modal), gaps: list(&gaps), residual: list(&residual) })
    }

    /// Rows for the functionals `Lᵀ q`, one column of `functionals` (n × k) each.
    ///
    /// No n × c matrix arises: `G = K⁻¹ − Φ Ω⁻² Φᵀ` is symmetric, so that either `G L` or `G W` is solved for in
    /// blocks, whichever has fewer columns.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`] if the functionals have another size than the structure.
    pub fn rows(&self, functionals: &SparseMatrix) -> Result<ResponseRows, ReductionError> {
        let (expected, found) = (self.n_dofs(), functionals.nrows());
        if expected != found {
            return Err(ReductionError::Dimension { what: "rows of the functionals", expected, found });
        }
        let modes = multiply_transposed(functionals, &self.shapes);
        let forces = match &self.residual_shapes {
            Some(shapes) => multiply_transposed(functionals, shapes),
            None if functionals.ncols() <= self.n_contacts() => {
                self.seen_by(functionals, &self.directions).transpose().to_owned()
            }
            None => self.seen_by(&self.directions, functionals),
        };
        Ok(ResponseRows { modes, forces })
    }

    /// Rows for the displacements of the degrees of freedom `dofs`.
    ///
    /// # Errors
    /// [`ReductionError::Linalg`] with [`LinalgError::Dimension`] for a degree of freedom that does not exist.
    pub fn rows_of_dofs(&self, dofs: &[usize]) -> Result<ResponseRows, ReductionError> {
        let entries: Vec<_> = dofs.iter().enumerate().map(|(j, &dof)| (dof, j, 1.0)).collect();
        let failed = |source: LinalgError| ReductionError::Linalg { what: "rows of degrees of freedom", source };
        self.rows(&sparse_from_triplets(self.n_dofs(), dofs.len(), &entries).map_err(failed)?)
    }

    /// Displacements (m, one row for each of `dofs`) where the modal coordinates are the columns of `eta` (m × k) and
    /// the contact forces those of `lambda` (c × k, N): `q = Φ η + [K⁻¹ W − Φ Ω⁻² Yᵀ] λ`.
    ///
    /// One solution for each column: for many contacts and places but few instants this takes far less than
    /// [`OpenModes::rows_of_dofs`].
    ///
    /// # Panics
    /// If `eta` and `lambda` have other sizes, or there is no such degree of freedom.
    pub fn displacements(&self, dofs: &[usize], eta: &Mat<f64>, lambda: &Mat<f64>) -> Mat<f64> {
        assert!(eta.nrows() == self.n_modes() && lambda.nrows() == self.n_contacts(), "modes and contacts of a motion");
        assert_eq!(eta.ncols(), lambda.ncols(), "instants of a motion");
        let mut seen = Mat::zeros(dofs.len(), eta.ncols());
        let beside = self.residual_shapes.is_none().then(|| self.residual.beside(&self.shapes));
        for block in blocks(eta.ncols()) {
            let (first, count) = (block.start, block.len());
            let forces = lambda.subcols(first, count).to_owned();
            let mut q = match (&beside, &self.residual_shapes) {
                (Some(beside), _) => beside.answer(multiply_many(&self.directions, &forces)),
                (None, Some(shapes)) => shapes * &forces,
                (None, None) => Mat::zeros(self.n_dofs(), count),
            };
            q += &self.shapes * eta.subcols(first, count);
            for (row, &dof) in dofs.iter().enumerate() {
                (0..count).for_each(|j| seen[(row, first + j)] = q[(dof, j)]);
            }
        }
        seen
    }

    /// Static response to these loads (n × any, N) beyond the retained modes, m: `(K⁻¹ − Φ Ω⁻² Φᵀ) P`.
    ///
    /// # Panics
    /// If the loads have another size than the structure.
    pub fn residual_answer(&self, loads: Mat<f64>) -> Mat<f64> {
        self.residual.beside(&self.shapes).answer(loads)
    }

    /// `Bᵀ G A`, with solutions for the columns of `a`: columns of `b` × columns of `a`.
    fn seen_by(&self, a: &SparseMatrix, b: &SparseMatrix) -> Mat<f64> {
        let (mut seen, beside) = (Mat::zeros(b.ncols(), a.ncols()), self.residual.beside(&self.shapes));
        for block in blocks(a.ncols()) {
            let (first, count) = (block.start, block.len());
            let answer = beside.answer(dense_columns(a, block));
            seen.subcols_mut(first, count).copy_from(&multiply_transposed(b, &answer));
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    use crate::reduction::{ModeCount, OpenModes};
    use nlmodes_linalg::{Mat, sparse_from_triplets};

    #[test]
    fn rows_that_are_solved_for_are_those_that_are_kept() {
        // A chain of 30 unit masses with contacts at three of them.
        let n = 30;
        let springs = (0..n).flat_map(|i| {
            let diagonal = (i, i, if i + 1 < n { 2.0 } else { 1.0 });
            [Some(diagonal), (i > 0).then(|| (i, i - 1, -1.0)), (i > 0).then(|| (i - 1, i, -1.0))]
        });
        let k = sparse_from_triplets(n, n, &springs.flatten().collect::<Vec<_>>()).unwrap();
        let m = sparse_from_triplets(n, n, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>()).unwrap();
        let w = sparse_from_triplets(n, 3, &[(4, 0, -1.0), (12, 1, 1.0), (29, 2, 0.6), (28, 2, -0.8)]).unwrap();
        let kept = OpenModes::new(m, k, w, vec![0.0; 3], vec![0.0; 3], ModeCount::Lowest(5)).unwrap();
        let mut solved = kept.clone();
        assert!(solved.residual_shapes.take().is_some());
        // Fewer functionals than contacts, and more.
        for dofs in [&[7, 29][..], &[0, 4, 12, 20, 28, 29]] {
            let [a, b] = [&kept, &solved].map(|open| open.rows_of_dofs(dofs).unwrap().forces);
            assert_eq!((a.nrows(), a.ncols()), (dofs.len(), 3));
            let off = (0..dofs.len()).flat_map(|i| (0..3).map(move |j| (i, j)));
            assert!(off.map(|at| (a[at] - b[at]).abs()).fold(0.0, f64::max) < 1e-13);
            // Displacements at once, more instants than are solved for at a time.
            let eta = Mat::from_fn(5, 40, |r, k| ((2 * r + 3 * k) % 7) as f64 - 3.0);
            let lambda = Mat::from_fn(3, 40, |i, k| ((5 * i + k) % 4) as f64);
            let expected = &kept.rows_of_dofs(dofs).unwrap();
            let expected = &expected.modes * &eta + &expected.forces * &lambda;
            for open in [&kept, &solved] {
                let found = open.displacements(dofs, &eta, &lambda);
                assert_eq!((found.nrows(), found.ncols()), (dofs.len(), 40));
                assert!((0..40).all(|k| (0..dofs.len()).all(|i| (found[(i, k)] - expected[(i, k)]).abs() < 1e-12)));
            }
        }
    }
}
