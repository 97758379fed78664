//! `modal_points.csv`: a row a record.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::experiment::extraction::{Measured, RecordExtraction};
use nlmodes::report::{ReportError, write_file};

use super::RecordOutcome;
use crate::Failure;

/// Least number of participation columns.
const PARTICIPATIONS: usize = 2;

/// A column: its name, and its text for a record.
type Column = (String, Box<dyn Fn(&RecordExtraction) -> String>);

/// The table, row by row.
pub struct Table {
    columns: Vec<Column>,
    rows: csv::Writer<Vec<u8>>,
    has_level: bool,
}

impl Table {
    /// With the participation of so many modes, and the level of the drive where its column has a name.
    ///
    /// # Errors
    /// None but those of a writer to memory.
    pub fn new(modes: usize, level: Option<&str>) -> Result<Self, Failure> {
        let columns = columns(modes.max(PARTICIPATIONS));
        let mut rows = csv::Writer::from_writer(Vec::new());
        let names = columns.iter().map(|(name, _)| name.as_str());
        rows.write_record(std::iter::once("record").chain(level).chain(names).chain(["findings"]))?;
        Ok(Self { columns, rows, has_level: level.is_some() })
    }

    /// Adds a row. Cells that a record does not give are empty.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn push(&mut self, outcome: &RecordOutcome) -> Result<(), Failure> {
        let cell = |(_, text): &Column| outcome.result.as_ref().map_or_else(|_| String::new(), text);
        let row = self.columns.iter().map(cell);
        let level = self.has_level.then(|| outcome.level.map_or_else(String::new, |level| format!("{level:?}")));
        let first = std::iter::once(outcome.record.clone()).chain(level);
        Ok(self.rows.write_record(first.chain(row).chain([outcome.finding_names()]))?)
    }

    /// What there is, as text.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn into_bytes(self) -> Result<Vec<u8>, Failure> {
        Ok(self.rows.into_inner().map_err(csv::IntoInnerError::into_error)?)
    }

    /// Writes what there is; a file of that name is replaced at once.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&mut self, path: &Path) -> Result<(), ReportError> {
        let io = |source| ReportError::Io { path: path.to_path_buf(), source };
        self.rows.flush().map_err(io)?;
        write_file(path, self.rows.get_ref())
    }
}

fn columns(modes: usize) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    let mut errors: Vec<Column> = Vec::new();
    let mut measured = |columns: &mut Vec<Column>, name: &str, of: fn(&RecordExtraction) -> Option<Measured>| {
        columns.push(plain(name, move |found| of(found).map(|m| m.value)));
        errors.push(plain(&format!("{name}_uncertainty"), move |found| of(found).map(|m| m.uncertainty)));
    };
    measured(&mut columns, "frequency_hz", |found| Some(found.omega.times(1.0 / TAU)));
    measured(&mut columns, "modal_amplitude", |found| Some(found.modal.as_ref()?.amplitude));
    measured(&mut columns, "damping", |found| found.modal.as_ref()?.damping);
    measured(&mut columns, "lag_deg", |found| Some(found.excitation.as_ref()?.lag.times(1f64.to_degrees())));
    measured(&mut columns, "pbmif", |found| Some(found.excitation.as_ref()?.pbmif));
    columns.push(count("pbmif_harmonics", |found| Some(found.excitation.as_ref()?.power.harmonics)));
    for k in 0..modes {
        columns.push(plain(&format!("participation_{}", k + 1), move |found| {
            found.modal.as_ref()?.participation.factors.get(k).copied()
        }));
    }
    columns.push(count("participation_harmonics", |found| found.modal.as_ref().map(|_| found.harmonics)));
    measured(&mut columns, "peak_contact_force_n", |found| Some(found.contact.as_ref()?.peak_force));
    measured(&mut columns, "contact_stiffness_n_m", |found| {
        let stiffness = found.contact.as_ref()?.stiffness?;
        Some(Measured { value: stiffness.stiffness, uncertainty: stiffness.stiffness_error })
    });
    columns.extend(impacts());
    measured(&mut columns, "force_n", |found| Some(found.excitation.as_ref()?.force));
    measured(&mut columns, "power_w", |found| Some(found.excitation.as_ref()?.fundamental_power));
    measured(&mut columns, "total_power_w", |found| Some(found.excitation.as_ref()?.total_power));
    columns.push(plain("linear_dissipation_w", |found| Some(found.modal.as_ref()?.dissipation.total())));
    measured(&mut columns, "energy_j", |found| Some(found.modal.as_ref()?.kinetic_energy));
    columns.push(count("periods", |found| Some(found.periods)));
    for k in 0..modes {
        errors.push(plain(&format!("participation_{}_uncertainty", k + 1), move |found| {
            found.modal.as_ref()?.participation_uncertainty.get(k).copied()
        }));
    }
    columns.extend(errors);
    columns
}

fn impacts() -> Vec<Column> {
    let statistics = |found: &RecordExtraction| Some(found.contact.as_ref()?.restitution.as_ref()?.statistics());
    vec![
        plain("restitution_mean", move |found| Some(statistics(found)?.mean)),
        plain("restitution_std", move |found| Some(statistics(found)?.std)),
        plain("approach_speed_m_s", move |found| Some(statistics(found)?.approach)),
        count("impacts", move |found| Some(statistics(found)?.n_impacts)),
        plain("contact_fraction", |found| Some(found.contact.as_ref()?.closed_fraction)),
    ]
}

/// A column of numbers: the shortest that read back as the same double; empty where there is none.
fn plain(name: &str, of: impl Fn(&RecordExtraction) -> Option<f64> + 'static) -> Column {
    let text = move |found: &RecordExtraction| match of(found) {
        Some(x) if x.is_finite() => format!("{x:?}"),
        _ => String::new(),
    };
    (name.to_owned(), Box::new(text))
}

fn count(name: &str, of: impl Fn(&RecordExtraction) -> Option<usize> + 'static) -> Column {
    (name.to_owned(), Box::new(move |found| of(found).map_or_else(String::new, |n| n.to_string())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes::report::columns::MODAL_POINT_COLUMNS;

    #[test]
    fn every_column_is_explained_and_every_explained_one_is_there() {
        let head = |level| {
            let text = Table::new(3, level).unwrap().into_bytes().unwrap();
            String::from_utf8(text).unwrap().trim_end().split(',').map(str::to_owned).collect::<Vec<_>>()
        };
        let names = [head(Some("drive_v")), head(Some("drive_n")), head(None)].concat();
        let is_explained = |name: &String| MODAL_POINT_COLUMNS.iter().any(|column| column.is_named(name));
        assert_eq!(names.iter().find(|name| !is_explained(name)), None);
        let is_there = |column: &&nlmodes::report::columns::Column| names.iter().any(|name| column.is_named(name));
        assert_eq!(MODAL_POINT_COLUMNS.iter().find(|column| !is_there(column)), None);
    }
}
