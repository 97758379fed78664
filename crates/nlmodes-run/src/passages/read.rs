//! Curves from `branch.csv` with `contacts.csv` and the certificate beside it.

use std::fs;
use std::path::{Path, PathBuf};

use nlmodes::modal::{ContactPeriod, Event};
use serde_json::Value;

use super::Abscissa;
use crate::files::DEPTH;
use crate::overlay::{OverlayError, contacts_beside, number};

const TABLE: &str = "branch.csv";

/// A row of a table: a point.
pub(super) struct Row {
    pub point: usize,
    pub frequency: f64,
    pub energy: f64,
    pub amplitude: f64,
    pub peak: f64,
    pub level: Option<f64>,
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

/// Tables of branches in a directory and the folders of methods, harmonics and branches below it, in the order of their names.
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

/// The points of a curve, with its name where a table has several.
type NamedRows = (Option<String>, Vec<Row>);

/// The curves of a table: one, or of responses each with its name.
pub(super) fn curves(path: &Path) -> Result<Vec<NamedRows>, OverlayError> {
    let failed = |source| OverlayError::Table { path: path.to_path_buf(), source };
    let mut table = csv::Reader::from_path(path).map_err(failed)?;
    let head = table.headers().map_err(failed)?.clone();
    let column = |name: &str| head.iter().position(|column| column.trim() == name);
    let needed = |name| column(name).ok_or_else(|| OverlayError::NoColumn { path: path.to_path_buf(), column: name });
    let (frequency, energy) = (needed("frequency_hz")?, needed("energy_j")?);
    let mut contacts = contacts_beside(path)?;
    let mut curves: Vec<NamedRows> = Vec::new();
    for (count, row) in table.records().enumerate() {
        let row = row.map_err(failed)?;
        let text = |name| column(name).and_then(|column| row.get(column)).unwrap_or_default().trim();
        let value = |name, column| number(&row, column, name, path);
        let name = column("response").map(|_| {
            let of = format!("{} of response {}", text("kind"), text("response"));
            let curve = format!("{of}, {}, curve {}", text("name"), text("curve"));
            curve.replace(", ,", ",")
        });
        let point = text("point").parse().unwrap_or(count);
        let row = Row {
            point,
            frequency: value("frequency_hz", Some(frequency))?,
            energy: value("energy_j", Some(energy))?,
            amplitude: value("modal_amplitude", column("modal_amplitude"))?,
            peak: value("peak_m", column("peak_m"))?,
            level: Some(value("level", column("level"))?).filter(|level| !level.is_nan()),
            stable: text("stable").parse().ok(),
            events: text("event").split_whitespace().filter_map(Event::from_name).collect(),
            contacts: contacts.remove(&point).unwrap_or_default(),
        };
        match curves.last_mut().filter(|(of, _)| *of == name) {
            Some((_, rows)) => rows.push(row),
            None => curves.push((name, vec![row])),
        }
    }
    Ok(curves)
}
