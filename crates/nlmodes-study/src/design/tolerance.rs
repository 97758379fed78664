//! The tolerance of a variable of a study.

use serde_json::Value;

use crate::distribution::Tolerance;
use crate::study::{Design, Values, Variable};

impl Tolerance {
    /// Of a variable of the study.
    ///
    /// # Errors
    /// Why it has none, in words: its values are no numbers, or each of its keys has values of its own.
    pub fn of(variable: &Variable, design: &Design) -> Result<Self, String> {
        let name = &variable.name;
        let values = match &variable.values {
            Values::Drawn(distribution) => return Ok(distribution.moments(design.box_deviations)),
            Values::Listed(values) => values,
        };
        if values.iter().any(|row| row.iter().any(|value| *value != row[0])) {
            return Err(format!("the keys of {name} have values of their own, and there is no mean of them"));
        }
        let numbers: Option<Vec<f64>> = values.iter().map(|row| row.first().and_then(Value::as_f64)).collect();
        let numbers = numbers.filter(|numbers| !numbers.is_empty());
        let numbers = numbers.ok_or_else(|| format!("the values of {name} are no numbers"))?;
        let n = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / n;
        let variance = numbers.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n;
        let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let high = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Ok(Self { mean, std: variance.sqrt(), ends: [low, high] })
    }
}
