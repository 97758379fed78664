//! What a fit found.

use nlmodes::least_squares::{Minimum, inverse_normal};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::FitError;
use super::model::Trials;
use crate::case::setting;
use crate::curve::Curve;
use crate::study::{Measured, Study};

/// What a fit found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitOutcome {
    /// The variables.
    pub parameters: Vec<Fitted>,
    /// Covariance of the variables, each in its unit.
    pub covariance: Vec<Vec<f64>>,
    /// Their correlations.
    pub correlation: Vec<Vec<f64>>,
    /// Whether the deviations of the points are stated; else they follow from what the fit leaves.
    pub deviations_are_stated: bool,
    /// Sum of the squares of what is left, over the deviations.
    pub chi_squared: f64,
    /// Numbers less variables.
    pub degrees_of_freedom: usize,
    /// Probability that noise with the stated deviations leaves as much; none where none are stated, or nothing is left
    /// to judge.
    pub probability: Option<f64>,
    /// Largest error of interpolation between the points of the curve, over the deviation of the measured number.
    pub interpolation: f64,
    /// Steps of the search.
    pub iterations: usize,
    /// Curves that it took.
    pub curves: usize,
    /// The measured numbers beside the curve.
    pub points: Vec<FittedRow>,
    /// The case with the variables as found.
    pub case: String,
    /// `--set` arguments of the scene with the variables as found.
    pub set: Vec<String>,
    /// The curves with the variables at the start and as found.
    #[serde(skip)]
    pub(super) curves_at: [Curve; 2],
}

/// A variable that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fitted {
    /// The variable.
    pub variable: String,
    /// Where it began.
    pub start: f64,
    /// What it is.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
}

/// A measured number beside the curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedRow {
    /// Its column.
    pub column: String,
    /// Where on the curve it is.
    pub place: f64,
    /// As measured.
    pub measured: f64,
    /// Its standard deviation; none where none is stated.
    pub std: Option<f64>,
    /// At the start.
    pub before: f64,
    /// As fitted.
    pub fitted: f64,
}

/// Full steps below this share of the standard deviation of each variable end a search that comes no nearer.
const SMALL: f64 = 0.01;

impl FitOutcome {
    pub(super) fn new(
        study: &Study,
        measured: &Measured,
        trials: &mut Trials<'_, '_>,
        minimum: &Minimum,
    ) -> Result<Self, FitError> {
        let n = trials.start.len();
        let degrees_of_freedom = trials.n_points() - n;
        let chi_squared: f64 = minimum.residual.iter().map(|r| r * r).sum();
        let stated = measured.columns.iter().all(|column| column.has_deviations);
        let scatter = if stated { 1.0 } else { chi_squared / degrees_of_freedom as f64 };
        let inverse = inverse_normal(&minimum.slopes).map_err(FitError::Linalg)?;
        let covariance: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..n).map(|j| scatter * inverse[(i, j)] * trials.start[i] * trials.start[j]).collect())
            .collect();
        let std = |k: usize| covariance[k][k].sqrt();
        let least = (0..n).map(|k| std(k) / trials.start[k].abs()).fold(f64::INFINITY, f64::min);
        if !minimum.is_found && minimum.step > (SMALL * least).max(1e3 * super::SEARCH.smallest_step) {
            return Err(FitError::NotConverged { iterations: minimum.iterations, step: minimum.step });
        }
        let before = trials.at(&vec![1.0; n])?.cloned();
        let found = trials.at(&minimum.x)?.cloned();
        let (Some(before), Some(found)) = (before, found) else {
            return Err(FitError::Start { reason: trials.missing.clone() });
        };
        let values = trials.values(&minimum.x);
        let named = study.variables.iter().zip(trials.start.iter().zip(&values)).enumerate();
        let parameters = named.map(|(k, (one, (start, value)))| Fitted {
            variable: one.name.clone(),
            start: *start,
            value: *value,
            std: std(k),
        });
        let columns = measured.columns.iter();
        let names = columns.flat_map(|column| column.cells.iter().flatten().map(|_| column.name.clone()));
        let rows = trials.points.iter().zip(names).zip(before.values.iter().zip(&found.values));
        let points = rows.map(|((point, column), (before, found))| FittedRow {
            column,
            place: point.place,
            measured: point.value,
            std: stated.then_some(point.std),
            before: before[0],
            fitted: found[0],
        });
        let worst = trials.points.iter().zip(&found.values).map(|(point, [_, error])| error / point.std);
        let set = study.variables.iter().zip(&values);
        let set = set.flat_map(|(one, value)| one.keys.iter().map(|key| setting(key, &(*value).into())));
        let probability = match ChiSquared::new(degrees_of_freedom as f64) {
            Ok(of) if stated && degrees_of_freedom > 0 => Some(of.sf(chi_squared)),
            _ => None,
        };
        Ok(Self {
            correlation: (0..n).map(|i| (0..n).map(|j| covariance[i][j] / (std(i) * std(j))).collect()).collect(),
            parameters: parameters.collect(),
            deviations_are_stated: stated,
            chi_squared,
            degrees_of_freedom,
            probability,
            interpolation: worst.fold(0.0, f64::max) / scatter.sqrt(),
            iterations: minimum.iterations,
            curves: trials.n_trials(),
            points: points.collect(),
            case: found.id,
            set: set.collect(),
            curves_at: [before.curve, found.curve],
            covariance,
        })
    }
}
