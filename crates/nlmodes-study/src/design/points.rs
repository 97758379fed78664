//! The points of a design.

use serde_json::Value;

use super::random::{independent, latin_hypercube};
use super::sobol::Sobol;
use crate::distribution::Tolerance;
use crate::study::{Design, DesignKind, Study, Values, Variable};

/// The points of a study's design, computed on request.
#[derive(Debug)]
pub struct Points<'a> {
    study: &'a Study,
    count: usize,
    unit: Unit,
}

/// Points of the unit cube.
#[derive(Debug)]
enum Unit {
    None,
    Listed(Vec<Vec<f64>>),
    Sequence(Sobol),
}

impl<'a> Points<'a> {
    /// The points of this study.
    pub fn new(study: &'a Study) -> Self {
        let (design, variables) = (&study.design, study.variables.len());
        // Sobol' indices use pairs of independent points.
        let dimensions = if design.sobol_indices { 2 * variables } else { variables };
        let unit = match design.kind {
            DesignKind::Grid | DesignKind::List | DesignKind::FirstOrder => Unit::None,
            DesignKind::Sobol => Unit::Sequence(Sobol::new(dimensions, design.seed)),
            DesignKind::LatinHypercube => Unit::Listed(latin_hypercube(design.samples, dimensions, design.seed)),
            DesignKind::Random => Unit::Listed(independent(design.samples, dimensions, design.seed)),
        };
        Self { study, count: count(study), unit }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The value of each key of each variable.
    pub fn get(&self, number: usize) -> Vec<Vec<Value>> {
        match self.study.design.kind {
            DesignKind::Grid => self.of_grid(number),
            DesignKind::List => self.study.variables.iter().map(|variable| listed(variable, number)).collect(),
            DesignKind::FirstOrder => self.study.variables.iter().map(|one| nominal(one, &self.study.design)).collect(),
            _ => {
                let unit = self.unit_point(number);
                self.study.variables.iter().zip(unit).map(|(variable, u)| drawn(variable, u)).collect()
            }
        }
    }

    /// A combination of values: the last variable varies fastest.
    fn of_grid(&self, mut number: usize) -> Vec<Vec<Value>> {
        let mut point: Vec<Vec<Value>> = Vec::new();
        for variable in self.study.variables.iter().rev() {
            let n = n_listed(variable);
            point.push(listed(variable, number % n));
            number /= n;
        }
        point.reverse();
        point
    }

    /// With Sobol' indices the points of a block are A, B, and A with one coordinate of B, for each of them.
    fn unit_point(&self, number: usize) -> Vec<f64> {
        let variables = self.study.variables.len();
        if !self.study.design.sobol_indices {
            return self.base(number);
        }
        let (block, of) = (number / (variables + 2), number % (variables + 2));
        let both = self.base(block);
        let (a, b) = both.split_at(variables);
        match of {
            0 => a.to_vec(),
            1 => b.to_vec(),
            of => a.iter().zip(b).enumerate().map(|(k, (a, b))| if k + 2 == of { *b } else { *a }).collect(),
        }
    }

    fn base(&self, number: usize) -> Vec<f64> {
        match &self.unit {
            Unit::Sequence(sequence) => sequence.point(number),
            Unit::Listed(points) => points.get(number).cloned().unwrap_or_default(),
            Unit::None => Vec::new(),
        }
    }
}

fn count(study: &Study) -> usize {
    let Design { kind, samples, sobol_indices, .. } = &study.design;
    match kind {
        DesignKind::Grid => study.variables.iter().map(n_listed).product(),
        DesignKind::List => study.variables.iter().map(n_listed).min().unwrap_or(1),
        DesignKind::FirstOrder => 1,
        _ if *sobol_indices => samples * (study.variables.len() + 2),
        _ => *samples,
    }
}

/// Number of values that are listed; 1 if they are drawn at random, which grid and list reject.
pub fn n_listed(variable: &Variable) -> usize {
    match &variable.values {
        Values::Listed(values) => values.len().max(1),
        Values::Drawn(_) => 1,
    }
}

fn listed(variable: &Variable, number: usize) -> Vec<Value> {
    match &variable.values {
        Values::Listed(values) => values.get(number).cloned().unwrap_or_default(),
        Values::Drawn(_) => Vec::new(),
    }
}

/// The mean of a variable; of one without a mean its first value.
fn nominal(variable: &Variable, design: &Design) -> Vec<Value> {
    match Tolerance::of(variable, design) {
        Ok(tolerance) => vec![Value::from(tolerance.mean); variable.keys.len()],
        Err(_) => listed(variable, 0),
    }
}

/// The value at a given cumulative probability: the quantile of a distribution, or an item of a list with equal
/// probabilities.
fn drawn(variable: &Variable, u: f64) -> Vec<Value> {
    match &variable.values {
        Values::Drawn(distribution) => vec![Value::from(distribution.quantile(u)); variable.keys.len()],
        Values::Listed(values) => listed(variable, ((u * values.len() as f64) as usize).min(values.len().max(1) - 1)),
    }
}
