//! Derivatives of quantities by parameters of the scene, from those of the points of a curve.
//!
//! ```text
//! q = A where B = v:   dq/dp = A_p − (A_s/B_s) B_p        A_p, B_p at points of the curve, with what is held there
//! ```

use nlmodes::modal::{Event, GradientOf};

use super::between::{at_first, slope_at_first};
use super::pick::{jump, part_with};
use super::{Curve, ENERGY_RATIO, Held};
use crate::study::{Of, Place, Quantity, Sweep};

/// The columns of `branch.csv` that have derivatives, with what these are of.
pub const DIFFERENTIATED: [(&str, GradientOf); 7] = [
    ("frequency_hz", GradientOf::Frequency),
    ("fundamental_m", GradientOf::Amplitude),
    ("peak_m", GradientOf::Peak),
    ("peak_contact_force_n", GradientOf::PeakForce),
    ("impulse_ns", GradientOf::Impulse),
    ("level", GradientOf::Level),
    ("damping_ratio", GradientOf::DampingRatio),
];

/// Columns whose largest value over the frequency has a point of its own.
const WITH_A_POINT: [&str; 2] = ["fundamental_m", "peak_contact_force_n"];

/// The columns of a curve, by name, with their derivatives by one parameter.
pub struct Columns<'c> {
    curve: &'c Curve,
    key: &'c str,
}

impl<'c> Columns<'c> {
    /// Of this curve by the parameter with this key.
    pub fn new(curve: &'c Curve, key: &'c str) -> Self {
        Self { curve, key }
    }

    /// Derivative of a column at each point, what is [`Held`] there being constant.
    pub fn derivative(&self, column: &str) -> Result<Vec<f64>, String> {
        if self.curve.held().columns().contains(&column) {
            return Ok(vec![0.0; self.curve.len()]);
        }
        let of = DIFFERENTIATED.iter().find(|(name, _)| *name == column);
        if column == ENERGY_RATIO {
            return Err("an energy ratio moves with the gap; { energy_j = … } holds the energy itself".to_owned());
        }
        let Some((_, of)) = of else {
            let known = DIFFERENTIATED.map(|(name, _)| name).join(", ");
            return Err(format!("{column} has no derivatives, which {known} have"));
        };
        let values = self.of(*of)?;
        // That of an amplitude is of its magnitude.
        match (of, self.curve.column(column)) {
            (GradientOf::Amplitude, Some(own)) => Ok(values.iter().zip(own).map(|(d, own)| d * own.signum()).collect()),
            _ => Ok(values.to_vec()),
        }
    }

    /// The column of derivatives as it is written.
    fn of(&self, what: GradientOf) -> Result<&'c [f64], String> {
        let name = format!("d_{}_d_{}", what.name(), self.key);
        self.curve.column(&name).ok_or_else(|| format!("there is no column {name}"))
    }

    /// `dA/dp` where B has a value.
    fn where_it_is(&self, column: &str, other: &str, value: f64) -> Result<f64, String> {
        let (curve, never) = (self.curve, || format!("the curve does not have {other} there"));
        if column == other {
            return Ok(0.0);
        }
        let (Some(x), Some(y)) = (curve.column(other), curve.column(column)) else {
            return Err(format!("there is no column {other}"));
        };
        // These are at constant amplitude, and stay what they are at a fold.
        let at_amplitude = match (curve.held(), column, other) {
            (Held::Frequency, "frequency_hz", "fundamental_m") => Some(GradientOf::Frequency),
            (Held::FrequencyOverLevel, "level", "fundamental_m") => Some(GradientOf::Level),
            _ => None,
        };
        if let Some(of) = at_amplitude {
            return at_first(curve, x, self.of(of)?, value).map(|found| found.value).ok_or_else(never);
        }
        let at = |values: &[f64]| at_first(curve, x, values, value).map(|found| found.value).ok_or_else(never);
        let own = at(&self.derivative(column)?)?;
        if curve.held().columns().contains(&other) {
            return Ok(own);
        }
        let moved = at(&self.derivative(other)?)?;
        let slope = slope_at_first(curve, x, y, value).ok_or_else(|| format!("{other} turns there"))?;
        Ok(own - slope * moved)
    }

    /// At a point that stays where it is: within the curve one with an extreme value, at its ends those of a window.
    fn at_point(&self, column: &str, point: usize) -> Result<f64, String> {
        let is_end = point == 0 || point + 1 == self.curve.len();
        let held = self.curve.held();
        if is_end && held == Held::Energy {
            let which = "of several responses, `response = 1` takes the first";
            return Err(format!(
                "the ends of a mode move with the parameters; {{ energy_j = … }} holds the energy; {which}"
            ));
        }
        if !is_end && held == Held::Frequency && !WITH_A_POINT.contains(&column) {
            let with = WITH_A_POINT.join(" and ");
            return Err(format!("the extreme value of {column} lies between points; {with} have one of their own"));
        }
        if held == Held::Frequency && self.is_at_a_fold(point) {
            return Err(
                "the extreme value lies at a fold, where nothing has a derivative at a constant frequency".to_owned()
            );
        }
        self.derivative(column)?.get(point).copied().ok_or_else(|| "there is no such point".to_owned())
    }

    /// Whether a point is a fold, or one that was located beside it.
    fn is_at_a_fold(&self, point: usize) -> bool {
        let hz = self.curve.column("frequency_hz").unwrap_or_default();
        let folds = self.curve.events().iter().zip(hz).filter(|(events, _)| events.contains(&Event::Fold));
        let Some(own) = hz.get(point) else { return false };
        folds.map(|(_, fold)| (own / fold - 1.0).abs()).any(|off| off < AT_A_FOLD)
    }
}

/// Relative distance from a fold within which derivatives at a constant frequency say nothing.
const AT_A_FOLD: f64 = 1e-9;

/// Derivatives of a quantity by the parameters with these keys, per unit of each.
///
/// # Errors
/// Why it has none: a place that moves with the parameters, a column without derivatives.
pub fn derivatives(curve: &Curve, quantity: &Quantity, keys: &[String]) -> Result<Vec<f64>, String> {
    let known = |value: Result<f64, String>| match value {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err("the derivative is not known there".to_owned()),
        Err(reason) => Err(reason),
    };
    match &quantity.of {
        Of::Jump(sweep) => {
            let (part, point) = jumped(curve, quantity, *sweep)?;
            keys.iter().map(|key| known(Columns::new(&part, key).at_fold("frequency_hz", point))).collect()
        }
        Of::Peak => {
            let parts = curve.parts(quantity.response, true);
            let highest = |part: &Curve| extreme(part.column("fundamental_m")?, |value| value.abs());
            let found = parts.iter().filter_map(|part| Some((part, highest(part)?)));
            let (part, (point, _)) =
                found.max_by(|a, b| a.1.1.total_cmp(&b.1.1)).ok_or_else(|| super::pick::no_curve(quantity))?;
            let sign = part.column("fundamental_m").map_or(1.0, |values| values[point].signum());
            let of = |key: &String| Columns::new(part, key).at_point("fundamental_m", point).map(|d| sign * d);
            keys.iter().map(|key| known(of(key))).collect()
        }
        Of::Column(column) => {
            let (part, found) = part_with(curve, quantity, column)?;
            keys.iter().map(|key| known(of_column(&part, quantity, (column, found.value), key))).collect()
        }
    }
}

fn of_column(part: &Curve, quantity: &Quantity, (column, value): (&str, f64), key: &str) -> Result<f64, String> {
    let columns = Columns::new(part, key);
    match &quantity.at {
        Place::Column { name, value } => columns.where_it_is(column, name, *value),
        Place::First => columns.at_point(column, 0),
        Place::Last => columns.at_point(column, part.len().saturating_sub(1)),
        Place::Max | Place::Min => {
            let values = part.column(column).unwrap_or_default();
            let point = values.iter().position(|own| *own == value);
            columns.at_point(column, point.ok_or("there is no such point")?)
        }
        Place::Event(Event::Fold) => {
            let point = part.events().iter().position(|events| events.contains(&Event::Fold));
            columns.at_fold(column, point.ok_or("there is no fold")?)
        }
        Place::Event(event) => Err(format!("where the branch has its {event} moves with the parameters")),
    }
}

impl Columns<'_> {
    /// Of what is folded, at the point of its fold.
    fn at_fold(&self, column: &str, point: usize) -> Result<f64, String> {
        let of = match (self.curve.held(), column) {
            (Held::Frequency, "frequency_hz") => GradientOf::Frequency,
            (Held::FrequencyOverLevel, "level") => GradientOf::Level,
            (held, _) if held.columns().contains(&column) => return Ok(0.0),
            _ => return Err(format!("at a fold {column} has no derivative, but that what folds has: where it jumps")),
        };
        self.of(of)?.get(point).copied().ok_or_else(|| "there is no such point".to_owned())
    }
}

/// The curve and the point of the fold at which a sweep jumps first.
fn jumped(curve: &Curve, quantity: &Quantity, sweep: Sweep) -> Result<(Curve, usize), String> {
    let at = jump(curve, quantity, sweep)?.value;
    let parts = curve.parts(quantity.response, true).into_iter();
    let mut found = parts.filter_map(|part| {
        let folds = part.events().iter().zip(part.column("frequency_hz")?);
        let point = folds.enumerate().position(|(_, (events, hz))| events.contains(&Event::Fold) && *hz == at)?;
        Some((part, point))
    });
    found.next().ok_or_else(|| "the jump is at no fold, and how it moves is not known".to_owned())
}

/// The point with the largest value that is a number, and this value.
fn extreme(values: &[f64], of: impl Fn(f64) -> f64) -> Option<(usize, f64)> {
    let finite = values.iter().map(|value| of(*value)).enumerate().filter(|(_, value)| value.is_finite());
    finite.max_by(|a, b| a.1.total_cmp(&b.1))
}
