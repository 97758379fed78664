//! Curves from `branch.csv` with `contacts.csv` and the certificate beside it.

use std::fs;
use std::path::{Path, PathBuf};

use nlmodes::modal::ContactPeriod;
use nlmodes::report::columns::{BranchRow, ResponseRow};

use super::Abscissa;
use crate::files::{DEPTH, summary};
use crate::overlay::{OverlayError, contacts_beside};
use crate::sheet::Sheet;

const TABLE: &str = "branch.csv";

/// A row of a table: a point, and what its stops do.
pub(super) struct Row {
    pub own: BranchRow,
    pub response: ResponseRow,
    pub contacts: Vec<ContactPeriod>,
}

impl Row {
    pub fn value(&self, abscissa: Abscissa) -> f64 {
        match abscissa {
            Abscissa::FrequencyHz => self.own.frequency_hz,
            Abscissa::EnergyJ => self.own.energy_j,
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
    let summary = summary(table.parent().unwrap_or(Path::new("")));
    summary["certificate"]["verdict"].as_str().unwrap_or_default().to_owned()
}

/// The points of a curve, with its name where a table has several.
type NamedRows = (Option<String>, Vec<Row>);

/// The curves of a table: one, or of responses each with its name. Every row has a value of the abscissa.
pub(super) fn curves(path: &Path, abscissa: Abscissa) -> Result<Vec<NamedRows>, OverlayError> {
    let mut table = Sheet::open(path)?;
    table.needed("frequency_hz")?;
    table.needed("energy_j")?;
    let (numbered, of_responses) = (table.column("point").is_some(), table.column("response").is_some());
    let (own, beside) = (table.places::<BranchRow>(), table.places::<ResponseRow>());
    let mut contacts = contacts_beside(path)?;
    let mut curves: Vec<NamedRows> = Vec::new();
    let mut count = 0;
    while let Some(cells) = table.row()? {
        let (read, response): (BranchRow, ResponseRow) = (table.read(&cells, &own)?, table.read(&cells, &beside)?);
        let name = of_responses.then(|| response.curve_name());
        let number = if numbered { read.point } else { count };
        let contacts = contacts.remove(&number).unwrap_or_default();
        let row = Row { own: BranchRow { point: number, ..read }, response, contacts };
        if row.value(abscissa).is_nan() {
            let column = if abscissa == Abscissa::EnergyJ { "energy_j" } else { "frequency_hz" };
            return Err(table.no_number(&cells, column, cells.text(table.column(column))).into());
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
