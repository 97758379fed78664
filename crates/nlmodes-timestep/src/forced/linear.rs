use nlmodes_linalg::{LinalgError, Mat, matrix_exponential};

use super::series::FlowSeries;
use crate::phase::product;

/// Length of a step times the fastest rate of the equations: power series along a step then end below rounding errors.
pub const TURN: f64 = 2.0;

/// Maximum number of terms of a power series within a step.
const TERMS: usize = 60;

/// `ẇ = 𝒜 w` in steps of one length, at most [`TURN`] over the largest eigenvalue of `𝒜`.
///
/// What drives a system is part of its `w`: a one for what is constant, oscillators, Taylor coefficients. Loads and
/// gaps are included in this way, and resonance needs no special treatment.
#[derive(Debug, Clone)]
pub struct LinearFlow {
    pub(super) step: f64,
    pub(super) matrix: Mat<f64>,
    /// `e^{𝒜 step}`.
    over_step: Mat<f64>,
}

impl LinearFlow {
    /// The flow of these equations.
    ///
    /// # Errors
    /// [`LinalgError::NotFinite`].
    pub fn new(matrix: Mat<f64>, step: f64) -> Result<Self, LinalgError> {
        let over_step = scaled_exponential(&matrix, step)?;
        Ok(Self { step, matrix, over_step })
    }

    /// A row along each step.
    #[must_use]
    pub fn along(&self, row: &[f64]) -> FlowSeries {
        FlowSeries::new(row, &self.matrix, self.step)
    }

    /// `w` after a time within a step, by its power series.
    #[must_use]
    pub fn after(&self, w: &[f64], t: f64) -> Vec<f64> {
        if t == self.step {
            return product(&self.over_step, w);
        }
        let (mut sum, mut term) = (w.to_vec(), w.to_vec());
        for k in 1..TERMS {
            term = product(&self.matrix, &term);
            term.iter_mut().for_each(|v| *v *= t / k as f64);
            sum.iter_mut().zip(&term).for_each(|(sum, v)| *sum += v);
            if term.iter().zip(&sum).all(|(v, sum)| v.abs() <= 1e-18 * sum.abs()) {
                break;
            }
        }
        sum
    }

    /// The transition of entries of `w` which only these entries drive over a time within a step.
    pub(super) fn transition_of(&self, entries: &[usize], t: f64) -> Result<Mat<f64>, LinalgError> {
        let n = entries.len();
        let block = |of: &Mat<f64>| Mat::from_fn(n, n, |i, j| of[(entries[i], entries[j])]);
        if t == self.step {
            return Ok(block(&self.over_step));
        }
        scaled_exponential(&block(&self.matrix), t)
    }
}

/// `e^{t 𝒜}`.
fn scaled_exponential(matrix: &Mat<f64>, t: f64) -> Result<Mat<f64>, LinalgError> {
    matrix_exponential(&Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| t * matrix[(i, j)]))
}
