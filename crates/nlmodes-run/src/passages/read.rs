//! Curves from `branch.csv` with `contacts.csv` and the certificate beside it.

use std::fs;
use std::path::{Path, PathBuf};

use nlmodes::modal::{ContactPeriod, Event};
use serde_json::Value;

use super::Abscissa;
use crate::files::DEPTH;
use crate::overlay::{OverlayError, contacts_beside};
use crate::sheet::{Row as Cells, Sheet};

const TABLE: &str = "branch.csv";

/// A row of a table: a point.
pub(super) struct Row {
    pub point: usize,
    pub frequency: f64,
    pub energy: f64,
    pub amplitude: f64,
    pub peak: f64,
    pub level: Option<f64>,
    pub level_unit: Option<&'static str>,
    pub stable: Option<bool>,
    pub events: Vec<Event>,
    pub contacts: Vec<ContactPeriod>,
}

impl Row {
    pub fn value(&self, abscissa: Abscissa) -> f64 {
        match abscissa {
            Abscissa::FrequencyHz => self.frequency,
            Abscissa::EnergyJ => self.energy,
        }
    }
}

/// Tables of branches in a directory and the folders of methods, harmonics and branches below it, in the order of their
/// names.
pub(super) fn tables(results: &Path) -> Vec<PathBuf> {
    if results.is_file() {
        return vec![results.to_path_buf()];
    }
    let mut found = Vec::new();
    below(results, DEPTH, &mut found);
    found
}

fn below(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    let table = folder.join(TABLE);
    if table.is_file() {
        found.push(table);
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    if depth > 0 {
        folders.iter().for_each(|folder| below(folder, depth - 1, found));
    }
}

/// What the certificate beside a table says in a sentence.
pub(super) fn verdict(table: &Path) -> String {
    let summary = fs::read(table.with_file_name("summary.json")).ok();
    let summary: Option<Value> = summary.and_then(|text| serde_json::from_slice(&text).ok());
    summary.and_then(|summary| Some(summary["certificate"]["verdict"].as_str()?.to_owned())).unwrap_or_default()
}

/// Columns of loads, one of which holds the level, with their units.
const LOADS: [(&str, &str); 3] = [("force_n", "N"), ("acceleration_m_s2", "m/s²"), ("base_amplitude_m", "m")];

/// The points of a curve, with its name where a table has several.
type NamedRows = (Option<String>, Vec<Row>);

/// The curves of a table: one, or of responses each with its name. Every row has a value of the abscissa.
pub(super) fn curves(path: &Path, abscissa: Abscissa) -> Result<Vec<NamedRows>, OverlayError> {
    let mut table = Sheet::open(path)?;
    let (frequency, energy) = (table.needed("frequency_hz")?, table.needed("energy_j")?);
    let mut contacts = contacts_beside(path)?;
    let mut curves: Vec<NamedRows> = Vec::new();
    let mut count = 0;
    while let Some(cells) = table.row()? {
        let text = |name| cells.text(table.column(name));
        let value = |name| table.number(&cells, table.column(name), name);
        let name = table.column("response").map(|_| {
            let of = format!("{} of response {}", text("kind"), text("response"));
            let curve = format!("{of}, {}, curve {}", text("name"), text("curve"));
            curve.replace(", ,", ",")
        });
        let point = match text("point") {
            "" => count,
            number => number.parse().map_err(|_| table.no_number(&cells, "point", number))?,
        };
        let level = Some(value("level")?).filter(|level| !level.is_nan());
        let row = Row {
            point,
            frequency: table.number(&cells, Some(frequency), "frequency_hz")?,
            energy: table.number(&cells, Some(energy), "energy_j")?,
            amplitude: value("modal_amplitude")?,
            peak: value("peak_m")?,
            level,
            level_unit: level.map_or(Ok(None), |level| unit(&table, &cells, level))?,
            stable: text("stable").parse().ok(),
            events: text("event").split_whitespace().filter_map(Event::from_name).collect(),
            contacts: contacts.remove(&point).unwrap_or_default(),
        };
        if row.value(abscissa).is_nan() {
            let column = if abscissa == Abscissa::EnergyJ { (energy, "energy_j") } else { (frequency, "frequency_hz") };
            return Err(table.no_number(&cells, column.1, cells.text(Some(column.0))).into());
        }
        count += 1;
        match curves.last_mut().filter(|(of, _)| *of == name) {
            Some((_, rows)) => rows.push(row),
            None => curves.push((name, vec![row])),
        }
    }
    if path.ends_with(TABLE) {
        table.refuse_open_end()?;
    }
    Ok(curves)
}

/// The unit of the load whose level this is.
fn unit(table: &Sheet, cells: &Cells, level: f64) -> Result<Option<&'static str>, OverlayError> {
    for (column, unit) in LOADS {
        if table.number(cells, table.column(column), column)? == level {
            return Ok(Some(unit));
        }
    }
    Ok(None)
}
