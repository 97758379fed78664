//! The formats of matrices, a file each.

mod abaqus;
mod calculix;
mod compressed;
mod dmig;
mod fortran;
mod harwell_boeing;
mod labelled;
mod mat5;
mod mat73;
mod matlab;
mod matrix_market;
pub(crate) mod npz;
mod user_element;

use std::collections::HashMap;
use std::fmt;
use std::io::Read;
use std::path::Path;
use std::str::FromStr;

use crate::error::{Problem, ReadError, Result, shown};
use crate::labels::DofLabel;
use crate::lower::LowerTriangle;
use crate::{Address, NumberArray};

/// A way to write a sparse matrix into a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Format {
    /// `.sti` and `.mas` of CalculiX: `row column value`, upper triangle column by column.
    Calculix,
    /// Matrix Market exchange format, coordinate or array, symmetric or general.
    MatrixMarket,
    /// `node,dof, node,dof, value`, as Abaqus writes with `FORMAT=MATRIX INPUT`, or the triangles of a user element, as
    /// it writes with `*SUBSTRUCTURE MATRIX OUTPUT`.
    Abaqus,
    /// `scipy.sparse.save_npz`: compressed columns, compressed rows or coordinates.
    Npz,
    /// MATLAB's files, version 5 to 7 and 7.3.
    Mat,
    /// Harwell-Boeing, real symmetric assembled, as Ansys writes with `HBMAT`.
    HarwellBoeing,
    /// Direct matrix input at grid points, as Nastran punches.
    Dmig,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 7] =
        [Self::Calculix, Self::MatrixMarket, Self::Abaqus, Self::Npz, Self::Mat, Self::HarwellBoeing, Self::Dmig];

    /// Name as in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Calculix => "calculix",
            Self::MatrixMarket => "matrix-market",
            Self::Abaqus => "abaqus",
            Self::Npz => "npz",
            Self::Mat => "mat",
            Self::HarwellBoeing => "harwell-boeing",
            Self::Dmig => "dmig",
        }
    }

    /// The format of a file, from the ending of its name; `.mtx` is Matrix Market if it begins as such files do, else
    /// Abaqus.
    ///
    /// # Errors
    /// [`ReadError`] if the ending is not known or the file cannot be read.
    pub fn of(address: &Address) -> Result<Self> {
        match address.ending().as_str() {
            "sti" | "mas" => Ok(Self::Calculix),
            "npz" => Ok(Self::Npz),
            "mat" => Ok(Self::Mat),
            "hb" | "rsa" | "rb" | "hbmat" | "matrix" => Ok(Self::HarwellBoeing),
            "pch" | "dmig" | "bdf" | "nas" => Ok(Self::Dmig),
            "inp" if user_element::is_one(&address.path)? => Ok(Self::Abaqus),
            "mtx" | "mm" => {
                let mut first = [0; 14];
                let read = crate::text::open(&address.path)?.read(&mut first);
                read.map_err(|error| ReadError::whole(&address.path, Problem::Io(error)))?;
                Ok(if first.eq_ignore_ascii_case(b"%%MatrixMarket") { Self::MatrixMarket } else { Self::Abaqus })
            }
            ending => Err(ReadError::whole(
                &address.path,
                Problem::Expected {
                    expected:
                        "a file of a matrix: .sti, .mas, .mtx, .npz, .mat, .hb or .pch (also .gz), or a format that \
                        is named"
                            .into(),
                    found: shown(format!(".{ending}").as_bytes()),
                },
            )),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(name: &str) -> std::result::Result<Self, UnknownFormat> {
        Self::ALL
            .into_iter()
            .find(|format| format.name() == name)
            .ok_or_else(|| UnknownFormat { name: name.to_owned() })
    }
}

/// There is no format of this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no format `{name}`; there are calculix, matrix-market, abaqus, npz, mat, harwell-boeing and dmig")]
pub struct UnknownFormat {
    /// The name.
    pub name: String,
}

/// Contents of a file for one symmetric matrix.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MatrixData {
    /// Lower triangle.
    pub lower: LowerTriangle,
    /// Labels of the rows, where the format has them (Abaqus, DMIG): ascending by node, then component.
    pub labels: Option<Vec<DofLabel>>,
    /// Degrees of freedom left out since the file holds them by 1e30 and more on the diagonal (Abaqus).
    pub fixed: Vec<DofLabel>,
    /// Positions of nodes given in the file in addition to its matrices, in its unit of length (GRID in a punch of
    /// Nastran).
    pub positions: HashMap<u64, [f64; 3]>,
    /// Axes of nodal displacements if not the global ones; none if not given in the file.
    pub directions: HashMap<u64, Option<[[f64; 3]; 3]>>,
}

/// Reads a symmetric matrix unchanged, in the file's units.
///
/// `order` is the number of rows, if known, so that a wrong header or row is rejected at its position. Without it a
/// matrix of n rows must have at least n entries.
///
/// # Errors
/// [`ReadError`] with the position and the expected contents.
pub fn read_matrix(address: &Address, format: Format, order: Option<usize>) -> Result<MatrixData> {
    let path = &address.path;
    let plain = |lower| MatrixData { lower, ..MatrixData::default() };
    let many = matches!(format, Format::Mat | Format::Dmig | Format::Abaqus);
    if !many {
        check_unnamed(path, address.name.as_deref())?;
    }
    match format {
        Format::Calculix => calculix::read(path, order).map(plain),
        Format::MatrixMarket => matrix_market::read(path, order).map(plain),
        Format::Abaqus => abaqus::read(path, address.name.as_deref()),
        Format::Npz => npz::read(path, order).map(plain),
        Format::Mat => matlab::read(path, address.name.as_deref(), order).map(plain),
        Format::HarwellBoeing => harwell_boeing::read(path, order).map(plain),
        Format::Dmig => dmig::read(path, address.name.as_deref()),
    }
}

/// All real arrays of numbers of a MATLAB file.
pub(crate) fn read_matlab_arrays(path: &Path) -> Result<Vec<NumberArray>> {
    matlab::read_arrays(path)
}

/// The same of any HDF5 file.
pub(crate) fn read_hdf5_arrays(path: &Path) -> Result<Vec<NumberArray>> {
    mat73::read_arrays(path)
}

/// No name may follow the file of a single matrix.
fn check_unnamed(path: &Path, name: Option<&str>) -> Result<()> {
    let Some(name) = name else { return Ok(()) };
    let expected = "the file alone: this format holds a single matrix without a name".into();
    Err(ReadError::whole(path, Problem::Expected { expected, found: format!("`#{name}` behind it") }))
}

/// A number of rows that a file claims: the expected one, or at least one that can be held.
fn check_order(path: &Path, place: crate::Place, found: u64, expected: Option<usize>) -> Result<usize> {
    let problem = match expected {
        Some(expected) if found != expected as u64 => {
            Problem::Size { what: "number of rows".into(), expected: expected as u64, found }
        }
        _ if found > crate::build::MAX_ORDER => {
            Problem::TooLarge { what: "number of rows", found, limit: crate::build::MAX_ORDER }
        }
        _ if found == 0 => Problem::Expected { expected: "at least one row".into(), found: "none".into() },
        _ => return Ok(found as usize),
    };
    Err(ReadError::new(path, place, problem))
}

/// Without an expected order, a header that claims more rows than there are entries would cost memory that nothing pays
/// for.
fn check_entries(path: &Path, place: crate::Place, order: usize, entries: u64, expected: Option<usize>) -> Result<()> {
    if expected.is_none() && entries < order as u64 {
        let what = format!("entries of a matrix of {order} rows, each of which has one at least");
        return Err(ReadError::new(path, place, Problem::Size { what, expected: order as u64, found: entries }));
    }
    Ok(())
}
