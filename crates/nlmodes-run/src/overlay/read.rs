use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use nlmodes::modal::{BranchEnd, ContactPeriod, Event, HarmonicCoefficients, ModalBranch, ModalPoint};
use nlmodes_scene::scene::Overlay;
use thiserror::Error;

use super::contacts;

/// Tables of a folder of results that hold modal points: of a branch, of records.
const TABLES: [&str; 2] = ["branch.csv", "modal_points.csv"];
/// Table of the contacts beside that of a branch.
const CONTACTS: &str = "contacts.csv";
/// Findings of records of vibrations that are no steady ones.
const UNSETTLED: [&str; 4] = ["not-locked", "frequency-drift", "amplitude-drift", "aperiodic"];
/// Kinds of responses that are modes.
const MODES: [&str; 2] = ["mode", "damped-mode"];
/// Most rows that are read.
const MOST_ROWS: usize = 1_000_000;

/// Why there is nothing to lay over.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OverlayError {
    /// The folder has no table of modal points.
    #[error("{} holds neither {} nor {}", .0.display(), TABLES[0], TABLES[1])]
    NoTable(PathBuf),
    /// The folder has no table of responses.
    #[error("{} holds no branch.csv", .0.display())]
    NoResponses(PathBuf),
    /// A table cannot be read.
    #[error("{}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// What is wrong with it.
        source: csv::Error,
    },
    /// A table has not the columns of modal points.
    #[error("{} has no column {column}", path.display())]
    NoColumn {
        /// The table.
        path: PathBuf,
        /// The column, or the two of which one is needed.
        column: &'static str,
    },
    /// A cell holds text where a number was expected.
    #[error("{}, line {line}: {column} is {text:?}, expected a number", path.display())]
    NoNumber {
        /// The table.
        path: PathBuf,
        /// The line.
        line: u64,
        /// The column.
        column: &'static str,
        /// What it holds.
        text: String,
    },
    /// A table has no row with a frequency and an amplitude or energy.
    #[error("{} has no row with a frequency and an amplitude or an energy", .0.display())]
    NoPoint(PathBuf),
    /// A table of responses has no mode.
    #[error("{} holds responses to loads, and no mode; beside a mode they mean nothing: lay them over a scene with [response]", .0.display())]
    OnlyLoads(PathBuf),
    /// A table has more rows than a branch has points.
    #[error("{} has more than {MOST_ROWS} rows", .0.display())]
    TooManyRows(PathBuf),
}

/// Modal points of another run or of a test.
#[derive(Debug, Clone)]
pub struct Laid {
    /// The points.
    pub branch: ModalBranch,
    /// Whether nothing is known between them.
    pub is_scattered: bool,
}

/// Reads what is laid over.
///
/// # Errors
/// [`OverlayError`].
pub fn read(overlay: &Overlay) -> Result<Laid, OverlayError> {
    let path = table(&overlay.path)?;
    let failed = |source| OverlayError::Table { path: path.clone(), source };
    let mut table = csv::Reader::from_path(&path).map_err(failed)?;
    let head = table.headers().map_err(failed)?.clone();
    let column = |name: &str| head.iter().position(|column| column.trim() == name);
    let missing = |column| OverlayError::NoColumn { path: path.clone(), column };
    let frequency = column("frequency_hz").ok_or_else(|| missing("frequency_hz"))?;
    let (energy, amplitude) = (column("energy_j"), column("modal_amplitude"));
    if energy.or(amplitude).is_none() {
        return Err(missing("modal_amplitude or energy_j"));
    }
    let columns =
        Columns { frequency, energy, amplitude, force: column("peak_contact_force_n"), event: column("event") };
    // A table of responses: of it a mode has a place beside modes, one curve of it.
    let of_responses = [column("kind"), column("response"), column("curve")];
    let (mut first, mut loads) = (None, 0);
    let number = column("point");
    let mut contacts = contacts_beside(&path)?;
    let findings = column("findings");
    let (mut points, mut unsettled) = (Vec::new(), Vec::new());
    for (count, row) in table.records().enumerate() {
        if count == MOST_ROWS {
            return Err(OverlayError::TooManyRows(path));
        }
        let row = row.map_err(failed)?;
        if let [Some(kind), Some(response), Some(curve)] = of_responses {
            let text = |column: usize| row.get(column).unwrap_or_default().trim().to_owned();
            if !MODES.contains(&text(kind).as_str()) {
                loads += 1;
                continue;
            }
            let of = (text(response), text(curve));
            if *first.get_or_insert_with(|| of.clone()) != of {
                continue;
            }
        }
        let beside = number.and_then(|number| row.get(number)?.trim().parse::<usize>().ok());
        let beside = beside.and_then(|number| contacts.remove(&number)).unwrap_or_default();
        let found = findings.and_then(|column| row.get(column)).unwrap_or_default();
        let is_settled = !found.split_whitespace().any(|name| UNSETTLED.contains(&name));
        let points = if is_settled { &mut points } else { &mut unsettled };
        points.extend(columns.point(&row, &path)?.map(|point| ModalPoint { contacts: beside, ..point }));
    }
    let label = match (points.len(), unsettled.len()) {
        (_, 0) => overlay.label.clone(),
        (0, _) => format!("{}, not settled", overlay.label),
        (_, n) => format!("{}, without {n} that had not settled", overlay.label),
    };
    if points.is_empty() {
        points = unsettled;
    }
    if points.is_empty() && loads > 0 {
        return Err(OverlayError::OnlyLoads(path));
    }
    if points.is_empty() {
        return Err(OverlayError::NoPoint(path));
    }
    let is_scattered = !path.ends_with(TABLES[0]);
    let message = match is_scattered {
        true => format!("from {}", path.display()),
        false => format!("{} points of {}", points.len(), path.display()),
    };
    let branch = ModalBranch {
        label,
        coordinates: Vec::new(),
        contact_coordinate: None,
        stop: None,
        points,
        end: BranchEnd::given(message),
    };
    Ok(Laid { branch, is_scattered })
}

/// What the contacts do at each point of a branch, by its number, if a table beside it says so.
pub fn contacts_beside(path: &Path) -> Result<HashMap<usize, Vec<ContactPeriod>>, OverlayError> {
    let table = path.with_file_name(CONTACTS);
    if !path.ends_with(TABLES[0]) || !table.is_file() {
        return Ok(HashMap::new());
    }
    contacts::read(&table).map_err(|source| OverlayError::Table { path: table, source })
}

/// The table of a folder, or the table itself.
fn table(path: &Path) -> Result<PathBuf, OverlayError> {
    if !path.is_dir() {
        return Ok(path.to_path_buf());
    }
    let found = TABLES.iter().map(|name| path.join(name)).find(|table| table.is_file());
    found.ok_or_else(|| OverlayError::NoTable(path.to_path_buf()))
}

/// The number in a cell, NaN where that is empty or holds no finite one.
///
/// # Errors
/// [`OverlayError::NoNumber`] for other text.
pub fn number(
    row: &csv::StringRecord,
    column: Option<usize>,
    name: &'static str,
    path: &Path,
) -> Result<f64, OverlayError> {
    let text = column.and_then(|column| row.get(column)).unwrap_or_default().trim();
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    let line = row.position().map_or(0, csv::Position::line);
    let no_number = |_| OverlayError::NoNumber { path: path.to_path_buf(), line, column: name, text: text.to_owned() };
    text.parse::<f64>().map(|x| if x.is_finite() { x } else { f64::NAN }).map_err(no_number)
}

/// Where the quantities of a point stand in a row.
struct Columns {
    frequency: usize,
    energy: Option<usize>,
    amplitude: Option<usize>,
    force: Option<usize>,
    event: Option<usize>,
}

impl Columns {
    /// The point of a row; `None` where there is none, as of a record that gave nothing.
    fn point(&self, row: &csv::StringRecord, path: &Path) -> Result<Option<ModalPoint>, OverlayError> {
        let value = |name, column| number(row, column, name, path);
        let hz = value("frequency_hz", Some(self.frequency))?;
        let (energy, amplitude) = (value("energy_j", self.energy)?, value("modal_amplitude", self.amplitude)?);
        let force = value("peak_contact_force_n", self.force)?;
        if hz.is_nan() || hz <= 0.0 || (energy.is_nan() && amplitude.is_nan()) {
            return Ok(None);
        }
        let events = self.event.and_then(|column| row.get(column)).unwrap_or_default();
        Ok(Some(ModalPoint {
            omega: TAU * hz,
            coefficients: HarmonicCoefficients::zeros(0, 0),
            kinetic_energy: energy,
            harmonic_energy: Vec::new(),
            resonance: None,
            stability: None,
            total_energy: f64::NAN,
            modal_amplitude: amplitude,
            fundamental: f64::NAN,
            peak: f64::NAN,
            contact_fraction: f64::NAN,
            contact_intervals: 0,
            peak_contact_force: force,
            contacts: Vec::new(),
            residual: f64::NAN,
            error_estimate: None,
            events: events.split_whitespace().filter_map(Event::from_name).collect(),
        }))
    }
}
