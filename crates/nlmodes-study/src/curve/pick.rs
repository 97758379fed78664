//! Quantities of a branch.

use super::Curve;
use super::between::{Between, at_first};
use crate::study::{Place, Quantity};

/// Value of a quantity on one branch.
#[derive(Debug, Clone, PartialEq)]
pub enum Picked {
    /// Its value, with the estimated error of interpolation.
    Value {
        /// The value.
        value: f64,
        /// Estimate of the error, 0 at a point of the branch.
        error: f64,
    },
    /// The branch does not have it; the reason is given.
    Missing(String),
}

/// Evaluates a quantity on a branch.
pub fn pick(curve: &Curve, quantity: &Quantity) -> Picked {
    let missing = |reason: String| Picked::Missing(format!("{}: {reason}", quantity.name));
    let Some(values) = curve.column(&quantity.of) else {
        return missing(format!("there is no column {}", quantity.of));
    };
    let found = match &quantity.at {
        Place::First => of_point(values, 0),
        Place::Last => of_point(values, values.len().wrapping_sub(1)),
        Place::Max => extreme(values, f64::gt),
        Place::Min => extreme(values, f64::lt),
        Place::Event(event) => {
            let point = curve.events().iter().position(|events| events.contains(event));
            match point {
                Some(point) => of_point(values, point),
                None => return missing(format!("the branch has no {event}")),
            }
        }
        Place::Column { name, value } => match curve.column(name) {
            Some(x) => match at_first(curve, x, values, *value) {
                Some(found) => Some(found),
                None => return missing(never(x, name, *value)),
            },
            None => return missing(format!("there is no column {name}")),
        },
    };
    match found.filter(|found| found.value.is_finite()) {
        Some(Between { value, error }) => Picked::Value { value, error },
        None => missing(format!("{} has no value there", quantity.of)),
    }
}

fn of_point(values: &[f64], point: usize) -> Option<Between> {
    values.get(point).map(|value| Between { value: *value, error: 0.0 })
}

fn extreme(values: &[f64], is_beyond: fn(&f64, &f64) -> bool) -> Option<Between> {
    let finite = values.iter().filter(|value| value.is_finite());
    let found = finite.copied().reduce(|found, value| if is_beyond(&value, &found) { value } else { found });
    found.map(|value| Between { value, error: 0.0 })
}

/// Why a value is never reached.
fn never(x: &[f64], name: &str, value: f64) -> String {
    let [low, high] = x.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
    let number = nlmodes_scene::number;
    if low > high {
        return format!("{name} has no values");
    }
    format!("{name} goes from {} to {}, and is never {}", number(low), number(high), number(value))
}
