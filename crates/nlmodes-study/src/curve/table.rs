//! A branch from `branch.csv` and `summary.json`.

use nlmodes::modal::Event;
use nlmodes_scene::scene::ResponseKind;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::Value;
use thiserror::Error;

use crate::study::Selected;

/// Averaged kinetic energy relative to that at grazing: not a column of the file, but defined for every branch.
pub const ENERGY_RATIO: &str = "energy_ratio";
const ENERGY: &str = "energy_j";
const EVENT: &str = "event";
const KIND: &str = "kind";
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

/// The points of a branch, or those of all curves of a scene with responses, one behind the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    names: Vec<String>,
    /// Each column; empty cells are not numbers.
    columns: Vec<Vec<f64>>,
    /// The events of each point.
    events: Vec<Vec<Event>>,
    /// What the summary says of each level of responses over the frequency.
    levels: Vec<Level>,
    /// What is held at each point where its curve is differentiated.
    held: Vec<Held>,
}

/// What is held where the points of a curve are differentiated by a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// The averaged kinetic energy: of modes.
    Energy,
    /// Frequency and level, of a response over the frequency.
    Frequency,
    /// Frequency and level, of a response over the level.
    FrequencyOverLevel,
    /// The level, of phase resonances.
    Level,
}

impl Held {
    /// Of a curve of this kind; of a branch without kinds the energy.
    fn of(kind: Option<&str>) -> Self {
        let is = |wanted: ResponseKind| kind == Some(wanted.name());
        match () {
            () if is(ResponseKind::Frequency) => Self::Frequency,
            () if is(ResponseKind::Force) => Self::FrequencyOverLevel,
            () if is(ResponseKind::PhaseResonance) => Self::Level,
            () => Self::Energy,
        }
    }

    /// The columns that do not change with a parameter.
    pub fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Energy => &[ENERGY],
            Self::Frequency | Self::FrequencyOverLevel => &["frequency_hz", "level"],
            Self::Level => &["level"],
        }
    }
}

/// A level of responses over the frequency: where sweeps jump.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Number of the response, from 1, and its level.
    pub of: (usize, f64),
    /// Frequencies of jumps with whether the sweep goes up, Hz.
    pub jumps: Vec<(f64, bool)>,
    /// Whether stability was found out somewhere, without which no jumps are known.
    pub is_known: bool,
}

impl Curve {
    /// The branch in the directory of a case.
    ///
    /// # Errors
    /// [`CurveError`] if there is none, or it is damaged.
    pub fn read(directory: &Path) -> Result<Self, CurveError> {
        let path = directory.join("branch.csv");
        let bytes = fs::read(&path).map_err(|source| CurveError::Io { path: path.clone(), source })?;
        let summary = summary(&directory.join("summary.json"))?;
        let grazing = summary["grazing"]["energy_j"].as_f64();
        let mut curve = Self::from_csv(&bytes, grazing.unwrap_or(f64::NAN))
            .map_err(|reason| CurveError::Damaged { path, reason })?;
        if grazing.is_none() && !curve.is_of_responses() {
            let reason = "there is no grazing energy".to_owned();
            return Err(CurveError::Damaged { path: directory.join("summary.json"), reason });
        }
        curve.levels = summary["levels"].as_array().into_iter().flatten().filter_map(Level::of).collect();
        Ok(curve)
    }

    /// Whether these are the curves of a scene with responses.
    pub fn is_of_responses(&self) -> bool {
        self.column("curve").is_some()
    }

    /// The levels of responses over the frequency that are selected.
    pub fn levels(&self, selected: Selected) -> impl Iterator<Item = &Level> {
        self.levels.iter().filter(move |level| selected.has(level.of.0, level.of.1))
    }

    /// Each curve by itself: the branch, or of responses those that are selected; `over_frequency` those over the
    /// frequency alone.
    pub fn parts(&self, selected: Selected, over_frequency: bool) -> Vec<Self> {
        let (Some(curve), Some(response)) = (self.column("curve"), self.column("response")) else {
            return vec![self.clone()];
        };
        let level = self.column("level");
        let is_own = |k: usize| {
            let level = level.map_or(f64::NAN, |level| level[k]);
            selected.has(response[k] as usize, level) && (!over_frequency || self.held[k] == Held::Frequency)
        };
        let mut parts: Vec<Self> = Vec::new();
        let mut from = 0;
        while from < self.len() {
            let count = curve[from..].iter().take_while(|number| **number == curve[from]).count().max(1);
            // Along a curve over the level each point has its own.
            let own: Vec<usize> = (from..from + count).filter(|&k| is_own(k)).collect();
            if let (Some(&first), Some(&last)) = (own.first(), own.last()) {
                parts.push(self.rows(first..last + 1));
            }
            from += count;
        }
        parts
    }

    fn rows(&self, rows: Range<usize>) -> Self {
        Self {
            names: self.names.clone(),
            columns: self.columns.iter().map(|column| column[rows.clone()].to_vec()).collect(),
            events: self.events[rows.clone()].to_vec(),
            levels: Vec::new(),
            held: self.held[rows].to_vec(),
        }
    }

    /// From the text of `branch.csv`.
    pub(crate) fn from_csv(bytes: &[u8], grazing_energy: f64) -> Result<Self, String> {
        let mut table = csv::Reader::from_reader(bytes);
        let header = table.headers().map_err(|error| error.to_string())?.clone();
        let mut curve = Self {
            names: header.iter().map(str::to_owned).collect(),
            columns: vec![Vec::new(); header.len()],
            events: Vec::new(),
            levels: Vec::new(),
            held: Vec::new(),
        };
        let kind = header.iter().position(|name| name == KIND);
        let event = header.iter().position(|name| name == EVENT);
        for row in table.records() {
            let row = row.map_err(|error| error.to_string())?;
            for (column, cell) in curve.columns.iter_mut().zip(&row) {
                column.push(cell.parse().unwrap_or(f64::NAN));
            }
            curve.held.push(Held::of(kind.and_then(|k| row.get(k))));
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

    /// What is held where its first point is differentiated; of one curve the same for all.
    pub fn held(&self) -> Held {
        self.held.first().copied().unwrap_or(Held::Energy)
    }

    /// The events of each point.
    pub fn events(&self) -> &[Vec<Event>] {
        &self.events
    }
}

/// The summary of a run.
fn summary(path: &Path) -> Result<Value, CurveError> {
    let bytes = fs::read(path).map_err(|source| CurveError::Io { path: path.to_path_buf(), source })?;
    serde_json::from_slice(&bytes)
        .map_err(|error| CurveError::Damaged { path: path.to_path_buf(), reason: error.to_string() })
}

impl Level {
    fn of(written: &Value) -> Option<Self> {
        let jump = |jump: &Value| Some((jump["frequency_hz"].as_f64()?, jump["direction"] == "up"));
        Some(Self {
            of: (written["response"].as_u64()? as usize, written["level"].as_f64()?),
            jumps: written["jumps"].as_array()?.iter().filter_map(jump).collect(),
            is_known: written["stable"].as_array().is_some_and(|stable| !stable.is_empty()),
        })
    }
}

impl Selected {
    /// Whether a response with this number and level is meant.
    fn has(self, response: usize, level: f64) -> bool {
        let is_level = |own: f64| (level - own).abs() <= SAME_LEVEL * own.abs();
        self.response.is_none_or(|own| own == response) && self.level.is_none_or(is_level)
    }
}

/// Relative difference within which a level is the one that is meant.
const SAME_LEVEL: f64 = 1e-9;
