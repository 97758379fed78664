use std::collections::HashMap;
use std::path::{Path, PathBuf};

use nlmodes::modal::{BranchEnd, ContactPeriod, ModalBranch};
use nlmodes::report::columns::BranchRow;
use nlmodes_scene::scene::Overlay;
use thiserror::Error;

use super::contacts;
use super::unused::{NO_FREQUENCY, Unused};
use crate::sheet::{Sheet, SheetError};

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
    table.needed("frequency_hz")?;
    if table.column("energy_j").or(table.column("modal_amplitude")).is_none() {
        return Err(table.missing("modal_amplitude or energy_j").into());
    }
    let places = table.places::<BranchRow>();
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
        let read: BranchRow = table.read(&row, &places)?;
        if read.frequency_hz.is_nan() || read.frequency_hz <= 0.0 {
            unused.add(NO_FREQUENCY, row.line);
        } else if read.energy_j.is_nan() && read.modal_amplitude.is_nan() {
            unused.add("with neither an amplitude nor an energy", row.line);
        } else {
            let points = if is_settled { &mut points } else { &mut unsettled };
            points.push(read.point(beside.unwrap_or_default()));
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
