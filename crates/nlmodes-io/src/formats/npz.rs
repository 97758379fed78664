//! Archives of `scipy.sparse.save_npz`: `format`, `shape`, `data` and the indices, stored or deflated, read side by
//! side; and plain arrays of `numpy.savez` and `numpy.save`.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};
use std::path::Path;

use npyz::npz::NpzArchive;
use npyz::{DType, NpyFile, Order, TypeChar};

use super::compressed::Layout;
use super::{check_entries, check_order};
use crate::build::{EntryBuilder, Stored, Triangles};
use crate::error::{Place, Problem, ReadError, Result, shown};
use crate::lower::LowerTriangle;
use crate::numbers::NumberTable;

/// Most bytes of the text that describes an array.
const MAX_HEADER: usize = 4096;

type Archive = NpzArchive<BufReader<File>>;

pub(super) fn read(path: &Path, expected: Option<usize>) -> Result<LowerTriangle> {
    let file = Npz { path };
    // Rows and columns of a symmetric matrix may be exchanged: compressed rows are as good as compressed columns.
    match file.format()?.as_str() {
        "csc" | "csr" => file.compressed(expected),
        "coo" => file.coordinates(expected),
        other => Err(file.refuse("format", "csc, csr or coo (A.tocsc() before it is saved)", shown(other.as_bytes()))),
    }
}

/// An array of an archive: the one of this name, or the only one.
pub(crate) fn read_array(path: &Path, name: Option<&str>) -> Result<NumberTable> {
    let file = Npz { path };
    let mut archive = file.open()?;
    let mut known: Vec<String> = archive.array_names().map(str::to_owned).collect();
    known.sort();
    let name = match (name, &known[..]) {
        (Some(name), _) => name.to_owned(),
        (None, [only]) => only.clone(),
        (None, _) => {
            let example = format!("{}#{}", path.display(), known.first().map_or("frequencies", String::as_str));
            return Err(ReadError::whole(path, Problem::Ambiguous { what: "arrays", known, example }));
        }
    };
    let array = file.array(&mut archive, &name)?;
    file.table(array, &name)
}

/// The array of a file of `numpy.save`.
pub(crate) fn read_lone_array(path: &Path) -> Result<NumberTable> {
    let file = Npz { path };
    let failed = |error: io::Error| ReadError::whole(path, Problem::Io(error));
    let mut input = BufReader::new(File::open(path).map_err(failed)?);
    let damaged = |error: io::Error| {
        let expected = "a file of numpy.save".into();
        ReadError::whole(path, Problem::Expected { expected, found: error.to_string() })
    };
    let header = header(&mut input).map_err(damaged)?;
    let array = NpyFile::new(Cursor::new(header).chain(input)).map_err(damaged)?;
    file.table(array, "the array")
}

struct Npz<'a> {
    path: &'a Path,
}

impl Npz<'_> {
    fn part(&self, name: &str, problem: Problem) -> ReadError {
        ReadError::new(self.path, Place::Part(name.to_owned()), problem)
    }

    fn refuse(&self, name: &str, expected: impl Into<String>, found: String) -> ReadError {
        self.part(name, Problem::Expected { expected: expected.into(), found })
    }

    /// Each array that is read at the same time as others has an archive of its own.
    fn open(&self) -> Result<Archive> {
        let failed = |error: io::Error| ReadError::whole(self.path, Problem::Io(error));
        if self.path.is_dir() {
            return Err(failed(io::Error::other("it is a directory")));
        }
        let file = BufReader::new(File::open(self.path).map_err(failed)?);
        NpzArchive::new(file).map_err(|error| {
            let problem =
                Problem::Expected { expected: "an archive of scipy.sparse.save_npz".into(), found: error.to_string() };
            ReadError::whole(self.path, problem)
        })
    }

    /// `format` is a text of three letters. An archive of `numpy.savez` has none.
    fn format(&self) -> Result<String> {
        let mut archive = self.open()?;
        let mut names: Vec<String> = archive.array_names().map(str::to_owned).collect();
        if !names.iter().any(|name| name == "format") {
            names.sort();
            let expected =
                "an archive that scipy.sparse.save_npz(\"K.npz\", scipy.sparse.csc_matrix(K)) writes, a matrix a file"
                    .into();
            let found = format!(
                "the arrays {}",
                names.iter().map(|name| shown(name.as_bytes())).collect::<Vec<_>>().join(", ")
            );
            return Err(ReadError::whole(self.path, Problem::Expected { expected, found }));
        }
        let array = self.array(&mut archive, "format")?;
        let mut bytes = Vec::new();
        let failed = |error| self.part("format", Problem::Io(error));
        array.into_inner().take(64).read_to_end(&mut bytes).map_err(failed)?;
        bytes.retain(|b| *b != 0);
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn order(&self, expected: Option<usize>) -> Result<usize> {
        let mut archive = self.open()?;
        let mut numbers = self.integers(&mut archive, "shape")?;
        let shape: Vec<u64> = numbers.by_ref().take(3).collect::<Result<_>>()?;
        match shape[..] {
            [rows, columns] if rows == columns => check_order(self.path, Place::Part("shape".into()), rows, expected),
            _ => Err(self.refuse("shape", "as many rows as columns", format!("{shape:?}"))),
        }
    }

    fn compressed(&self, expected: Option<usize>) -> Result<LowerTriangle> {
        let order = self.order(expected)?;
        let mut archives = [self.open()?, self.open()?, self.open()?];
        let [first, second, third] = &mut archives;
        let pointers: Vec<u64> = self.integers(first, "indptr")?.take(order + 2).collect::<Result<_>>()?;
        if pointers.len() != order + 1 {
            let what = "number of pointers".to_owned();
            let size = Problem::Size { what, expected: order as u64 + 1, found: pointers.len() as u64 };
            return Err(self.part("indptr", size));
        }
        let mut rows = self.integers(second, "indices")?;
        let mut values = self.reals(third, "data")?;
        let layout = Layout { path: self.path, stored: Stored::Full, base: 0, names: ["indptr", "indices", "data"] };
        layout.check_pointers(&pointers, values.length)?;
        self.as_long(&rows, values.length)?;
        layout.read(&pointers, &mut rows, &mut values)
    }

    fn as_long<T>(&self, indices: &Numbers<'_, T>, values: u64) -> Result<()> {
        if indices.length == values {
            return Ok(());
        }
        let what = format!("length of `{}`, as that of `data`", indices.name);
        Err(self.part(indices.name, Problem::Size { what, expected: values, found: indices.length }))
    }

    fn coordinates(&self, expected: Option<usize>) -> Result<LowerTriangle> {
        let order = self.order(expected)?;
        let mut archives = [self.open()?, self.open()?, self.open()?];
        let [first, second, third] = &mut archives;
        let (rows, columns) = (self.integers(first, "row")?, self.integers(second, "col")?);
        let values = self.reals(third, "data")?;
        self.as_long(&rows, values.length)?;
        self.as_long(&columns, values.length)?;
        let mut builder = EntryBuilder::new(Triangles::Both, None);
        for (index, ((row, column), value)) in rows.zip(columns).zip(values).enumerate() {
            let at = |name: &str, problem| {
                ReadError::new(self.path, Place::Entry { array: name.to_owned(), index: index as u64 }, problem)
            };
            let (row, column, value) = (row?, column?, value?);
            for (name, found) in [("row", row), ("col", column)] {
                if found >= order as u64 {
                    let expected = format!("an index from 0 to {}", order - 1);
                    return Err(at(name, Problem::Expected { expected, found: found.to_string() }));
                }
            }
            if !value.is_finite() {
                return Err(at("data", Problem::NotFinite { what: "value", found: value.to_string() }));
            }
            let named = |fault: crate::build::Fault| at("row", fault.problem(|k| k.to_string()));
            builder.push(row as usize, column as usize, value).map_err(named)?;
        }
        check_entries(self.path, Place::File, order, builder.n_entries() as u64, expected)?;
        builder.finish(order, None).map_err(|fault| ReadError::whole(self.path, fault.problem(|k| k.to_string())))
    }

    /// The array `name`, with the header of a plain array: the parser after it recurses over brackets and multiplies
    /// lengths unchecked.
    fn array<'a>(&self, archive: &'a mut Archive, name: &str) -> Result<NpyFile<impl Read + 'a>> {
        let mut known: Vec<String> = archive.array_names().map(str::to_owned).collect();
        if !known.iter().any(|found| found == name) {
            known.sort();
            return Err(ReadError::whole(self.path, Problem::Missing { what: "array", name: name.to_owned(), known }));
        }
        let damaged = |error: io::Error| self.refuse(name, "an array of NumPy", error.to_string());
        let entry = archive.zip_archive().by_name(&format!("{name}.npy"));
        let mut entry = BufReader::with_capacity(1 << 16, entry.map_err(|error| damaged(io::Error::other(error)))?);
        let header = header(&mut entry).map_err(damaged)?;
        NpyFile::new(Cursor::new(header).chain(entry)).map_err(damaged)
    }

    fn integers<'a>(&'a self, archive: &'a mut Archive, name: &'static str) -> Result<Numbers<'a, u64>> {
        let file = self.array(archive, name)?;
        let length = self.length(&file, name)?;
        let damaged = move |error: io::Error| self.refuse(name, "whole numbers from 0 on", error.to_string());
        macro_rules! read_as {
            ($file:ident, $($number:ty),+) => {{
                $(let $file = match $file.try_data::<$number>() {
                    Ok(reader) => {
                        let negative = move |value: $number| {
                            u64::try_from(value)
                                .map_err(|_| self.refuse(name, "whole numbers from 0 on", value.to_string()))
                        };
                        let values = reader.map(move |value| value.map_err(damaged).and_then(negative));
                        return Ok(Numbers { name, length, values: Box::new(values) });
                    }
                    Err(file) => file,
                };)+
                Err(self.refuse(name, "whole numbers (int32 or int64)", format!("numbers of type \
                    {}", $file.dtype().descr())))
            }};
        }
        read_as!(file, i32, i64, u32, u64)
    }

    fn reals<'a>(&'a self, archive: &'a mut Archive, name: &'static str) -> Result<Numbers<'a, f64>> {
        let file = self.array(archive, name)?;
        let length = self.length(&file, name)?;
        Ok(Numbers { name, length, values: self.real_values(file, name)? })
    }

    /// An array of up to two dimensions, its numbers row by row.
    fn table<R: Read>(&self, file: NpyFile<R>, name: &str) -> Result<NumberTable> {
        let (order, lengths) = (file.order(), file.shape().to_vec());
        let shape: Vec<usize> = lengths.iter().filter_map(|length| usize::try_from(*length).ok()).collect();
        let count = shape.iter().try_fold(1_usize, |product, length| product.checked_mul(*length));
        let (Some(count), true, true) = (count, shape.len() == lengths.len(), shape.len() <= 2) else {
            let found = format!("{} dimensions", lengths.len());
            return Err(self.refuse(name, "an array of one or two dimensions", found));
        };
        let mut values = Vec::new();
        for value in self.real_values(file, name)? {
            values.push(self.finite(value?, (name, values.len()))?);
        }
        if values.len() != count {
            let what = "length of the array, as its shape says".to_owned();
            return Err(self.part(name, Problem::Size { what, expected: count as u64, found: values.len() as u64 }));
        }
        if let (Order::Fortran, &[rows, columns]) = (order, &shape[..]) {
            values = (0..count).map(|k| values[k / columns + (k % columns) * rows]).collect();
        }
        Ok(NumberTable { shape, values })
    }

    fn finite(&self, value: f64, (name, index): (&str, usize)) -> Result<f64> {
        if value.is_finite() {
            return Ok(value);
        }
        let place = Place::Entry { array: name.to_owned(), index: index as u64 };
        Err(ReadError::new(self.path, place, Problem::NotFinite { what: "number", found: value.to_string() }))
    }

    fn real_values<'a, R: Read + 'a>(
        &'a self,
        file: NpyFile<R>,
        name: &'a str,
    ) -> Result<Box<dyn Iterator<Item = Result<f64>> + 'a>> {
        let damaged = move |error: io::Error| self.refuse(name, "numbers", error.to_string());
        macro_rules! read_as {
            ($file:ident, $($number:ty),+) => {{
                $(let $file = match $file.try_data::<$number>() {
                    Ok(reader) => {
                        return Ok(Box::new(reader.map(move |value| value.map(|v| v as f64).map_err(damaged))));
                    }
                    Err(file) => file,
                };)+
                Err(self.refuse(name, "real numbers", format!("numbers of type {}", $file.dtype().descr())))
            }};
        }
        read_as!(file, f64, f32, i64, i32, i16, i8)
    }

    /// One-dimensional.
    fn length<R: Read>(&self, file: &NpyFile<R>, name: &str) -> Result<u64> {
        match (file.shape(), file.dtype()) {
            ([length], DType::Plain(plain)) if plain.type_char() != TypeChar::ByteStr => Ok(*length),
            (shape, _) => Err(self.refuse(name, "an array of one dimension", format!("shape {shape:?}"))),
        }
    }
}

/// Numbers of an array, one after the other.
struct Numbers<'a, T> {
    name: &'static str,
    length: u64,
    values: Box<dyn Iterator<Item = Result<T>> + 'a>,
}

impl<T> Iterator for Numbers<'_, T> {
    type Item = Result<T>;

    fn next(&mut self) -> Option<Result<T>> {
        self.values.next()
    }
}

/// The bytes up to the end of the description.
fn header(entry: &mut impl Read) -> io::Result<Vec<u8>> {
    let wrong = |message: &str| io::Error::new(io::ErrorKind::InvalidData, message.to_owned());
    let mut bytes = vec![0; 10];
    entry.read_exact(&mut bytes)?;
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err(wrong("something that does not begin as arrays of NumPy do"));
    }
    if bytes[6] != 1 {
        bytes.resize(12, 0);
        entry.read_exact(&mut bytes[10..])?;
    }
    let length = bytes[8..].iter().rev().fold(0_usize, |length, b| (length << 8) | usize::from(*b));
    if length > MAX_HEADER {
        return Err(wrong("a description that is too long"));
    }
    let start = bytes.len();
    bytes.resize(start + length, 0);
    entry.read_exact(&mut bytes[start..])?;
    let count = |wanted: &[u8]| bytes[start..].iter().filter(|b| wanted.contains(b)).count();
    if count(b"[") > 0 || count(b"(") > 1 || count(b"{") > 1 || count(b"0123456789") > 18 {
        return Err(wrong("records, or a description that is damaged"));
    }
    Ok(bytes)
}
