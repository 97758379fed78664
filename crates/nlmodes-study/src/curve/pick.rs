//! Quantities of a branch.

use super::between::{Between, at_first, largest_between};
use super::{Curve, Level};
use crate::study::{Of, Place, Quantity, Selected, Sweep};

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

/// Evaluates a quantity on a branch, or on the curves of responses that it is about.
pub fn pick(curve: &Curve, quantity: &Quantity) -> Picked {
    let found = match &quantity.of {
        Of::Column(column) => of_column(curve, quantity, column),
        Of::Peak => peak(curve, quantity),
        Of::Jump(sweep) => jump(curve, quantity, *sweep),
    };
    match found {
        Ok(Between { value, error }) if value.is_finite() => Picked::Value { value, error },
        Ok(_) => Picked::Missing(format!("{}: {} has no value there", quantity.name, quantity.of.column())),
        Err(reason) => Picked::Missing(format!("{}: {reason}", quantity.name)),
    }
}

/// A column at a place: of several curves at the first one that has it, or the most extreme of all.
fn of_column(curve: &Curve, quantity: &Quantity, column: &str) -> Result<Between, String> {
    part_with(curve, quantity, column).map(|(_, found)| found)
}

/// The curve that has a column at a place, and its value there.
pub(super) fn part_with(curve: &Curve, quantity: &Quantity, column: &str) -> Result<(Curve, Between), String> {
    let parts = curve.parts(quantity.response, false);
    let found = parts.into_iter().map(|part| {
        let value = at_place(&part, quantity, column)?;
        Ok((part, value))
    });
    let wanted: fn(f64, f64) -> bool = match quantity.at {
        Place::Max => |new, old| new > old,
        Place::Min => |new, old| new < old,
        _ => |_, _| false,
    };
    found
        .reduce(|best: Result<(Curve, Between), String>, next| match (&best, &next) {
            (Ok((_, old)), Ok((_, new))) if wanted(new.value, old.value) => next,
            (Err(_), Ok(_)) => next,
            _ => best,
        })
        .unwrap_or_else(|| Err(no_curve(quantity)))
}

pub(super) fn no_curve(quantity: &Quantity) -> String {
    let Selected { response, level } = quantity.response;
    let response = response.map(|number| format!(" of response {number}"));
    let level = level.map(|level| format!(" at level {}", nlmodes_scene::number(level)));
    format!("there is no curve{}{}", response.unwrap_or_default(), level.unwrap_or_default())
}

fn at_place(curve: &Curve, quantity: &Quantity, column: &str) -> Result<Between, String> {
    let Some(values) = curve.column(column) else { return Err(format!("there is no column {column}")) };
    let unknown = || format!("{column} has no value there");
    match &quantity.at {
        Place::First => of_point(values, 0).ok_or_else(unknown),
        Place::Last => of_point(values, values.len().wrapping_sub(1)).ok_or_else(unknown),
        Place::Max => extreme(values, f64::gt).ok_or_else(unknown),
        Place::Min => extreme(values, f64::lt).ok_or_else(unknown),
        Place::Event(event) => match curve.events().iter().position(|events| events.contains(event)) {
            Some(point) => of_point(values, point).ok_or_else(unknown),
            None => Err(format!("the branch has no {event}")),
        },
        Place::Column { name, value } => match curve.column(name) {
            Some(x) => at_first(curve, x, values, *value).ok_or_else(|| never(x, name, *value)),
            None => Err(format!("there is no column {name}")),
        },
    }
}

/// The largest amplitude of the curves over the frequency, between points.
fn peak(curve: &Curve, quantity: &Quantity) -> Result<Between, String> {
    let parts = curve.parts(quantity.response, true);
    let of = |part: &Curve| {
        let amplitude: Vec<f64> = part.column("fundamental_m")?.iter().map(|value| value.abs()).collect();
        largest_between(part, part.column("frequency_hz")?, &amplitude)
    };
    let found = parts.iter().filter_map(of);
    found.max_by(|a, b| a.value.total_cmp(&b.value)).ok_or_else(|| no_curve(quantity))
}

/// The frequency of the first jump of a sweep: the lowest upwards, the highest downwards.
pub(super) fn jump(curve: &Curve, quantity: &Quantity, sweep: Sweep) -> Result<Between, String> {
    let is_up = sweep == Sweep::Up;
    let mut levels = curve.levels(quantity.response).peekable();
    if levels.peek().is_none() {
        return Err(no_curve(quantity));
    }
    let levels: Vec<&Level> = levels.collect();
    if levels.iter().all(|level| !level.is_known) {
        return Err("stability is not known, without which no jumps are (output.stability)".to_owned());
    }
    let jumps = levels.iter().flat_map(|level| &level.jumps).filter(|(_, up)| *up == is_up).map(|(hz, _)| *hz);
    let first = if is_up { jumps.reduce(f64::min) } else { jumps.reduce(f64::max) };
    let name = if is_up { "up" } else { "down" };
    first.map(|value| Between { value, error: 0.0 }).ok_or_else(|| format!("a sweep {name} does not jump"))
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
