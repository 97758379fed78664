//! MATLAB's MAT-file format, level 5: elements with a type and a length, packed with zlib from version 7 on.

mod arrays;
mod element;

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::ZlibDecoder;

use self::arrays::Walk;
use self::element::{Elements, Order, Tag};
use super::compressed::Layout;
use super::matlab::{Leaf, MAX_ARRAYS, MatPath, chosen};
use super::{check_entries, check_order};
use crate::NumberArray;
use crate::build::Stored;
use crate::error::{Place, Problem, ReadError, Result};
use crate::lower::LowerTriangle;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Length of the text and version at the head of a file.
const HEADER: u64 = 128;
/// Classes of arrays: 1 is a cell, 2 a structure, 5 is sparse, 6 to 15 are numbers.
const SPARSE: u8 = 5;
const NUMBERS: std::ops::RangeInclusive<u8> = 6..=15;
/// Objects of classes, and what MATLAB keeps elsewhere in the file.
const OBJECTS: [u8; 3] = [3, 16, 17];

pub(super) fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> Result<LowerTriangle> {
    let file = Mat { path };
    let contents = file.contents()?;
    let at = chosen(path, name, &contents.leaves, &contents.objects)?;
    file.matrix(contents.starts[at], &contents.leaves[at].path, order)
}

/// All real arrays of numbers that are not sparse.
pub(super) fn read_arrays(path: &Path) -> Result<Vec<NumberArray>> {
    let file = Mat { path };
    let mut arrays = Vec::new();
    file.each(&mut |_, path, head, elements| {
        if NUMBERS.contains(&head.class) && !head.complex {
            arrays.extend(file.array(path, head, elements)?);
        }
        Ok(false)
    })?;
    Ok(arrays)
}

/// The arrays of numbers of a file, and where the variables begin in which they are.
#[derive(Default)]
struct Contents {
    leaves: Vec<Leaf>,
    starts: Vec<u64>,
    objects: Vec<String>,
}

impl Contents {
    fn take(&mut self, start: u64, path: &MatPath, head: &Head) {
        if head.is_matrix() {
            self.leaves.push(Leaf { path: path.clone(), dimensions: head.dimensions.clone() });
            self.starts.push(start);
        } else if OBJECTS.contains(&head.class) {
            self.objects.push(path.to_string());
        }
    }
}

/// The header of the numbers of an array.
struct Head {
    name: String,
    class: u8,
    complex: bool,
    dimensions: Vec<u64>,
}

impl Head {
    fn is_matrix(&self) -> bool {
        self.dimensions.len() == 2 && (self.class == SPARSE || NUMBERS.contains(&self.class))
    }
}

/// What is done with an array, of a variable that begins at a byte.
type EachArray<'v> = dyn FnMut(u64, &MatPath, &Head, &mut Elements<'_>) -> Result<bool> + 'v;

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

    /// All arrays of numbers.
    fn contents(&self) -> Result<Contents> {
        let mut contents = Contents::default();
        self.each(&mut |start, path, head, _| {
            contents.take(start, path, head);
            Ok(false)
        })?;
        Ok(contents)
    }

    /// The numbers after a header; none of an empty array.
    fn array(&self, path: &MatPath, head: &Head, elements: &mut Elements<'_>) -> Result<Option<NumberArray>> {
        let name = path.to_string();
        let count = head.dimensions.iter().try_fold(1_u64, |product, length| product.checked_mul(*length));
        let mut numbers = elements.numbers("pr")?;
        if Some(numbers.count()) != count {
            let (what, expected) = ("number of values".into(), count.unwrap_or(u64::MAX));
            let problem = Problem::Size { what, expected, found: numbers.count() };
            return Err(ReadError::new(self.path, Place::Part(name), problem));
        }
        let mut values = Vec::new();
        while let Some(value) = numbers.next()? {
            values.push(value);
        }
        let dimensions = head.dimensions.iter().map(|length| *length as usize).collect();
        Ok(Some(NumberArray { name, dimensions, values }).filter(|array| !array.values.is_empty()))
    }

    /// Visits all arrays that hold none, each with the byte at which its variable begins.
    fn each(&self, visit: &mut EachArray<'_>) -> Result<()> {
        let (mut file, order, length) = self.open()?;
        let (mut start, mut count) = (HEADER, 0);
        while start < length {
            let tag = self.top(&mut file, order, start)?;
            count += 1;
            if count > MAX_ARRAYS {
                let (found, limit) = (count as u64, MAX_ARRAYS as u64);
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
                let mut own =
                    |path: &MatPath, head: &Head, elements: &mut Elements<'_>| visit(start, path, head, elements);
                Walk::new(&mut own).array(&mut elements, None, 0)?;
            }
            start += 8 + tag.length;
        }
        Ok(())
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

    /// The array at this path, in the variable that begins there.
    fn matrix(&self, start: u64, wanted: &MatPath, expected: Option<usize>) -> Result<LowerTriangle> {
        let (mut file, bytes, _) = self.open()?;
        let tag = self.top(&mut file, bytes, start)?;
        let name = wanted.to_string();
        let mut elements = self.elements(&mut file, bytes, tag, &name)?;
        let mut matrix = None;
        let mut visit = |path: &MatPath, head: &Head, elements: &mut Elements<'_>| {
            if path == wanted && head.is_matrix() {
                matrix = Some(self.numbers(elements, head, &name, expected)?);
            }
            Ok(matrix.is_some())
        };
        Walk::new(&mut visit).array(&mut elements, None, 0)?;
        let missing = || Problem::Missing { what: "matrix", name: name.clone(), known: vec![] };
        matrix.ok_or_else(|| ReadError::whole(self.path, missing()))
    }

    /// The numbers after a header.
    fn numbers(
        &self,
        elements: &mut Elements<'_>,
        head: &Head,
        name: &str,
        expected: Option<usize>,
    ) -> Result<LowerTriangle> {
        let place = || Place::Part(name.to_owned());
        if head.complex {
            let found = "complex numbers".to_owned();
            let reason = "mass and stiffness are real; damping is given elsewhere";
            let problem = Problem::Refused { found, expected: "real numbers", reason };
            return Err(ReadError::new(self.path, place(), problem));
        }
        let (rows, columns) = (head.dimensions[0], head.dimensions[1]);
        if rows != columns {
            let what = "columns of a symmetric matrix".to_owned();
            return Err(ReadError::new(self.path, place(), Problem::Size { what, expected: rows, found: columns }));
        }
        let order = check_order(self.path, place(), rows, expected)?;
        if head.class == SPARSE {
            self.sparse(elements, name, order, expected)
        } else {
            self.full(elements, name, order)
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
fn head(elements: &mut Elements<'_>) -> Result<Head> {
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
    Ok(Head { name, class: (flags & 0xff) as u8, complex: flags & 0x0800 != 0, dimensions })
}
