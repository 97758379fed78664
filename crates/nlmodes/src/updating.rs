//! Model updating: parameters of a structure from linear frequencies that are known (Section 4).

use std::error::Error;

use nlmodes_linalg::{LinalgError, Mat, symmetric_eigen};
use thiserror::Error;

/// A linear frequency that the structure is to have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyTarget {
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Its frequency, in the unit of the model.
    pub frequency: f64,
}

/// What an updating found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Updated {
    /// The parameters.
    pub values: Vec<f64>,
    /// Frequencies of the targets' modes with the parameters it began with.
    pub before: Vec<f64>,
    /// The same with [`Self::values`].
    pub after: Vec<f64>,
    /// Steps taken.
    pub iterations: usize,
}

/// Why parameters cannot be found.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum UpdatingError<E: Error + 'static> {
    /// There is nothing to find, or too little to find it from.
    #[error("{parameters} parameters cannot be found from {targets} frequencies")]
    Count {
        /// Parameters.
        parameters: usize,
        /// Frequencies.
        targets: usize,
    },
    /// A parameter or a frequency is not positive.
    #[error("a parameter or a frequency is {value}; updating needs positive ones")]
    NotPositive {
        /// The number.
        value: f64,
    },
    /// The structure does not have a target's mode.
    #[error("mode {mode} does not exist: the structure has {available} \
        {}", if *.available == 1 { "mode" } else { "modes" })]
    NoSuchMode {
        /// The mode.
        mode: usize,
        /// Modes that there are.
        available: usize,
    },
    /// Different parameters give the same frequencies.
    #[error(
        "these frequencies cannot tell the parameters apart: there are changes of them that leave all frequencies as \
            they are"
    )]
    Indistinct,
    /// No step brings the frequencies closer.
    #[error("after {iterations} steps a frequency is still off by {worst:.1e} of itself, and no step brings it closer")]
    NotConverged {
        /// Steps taken.
        iterations: usize,
        /// Largest relative deviation.
        worst: f64,
    },
    /// The linear algebra.
    #[error("least squares of the updating")]
    Linalg(#[source] LinalgError),
    /// The model with some parameters.
    #[error("the model")]
    Model(#[source] E),
}

/// Step of the logarithms of the parameters in central differences: rounding of the frequencies and curvature are
/// equally small.
const DIFFERENCE: f64 = 1e-4;
/// Largest change of a logarithm in one step.
const LARGEST_STEP: f64 = 1.0;
/// Change of the logarithms below which the parameters are found.
const SMALLEST_STEP: f64 = 1e-10;
/// Eigenvalue of the normal equations, over the largest, below which parameters count as indistinct.
const INDISTINCT: f64 = 1e-10;
const MAX_STEPS: usize = 50;

/// Finds positive parameters `p`, from `start` on, such that the linear frequencies `f_r(p)` are those of the targets:
/// exactly, where there are as many as parameters, else with the least
///
/// ```text
/// Σ_r (ln f_r(p) − ln f_r*)²
/// ```
///
/// by the Gauss-Newton method in the logarithms of the parameters, in which frequencies are nearly linear.
/// `frequencies` gives those of the model with given parameters, ascending.
///
/// # Errors
/// [`UpdatingError`].
///
/// # Example
/// A mass of 0.5 kg that is to swing with 4 rad/s: what is its spring?
/// ```
/// use nlmodes::updating::{FrequencyTarget, update_parameters};
/// use std::convert::Infallible;
///
/// let target = [FrequencyTarget { mode: 1, frequency: 4.0 }];
/// let found = update_parameters(&[1.0], &target, |p| Ok::<_, Infallible>(vec![(p[0] / 0.5_f64).sqrt()]))?;
/// assert!((found.values[0] - 8.0).abs() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn update_parameters<E: Error + 'static>(
    start: &[f64],
    targets: &[FrequencyTarget],
    mut frequencies: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Updated, UpdatingError<E>> {
    let (parameters, count) = (start.len(), targets.len());
    if parameters == 0 || parameters > count {
        return Err(UpdatingError::Count { parameters, targets: count });
    }
    let given = start.iter().copied().chain(targets.iter().map(|t| t.frequency));
    if let Some(value) = given.into_iter().find(|v| !(v.is_finite() && *v > 0.0)) {
        return Err(UpdatingError::NotPositive { value });
    }
    let mut at = |x: &[f64]| -> Result<Vec<f64>, UpdatingError<E>> {
        let values: Vec<f64> = x.iter().map(|x| x.exp()).collect();
        off(&frequencies(&values).map_err(UpdatingError::Model)?, targets)
    };
    let mut x: Vec<f64> = start.iter().map(|p| p.ln()).collect();
    let mut residual = at(&x)?;
    let before = hertz(&residual, targets);
    for iterations in 1..=MAX_STEPS {
        let step = gauss_newton(&slopes(&x, &mut at)?, &residual)?;
        let size = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        let (moved, next) = shortened(&x, &step, size, &residual, &mut at)?;
        let is_better = square(&next) < square(&residual);
        if is_better {
            (x, residual) = (moved, next);
        }
        if size < SMALLEST_STEP || !is_better {
            let worst = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            // Rounding ends the search where the frequencies are met, or where no slope is left.
            if size > 1e-7 && (parameters == count && worst > 1e-9 || parameters < count) {
                return Err(UpdatingError::NotConverged { iterations, worst });
            }
            let values = x.iter().map(|x| x.exp()).collect();
            return Ok(Updated { values, before, after: hertz(&residual, targets), iterations });
        }
    }
    let worst = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    Err(UpdatingError::NotConverged { iterations: MAX_STEPS, worst })
}

/// `ln f_r − ln f_r*` of each target.
fn off<E: Error + 'static>(found: &[f64], targets: &[FrequencyTarget]) -> Result<Vec<f64>, UpdatingError<E>> {
    let of = |t: &FrequencyTarget| match t.mode.checked_sub(1).and_then(|k| found.get(k)) {
        Some(f) if *f > 0.0 => Ok((f / t.frequency).ln()),
        Some(f) => Err(UpdatingError::NotPositive { value: *f }),
        None => Err(UpdatingError::NoSuchMode { mode: t.mode, available: found.len() }),
    };
    targets.iter().map(of).collect()
}

fn hertz(residual: &[f64], targets: &[FrequencyTarget]) -> Vec<f64> {
    residual.iter().zip(targets).map(|(r, t)| t.frequency * r.exp()).collect()
}

fn square(residual: &[f64]) -> f64 {
    residual.iter().map(|r| r * r).sum()
}

/// Derivatives of the residual, one column a parameter.
fn slopes<E: Error + 'static>(
    x: &[f64],
    at: &mut impl FnMut(&[f64]) -> Result<Vec<f64>, UpdatingError<E>>,
) -> Result<Vec<Vec<f64>>, UpdatingError<E>> {
    (0..x.len())
        .map(|j| {
            let mut shifted = |by: f64| {
                let mut x = x.to_vec();
                x[j] += by;
                at(&x)
            };
            let (plus, minus) = (shifted(DIFFERENCE)?, shifted(-DIFFERENCE)?);
            Ok(plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * DIFFERENCE)).collect())
        })
        .collect()
}

/// Least squares by the normal equations: with a few logarithms as unknowns they are well scaled.
fn gauss_newton<E: Error + 'static>(columns: &[Vec<f64>], residual: &[f64]) -> Result<Vec<f64>, UpdatingError<E>> {
    let n = columns.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let normal = Mat::from_fn(n, n, |i, j| dot(&columns[i], &columns[j]));
    let (values, vectors) = symmetric_eigen(&normal).map_err(UpdatingError::Linalg)?;
    if values[0] <= INDISTINCT * values[n - 1] || values[n - 1] == 0.0 {
        return Err(UpdatingError::Indistinct);
    }
    let mut step = vec![0.0; n];
    for (k, value) in values.iter().enumerate() {
        let share = (0..n).map(|i| vectors[(i, k)] * dot(&columns[i], residual)).sum::<f64>() / value;
        step.iter_mut().enumerate().for_each(|(i, s)| *s -= share * vectors[(i, k)]);
    }
    Ok(step)
}

/// The step, not too long and halved until it brings the frequencies closer; where it never does, its shortest trial.
fn shortened<E: Error + 'static>(
    x: &[f64],
    step: &[f64],
    size: f64,
    residual: &[f64],
    at: &mut impl FnMut(&[f64]) -> Result<Vec<f64>, UpdatingError<E>>,
) -> Result<(Vec<f64>, Vec<f64>), UpdatingError<E>> {
    let mut share = (LARGEST_STEP / size).min(1.0);
    loop {
        let moved: Vec<f64> = x.iter().zip(step).map(|(x, s)| x + share * s).collect();
        let next = at(&moved)?;
        if square(&next) < square(residual) || share * size < SMALLEST_STEP || share < 1e-6 {
            return Ok((moved, next));
        }
        share *= 0.5;
    }
}
