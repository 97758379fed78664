//! The worst corners of the box of tolerances.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Cases, Further, Slope, Within};
use crate::distribution::Tolerance;
use crate::error::StudyError;
use crate::study::Quantity;

/// A corner of the box at which a quantity is largest or smallest by first order, and what it is there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Corner {
    /// `largest` or `smallest`.
    pub which: &'static str,
    /// The values of the variables.
    pub at: BTreeMap<String, f64>,
    /// The quantity by first order.
    pub predicted: f64,
    /// As it is computed there; none where it is not.
    pub computed: Option<f64>,
    /// Variables whose derivative has another sign there: the quantity is more extreme within the box.
    pub turns_over: Vec<String>,
    /// Why it is not computed, or its gradients are not known; else empty.
    pub reason: String,
    /// The case; empty where there is none.
    pub case: String,
}

/// The ends of the box toward which a quantity grows, or falls; a variable that does nothing stays at its mean.
pub fn ends(within: &Within<'_>, slope: &Slope, grows: bool) -> Vec<f64> {
    let end = |(by, tolerance): (&f64, &Tolerance)| match *by {
        0.0 => tolerance.mean,
        by => tolerance.ends[usize::from((by > 0.0) == grows)],
    };
    slope.by.iter().zip(&within.tolerances).map(end).collect()
}

/// The largest and the smallest corner.
pub fn both(
    within: &Within<'_>,
    (quantity, slope): (&Quantity, &Slope),
    cases: &mut Cases<'_>,
) -> Result<Vec<Corner>, StudyError> {
    let mut corners = Vec::new();
    for (which, grows) in [("largest", true), ("smallest", false)] {
        let at = ends(within, slope, grows);
        let names = within.study.variables.iter().map(|variable| variable.name.clone());
        let mut corner = Corner {
            which,
            predicted: within.predicted(slope, &at),
            at: names.zip(at.iter().copied()).collect(),
            computed: None,
            turns_over: Vec::new(),
            reason: String::new(),
            case: String::new(),
        };
        match cases(&at)? {
            Further::Missing => corner.reason = "not computed yet".to_owned(),
            Further::Failed(reason) => corner.reason = reason,
            Further::Found { id, curve } => {
                corner.case = id;
                match within.slope(quantity, &curve) {
                    Ok(there) => {
                        corner.computed = Some(there.value);
                        corner.turns_over = turned(within, slope, &there);
                    }
                    Err(reason) => {
                        corner.computed = within.value(quantity, &curve);
                        corner.reason = reason;
                    }
                }
            }
        }
        corners.push(corner);
    }
    Ok(corners)
}

/// Variables whose derivative has another sign at a corner than at the means.
fn turned(within: &Within<'_>, slope: &Slope, there: &Slope) -> Vec<String> {
    let both = slope.by.iter().zip(&there.by).zip(&within.study.variables);
    both.filter(|((here, there), _)| *here * *there < 0.0).map(|(_, variable)| variable.name.clone()).collect()
}
