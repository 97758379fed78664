//! MATLAB's MAT-file format, level 5: elements with a type and a length, packed with zlib from version 7 on.

mod element;

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::ZlibDecoder;

use self::element::{Elements, Order, Tag};
use super::compressed::Layout;
use super::matlab::chosen;
use super::{check_entries, check_order};
use crate::build::Stored;
use crate::error::{Place, Problem, ReadError, Result};
use crate::lower::LowerTriangle;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Length of the text and version at the head of a file.
const HEADER: u64 = 128;
/// Most variables of a file.
const MAX_VARIABLES: usize = 100_000;
/// Classes of arrays: 5 is sparse, 6 to 15 are numbers.
const SPARSE: u8 = 5;
const NUMBERS: std::ops::RangeInclusive<u8> = 6..=15;

pub(super) fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> Result<LowerTriangle> {
    let file = Mat { path };
    let variables = file.variables()?;
    let matrices: Vec<String> = variables.iter().filter(|v| v.is_matrix()).map(|v| v.name.clone()).collect();
    let name = chosen(path, name, matrices)?;
    match variables.iter().find(|variable| variable.name == name && variable.is_matrix()) {
        Some(variable) => file.matrix(variable, order),
        None => Err(ReadError::whole(path, Problem::Missing { what: "matrix", name, known: vec![] })),
    }
}

/// A variable of the file, and where it stands.
struct Variable {
    name: String,
    start: u64,
    class: u8,
    complex: bool,
    dimensions: Vec<u64>,
}

impl Variable {
    fn is_matrix(&self) -> bool {
        self.dimensions.len() == 2 && (self.class == SPARSE || NUMBERS.contains(&self.class))
    }
}

struct Mat<'a> {
    path: &'a Path,
}

impl Mat<'_> {
    fn failed(&self, error: std::io::Error) -> ReadError {
        ReadError::whole(self.path, Problem::Io(error))
    }

    fn open(&self) -> Result<(BufReader<File>, Order, u64)> {
        let file = File::open(self.path).map_err(|error| self.failed(error))?;
        let length = file.metadata().map_err(|error| self.failed(error))?.len();
        let mut file = BufReader::with_capacity(1 << 16, file);
        let mut header = [0; HEADER as usize];
        file.read_exact(&mut header).map_err(|error| self.failed(error))?;
        Ok((file, if header[126] == b'I' { Order::Little } else { Order::Big }, length))
    }

    /// The heads of all variables.
    fn variables(&self) -> Result<Vec<Variable>> {
        let (mut file, order, length) = self.open()?;
        let mut variables = Vec::new();
        let mut start = HEADER;
        while start < length {
            let tag = self.top(&mut file, order, start)?;
            if variables.len() == MAX_VARIABLES {
                let found = MAX_VARIABLES as u64 + 1;
                let limit = MAX_VARIABLES as u64;
                return Err(ReadError::whole(
                    self.path,
                    Problem::TooLarge { what: "number of variables", found, limit },
                ));
            }
            if start + 8 + tag.length > length {
                let expected = format!("{} bytes of the variable at byte {start}", tag.length);
                return Err(ReadError::whole(self.path, Problem::Ended { expected }));
            }
            if matches!(tag.kind, MATRIX | COMPRESSED) {
                let variable = format!("variable at byte {start}");
                let mut elements = self.elements(&mut file, order, tag, &variable)?;
                variables.push(head(&mut elements, start)?);
            }
            start += 8 + tag.length;
        }
        Ok(variables)
    }

    fn top(&self, file: &mut BufReader<File>, order: Order, start: u64) -> Result<Tag> {
        let mut bytes = [0; 8];
        let read = file.seek(SeekFrom::Start(start)).and_then(|_| file.read_exact(&mut bytes));
        read.map_err(|_| {
            let expected = format!("type and length of the variable at byte {start}");
            ReadError::whole(self.path, Problem::Ended { expected })
        })?;
        Ok(Tag::long(bytes, order))
    }

    /// The elements of a variable, unpacked.
    fn elements<'a>(
        &'a self,
        file: &'a mut BufReader<File>,
        order: Order,
        tag: Tag,
        name: &'a str,
    ) -> Result<Elements<'a>> {
        let bytes = file.take(tag.length);
        if tag.kind == MATRIX {
            return Ok(Elements::new(self.path, Box::new(bytes), order, name));
        }
        let unpacked: Box<dyn Read + 'a> = Box::new(BufReader::with_capacity(1 << 16, ZlibDecoder::new(bytes)));
        let mut elements = Elements::new(self.path, unpacked, order, name);
        let inner = elements.tag("variable")?;
        if inner.kind != MATRIX {
            return Err(elements.expected("packed variable", "an array (type 14)", format!("type {}", inner.kind)));
        }
        elements.enter();
        Ok(elements)
    }

    fn matrix(&self, variable: &Variable, expected: Option<usize>) -> Result<LowerTriangle> {
        let place = || Place::Part(variable.name.clone());
        if variable.complex {
            let found = "complex numbers".to_owned();
            let reason = "mass and stiffness are real; damping stands elsewhere";
            let problem = Problem::Refused { found, expected: "real numbers", reason };
            return Err(ReadError::new(self.path, place(), problem));
        }
        let (rows, columns) = (variable.dimensions[0], variable.dimensions[1]);
        if rows != columns {
            let what = "columns of a symmetric matrix".to_owned();
            return Err(ReadError::new(self.path, place(), Problem::Size { what, expected: rows, found: columns }));
        }
        let order = check_order(self.path, place(), rows, expected)?;
        let (mut file, bytes, _) = self.open()?;
        let tag = self.top(&mut file, bytes, variable.start)?;
        let mut elements = self.elements(&mut file, bytes, tag, &variable.name)?;
        head(&mut elements, variable.start)?;
        if variable.class == SPARSE {
            self.sparse(&mut elements, &variable.name, order, expected)
        } else {
            self.full(&mut elements, &variable.name, order)
        }
    }

    /// Row indices, pointers, values.
    fn sparse(
        &self,
        elements: &mut Elements<'_>,
        name: &str,
        order: usize,
        expected: Option<usize>,
    ) -> Result<LowerTriangle> {
        let mut rows = Vec::new();
        let mut numbers = elements.numbers("ir")?;
        while let Some(row) = numbers.whole()? {
            rows.push(u32::try_from(row).unwrap_or(u32::MAX)); // refused below: no matrix has so many rows
        }
        let mut pointers = Vec::new();
        let mut numbers = elements.numbers("jc")?;
        while let Some(pointer) = numbers.whole()? {
            pointers.push(pointer);
        }
        if pointers.len() != order + 1 {
            let what = "number of column pointers".to_owned();
            let problem = Problem::Size { what, expected: order as u64 + 1, found: pointers.len() as u64 };
            return Err(ReadError::new(self.path, Place::Part(name.to_owned()), problem));
        }
        let names = [format!("{name}.jc"), format!("{name}.ir"), format!("{name}.data")];
        let layout =
            Layout { path: self.path, stored: Stored::Full, base: 0, names: [&names[0], &names[1], &names[2]] };
        // More may be allocated than is used.
        let entries = pointers.last().copied().unwrap_or(0);
        layout.check_pointers(&pointers, entries)?;
        check_entries(self.path, Place::Part(name.to_owned()), order, entries, expected)?;
        let mut numbers = elements.numbers("pr")?;
        let mut values = std::iter::from_fn(|| numbers.next().transpose());
        layout.read(&pointers, &mut rows.iter().map(|row| Ok(u64::from(*row))), &mut values)
    }

    /// All values, column by column.
    fn full(&self, elements: &mut Elements<'_>, name: &str, order: usize) -> Result<LowerTriangle> {
        let entries = order as u64 * order as u64;
        let mut numbers = elements.numbers("pr")?;
        if numbers.count() != entries {
            let problem = Problem::Size { what: "number of values".into(), expected: entries, found: numbers.count() };
            return Err(ReadError::new(self.path, Place::Part(name.to_owned()), problem));
        }
        let pointers: Vec<u64> = (0..=order as u64).map(|j| j * order as u64).collect();
        let layout = Layout { path: self.path, stored: Stored::Full, base: 0, names: ["columns", "rows", name] };
        let mut values = std::iter::from_fn(|| numbers.next().transpose());
        let mut rows = (0..order as u64).cycle().map(Ok);
        layout.read(&pointers, &mut rows, &mut values)
    }
}

/// Flags, dimensions and name of an array.
fn head(elements: &mut Elements<'_>, start: u64) -> Result<Variable> {
    let flags = elements.small("array flags", 8)?;
    let flags = match *flags.as_slice() {
        [a, b, c, d, ..] => elements.order().u32([a, b, c, d]),
        _ => return Err(elements.expected("array flags", "eight bytes of flags", format!("{} bytes", flags.len()))),
    };
    let mut dimensions = Vec::new();
    let mut numbers = elements.numbers("dimensions")?;
    while let Some(length) = numbers.whole()? {
        if dimensions.len() == 32 {
            return Err(elements.expected("dimensions", "at most 32 dimensions", "more".into()));
        }
        dimensions.push(length);
    }
    let name = String::from_utf8_lossy(&elements.small("name", 64)?).into_owned();
    Ok(Variable { name, start, class: (flags & 0xff) as u8, complex: flags & 0x0800 != 0, dimensions })
}
