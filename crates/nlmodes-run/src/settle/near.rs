//! Rows of `branch.csv` of responses.

use std::path::Path;

use nlmodes::report::columns::{BranchRow, ResponseRow};

use super::SettleError;
use crate::sheet::Sheet;

/// A point of a table of responses.
#[derive(Debug, Clone)]
pub struct Row {
    /// Its number.
    pub point: usize,
    /// Number of its response, from 1, and its kind.
    pub response: usize,
    pub kind: String,
    /// Its curve.
    pub curve: usize,
    /// Frequency of the load, Hz.
    pub frequency_hz: f64,
    /// Level of the load.
    pub level: Option<f64>,
    /// Amplitude of the first contact, m.
    pub fundamental: f64,
}

/// All points.
///
/// # Errors
/// [`SettleError::Table`].
pub fn rows(directory: &Path) -> Result<Vec<Row>, SettleError> {
    let mut table = Sheet::open(&directory.join("branch.csv"))?;
    table.needed("frequency_hz")?;
    let (own, beside) = (table.places::<BranchRow>(), table.places::<ResponseRow>());
    let mut rows = Vec::new();
    while let Some(cells) = table.row()? {
        let (read, response): (BranchRow, ResponseRow) = (table.read(&cells, &own)?, table.read(&cells, &beside)?);
        rows.push(Row {
            point: rows.len(),
            response: response.response,
            kind: response.kind,
            curve: response.curve,
            frequency_hz: read.frequency_hz,
            level: response.level,
            fundamental: read.fundamental_m.abs(),
        });
    }
    Ok(rows)
}

/// Largest relative difference of levels that are one.
const SAME_LEVEL: f64 = 1e-6;

/// The two neighbouring points of curves at this level between which the amplitude at this frequency is nearest, the
/// nearer one first.
pub fn nearest(rows: &[Row], level: f64, frequency_hz: f64, fundamental: f64) -> Option<[usize; 2]> {
    let is_own = |row: &Row| row.level.is_some_and(|own| (own / level - 1.0).abs() < SAME_LEVEL);
    let passes = rows.windows(2).filter(|pair| pair[0].curve == pair[1].curve && pair.iter().all(is_own));
    let found = passes.filter_map(|pair| {
        let [a, b] = [&pair[0], &pair[1]];
        let share = (frequency_hz - a.frequency_hz) / (b.frequency_hz - a.frequency_hz);
        let there = a.fundamental + share * (b.fundamental - a.fundamental);
        let points = if share < 0.5 { [a.point, b.point] } else { [b.point, a.point] };
        (0.0..=1.0).contains(&share).then_some((points, (there - fundamental).abs()))
    });
    found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(points, _)| points)
}
