//! Matrices whose rows are named by node and direction.

use std::collections::HashMap;

use super::MatrixData;
use crate::build::{EntryBuilder, Fault, MAX_ORDER, Pass, Triangles};
use crate::error::Problem;
use crate::labels::{Component, DofLabel};

/// From here on, a stiffness on the diagonal holds its degree of freedom.
const HELD: f64 = 1e30;

/// Collects entries between labels, and gives the labels their rows at the end.
pub(super) struct LabelledBuilder {
    entries: EntryBuilder,
    numbers: HashMap<DofLabel, usize>,
    labels: Vec<DofLabel>,
    held: Vec<bool>,
    last: Option<(DofLabel, usize)>,
}

impl LabelledBuilder {
    pub(super) fn new(triangles: Triangles, watched: Option<Fault>) -> Self {
        let entries = EntryBuilder::new(triangles, watched);
        Self { entries, numbers: HashMap::new(), labels: Vec::new(), held: Vec::new(), last: None }
    }

    /// The number of a label, in the order of their coming.
    fn number(&mut self, label: DofLabel) -> Result<usize, Problem> {
        if let Some((_, number)) = self.last.filter(|(last, _)| *last == label) {
            return Ok(number);
        }
        let next = self.labels.len();
        let number = *self.numbers.entry(label).or_insert(next);
        if number == next {
            if next as u64 >= MAX_ORDER {
                return Err(Problem::TooLarge {
                    what: "number of degrees of freedom",
                    found: next as u64 + 1,
                    limit: MAX_ORDER,
                });
            }
            self.labels.push(label);
            self.held.push(false);
        }
        self.last = Some((label, number));
        Ok(number)
    }

    pub(super) fn push(&mut self, row: DofLabel, column: DofLabel, value: f64) -> Result<(), Problem> {
        let (i, j) = (self.number(row)?, self.number(column)?);
        self.held[i] |= i == j && value >= HELD;
        self.entries.push(i, j, value).map_err(|fault| fault.problem(|k| self.labels[k].to_string()))
    }

    pub(super) fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// Labels in ascending order, without fixed ones.
    pub(super) fn finish(self) -> Pass<MatrixData> {
        let mut order: Vec<usize> = (0..self.labels.len()).collect();
        order.sort_unstable_by_key(|k| self.labels[*k]);
        let (mut to, mut labels, mut fixed) = (vec![None; order.len()], Vec::new(), Vec::new());
        for k in order {
            if self.held[k] {
                fixed.push(self.labels[k]);
            } else {
                to[k] = Some(labels.len());
                labels.push(self.labels[k]);
            }
        }
        match self.entries.finish(labels.len(), Some(&to)) {
            Ok(lower) => Pass::Read(MatrixData { lower, labels: Some(labels), fixed, ..MatrixData::default() }),
            Err(fault) => Pass::Faulty(fault),
        }
    }
}

/// The label of a node and the number of a direction, 1 to 6; with `scalar`, 0 is a generalised coordinate.
pub(super) fn label(node: u64, direction: u64, scalar: bool) -> Option<DofLabel> {
    let component = if scalar && direction == 0 { Some(Component::Modal) } else { Component::from_number(direction) };
    component.map(|component| DofLabel { node, component })
}
