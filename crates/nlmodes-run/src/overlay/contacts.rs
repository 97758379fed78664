//! What the contacts of another run do, from its `contacts.csv`.

use std::collections::HashMap;
use std::path::Path;

use nlmodes::modal::ContactPeriod;

use super::OverlayError;
use crate::sheet::Sheet;

/// The contacts of each point, by its number.
///
/// # Errors
/// [`OverlayError`] if a row is damaged, or a point has fewer rows than others.
pub(super) fn read(path: &Path) -> Result<HashMap<usize, Vec<ContactPeriod>>, OverlayError> {
    let mut table = Sheet::open(path)?;
    let (point, impulse) = (table.needed("point")?, Some(table.needed("impulse_ns")?));
    let [share, peak, mean, touches, approach] =
        ["contact_fraction", "peak_force_n", "mean_force_n", "touches", "approach_velocity_m_s"]
            .map(|name| table.column(name));
    let mut found: HashMap<usize, Vec<ContactPeriod>> = HashMap::new();
    while let Some(row) = table.row()? {
        let value = |name, column| table.number(&row, column, name);
        let text = row.text(Some(point));
        let number = text.parse().map_err(|_| table.no_number(&row, "point", text))?;
        found.entry(number).or_default().push(ContactPeriod {
            closed_share: value("contact_fraction", share)?,
            peak_force: value("peak_force_n", peak)?,
            mean_force: value("mean_force_n", mean)?,
            impulse: value("impulse_ns", impulse)?,
            touches: value("touches", touches)?.max(0.0) as usize,
            approach_velocity: value("approach_velocity_m_s", approach)?,
        });
    }
    table.refuse_open_end()?;
    let most = found.values().map(Vec::len).max().unwrap_or(0);
    match found.iter().filter(|(_, stops)| stops.len() < most).map(|(point, stops)| (*point, stops.len())).min() {
        Some((point, found)) => Err(OverlayError::FewerStops { path: path.to_path_buf(), point, found, most }),
        None => Ok(found),
    }
}
