//! Rows of a table that is laid over which are not used.

use std::path::Path;

/// Message about rows without a frequency.
pub(crate) const NO_FREQUENCY: &str = "without a frequency above 0 Hz";

/// How many rows there are, and how many of them are not used, by reasons.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Unused {
    /// All rows.
    pub rows: usize,
    /// Each reason with the number of rows and the line of the first one.
    reasons: Vec<(&'static str, usize, u64)>,
}

impl Unused {
    /// Counts a row that is not used.
    pub fn add(&mut self, reason: &'static str, line: u64) {
        match self.reasons.iter_mut().find(|(known, ..)| *known == reason) {
            Some((_, count, _)) => *count += 1,
            None => self.reasons.push((reason, 1, line)),
        }
    }

    /// Message about them; empty if all rows are used.
    pub fn sentence(&self, path: &Path) -> Option<String> {
        let count: usize = self.reasons.iter().map(|(_, count, _)| count).sum();
        let reason = |(reason, count, line): &(&str, usize, u64)| {
            let place = if *count == 1 { "line" } else { "first in line" };
            format!("{count} {reason} ({place} {line})")
        };
        let reasons: Vec<String> = self.reasons.iter().map(reason).collect();
        let is = if count == 1 { "is" } else { "are" };
        let name = path.display();
        (count > 0).then(|| format!("{name}: {count} of {} rows {is} not used: {}", self.rows, reasons.join(", ")))
    }
}
