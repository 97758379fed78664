use std::io::Write;
use std::path::Path;

use super::harmonics::{all_coefficients, common_width};
use super::histories::{PointHistories, SERIES};
use super::mat5::{Value, file};
use crate::ReportError;
use crate::columns::{BranchRow, Column, ContactRow, ResponseRow, Row};
use crate::output::replace_file;
use nlmodes_modal::{ModalBranch, ModalPoint};

/// Maximum number of coefficients written.
const MOST_COEFFICIENTS: usize = 1 << 24;

/// Variables of `results.mat`.
pub const MATLAB_VARIABLES: [Column; 4] = [
    Column::new(
        "branch",
        "",
        "structure with the columns of `branch.csv`; `event`, `resonance` and other texts are cell arrays, what is \
         unknown is NaN",
    ),
    Column::new(
        "contacts",
        "",
        "structure with the columns of `contacts.csv` without `point`, `contact` and `frequency_hz`, each points × \
         stops",
    ),
    Column::new("harmonics", "", "structure with the arrays of `harmonics.npz`; beyond 2²⁴ coefficients without these"),
    Column::new("histories", "", "structure with the arrays of `histories.npz`"),
];

/// Writes a branch with its motions as a MATLAB file of version 5, with the variables of `columns::FILES`; `responses`
/// are the further columns of the points of responses, none of a branch.
///
/// # Errors
/// Errors of [`write_harmonics`](super::write_harmonics) and [`write_histories`](super::write_histories).
pub fn write_matlab(
    path: impl AsRef<Path>,
    branch: &ModalBranch,
    responses: &[ResponseRow],
    histories: &PointHistories,
) -> Result<(), ReportError> {
    let bytes = file(&[
        ("branch", branch_columns(&branch.points, responses)),
        ("contacts", contacts(&branch.points)),
        ("harmonics", harmonics(branch)?),
        ("histories", motions(histories)?),
    ]);
    replace_file(path.as_ref(), |file| file.write_all(&bytes))
}

/// Columns that number the rows, and that `branch` has as well.
const NUMBERING: [&str; 3] = ["point", "contact", "frequency_hz"];

fn branch_columns(points: &[ModalPoint], responses: &[ResponseRow]) -> Value {
    let rows: Vec<BranchRow> = points.iter().enumerate().map(|(k, point)| BranchRow::of(k, point)).collect();
    let mut fields = columns(&rows);
    if !responses.is_empty() {
        fields.extend(columns(responses));
    }
    Value::Structure(fields)
}

fn columns<R: Row>(rows: &[R]) -> Vec<(&'static str, Value)> {
    let (numbers, cells): (Vec<_>, Vec<_>) = rows.iter().map(|row| (row.numbers(), row.cells())).unzip();
    let field = |(k, column): (usize, &Column)| match R::TEXTS[k] {
        true => (column.name, Value::Texts(cells.iter().map(|cells| cells[k].clone()).collect())),
        false => (column.name, Value::column(numbers.iter().map(|numbers| numbers[k]))),
    };
    R::COLUMNS.iter().enumerate().map(field).collect()
}

fn contacts(points: &[ModalPoint]) -> Value {
    let n_contacts = points.iter().map(|point| point.contacts.len()).min().unwrap_or(0);
    let rows = points.iter().enumerate().flat_map(|(k, point)| ContactRow::of(k, point).take(n_contacts));
    let numbers: Vec<Vec<f64>> = rows.map(|row| row.numbers()).collect();
    let columns = ContactRow::COLUMNS.iter().enumerate().filter(|(_, column)| !NUMBERING.contains(&column.name));
    let shape = [points.len(), n_contacts];
    let field = |(k, column): (usize, &Column)| (column.name, Value::rows(&shape, numbers.iter().map(|row| row[k])));
    Value::Structure(columns.map(field).collect())
}

fn harmonics(branch: &ModalBranch) -> Result<Value, ReportError> {
    let width = common_width(branch)?;
    let shape = [branch.points.len(), branch.coordinates.len(), width];
    let mut fields = vec![("omega", Value::column(branch.points.iter().map(|point| point.omega)))];
    if shape.iter().product::<usize>() <= MOST_COEFFICIENTS {
        fields.push(("coefficients", Value::complex_rows(&shape, all_coefficients(branch, width))));
    }
    fields.push(("dof_position_m", Value::column(branch.coordinates.iter().map(|coordinate| coordinate.position))));
    fields.push(("dof_kind", Value::Texts(branch.coordinates.iter().map(|c| c.kind.clone()).collect())));
    Ok(Value::Structure(fields))
}

fn motions(histories: &PointHistories) -> Result<Value, ReportError> {
    let ([contacts, instants], points) = (histories.shape()?, histories.points.len());
    let mut fields = vec![
        ("point", Value::column(histories.points.iter().map(|point| *point as f64))),
        ("stop_m", Value::column(histories.stops().into_iter())),
        ("time_s", Value::rows(&[points, instants], histories.times())),
    ];
    for (name, values) in SERIES {
        fields.push((name, Value::rows(&[points, contacts, instants], histories.series(values))));
    }
    Ok(Value::Structure(fields))
}
