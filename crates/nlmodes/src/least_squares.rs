//! Nonlinear least squares of a few unknowns by the Gauss-Newton method.
//!
//! ```text
//! min Σ r_i(x)² ,   JᵀJ s = −Jᵀr ,   x ← x + share · s   share by halves from the largest step until Σ r² falls
//! ```

use nlmodes_linalg::{LinalgError, Mat, symmetric_eigen};
use thiserror::Error;

/// When a search ends, in the unit of the unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    /// Largest change of an unknown in one step.
    pub largest_step: f64,
    /// Change of the unknowns below which they are found.
    pub smallest_step: f64,
    /// Eigenvalue of the normal equations, over the largest, below which unknowns count as indistinct.
    pub indistinct: f64,
    /// Most steps.
    pub max_steps: usize,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self { largest_step: 1.0, smallest_step: 1e-10, indistinct: 1e-10, max_steps: 50 }
    }
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The unknowns.
    pub x: Vec<f64>,
    /// The residuals there.
    pub residual: Vec<f64>,
    /// Those at the start.
    pub before: Vec<f64>,
    /// Derivatives of the residuals at the last step, one column an unknown.
    pub slopes: Vec<Vec<f64>>,
    /// Steps taken.
    pub iterations: usize,
    /// The last step in full, the largest change of an unknown.
    pub step: f64,
    /// Whether the last step was below the smallest one; else none brought the residuals closer, or there were too
    /// many.
    pub is_found: bool,
}

/// Why there is no minimum.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SearchError<E: std::error::Error + 'static> {
    /// The residuals do not exist at the start.
    #[error("there is nothing to compare at the start")]
    Start,
    /// Changes of the unknowns leave all residuals as they are.
    #[error("there are changes of the unknowns that leave all residuals as they are")]
    Indistinct {
        /// Such a change, of length one.
        along: Vec<f64>,
    },
    /// The linear algebra.
    #[error("least squares")]
    Linalg(#[source] LinalgError),
    /// The model.
    #[error(transparent)]
    Model(E),
}

/// What residuals and slopes come from.
pub trait Residuals {
    /// What an evaluation can fail with, which ends the search.
    type Error: std::error::Error + 'static;

    /// The residuals; none where the model has no such point, and a shorter step is to be tried.
    ///
    /// # Errors
    /// What ends the search.
    fn residual(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, Self::Error>;

    /// Their derivatives, one column an unknown.
    ///
    /// # Errors
    /// What ends the search.
    fn slopes(&mut self, x: &[f64]) -> Result<Vec<Vec<f64>>, Self::Error>;
}

/// Searches the least sum of squares from `start` on.
///
/// # Errors
/// [`SearchError`].
pub fn least_squares<R: Residuals>(
    start: &[f64],
    settings: &SearchSettings,
    model: &mut R,
) -> Result<Minimum, SearchError<R::Error>> {
    let mut x = start.to_vec();
    let mut residual = model.residual(&x).map_err(SearchError::Model)?.ok_or(SearchError::Start)?;
    let (before, mut slopes, mut size) = (residual.clone(), Vec::new(), f64::INFINITY);
    for iterations in 1..=settings.max_steps {
        slopes = model.slopes(&x).map_err(SearchError::Model)?;
        let step = gauss_newton(&slopes, &residual, settings.indistinct)?;
        size = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        let better = shortened(&x, &step, (size, square(&residual)), settings, model)?;
        let is_better = better.is_some();
        if let Some((moved, next)) = better {
            (x, residual) = (moved, next);
        }
        if size < settings.smallest_step || !is_better {
            let is_found = size < settings.smallest_step;
            return Ok(Minimum { x, residual, before, slopes, iterations, step: size, is_found });
        }
    }
    Ok(Minimum { x, residual, before, slopes, iterations: settings.max_steps, step: size, is_found: false })
}

/// `(JᵀJ)⁻¹`, from the columns of J.
///
/// # Errors
/// [`LinalgError`].
pub fn inverse_normal(columns: &[Vec<f64>]) -> Result<Mat<f64>, LinalgError> {
    let (values, vectors) = symmetric_eigen(&normal(columns))?;
    let n = columns.len();
    Ok(Mat::from_fn(n, n, |i, j| (0..n).map(|k| vectors[(i, k)] * vectors[(j, k)] / values[k]).sum()))
}

fn square(residual: &[f64]) -> f64 {
    residual.iter().map(|r| r * r).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn normal(columns: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(columns.len(), columns.len(), |i, j| dot(&columns[i], &columns[j]))
}

/// Least squares by the normal equations: with a few unknowns of size one they are well scaled.
fn gauss_newton<E: std::error::Error + 'static>(
    columns: &[Vec<f64>],
    residual: &[f64],
    indistinct: f64,
) -> Result<Vec<f64>, SearchError<E>> {
    let n = columns.len();
    let (values, vectors) = symmetric_eigen(&normal(columns)).map_err(SearchError::Linalg)?;
    if values[0] <= indistinct * values[n - 1] || values[n - 1] == 0.0 {
        return Err(SearchError::Indistinct { along: (0..n).map(|i| vectors[(i, 0)]).collect() });
    }
    let mut step = vec![0.0; n];
    for (k, value) in values.iter().enumerate() {
        let share = (0..n).map(|i| vectors[(i, k)] * dot(&columns[i], residual)).sum::<f64>() / value;
        step.iter_mut().enumerate().for_each(|(i, s)| *s -= share * vectors[(i, k)]);
    }
    Ok(step)
}

/// Unknowns with their residuals.
type Evaluated = (Vec<f64>, Vec<f64>);

/// Least share of a step that is tried.
const SHORTEST: f64 = 1e-6;

/// The unknowns after the step, not too long and halved until it brings the residuals closer, with these; none where it
/// never does.
fn shortened<R: Residuals>(
    x: &[f64],
    step: &[f64],
    (size, before): (f64, f64),
    settings: &SearchSettings,
    model: &mut R,
) -> Result<Option<Evaluated>, SearchError<R::Error>> {
    let mut share = (settings.largest_step / size).min(1.0);
    loop {
        let moved: Vec<f64> = x.iter().zip(step).map(|(x, s)| x + share * s).collect();
        if let Some(next) = model.residual(&moved).map_err(SearchError::Model)?.filter(|next| square(next) < before) {
            return Ok(Some((moved, next)));
        }
        if share * size < settings.smallest_step || share < SHORTEST {
            return Ok(None);
        }
        share *= 0.5;
    }
}
