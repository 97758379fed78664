use std::collections::HashMap;
use std::path::{Path, PathBuf};

use nlmodes::modal::{BranchEnd, ContactPeriod, ModalBranch};
use nlmodes::report::columns::BranchRow;
use nlmodes_scene::scene::Overlay;
use thiserror::Error;

use super::contacts;
use super::unused::{NO_FREQUENCY, Unused};
use crate::sheet::{Row, Sheet, SheetError};

/// Tables of a folder of results that hold modal points: of a branch, of records.
pub(super) const TABLES: [&str; 2] = ["branch.csv", "modal_points.csv"];
/// Table of the contacts beside that of a branch.
const CONTACTS: &str = "contacts.csv";
/// Findings of records of vibrations that are no steady ones.
const UNSETTLED: [&str; 4] = ["not-locked", "frequency-drift", "amplitude-drift", "aperiodic"];
/// Kinds of responses that are laid over modes, and over tests, which follow phase resonances, those that count first
/// first.
pub(crate) const MODES: [&str; 2] = ["mode", "damped-mode"];
pub(crate) const OF_TESTS: [&str; 3] = ["phase-resonance", "damped-mode", "mode"];
/// Most rows that are read.
const MOST_ROWS: usize = 1_000_000;

/// Why there is nothing to lay over.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OverlayError {
    /// The folder has no table of modal points.
    #[error("{} holds neither {} nor {}", .0.display(), TABLES[0], TABLES[1])]
    NoTable(PathBuf),
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
    #[error("{} holds responses to loads, and no mode; beside a mode they mean nothing: lay them over a scene with \
        [response]", .0.display())]
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

/// The rows of a table of points, of a run or of a test, one after the other.
pub(super) struct Points {
    pub sheet: Sheet,
    path: PathBuf,
    places: Vec<Option<usize>>,
    /// How many rows there are, and which are not used.
    pub unused: Unused,
}

impl Points {
    /// A table that has a frequency and one of two columns.
    pub fn open(path: PathBuf, either: [&str; 2], both: &'static str) -> Result<Self, OverlayError> {
        let sheet = Sheet::open(&path)?;
        sheet.needed("frequency_hz")?;
        if either.iter().all(|name| sheet.column(name).is_none()) {
            return Err(sheet.missing(both).into());
        }
        Ok(Self { places: sheet.places::<BranchRow>(), sheet, path, unused: Unused::default() })
    }

    /// The next row.
    pub fn row(&mut self) -> Result<Option<Row>, OverlayError> {
        let row = self.sheet.row()?;
        self.unused.rows += usize::from(row.is_some());
        if self.unused.rows > MOST_ROWS { Err(OverlayError::TooManyRows(self.path.clone())) } else { Ok(row) }
    }

    /// What it says of a point; none without a frequency, which is counted.
    pub fn point(&mut self, row: &Row) -> Result<Option<BranchRow>, OverlayError> {
        let read: BranchRow = self.sheet.read(row, &self.places)?;
        if read.frequency_hz > 0.0 {
            return Ok(Some(read));
        }
        self.unused.add(NO_FREQUENCY, row.line);
        Ok(None)
    }
}

/// Reads what is laid over modes.
///
/// # Errors
/// [`OverlayError`].
pub fn read(overlay: &Overlay) -> Result<Laid, OverlayError> {
    read_with_unused(overlay, &MODES).map(|(laid, _)| laid)
}

/// Reads what is laid over, of a table of responses the first curve of the first of these kinds that it has; with the
/// rows that are not used.
///
/// # Errors
/// [`OverlayError`].
pub(crate) fn read_with_unused(overlay: &Overlay, kinds: &[&str]) -> Result<(Laid, Unused), OverlayError> {
    let path = table(&overlay.path)?;
    let mut table = Points::open(path.clone(), ["energy_j", "modal_amplitude"], "modal_amplitude or energy_j")?;
    let of_responses = ["kind", "response", "curve"].map(|name| table.sheet.column(name));
    let mut loads = 0;
    let (number, findings) = (table.sheet.column("point"), table.sheet.column("findings"));
    let mut contacts = contacts_beside(&path)?;
    let mut all = Vec::new();
    while let Some(row) = table.row()? {
        let mut curve_of = None;
        if let [Some(_), Some(_), Some(_)] = of_responses {
            let [kind, response, curve] = of_responses.map(|column| row.text(column));
            let Some(rank) = kinds.iter().position(|own| *own == kind) else {
                loads += 1;
                table.unused.add("of responses to loads", row.line);
                continue;
            };
            curve_of = Some((rank, response.to_owned(), curve.to_owned()));
        }
        let beside = row.text(number).parse::<usize>().ok().and_then(|number| contacts.remove(&number));
        let is_settled = !row.text(findings).split_whitespace().any(|name| UNSETTLED.contains(&name));
        let Some(read) = table.point(&row)? else { continue };
        if read.energy_j.is_nan() && read.modal_amplitude.is_nan() {
            table.unused.add("with neither an amplitude nor an energy", row.line);
        } else {
            all.push((curve_of, row.line, is_settled, read.point(beside.unwrap_or_default())));
        }
    }
    let first = all.iter().filter_map(|(of, ..)| of.as_ref()).min_by_key(|(rank, ..)| *rank).cloned();
    let (mut points, mut unsettled) = (Vec::new(), Vec::new());
    for (of, line, is_settled, point) in all {
        match is_settled {
            _ if of != first => table.unused.add("of other curves than the first mode", line),
            true => points.push(point),
            false => unsettled.push(point),
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
    Ok((Laid { branch: ModalBranch::of_points(label, points, BranchEnd::given(message)), is_scattered }, table.unused))
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
pub(super) fn table(path: &Path) -> Result<PathBuf, OverlayError> {
    if !path.is_dir() {
        return Ok(path.to_path_buf());
    }
    let found = TABLES.iter().map(|name| path.join(name)).find(|table| table.is_file());
    found.ok_or_else(|| OverlayError::NoTable(path.to_path_buf()))
}
