//! What the contacts of another run do, from its `contacts.csv`.

use std::collections::HashMap;
use std::path::Path;

use nlmodes::modal::ContactPeriod;

/// The contacts of each point, by its number; empty where the table lacks a column.
pub(super) fn read(path: &Path) -> Result<HashMap<usize, Vec<ContactPeriod>>, csv::Error> {
    let mut table = csv::Reader::from_path(path)?;
    let head = table.headers()?.clone();
    let column = |name: &str| head.iter().position(|column| column.trim() == name);
    let mut found: HashMap<usize, Vec<ContactPeriod>> = HashMap::new();
    let (Some(point), Some(impulse)) = (column("point"), column("impulse_ns")) else { return Ok(found) };
    let [share, peak, mean, touches, approach] =
        ["contact_fraction", "peak_force_n", "mean_force_n", "touches", "approach_velocity_m_s"].map(column);
    for row in table.records() {
        let row = row?;
        let text = |column: Option<usize>| column.and_then(|column| row.get(column)).unwrap_or_default().trim();
        let value = |column| text(column).parse().unwrap_or(f64::NAN);
        let Ok(number) = text(Some(point)).parse() else { continue };
        found.entry(number).or_default().push(ContactPeriod {
            closed_share: value(share),
            peak_force: value(peak),
            mean_force: value(mean),
            impulse: value(Some(impulse)),
            touches: text(touches).parse().unwrap_or(0),
            approach_velocity: value(approach),
        });
    }
    Ok(found)
}
