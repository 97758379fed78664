//! First-order spread, beside that of the cases.

use serde::Serialize;

use super::{Slope, Within};
use crate::distribution::Tolerance;
use crate::statistics::Statistics;
use crate::study::{Study, Variable};

/// What a variable does to a quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// The variable.
    pub variable: String,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub std: f64,
    /// Derivative of the quantity, per unit of the variable.
    pub derivative: f64,
    /// Its share of the first-order variance; none where that is zero.
    pub share: Option<f64>,
    /// Its first-order Sobol' index less this share, and the standard error of the index; none without an index.
    pub index_less_share: Option<[f64; 2]>,
}

/// The standard deviation of cases beside that of first order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Compared {
    /// That of the cases.
    pub std: f64,
    /// Its standard error, of independent cases.
    pub std_error: f64,
    /// What it is more than that of first order, relative to that.
    pub more: f64,
    /// Whether that is more than two standard errors: the quantity is then no straight line over the tolerances, and
    /// the cases count.
    pub differs: bool,
    /// The mean of the cases less the value at the means of the variables, in standard deviations of first order.
    pub shift: f64,
}

/// Standard errors within which two deviations agree.
const ERRORS: f64 = 2.0;

/// The first-order standard deviation, and the effect of each variable.
pub fn effects(within: &Within<'_>, slope: &Slope, statistics: Option<&Statistics>) -> (Option<f64>, Vec<Effect>) {
    let each = || slope.by.iter().zip(&within.tolerances);
    let variance: f64 = each().map(|(by, tolerance)| (by * tolerance.std).powi(2)).sum();
    let index = |name: &str| {
        let found = statistics?.sobol_indices.iter().find(|found| found.variable == name)?;
        Some([found.measure.first, found.measure.first_error])
    };
    let effect = |(variable, (by, tolerance)): (&Variable, (&f64, &Tolerance))| {
        let share = (variance > 0.0).then(|| (by * tolerance.std).powi(2) / variance);
        Effect {
            variable: variable.name.clone(),
            mean: tolerance.mean,
            std: tolerance.std,
            derivative: *by,
            share,
            index_less_share: share.zip(index(&variable.name)).map(|(share, [index, error])| [index - share, error]),
        }
    };
    let effects = within.study.variables.iter().zip(each()).map(effect).collect();
    (Some(variance.sqrt()), effects)
}

/// The deviation of the cases beside that of first order; none of designs whose cases are not drawn.
pub fn compared(study: &Study, (value, std): (f64, Option<f64>), statistics: Option<&Statistics>) -> Option<Compared> {
    let (spread, first) = (statistics?.spread.as_ref()?, std.filter(|std| *std > 0.0)?);
    if !study.design.kind.is_sampled() || !spread.std.is_finite() {
        return None;
    }
    Some(Compared {
        std: spread.std,
        std_error: spread.std_error,
        more: spread.std / first - 1.0,
        differs: (spread.std - first).abs() > ERRORS * spread.std_error,
        shift: (spread.mean - value) / first,
    })
}
