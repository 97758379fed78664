//! What the contacts of another run do, from its `contacts.csv`.

use std::collections::HashMap;
use std::path::Path;

use nlmodes::modal::ContactPeriod;
use nlmodes::report::columns::ContactRow;

use super::OverlayError;
use crate::sheet::Sheet;

/// The contacts of each point, by its number.
///
/// # Errors
/// [`OverlayError`] if a row is damaged, or a point has fewer rows than others.
pub(super) fn read(path: &Path) -> Result<HashMap<usize, Vec<ContactPeriod>>, OverlayError> {
    let mut table = Sheet::open(path)?;
    table.needed("point")?;
    table.needed("impulse_ns")?;
    let places = table.places::<ContactRow>();
    let mut found: HashMap<usize, Vec<ContactPeriod>> = HashMap::new();
    while let Some(row) = table.row()? {
        let read: ContactRow = table.read(&row, &places)?;
        found.entry(read.point).or_default().push(read.period());
    }
    table.refuse_open_end()?;
    let most = found.values().map(Vec::len).max().unwrap_or(0);
    match found.iter().filter(|(_, stops)| stops.len() < most).map(|(point, stops)| (*point, stops.len())).min() {
        Some((point, found)) => Err(OverlayError::FewerStops { path: path.to_path_buf(), point, found, most }),
        None => Ok(found),
    }
}
