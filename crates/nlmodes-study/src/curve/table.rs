//! A branch from `branch.csv` and `summary.json`.

use nlmodes::modal::Event;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;
use thiserror::Error;

/// Averaged kinetic energy relative to that at grazing: not a column of the file, but defined for every branch.
pub const ENERGY_RATIO: &str = "energy_ratio";
const ENERGY: &str = "energy_j";
const EVENT: &str = "event";
/// Text columns.
const TEXTS: [&str; 3] = [EVENT, "resonance", "stable"];

/// Whether a column of the branch is numerical.
pub fn has_numbers(column: &str) -> bool {
    !TEXTS.contains(&column)
}

/// Why there is no branch to read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CurveError {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A file was not written by a run.
    #[error("{} is not what a run writes: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The evidence.
        reason: String,
    },
}

/// The points of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    names: Vec<String>,
    /// Each column; empty cells are not numbers.
    columns: Vec<Vec<f64>>,
    /// The events of each point.
    events: Vec<Vec<Event>>,
}

impl Curve {
    /// The branch in the directory of a case.
    ///
    /// # Errors
    /// [`CurveError`] if there is none, or it is damaged.
    pub fn read(directory: &Path) -> Result<Self, CurveError> {
        let path = directory.join("branch.csv");
        let bytes = fs::read(&path).map_err(|source| CurveError::Io { path: path.clone(), source })?;
        let grazing = grazing_energy(&directory.join("summary.json"))?;
        Self::from_csv(&bytes, grazing).map_err(|reason| CurveError::Damaged { path, reason })
    }

    /// From the text of `branch.csv`.
    pub(crate) fn from_csv(bytes: &[u8], grazing_energy: f64) -> Result<Self, String> {
        let mut table = csv::Reader::from_reader(bytes);
        let header = table.headers().map_err(|error| error.to_string())?.clone();
        let mut curve = Self {
            names: header.iter().map(str::to_owned).collect(),
            columns: vec![Vec::new(); header.len()],
            events: Vec::new(),
        };
        let event = header.iter().position(|name| name == EVENT);
        for row in table.records() {
            let row = row.map_err(|error| error.to_string())?;
            for (column, cell) in curve.columns.iter_mut().zip(&row) {
                column.push(cell.parse().unwrap_or(f64::NAN));
            }
            let events = event.and_then(|k| row.get(k)).unwrap_or_default();
            curve.events.push(events.split_whitespace().filter_map(Event::from_name).collect());
        }
        let energy = curve.column(ENERGY).ok_or_else(|| format!("there is no column {ENERGY}"))?;
        let ratio = energy.iter().map(|energy| energy / grazing_energy).collect();
        curve.names.push(ENERGY_RATIO.to_owned());
        curve.columns.push(ratio);
        Ok(curve)
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.events.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.events.is_empty()
    }

    /// A column, by its name in `branch.csv` or [`ENERGY_RATIO`].
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let k = self.names.iter().position(|known| known == name)?;
        self.columns.get(k).map(Vec::as_slice)
    }

    /// The events of each point.
    pub fn events(&self) -> &[Vec<Event>] {
        &self.events
    }
}

/// Energy of the grazing point, J.
fn grazing_energy(path: &Path) -> Result<f64, CurveError> {
    let bytes = fs::read(path).map_err(|source| CurveError::Io { path: path.to_path_buf(), source })?;
    let damaged = |reason: String| CurveError::Damaged { path: path.to_path_buf(), reason };
    let summary: Value = serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
    summary["grazing"]["energy_j"].as_f64().ok_or_else(|| damaged("there is no grazing energy".into()))
}
