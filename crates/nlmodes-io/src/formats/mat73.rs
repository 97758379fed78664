//! MATLAB's files of version 7.3: HDF5, a sparse matrix is a group of `data`, `ir` and `jc` with the number of rows as
//! an attribute.

use std::path::Path;

use hdf5_pure::{AttrValue, ChunkIndex, Dataset, File};

use super::compressed::Layout;
use super::matlab::chosen;
use super::{check_entries, check_order};
use crate::build::Stored;
use crate::error::{Place, Problem, ReadError, Result};
use crate::lower::LowerTriangle;

/// No filter packs more numbers into a byte of the file.
const PACKED: u64 = 1100;
const ROWS: &str = "MATLAB_sparse";

pub(super) fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> Result<LowerTriangle> {
    let mat = Mat { path, file: File::open_streaming(path).map_err(|error| refused(path, Place::File, &error))? };
    let name = chosen(path, name, mat.names()?)?;
    mat.matrix(&name, order)
}

fn refused(path: &Path, place: Place, error: &hdf5_pure::Error) -> ReadError {
    ReadError::new(
        path,
        place,
        Problem::Expected { expected: "an HDF5 file of MATLAB".into(), found: error.to_string() },
    )
}

struct Mat<'a> {
    path: &'a Path,
    file: File,
}

impl Mat<'_> {
    fn wrong(&self, part: &str, error: &hdf5_pure::Error) -> ReadError {
        refused(self.path, Place::Part(part.to_owned()), error)
    }

    /// Sparse matrices and full ones.
    fn names(&self) -> Result<Vec<String>> {
        let root = self.file.root();
        let wrong = |error| refused(self.path, Place::File, &error);
        let mut names = Vec::new();
        for name in root.groups().map_err(wrong)? {
            let attributes = root.group(&name).and_then(|group| group.attrs()).map_err(wrong)?;
            if attributes.contains_key(ROWS) {
                names.push(name);
            }
        }
        for name in root.datasets().map_err(wrong)? {
            if root.dataset(&name).and_then(|set| set.shape()).map_err(wrong)?.len() == 2 {
                names.push(name);
            }
        }
        Ok(names)
    }

    fn matrix(&self, name: &str, expected: Option<usize>) -> Result<LowerTriangle> {
        let root = self.file.root();
        match root.groups().is_ok_and(|groups| groups.iter().any(|group| group == name)) {
            true => self.sparse(name, expected),
            false => self.full(name, expected),
        }
    }

    fn sparse(&self, name: &str, expected: Option<usize>) -> Result<LowerTriangle> {
        let place = || Place::Part(name.to_owned());
        let group = self.file.root().group(name).map_err(|error| self.wrong(name, &error))?;
        let attributes = group.attrs().map_err(|error| self.wrong(name, &error))?;
        let rows = attributes.get(ROWS).and_then(whole).ok_or_else(|| {
            let problem = Problem::Expected { expected: "a number of rows".into(), found: "another attribute".into() };
            ReadError::new(self.path, Place::Part(format!("{name}: {ROWS}")), problem)
        })?;
        let order = check_order(self.path, place(), rows, expected)?;
        let names = [format!("{name}/jc"), format!("{name}/ir"), format!("{name}/data")];
        let pointers = self.whole_numbers(&names[0], Some(order as u64 + 1))?;
        let layout =
            Layout { path: self.path, stored: Stored::Full, base: 0, names: [&names[0], &names[1], &names[2]] };
        let entries = pointers.last().copied().unwrap_or(0);
        layout.check_pointers(&pointers, entries)?;
        check_entries(self.path, place(), order, entries, expected)?;
        let indices = self.whole_numbers(&names[1], Some(entries))?;
        let values = self.values(&names[2], Some(entries))?;
        layout.read(&pointers, &mut indices.into_iter().map(Ok), &mut values.into_iter().map(Ok))
    }

    fn full(&self, name: &str, expected: Option<usize>) -> Result<LowerTriangle> {
        let shape = self.set(name)?.shape().map_err(|error| self.wrong(name, &error))?;
        let [rows, columns] = shape[..] else {
            let problem = Problem::Expected { expected: "two dimensions".into(), found: format!("shape {shape:?}") };
            return Err(ReadError::new(self.path, Place::Part(name.to_owned()), problem));
        };
        if rows != columns {
            let what = "columns of a symmetric matrix".to_owned();
            let problem = Problem::Size { what, expected: rows, found: columns };
            return Err(ReadError::new(self.path, Place::Part(name.to_owned()), problem));
        }
        let order = check_order(self.path, Place::Part(name.to_owned()), rows, expected)?;
        let values = self.values(name, None)?;
        let pointers: Vec<u64> = (0..=order as u64).map(|j| j * order as u64).collect();
        let layout = Layout { path: self.path, stored: Stored::Full, base: 0, names: ["columns", "rows", name] };
        layout.read(&pointers, &mut (0..order as u64).cycle().map(Ok), &mut values.into_iter().map(Ok))
    }

    fn set(&self, name: &str) -> Result<Dataset> {
        self.file.dataset(name).map_err(|error| self.wrong(name, &error))
    }

    /// A data set of `length` numbers, no more than the file can hold.
    fn checked(&self, name: &str, length: Option<u64>) -> Result<Dataset> {
        let set = self.set(name)?;
        let shape = set.shape().map_err(|error| self.wrong(name, &error))?;
        let found = shape.iter().try_fold(1_u64, |product, length| product.checked_mul(*length)).unwrap_or(u64::MAX);
        if let Some(expected) = length.filter(|expected| *expected != found) {
            let problem = Problem::Size { what: "number of values".to_owned(), expected, found };
            return Err(ReadError::new(self.path, Place::Part(name.to_owned()), problem));
        }
        let most = self.file.file_size().saturating_mul(PACKED);
        self.at_most(name, "number of values, for the length of the file,", found, most)?;
        if let Some(shape) = set.chunk_shape().map_err(|error| self.wrong(name, &error))? {
            let chunk = shape.iter().fold(1_u64, |product, length| product.saturating_mul(*length));
            self.at_most(name, "number of values in a chunk, for the length of the file,", chunk, most)?;
            let chunks = match set.chunk_index().map_err(|error| self.wrong(name, &error))? {
                // The crate does not list them.
                Some(ChunkIndex::BTreeV2) => Vec::new(),
                _ => set.chunks().map_err(|error| self.wrong(name, &error))?,
            };
            let ends = chunks.iter().map(|chunk| chunk.address.saturating_add(chunk.storage_size));
            self.at_most(name, "last byte of a chunk", ends.max().unwrap_or(0), self.file.file_size())?;
        }
        Ok(set)
    }

    /// Refuses a number that the file cannot mean, before memory is taken for it.
    fn at_most(&self, name: &str, what: &'static str, found: u64, limit: u64) -> Result<()> {
        if found <= limit {
            return Ok(());
        }
        Err(ReadError::new(self.path, Place::Part(name.to_owned()), Problem::TooLarge { what, found, limit }))
    }

    fn whole_numbers(&self, name: &str, length: Option<u64>) -> Result<Vec<u64>> {
        self.checked(name, length)?.read_u64().map_err(|error| self.wrong(name, &error))
    }

    fn values(&self, name: &str, length: Option<u64>) -> Result<Vec<f64>> {
        self.checked(name, length)?.read_f64().map_err(|error| self.wrong(name, &error))
    }
}

fn whole(value: &AttrValue) -> Option<u64> {
    match value {
        AttrValue::U64(n) => Some(*n),
        AttrValue::I64(n) => u64::try_from(*n).ok(),
        AttrValue::U32(n) => Some(u64::from(*n)),
        AttrValue::I32(n) => u64::try_from(*n).ok(),
        AttrValue::U64Array(n) if n.len() == 1 => n.first().copied(),
        AttrValue::I64Array(n) if n.len() == 1 => n.first().and_then(|n| u64::try_from(*n).ok()),
        _ => None,
    }
}
