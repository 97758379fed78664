//! Residuals of measured points and their derivatives.

use std::collections::HashMap;

use nlmodes::least_squares::Residuals;

use super::FitError;
use crate::case::resolve_differentiated;
use crate::curve::{Curve, Picked, derivatives, pick};
use crate::distribution::Tolerance;
use crate::first_order::Further;
use crate::run::Worker;
use crate::study::{Measured, Of, Place, Quantity, Study};

/// A measured number as a quantity of the curve.
pub struct Point {
    pub quantity: Quantity,
    pub place: f64,
    pub value: f64,
    pub std: f64,
}

/// The points on the curve with trial values, and their derivatives.
#[derive(Debug, Clone)]
pub struct Trial {
    pub id: String,
    pub curve: Curve,
    /// Each value with the error of its interpolation.
    pub values: Vec<[f64; 2]>,
    /// Derivatives of each value by the variables.
    pub slopes: Vec<Vec<f64>>,
}

/// The curves with trial values, which are over those at the start.
pub struct Trials<'a, 'b> {
    study: &'a Study,
    cases: &'a Worker<'b>,
    pub points: Vec<Point>,
    pub start: Vec<f64>,
    /// Those that were computed, by the bits of their values.
    known: HashMap<Vec<u64>, Option<Trial>>,
    /// Why the last one that could not be compared could not.
    pub missing: String,
}

impl<'a, 'b> Trials<'a, 'b> {
    /// Of the measured points of a study.
    pub fn new(study: &'a Study, measured: &Measured, cases: &'a Worker<'b>) -> Result<Self, FitError> {
        let mut points = Vec::new();
        for column in &measured.columns {
            for (place, cell) in measured.places.iter().zip(&column.cells) {
                let Some([value, std]) = *cell else { continue };
                let quantity = Quantity {
                    name: format!("{} at {} = {}", column.name, measured.over, nlmodes_scene::number(*place)),
                    of: Of::Column(column.name.clone()),
                    at: Place::Column { name: measured.over.clone(), value: *place },
                    response: measured.response,
                    limit: None,
                };
                points.push(Point { quantity, place: *place, value, std });
            }
        }
        let (start, known, missing) = (start(study)?, HashMap::new(), String::new());
        Ok(Self { study, cases, points, start, known, missing })
    }

    /// Number of measured numbers.
    pub fn n_points(&self) -> usize {
        self.points.len()
    }

    /// Number of curves that were computed.
    pub fn n_trials(&self) -> usize {
        self.known.len()
    }

    /// The values of the variables.
    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.start).map(|(x, start)| x * start).collect()
    }

    /// The curve with these values over those at the start; none where a point is not on it.
    pub fn at(&mut self, x: &[f64]) -> Result<Option<&Trial>, FitError> {
        let bits: Vec<u64> = x.iter().map(|x| x.to_bits()).collect();
        if !self.known.contains_key(&bits) {
            let values = self.values(x);
            let found = match self.cases.at(&values)? {
                Further::Missing => return Err(FitError::Ended),
                Further::Failed(reason) => Err(reason),
                Further::Found { id, curve } => self.trial(id, *curve),
            };
            let found = found.map_err(|reason| self.missing = reason).ok();
            self.known.insert(bits.clone(), found);
        }
        Ok(self.known.get(&bits).and_then(Option::as_ref))
    }

    fn trial(&self, id: String, curve: Curve) -> Result<Trial, String> {
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for point in &self.points {
            match pick(&curve, &point.quantity) {
                Picked::Value { value, error } => values.push([value, error]),
                Picked::Missing(reason) => return Err(reason),
            }
            let of = |keys: &Vec<String>| -> Result<f64, String> {
                let by = derivatives(&curve, &point.quantity, keys);
                Ok(by.map_err(|reason| format!("{}: {reason}", point.quantity.name))?.iter().sum())
            };
            slopes.push(self.study.variables.iter().map(|one| of(&one.keys)).collect::<Result<_, String>>()?);
        }
        Ok(Trial { id, curve, values, slopes })
    }
}

impl Residuals for Trials<'_, '_> {
    type Error = FitError;

    fn residual(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, FitError> {
        let Some(values) = self.at(x)?.map(|trial| trial.values.clone()) else { return Ok(None) };
        let residual = |(point, [value, _]): (&Point, [f64; 2])| (value - point.value) / point.std;
        Ok(Some(self.points.iter().zip(values).map(residual).collect()))
    }

    fn slopes(&mut self, x: &[f64]) -> Result<Vec<Vec<f64>>, FitError> {
        let slopes = self.at(x)?.map(|trial| trial.slopes.clone()).unwrap_or_default();
        let column = |k: usize| {
            let rows = slopes.iter().zip(&self.points);
            rows.map(|(row, point)| row[k] * self.start[k] / point.std).collect()
        };
        Ok((0..self.start.len()).map(column).collect())
    }
}

/// Where the variables begin: at their means or, where none are given, at the values of the scene.
fn start(study: &Study) -> Result<Vec<f64>, FitError> {
    let parts =
        resolve_differentiated(study, Vec::new()).map_err(|refused| FitError::Start { reason: refused.sentence() })?;
    let written = |key: &str| {
        let own = parts.first()?.file.scene.sensitivities.iter().find(|own| own.key == key)?;
        Some(own.value)
    };
    let of = |variable: &crate::study::Variable| {
        let mean = Tolerance::of(variable, &study.design).ok().map(|tolerance| tolerance.mean);
        let own = mean.or_else(|| written(variable.keys.first()?));
        own.filter(|value| *value != 0.0).ok_or_else(|| FitError::Start {
            reason: format!("{} has no value from which a search could begin", variable.name),
        })
    };
    study.variables.iter().map(of).collect()
}
