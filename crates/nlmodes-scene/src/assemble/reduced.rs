//! Structures that were reduced elsewhere: their numbers, and what they have to be.

mod picture;

use std::f64::consts::TAU;

use nlmodes::linalg::{Mat, SparseMatrix, sparse_from_triplets};
use nlmodes::model::reduction::{GivenFlexibility, GivenModes, OpenModes, ReductionError};
use nlmodes::model::{Dof, DofKind};
use nlmodes_io::{Component, NumberTable, ReadError, UnitSystem, read_numbers};
pub use picture::PictureMesh;
use thiserror::Error;

use super::StructureError;
use crate::rule::counted;
use crate::scene::{Flexibility, Numbers, ReducedModel, Reduction, RowContact, Side};

const FREQUENCIES: &str = "frequencies_hz";
const ROWS: &str = "contact_rows";

/// Rows that differ by less than this share of the largest number of one are the same displacement.
const SAME: f64 = 1e-9;

/// What is wrong with the numbers of a structure that was reduced elsewhere.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReducedProblem {
    /// The file cannot be read.
    #[error("{0}")]
    Read(ReadError),
    /// Other numbers than are needed, or more or fewer.
    #[error("{of}found {found}; expected {expected}")]
    Shape {
        /// The file with a colon; empty for numbers of the scene.
        of: String,
        /// Lengths along the dimensions, in words.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A frequency that is negative, or lower than the one before.
    #[error(
        "{of}mode {mode} has {hz} Hz behind {before} Hz; expected 0 for each rigid-body motion, and then frequencies \
        that ascend"
    )]
    Frequency {
        /// The file with a colon; empty for numbers of the scene.
        of: String,
        /// The mode, from 1.
        mode: usize,
        /// Its frequency, Hz.
        hz: f64,
        /// That of the mode before, zero before the first, Hz.
        before: f64,
    },
    /// A row that no mode moves.
    #[error("{of}row {row} is zero in all modes; expected the displacement of a place that moves")]
    ZeroRow {
        /// The file with a colon; empty for numbers of the scene.
        of: String,
        /// The row, from 1.
        row: usize,
    },
    /// They make no reduced structure.
    #[error("{of}{source}")]
    Reduction {
        /// The file with a colon; empty for numbers of the scene.
        of: String,
        /// Why not.
        #[source]
        source: ReductionError,
    },
    /// A static flexibility of a structure that floats.
    #[error(
        "{of}the structure floats, with mode 1 at 0 Hz, and so has no static flexibility; expected \
        `residual_flexibility_m_n` in its place, that of loads in balance with the inertia forces of the modes"
    )]
    Floating {
        /// The file with a colon; empty for numbers of the scene.
        of: String,
    },
    /// A static flexibility that is less than what the modes have of it.
    #[error(
        "{of}less than what the modes alone give, mostly at row {row}: {flexibility:e} m/N, and {modal:e} m/N of the \
        modes; expected the whole static flexibility, that of the modes included. What is left beside the modes is \
        given under `residual_flexibility_m_n`; other units are named by `units`"
    )]
    LessThanModes {
        /// The file with a colon; empty for numbers of the scene.
        of: String,
        /// The row, from 1.
        row: usize,
        /// Its static flexibility, m/N.
        flexibility: f64,
        /// What the elastic modes have of it, m/N.
        modal: f64,
    },
}

/// What is known of the numbers of a structure that was reduced elsewhere.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReducedElsewhere {
    /// Number of modes.
    pub modes: usize,
    /// Number of rows.
    pub rows: usize,
    /// Whether the file or list of the rows has a line a mode, and not one a row.
    pub is_by_modes: bool,
}

impl ReducedElsewhere {
    /// Whether the numbers do not tell what a line of the rows is: there are as many as numbers in it.
    pub fn is_ambiguous(&self) -> bool {
        self.rows == self.modes && self.rows > 1
    }
}

/// Structure, contacts and degrees of freedom; these are the rows.
pub(super) struct Read {
    pub modes: OpenModes,
    pub dofs: Vec<Dof>,
    pub known: ReducedElsewhere,
    pub picture: Option<PictureMesh>,
}

/// Reads the numbers and makes the structure of them, with as many of its modes as are asked for.
pub(super) fn read(model: &ReducedModel, reduction: Option<Reduction>) -> Result<Read, StructureError> {
    let omega_squared = omega_squared(&model.frequencies_hz)?;
    let (mut rows, is_by_modes) = rows(model, omega_squared.len())?;
    let mut flexibility = flexibility(model, rows.nrows())?;
    let known = ReducedElsewhere { modes: omega_squared.len(), rows: rows.nrows(), is_by_modes };
    let mut picture = None;
    if let Some(of) = &model.picture {
        let (mesh, all, answers) = picture::joined((model, of), &omega_squared, &rows, flexibility)?;
        (picture, rows, flexibility) = (Some(mesh), all, answers);
    }
    let directions = directions(model, &rows, (&flexibility, known.rows))?;
    let contacts = &model.row_contacts;
    let gaps = contacts.iter().map(|contact| contact.gap).collect();
    let compliance = contacts.iter().map(|contact| contact.stiffness.map_or(0.0, |k| 1.0 / k)).collect();
    let given = GivenModes { omega_squared, rows, flexibility };
    let modes = OpenModes::given(given, directions, gaps, compliance).map_err(|error| refused(model, error))?;
    let dofs = (1..=modes.n_dofs()).map(|node| Dof { node, position: 0.0, kind: DofKind::Row }).collect();
    let wanted = wanted(&modes, reduction)?;
    let modes = if wanted < modes.n_modes() { modes.truncated(wanted)? } else { modes };
    Ok(Read { modes, dofs, known, picture })
}

/// How many of the modes the scene asks for: all where it does not.
fn wanted(modes: &OpenModes, reduction: Option<Reduction>) -> Result<usize, StructureError> {
    let available = modes.n_modes();
    match reduction.map(|asked| (asked.modes, asked.up_to_hz)) {
        Some((Some(asked), _)) if asked > available => Err(StructureError::TooManyGivenModes { asked, available }),
        Some((Some(asked), _)) => Ok(asked),
        Some((None, Some(hz))) => {
            let below = modes.omega_squared().iter().take_while(|square| **square <= (TAU * hz).powi(2));
            Ok(below.count().max(1))
        }
        _ => Ok(available),
    }
}

fn omega_squared(numbers: &Numbers) -> Result<Vec<f64>, StructureError> {
    let (table, of) = (table(numbers, FREQUENCIES)?, name(numbers));
    let Some(hz) = table.list() else {
        let (found, expected) = (table.size(), "a list of frequencies, one a mode".to_owned());
        return Err(refuse(FREQUENCIES, ReducedProblem::Shape { of, found, expected }));
    };
    let before = |k: usize| k.checked_sub(1).map_or(0.0, |k| hz[k]);
    if let Some(k) = (0..hz.len()).find(|&k| hz[k] < before(k)) {
        let problem = ReducedProblem::Frequency { of, mode: k + 1, hz: hz[k], before: before(k) };
        return Err(refuse(FREQUENCIES, problem));
    }
    Ok(hz.iter().map(|hz| (TAU * hz).powi(2)).collect())
}

/// The rows, rows × modes, in SI units, and whether they are given as modes × rows.
fn rows(model: &ReducedModel, modes: usize) -> Result<(Mat<f64>, bool), StructureError> {
    let (rows, is_by_modes) = by_modes((&model.contact_rows, ROWS), modes, model.units)?;
    match (0..rows.nrows()).find(|&i| (0..modes).all(|r| rows[(i, r)] == 0.0)) {
        Some(row) => {
            let of = name(&model.contact_rows);
            Err(refuse(ROWS, ReducedProblem::ZeroRow { of, row: row + 1 }))
        }
        None => Ok((rows, is_by_modes)),
    }
}

/// Displacements in the modes, displacements × modes, in SI units, and whether they are given the other way round.
fn by_modes(
    (numbers, key): (&Numbers, &'static str),
    modes: usize,
    units: UnitSystem,
) -> Result<(Mat<f64>, bool), StructureError> {
    let (table, of) = (table(numbers, key)?, name(numbers));
    let (lines, width) = match table.shape[..] {
        [lines, width] => (lines, width),
        [length] if modes == 1 => (length, 1),
        [length] => (1, length),
        _ => (1, 1),
    };
    let scale = match numbers {
        Numbers::File(_) => 1.0 / units.mass(Component::X, Component::X).sqrt(),
        Numbers::List(_) | Numbers::Table(_) => 1.0,
    };
    let is_by_modes = width != modes;
    if is_by_modes && lines != modes {
        let expected = format!(
            "a line of {} for each row, as many as modes, or a line for each of the {modes} modes",
            counted(modes, "number")
        );
        return Err(refuse(key, ReducedProblem::Shape { of, found: table.size(), expected }));
    }
    let rows = match is_by_modes {
        false => Mat::from_fn(lines, modes, |i, r| scale * table.values[i * width + r]),
        true => Mat::from_fn(width, modes, |i, r| scale * table.values[r * width + i]),
    };
    Ok((rows, is_by_modes))
}

fn flexibility(model: &ReducedModel, rows: usize) -> Result<GivenFlexibility, StructureError> {
    let (key, numbers) = (model.flexibility.key(), model.flexibility.numbers());
    let table = table(numbers, key)?;
    if table.values.len() != rows * rows || !(rows == 1 || table.shape.len() == 2 && table.shape[0] == rows) {
        let expected = format!("{rows} × {rows} numbers, as `{ROWS}` has {}", counted(rows, "row"));
        return Err(refuse(key, ReducedProblem::Shape { of: name(numbers), found: table.size(), expected }));
    }
    let scale = flexibility_scale(numbers, model.units);
    let matrix = Mat::from_fn(rows, rows, |i, j| scale * table.values[i * rows + j]);
    Ok(match model.flexibility {
        Flexibility::Static(_) => GivenFlexibility::Static(matrix),
        Flexibility::Residual(_) => GivenFlexibility::Residual(matrix),
    })
}

/// SI units over those of a flexibility.
fn flexibility_scale(numbers: &Numbers, units: UnitSystem) -> f64 {
    match numbers {
        Numbers::File(_) => 1.0 / units.stiffness(Component::X, Component::X),
        Numbers::List(_) | Numbers::Table(_) => 1.0,
    }
}

/// `g = g₀ − u` of a stop that is met by positive displacements `u` of its row.
fn directions(
    model: &ReducedModel,
    shapes: &Mat<f64>,
    (flexibility, rows): (&GivenFlexibility, usize),
) -> Result<SparseMatrix, StructureError> {
    let flexibility = flexibility.matrix();
    let contacts = model.row_contacts.iter().enumerate();
    if let Some((contact, of)) = contacts.clone().find(|(_, of)| of.row > rows) {
        return Err(StructureError::NoSuchRow { contact, row: of.row, rows });
    }
    let entry = |(contact, of): (usize, &RowContact)| {
        // Stops that face each other may have a row each: they share the first.
        let same = (0..of.row - 1).find_map(|j| Some((j, is_same([shapes, flexibility], (of.row - 1, j))?)));
        let (row, sign) = same.unwrap_or((of.row - 1, 1.0));
        (row, contact, if of.side == Side::Positive { -sign } else { sign })
    };
    let entries: Vec<_> = contacts.map(entry).collect();
    Ok(sparse_from_triplets(shapes.nrows(), model.row_contacts.len(), &entries)?)
}

/// +1 or −1 where two rows are the same displacement, or one against the other, as all modes and forces show.
fn is_same(tables: [&Mat<f64>; 2], (i, j): (usize, usize)) -> Option<f64> {
    let is = |sign: f64| {
        tables.iter().all(|table| {
            let size = table.row(j).iter().fold(0.0_f64, |size, value| size.max(value.abs()));
            (0..table.ncols()).all(|k| (table[(i, k)] - sign * table[(j, k)]).abs() <= SAME * size)
        })
    };
    [1.0, -1.0].into_iter().find(|sign| is(*sign))
}

/// What the library has against the numbers, at the key of those that it is about.
fn refused(model: &ReducedModel, error: ReductionError) -> StructureError {
    let (key, of) = (model.flexibility.key(), name(model.flexibility.numbers()));
    match error {
        ReductionError::FloatingFlexibility => refuse(key, ReducedProblem::Floating { of }),
        ReductionError::LessThanModes { row, flexibility, modal } => {
            refuse(key, ReducedProblem::LessThanModes { of, row, flexibility, modal })
        }
        source @ (ReductionError::NotSymmetric { .. } | ReductionError::NegativeFlexibility { .. }) => {
            refuse(key, ReducedProblem::Reduction { of, source })
        }
        source @ (ReductionError::Descending { .. } | ReductionError::OnlyRigidModes { .. }) => {
            refuse(FREQUENCIES, ReducedProblem::Reduction { of: name(&model.frequencies_hz), source })
        }
        other => other.into(),
    }
}

fn refuse(key: &'static str, problem: ReducedProblem) -> StructureError {
    StructureError::Reduced { key, problem }
}

/// The file of numbers with a colon behind it; nothing of those of the scene.
fn name(numbers: &Numbers) -> String {
    match numbers {
        Numbers::File(address) => format!("{address}: "),
        Numbers::List(_) | Numbers::Table(_) => String::new(),
    }
}

/// The numbers, from their file if they are in one.
fn table(numbers: &Numbers, key: &'static str) -> Result<NumberTable, StructureError> {
    match numbers {
        Numbers::File(address) => read_numbers(address).map_err(|source| refuse(key, ReducedProblem::Read(source))),
        Numbers::List(values) => Ok(NumberTable { shape: vec![values.len()], values: values.clone() }),
        Numbers::Table(lines) => {
            let width = lines.first().map_or(0, Vec::len);
            if let Some((i, line)) = lines.iter().enumerate().find(|(_, line)| line.len() != width) {
                let found = format!("{} in list {}", counted(line.len(), "number"), i + 1);
                let expected = format!("{width} in each list, as in the first one");
                return Err(refuse(key, ReducedProblem::Shape { of: String::new(), found, expected }));
            }
            Ok(NumberTable { shape: vec![lines.len(), width], values: lines.concat() })
        }
    }
}
