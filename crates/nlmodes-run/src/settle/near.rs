//! Rows of `branch.csv` of responses.

use std::path::Path;

use nlmodes::report::columns::{BranchRow, ResponseRow};

use crate::sheet::Sheet;
use crate::verify::VerifyError;

/// A point of a table of responses, at its place in it.
pub type Row = (BranchRow, ResponseRow);

/// All points.
///
/// # Errors
/// [`VerifyError::Table`].
pub fn rows(directory: &Path) -> Result<Vec<Row>, VerifyError> {
    let mut table = Sheet::open(&directory.join("branch.csv"))?;
    table.needed("frequency_hz")?;
    let (own, beside) = (table.places::<BranchRow>(), table.places::<ResponseRow>());
    let mut rows = Vec::new();
    while let Some(cells) = table.row()? {
        rows.push((table.read(&cells, &own)?, table.read(&cells, &beside)?));
    }
    Ok(rows)
}

/// Largest relative difference of levels that are one.
const SAME_LEVEL: f64 = 1e-6;

/// The two neighbouring points of curves at this level between which the amplitude at this frequency is nearest, the
/// nearer one first.
pub fn nearest(rows: &[Row], level: f64, frequency_hz: f64, fundamental: f64) -> Option<[usize; 2]> {
    let is_own = |(_, row): &Row| row.level.is_some_and(|own| (own / level - 1.0).abs() < SAME_LEVEL);
    let passes = rows.windows(2).enumerate();
    let passes = passes.filter(|(_, pair)| pair[0].1.curve == pair[1].1.curve && pair.iter().all(is_own));
    let found = passes.filter_map(|(k, pair)| {
        let [a, b] = [&pair[0].0, &pair[1].0];
        let share = (frequency_hz - a.frequency_hz) / (b.frequency_hz - a.frequency_hz);
        let [low, high] = [a, b].map(|row| row.fundamental_m.abs());
        let there = low + share * (high - low);
        let points = if share < 0.5 { [k, k + 1] } else { [k + 1, k] };
        (0.0..=1.0).contains(&share).then_some((points, (there - fundamental).abs()))
    });
    found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(points, _)| points)
}
