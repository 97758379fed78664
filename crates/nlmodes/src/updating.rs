//! Model updating: parameters of a structure from linear frequencies that are known (Section 4).

use std::error::Error;

use nlmodes_linalg::LinalgError;
use thiserror::Error;

use crate::least_squares::{Residuals, SearchError, SearchSettings, least_squares};

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
    let mut model = Logarithms { frequencies: &mut frequencies, targets };
    let x: Vec<f64> = start.iter().map(|p| p.ln()).collect();
    let found = least_squares(&x, &SearchSettings::default(), &mut model)?;
    let worst = found.residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    let is_exact = parameters == count;
    // Rounding ends the search where the frequencies are met, or where no slope is left.
    if !found.is_found && found.step > 1e-7 && (!is_exact || worst > 1e-9) {
        return Err(UpdatingError::NotConverged { iterations: found.iterations, worst });
    }
    let values = found.x.iter().map(|x| x.exp()).collect();
    let [before, after] = [&found.before, &found.residual].map(|residual| hertz(residual, targets));
    Ok(Updated { values, before, after, iterations: found.iterations })
}

/// `ln f_r − ln f_r*` over the logarithms of the parameters.
struct Logarithms<'a, F> {
    frequencies: &'a mut F,
    targets: &'a [FrequencyTarget],
}

impl<E: Error + 'static, F: FnMut(&[f64]) -> Result<Vec<f64>, E>> Logarithms<'_, F> {
    fn at(&mut self, x: &[f64]) -> Result<Vec<f64>, UpdatingError<E>> {
        let values: Vec<f64> = x.iter().map(|x| x.exp()).collect();
        off(&(self.frequencies)(&values).map_err(UpdatingError::Model)?, self.targets)
    }
}

impl<E: Error + 'static, F: FnMut(&[f64]) -> Result<Vec<f64>, E>> Residuals for Logarithms<'_, F> {
    type Error = UpdatingError<E>;

    fn residual(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, UpdatingError<E>> {
        self.at(x).map(Some)
    }

    fn slopes(&mut self, x: &[f64]) -> Result<Vec<Vec<f64>>, UpdatingError<E>> {
        let one = |j: usize| {
            let mut shifted = |by: f64| {
                let mut x = x.to_vec();
                x[j] += by;
                self.at(&x)
            };
            let (plus, minus) = (shifted(DIFFERENCE)?, shifted(-DIFFERENCE)?);
            Ok(plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * DIFFERENCE)).collect())
        };
        (0..x.len()).map(one).collect()
    }
}

impl<E: Error + 'static> From<SearchError<UpdatingError<E>>> for UpdatingError<E> {
    fn from(error: SearchError<UpdatingError<E>>) -> Self {
        match error {
            SearchError::Model(error) => error,
            SearchError::Linalg(source) => Self::Linalg(source),
            SearchError::Start | SearchError::Indistinct { .. } => Self::Indistinct,
        }
    }
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
