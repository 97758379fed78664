//! Arrays of numbers from untrusted NumPy archives.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use npyz::npz::NpzArchive;
use npyz::{DType, NpyFile, Order};
use num_complex::Complex64;

use super::error::ProblemError;

/// Most bytes of an array.
const MAX_BYTES: u64 = 1 << 30;

/// Most bytes of the text that describes an array.
const MAX_HEADER: usize = 4096;

/// An array of one or two dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Lengths along the dimensions.
    pub shape: Vec<usize>,
    /// Values, row by row.
    pub values: Vec<f64>,
}

/// An open archive.
pub struct Archive(NpzArchive<BufReader<File>>);

impl Archive {
    pub fn open(path: &Path) -> Result<Self, ProblemError> {
        if path.is_dir() {
            return Err(ProblemError::Directory);
        }
        let file = File::open(path).map_err(ProblemError::Read)?;
        NpzArchive::new(BufReader::new(file)).map(Self).map_err(ProblemError::NotAnArchive)
    }

    /// The array `name`.
    pub fn array(&mut self, name: &'static str) -> Result<Array, ProblemError> {
        let found = self.names();
        if !found.iter().any(|known| known == name) {
            return Err(ProblemError::Missing { name, found });
        }
        let bytes = self.bytes(name)?;
        check_header(&bytes).map_err(|found| ProblemError::NotNumbers { name, found })?;
        let file = NpyFile::new(&bytes[..]).map_err(|source| ProblemError::Damaged { name, source })?;
        decode(name, file)
    }

    /// Names of the arrays, in alphabetical order.
    pub fn names(&self) -> Vec<String> {
        let mut found: Vec<String> = self.0.array_names().map(str::to_owned).collect();
        found.sort();
        found
    }

    /// The complex array `name`, row by row, with its lengths along any number of dimensions.
    pub fn complex(&mut self, name: &'static str) -> Result<(Vec<usize>, Vec<Complex64>), ProblemError> {
        let bytes = self.bytes(name)?;
        check_header(&bytes).map_err(|found| ProblemError::NotNumbers { name, found })?;
        let damaged = |source| ProblemError::Damaged { name, source };
        let file = NpyFile::new(&bytes[..]).map_err(damaged)?;
        check_length(&file).map_err(damaged)?;
        let lengths: Option<Vec<usize>> = file.shape().iter().map(|n| usize::try_from(*n).ok()).collect();
        let shape = lengths.unwrap_or_default();
        if file.order() == Order::Fortran && shape.len() > 1 {
            return Err(ProblemError::NotNumbers { name, found: "columns before rows (Fortran order)".into() });
        }
        let values = file
            .try_data::<Complex64>()
            .map_err(|_| ProblemError::NotNumbers { name, found: "values that are not complex numbers".into() })?;
        Ok((shape, values.collect::<io::Result<Vec<_>>>().map_err(damaged)?))
    }

    /// The unpacked bytes of an array; memory is allocated as they are read, whatever the archive claims.
    fn bytes(&mut self, name: &'static str) -> Result<Vec<u8>, ProblemError> {
        let damaged = |source| ProblemError::Damaged { name, source };
        let entry = self.0.zip_archive().by_name(&format!("{name}.npy"));
        let mut entry = entry.map_err(|error| damaged(io::Error::other(error)))?;
        let too_large = |bytes| ProblemError::TooLarge { name, bytes, most: MAX_BYTES };
        if entry.size() > MAX_BYTES {
            return Err(too_large(entry.size()));
        }
        let mut bytes = Vec::new();
        entry.by_ref().take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(damaged)?;
        if bytes.len() as u64 > MAX_BYTES { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
    }
}

/// Accepts only headers of plain arrays: the parser after it recurses over brackets and multiplies lengths unchecked.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let start = if bytes.get(6) == Some(&1) { 10 } else { 12 };
    let text = bytes.get(start..).unwrap_or_default();
    let text = &text[..text.iter().position(|b| *b == b'}').map_or(text.len(), |end| end + 1).min(MAX_HEADER)];
    let claimed = bytes.get(8..start).unwrap_or_default().iter().rev().fold(0_usize, |n, b| (n << 8) | usize::from(*b));
    if claimed > MAX_HEADER {
        return Err("a description that is too long".into());
    }
    let count = |wanted: fn(&u8) -> bool| text.iter().filter(|b| wanted(b)).count();
    if count(|b| *b == b'[') > 0 || count(|b| *b == b'(') > 1 || count(|b| *b == b'{') > 1 {
        return Err("records or a description that is damaged".into());
    }
    // With so few digits no product of lengths leaves 64 bits.
    if count(u8::is_ascii_digit) > 18 { Err("a shape that is too large".into()) } else { Ok(()) }
}

fn decode(name: &'static str, file: NpyFile<&[u8]>) -> Result<Array, ProblemError> {
    let order = file.order();
    let lengths: Option<Vec<usize>> = file.shape().iter().map(|n| usize::try_from(*n).ok()).collect();
    let Some(shape) = lengths.filter(|lengths| (1..=2).contains(&lengths.len())) else {
        let dimensions = file.shape().len();
        return Err(ProblemError::NotNumbers { name, found: format!("{dimensions} dimensions") });
    };
    check_length(&file).map_err(|source| ProblemError::Damaged { name, source })?;
    let values =
        numbers(file).map_err(|dtype| ProblemError::NotNumbers { name, found: format!("the type {dtype}") })?;
    let values = values.map_err(|source| ProblemError::Damaged { name, source })?;
    Ok(match (order, shape.as_slice()) {
        (Order::Fortran, &[rows, columns]) => {
            let row_by_row = (0..rows).flat_map(|i| (0..columns).map(move |j| i + j * rows));
            Array { values: row_by_row.map(|at| values[at]).collect(), shape }
        }
        _ => Array { shape, values },
    })
}

/// The bytes that are there must be those that the shape needs.
fn check_length(file: &NpyFile<&[u8]>) -> io::Result<()> {
    let needed = file.dtype().num_bytes().and_then(|size| usize::try_from(file.len()).ok()?.checked_mul(size));
    let found = file.clone().into_inner().len();
    if needed == Some(found) {
        return Ok(());
    }
    let needed = needed.map_or_else(|| "more than there can be".to_owned(), |n| n.to_string());
    Err(io::Error::new(io::ErrorKind::InvalidData, format!("{found} bytes of numbers, its shape needs {needed}")))
}

/// The numbers in the order of the file, or the name of a type that holds none.
fn numbers(file: NpyFile<&[u8]>) -> Result<io::Result<Vec<f64>>, String> {
    let name = match file.dtype() {
        DType::Plain(plain) => plain.to_string(),
        other => other.descr(),
    };
    macro_rules! read_as {
        ($file:ident, $($number:ty),+) => {{
            $(let $file = match $file.try_data::<$number>() {
                Ok(reader) => return Ok(reader.map(|value| value.map(|v| v as f64)).collect()),
                Err(file) => file,
            };)+
            drop($file);
        }};
    }
    read_as!(file, f64, f32, i64, i32, i16, i8, u64, u32, u16, u8);
    Err(name)
}
