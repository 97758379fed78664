mod solution;

use std::{collections::HashMap, sync::Arc};

use nlmodes_linalg::Mat;

pub use solution::SeriesSolution;

use crate::{ClosedResponse, ContactBody, LcpError, LcpMatrix, LcpSolver, LcpWorkspace, body::response_of_gaps};

/// Initial guess of the closed contacts of a sample.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Start {
    /// No guess.
    Cold,
    /// Extrapolation of the forces and gaps of the previous two samples; the first sample has no guess.
    #[default]
    PreviousSample,
    /// The closed contacts of the same sample in the solution that is passed in, which is the previous iterate of an
    /// outer iteration. If it has another size, for instance if it is empty, this is as [`Self::PreviousSample`].
    SameSample,
}

/// Many contact problems with one `A` and changing `b`, such as the samples of a period.
///
/// Everything that depends on `A` alone is done once; memory grows linearly with the number of samples.
///
/// ```
/// use nlmodes_contact::{ActiveSet, LcpMatrix, Mat, Series, SeriesSolution, Start};
/// let a = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 2e-6 } else { 1e-6 }))?;
/// let mut series = Series::new(&a, &ActiveSet::default())?;
/// // Two contacts, three samples; sample by sample.
/// let b = [1e-3, 1e-3, -1e-3, 1e-3, -1e-3, -2e-3];
/// let mut solution = SeriesSolution::default();
/// series.solve(&b, Start::PreviousSample, &mut solution)?;
/// assert_eq!(solution.closed(1), [true, false]);
/// assert!((solution.lambda(1)[0] - 500.0).abs() < 1e-9);
/// let response = series.response(solution.closed(1))?;
/// assert!((response.lambda[(0, 0)] + 5e5).abs() < 1e-6 && (response.gaps[(1, 0)] + 0.5).abs() < 1e-12);
/// # Ok::<(), nlmodes_contact::LcpError>(())
/// ```
pub struct Series {
    matrix: LcpMatrix,
    body: Option<ContactBody>,
    workspace: Box<dyn LcpWorkspace>,
    responses: HashMap<Box<[bool]>, Arc<ClosedResponse>>,
}

/// Bytes of derivatives kept.
const BUDGET_BYTES: usize = 128 << 20;

impl std::fmt::Debug for Series {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Series").field("matrix", &self.matrix).finish_non_exhaustive()
    }
}

impl Series {
    /// Prepares `solver` for the matrix.
    ///
    /// # Errors
    /// [`LcpError`] if the backend cannot treat the matrix.
    pub fn new(matrix: &LcpMatrix, solver: &dyn LcpSolver) -> Result<Self, LcpError> {
        let workspace = solver.workspace(matrix)?;
        Ok(Self { matrix: matrix.clone(), body: None, workspace, responses: HashMap::new() })
    }

    /// Prepares `solver` for the contacts of a body: [`Series::response`] then gives the derivatives of its
    /// displacements.
    ///
    /// # Errors
    /// [`LcpError`] if the backend cannot treat the matrix.
    pub fn of_body(body: &ContactBody, solver: &dyn LcpSolver) -> Result<Self, LcpError> {
        Ok(Self { body: Some(body.clone()), ..Self::new(body.matrix(), solver)? })
    }

    /// The matrix of the series.
    pub fn matrix(&self) -> &LcpMatrix {
        &self.matrix
    }

    /// Solves all samples of `b` (m), which holds the c values of one sample after the other, and overwrites
    /// `solution`.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `b` is not a whole number of samples, [`LcpError::Sample`] with the first sample that
    /// has no solution and the reason; the samples before it are in `solution`.
    pub fn solve(&mut self, b: &[f64], start: Start, solution: &mut SeriesSolution) -> Result<(), LcpError> {
        let c = self.matrix.n_contacts();
        let samples = b.len() / c.max(1);
        if samples * c != b.len() {
            return Err(LcpError::Dimension {
                what: "b of whole samples",
                expected: (samples + 1) * c,
                found: b.len(),
            });
        }
        let same = start == Start::SameSample && solution.c == c && solution.n_samples() == samples;
        solution.resize(c, samples);
        (0..samples).try_for_each(|sample| {
            if !same {
                solution.guess(sample, start != Start::Cold);
            }
            self.solve_sample(&b[sample * c..(sample + 1) * c], sample, solution)
                .map_err(|source| LcpError::Sample { sample, source: Box::new(source) })
        })
    }

    fn solve_sample(&mut self, b: &[f64], sample: usize, solution: &mut SeriesSolution) -> Result<(), LcpError> {
        let range = solution.range(sample);
        let (closed, lambda) = (&mut solution.closed[range.clone()], &mut solution.lambda[range.clone()]);
        solution.statistics[sample] = self.workspace.solve(b, closed, lambda)?;
        self.workspace.gaps(&mut solution.gaps[range])
    }

    /// Derivatives of forces, gaps and displacements with the closed contacts of a sample, `solution.closed(sample)`:
    /// see [`ContactBody::response`]. Computed once per closed set: few distinct ones occur in a period.
    ///
    /// Without a body the displacements are the gaps, `u = g` and `u_free = b`.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `closed` has not c entries.
    pub fn response(&mut self, closed: &[bool]) -> Result<Arc<ClosedResponse>, LcpError> {
        if let Some(known) = self.responses.get(closed) {
            return Ok(known.clone());
        }
        let response = Arc::new(match &self.body {
            Some(body) => body.response(closed)?,
            None => response_of_gaps(&self.matrix, closed)?,
        });
        let entries = |m: &Mat<f64>| m.nrows() * m.ncols();
        let entries = entries(&response.lambda) + entries(&response.gaps) + entries(&response.blocked);
        if (self.responses.len() + 1) * entries * size_of::<f64>() > BUDGET_BYTES {
            self.responses.clear();
        }
        self.responses.insert(closed.into(), response.clone());
        Ok(response)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SOLVER_NAMES, factor::tests::smooth, solver_by_name};

    /// A wave of gaps over 12 contacts, 32 samples.
    fn wave() -> Vec<f64> {
        let gap = |k: usize, i: usize| 1e-4 * (0.3 + (0.2 * k as f64 - 0.5 * i as f64).cos());
        (0..32).flat_map(|k| (0..12).map(move |i| gap(k, i))).collect()
    }

    #[test]
    fn every_start_and_every_backend_gives_the_same_series() {
        let (matrix, b) = (smooth(12), wave());
        let mut reference = SeriesSolution::default();
        Series::new(&matrix, &crate::ActiveSet::default()).unwrap().solve(&b, Start::Cold, &mut reference).unwrap();
        for name in SOLVER_NAMES.iter().filter(|name| **name != "closed-form") {
            let mut series = Series::new(&matrix, solver_by_name(name).unwrap().as_ref()).unwrap();
            let mut solution = SeriesSolution::default();
            for start in [Start::Cold, Start::PreviousSample, Start::SameSample] {
                series.solve(&b, start, &mut solution).unwrap();
                assert_eq!(solution.closed, reference.closed, "{name} {start:?}");
                for (found, expected) in solution.lambda.iter().zip(&reference.lambda) {
                    approx::assert_relative_eq!(found, expected, epsilon = 1e-16, max_relative = 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_second_pass_from_the_same_samples_takes_one_step_per_sample() {
        let mut series = Series::new(&smooth(12), &crate::ActiveSet::default()).unwrap();
        let mut solution = SeriesSolution::default();
        series.solve(&wave(), Start::PreviousSample, &mut solution).unwrap();
        series.solve(&wave(), Start::SameSample, &mut solution).unwrap();
        assert!(solution.statistics().iter().all(|s| s.iterations <= 1));
    }

    #[test]
    fn a_sample_without_solution_is_named() {
        let mut series = Series::new(&smooth(2), &crate::ActiveSet::default()).unwrap();
        let b = [1.0, 1.0, 1.0, f64::NAN];
        let error = series.solve(&b, Start::default(), &mut SeriesSolution::default()).unwrap_err();
        assert_eq!(error, LcpError::Sample { sample: 1, source: Box::new(LcpError::NotFinite { what: "b" }) });
        // Three numbers of two samples of two contacts.
        let error = series.solve(&b[..3], Start::default(), &mut SeriesSolution::default()).unwrap_err();
        assert_eq!(error, LcpError::Dimension { what: "b of whole samples", expected: 4, found: 3 });
    }

    #[test]
    fn responses_are_central_differences_of_forces_and_gaps() {
        let (matrix, b) = (smooth(12), wave());
        let mut series = Series::new(&matrix, &crate::ActiveSet::default()).unwrap();
        let mut solution = SeriesSolution::default();
        series.solve(&b, Start::default(), &mut solution).unwrap();
        let response = series.response(solution.closed(3)).unwrap();
        assert!(Arc::ptr_eq(&response, &series.response(solution.closed(3)).unwrap()));
        let mut moved = |step: f64| {
            let mut moved = b[36..48].to_vec();
            moved[4] += step;
            series.solve(&moved, Start::Cold, &mut solution).unwrap();
            (solution.lambda(0).to_vec(), solution.gaps(0).to_vec())
        };
        let (above, below) = (moved(1e-8), moved(-1e-8));
        for i in 0..12 {
            let forces = (above.0[i] - below.0[i]) / 2e-8;
            approx::assert_relative_eq!(response.lambda[(i, 4)], forces, epsilon = 1e-6, max_relative = 1e-6);
            let gaps = (above.1[i] - below.1[i]) / 2e-8;
            approx::assert_abs_diff_eq!(response.gaps[(i, 4)], gaps, epsilon = 1e-6);
            approx::assert_abs_diff_eq!(response.displacement()[(i, 4)], gaps, epsilon = 1e-6);
        }
    }
}
