//! Columns that come as pointers, rows and values.

use std::path::Path;

use crate::build::{ColumnBuilder, Stored};
use crate::error::{Place, Problem, ReadError, Result};
use crate::lower::LowerTriangle;

/// How a file stores compressed columns.
pub(super) struct Layout<'a> {
    pub(super) path: &'a Path,
    pub(super) stored: Stored,
    /// Number of the first row: 0 or 1.
    pub(super) base: usize,
    /// Names of the arrays of pointers, rows and values, for messages.
    pub(super) names: [&'a str; 3],
}

impl Layout<'_> {
    fn entry(&self, array: usize, index: u64, problem: Problem) -> ReadError {
        let place = Place::Entry { array: self.names[array].to_owned(), index };
        ReadError::new(self.path, place, problem)
    }

    /// Pointers, from 0: they begin at the first entry and never descend.
    pub(super) fn check_pointers(&self, pointers: &[u64], entries: u64) -> Result<()> {
        let wrong = |index: usize, expected: String| {
            self.entry(0, index as u64, Problem::Expected { expected, found: pointers[index].to_string() })
        };
        let base = self.base as u64;
        if pointers.first().is_some_and(|first| *first != base) {
            return Err(wrong(0, base.to_string()));
        }
        if let Some(at) = pointers.windows(2).position(|pair| pair[1] < pair[0]) {
            return Err(wrong(at + 1, format!("at least {}, the pointer before", pointers[at])));
        }
        match pointers.last() {
            Some(last) if *last != entries + base => {
                Err(wrong(pointers.len() - 1, format!("{}, as there are {entries} entries", entries + base)))
            }
            _ => Ok(()),
        }
    }

    /// Takes rows and values in step, column by column.
    pub(super) fn read(
        &self,
        pointers: &[u64],
        rows: &mut dyn Iterator<Item = Result<u64>>,
        values: &mut dyn Iterator<Item = Result<f64>>,
    ) -> Result<LowerTriangle> {
        let order = pointers.len().saturating_sub(1);
        let mut builder = ColumnBuilder::new(self.stored);
        let (mut column, mut index) = (Vec::new(), 0);
        let problem = |fault: crate::build::Fault| fault.problem(|k| (k + self.base).to_string());
        for pair in pointers.windows(2) {
            column.clear();
            for _ in pair[0]..pair[1] {
                let ended =
                    |array: usize| self.entry(array, index, Problem::Ended { expected: format!("entry {index}") });
                let row = rows.next().ok_or_else(|| ended(1))??;
                let value = values.next().ok_or_else(|| ended(2))??;
                column.push((self.row(row, order, index)?, self.finite(value, index)?));
                index += 1;
            }
            let first = pair[0] - self.base as u64;
            builder.push(&mut column).map_err(|fault| self.entry(1, first, problem(fault)))?;
        }
        builder.finish().map_err(|fault| ReadError::whole(self.path, problem(fault)))
    }

    fn row(&self, row: u64, order: usize, index: u64) -> Result<usize> {
        match row.checked_sub(self.base as u64) {
            Some(row) if row < order as u64 => Ok(row as usize),
            _ => {
                let expected = format!("a row from {} to {}", self.base, order - 1 + self.base);
                Err(self.entry(1, index, Problem::Expected { expected, found: row.to_string() }))
            }
        }
    }

    fn finite(&self, value: f64, index: u64) -> Result<f64> {
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.entry(2, index, Problem::NotFinite { what: "value", found: value.to_string() }))
    }
}
