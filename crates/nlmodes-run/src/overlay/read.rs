use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use nlmodes::modal::{BranchEnd, ContactPeriod, Event, HarmonicCoefficients, ModalBranch, ModalPoint};
use nlmodes_scene::scene::Overlay;
use thiserror::Error;

use super::contacts;
use super::unused::{NO_FREQUENCY, Unused};
use crate::sheet::{Row, Sheet, SheetError};

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
    /// A table, or a row of it, cannot be read.
    #[error(transparent)]
    Sheet(#[from] SheetError),
    /// A point of `contacts.csv` has fewer rows than others.
    #[error("{}: point {point} has {found} of {most} stops; the table is cut or damaged", path.display())]
    FewerStops {
        /// The table.
        path: PathBuf,
        /// Number of the point.
        point: usize,
        /// Its rows.
        found: usize,
        /// Most rows of a point.
        most: usize,
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
    read_with_unused(overlay).map(|(laid, _)| laid)
}

/// The same with the rows that are not used.
///
/// # Errors
/// [`OverlayError`].
pub(crate) fn read_with_unused(overlay: &Overlay) -> Result<(Laid, Unused), OverlayError> {
    let path = table(&overlay.path)?;
    let mut table = Sheet::open(&path)?;
    let columns = Columns::of(&table)?;
    // A table of responses: of it a mode has a place beside modes, one curve of it.
    let of_responses = ["kind", "response", "curve"].map(|name| table.column(name));
    let (mut first, mut loads) = (None, 0);
    let (number, findings) = (table.column("point"), table.column("findings"));
    let mut contacts = contacts_beside(&path)?;
    let mut unused = Unused::default();
    let (mut points, mut unsettled) = (Vec::new(), Vec::new());
    while let Some(row) = table.row()? {
        unused.rows += 1;
        if unused.rows > MOST_ROWS {
            return Err(OverlayError::TooManyRows(path));
        }
        if let [Some(_), Some(_), Some(_)] = of_responses {
            let [kind, response, curve] = of_responses.map(|column| row.text(column));
            if !MODES.contains(&kind) {
                loads += 1;
                unused.add("of responses to loads", row.line);
                continue;
            }
            let of = (response.to_owned(), curve.to_owned());
            if *first.get_or_insert_with(|| of.clone()) != of {
                unused.add("of other curves than the first mode", row.line);
                continue;
            }
        }
        let beside = row.text(number).parse::<usize>().ok().and_then(|number| contacts.remove(&number));
        let is_settled = !row.text(findings).split_whitespace().any(|name| UNSETTLED.contains(&name));
        match columns.point(&row, &table)? {
            Ok(point) => {
                let points = if is_settled { &mut points } else { &mut unsettled };
                points.push(ModalPoint { contacts: beside.unwrap_or_default(), ..point });
            }
            Err(reason) => unused.add(reason, row.line),
        }
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
    Ok((Laid { branch, is_scattered }, unused))
}

/// What the contacts do at each point of a branch, by its number, if a table beside it says so.
pub fn contacts_beside(path: &Path) -> Result<HashMap<usize, Vec<ContactPeriod>>, OverlayError> {
    contacts_of(path).map_or_else(|| Ok(HashMap::new()), |table| contacts::read(&table))
}

/// The table of the contacts beside that of a branch.
pub fn contacts_of(path: &Path) -> Option<PathBuf> {
    Some(path.with_file_name(CONTACTS)).filter(|table| path.ends_with(TABLES[0]) && table.is_file())
}

/// The table of a folder, or the table itself.
fn table(path: &Path) -> Result<PathBuf, OverlayError> {
    if !path.is_dir() {
        return Ok(path.to_path_buf());
    }
    let found = TABLES.iter().map(|name| path.join(name)).find(|table| table.is_file());
    found.ok_or_else(|| OverlayError::NoTable(path.to_path_buf()))
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
    fn of(table: &Sheet) -> Result<Self, SheetError> {
        let [energy, amplitude, force, event] =
            ["energy_j", "modal_amplitude", "peak_contact_force_n", "event"].map(|name| table.column(name));
        let frequency = table.needed("frequency_hz")?;
        match energy.or(amplitude) {
            Some(_) => Ok(Self { frequency, energy, amplitude, force, event }),
            None => Err(table.missing("modal_amplitude or energy_j")),
        }
    }

    /// The point of a row; why there is none, as of a record that gave nothing.
    fn point(&self, row: &Row, table: &Sheet) -> Result<Result<ModalPoint, &'static str>, SheetError> {
        let value = |name, column| table.number(row, column, name);
        let hz = value("frequency_hz", Some(self.frequency))?;
        let (energy, amplitude) = (value("energy_j", self.energy)?, value("modal_amplitude", self.amplitude)?);
        let force = value("peak_contact_force_n", self.force)?;
        if hz.is_nan() || hz <= 0.0 {
            return Ok(Err(NO_FREQUENCY));
        }
        if energy.is_nan() && amplitude.is_nan() {
            return Ok(Err("with neither an amplitude nor an energy"));
        }
        Ok(Ok(ModalPoint {
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
            events: row.text(self.event).split_whitespace().filter_map(Event::from_name).collect(),
        }))
    }
}
