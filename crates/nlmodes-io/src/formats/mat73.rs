//! MATLAB's files of version 7.3: HDF5, a sparse matrix is a group of `data`, `ir` and `jc` with the number of rows as
//! an attribute.

use std::path::Path;

use hdf5_pure::{AttrValue, ChunkIndex, Dataset, Datatype, File, Group, Object};

use super::compressed::Layout;
use super::matlab::{DEEPEST, Leaf, MAX_ARRAYS, MatPath, chosen};
use super::{check_entries, check_order};
use crate::NumberArray;
use crate::build::Stored;
use crate::error::{Place, Problem, ReadError, Result};
use crate::lower::LowerTriangle;

/// No filter packs more numbers into a byte of the file.
const PACKED: u64 = 1100;
const ROWS: &str = "MATLAB_sparse";

pub(super) fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> Result<LowerTriangle> {
    let mat = Mat { path, file: File::open_streaming(path).map_err(|error| refused(path, Place::File, &error))? };
    let mut contents = Contents::default();
    mat.group(&mat.file.root(), None, 0, &mut contents)?;
    let at = chosen(path, name, &contents.leaves, &contents.objects)?;
    let name = contents.leaves[at].path.to_string();
    match &contents.arrays[at] {
        Array::Sparse(group) => mat.sparse(&name, group, order),
        Array::Full(set) => mat.full(&name, set, order),
    }
}

/// All real arrays of numbers that are not sparse.
pub(super) fn read_arrays(path: &Path) -> Result<Vec<NumberArray>> {
    let mat = Mat { path, file: File::open_streaming(path).map_err(|error| refused(path, Place::File, &error))? };
    let mut contents = Contents { is_of_any_size: true, ..Contents::default() };
    mat.group(&mat.file.root(), None, 0, &mut contents)?;
    let mut arrays = Vec::new();
    for (leaf, array) in contents.leaves.iter().zip(&contents.arrays) {
        let Array::Full(set) = array else { continue };
        // Texts and compound numbers, as complex ones are, are none.
        if !matches!(set.datatype(), Ok(Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. })) {
            continue;
        }
        let name = leaf.path.to_string();
        mat.check(&name, set, None)?;
        let values = mat.values(set, &name)?;
        let dimensions = leaf.dimensions.iter().map(|length| *length as usize).collect();
        arrays.push(NumberArray { name, dimensions, values });
    }
    arrays.retain(|array| !array.values.is_empty());
    Ok(arrays)
}

/// An array of numbers.
enum Array {
    Sparse(Group),
    Full(Box<Dataset>),
}

/// The arrays of numbers of a file.
#[derive(Default)]
struct Contents {
    leaves: Vec<Leaf>,
    arrays: Vec<Array>,
    objects: Vec<String>,
    /// Whether lists, and what is true or false, count, too.
    is_of_any_size: bool,
    /// Groups and data sets already visited.
    count: usize,
}

impl Contents {
    fn push(&mut self, path: MatPath, dimensions: Vec<u64>, array: Array) {
        self.leaves.push(Leaf { path, dimensions });
        self.arrays.push(array);
    }
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

    /// All that is in a group: the file, or a structure, whose fields are its members.
    fn group(&self, group: &Group, path: Option<&MatPath>, depth: usize, contents: &mut Contents) -> Result<()> {
        let wrong = |error| refused(self.path, Place::File, &error);
        let below = |name: &str| path.map_or_else(|| MatPath::variable(name), |path| path.field(name));
        self.count(depth, contents)?;
        for (name, member) in group.iter_groups().map_err(wrong)? {
            // What cells and objects refer to.
            if !(path.is_none() && name.starts_with('#')) {
                self.member(member, below(&name), depth, contents)?;
            }
        }
        for (name, set) in group.iter_datasets().map_err(wrong)? {
            self.set(Box::new(set), &below(&name), depth, contents)?;
        }
        Ok(())
    }

    /// A group that is a sparse matrix or a structure.
    fn member(&self, group: Group, path: MatPath, depth: usize, contents: &mut Contents) -> Result<()> {
        let attributes = group.attrs().unwrap_or_default();
        if let Some(rows) = attributes.get(ROWS) {
            let rows = whole(rows).unwrap_or(0);
            contents.push(path, vec![rows, rows], Array::Sparse(group));
            return Ok(());
        }
        self.group(&group, Some(&path), depth + 1, contents)
    }

    /// Numbers, the elements of a cell, or a field of an array of structures.
    fn set(&self, set: Box<Dataset>, path: &MatPath, depth: usize, contents: &mut Contents) -> Result<()> {
        let name = path.to_string();
        self.count(depth, contents)?;
        let attributes = set.attrs().unwrap_or_default();
        let class = attributes.get("MATLAB_class").and_then(|class| class.as_str().map(str::to_owned));
        if attributes.contains_key("MATLAB_object_decode") {
            contents.objects.push(name);
            return Ok(());
        }
        // What cannot be read is no matrix of numbers.
        let (Ok(mut dimensions), Ok(of)) = (set.shape(), set.datatype()) else { return Ok(()) };
        dimensions.reverse();
        if !matches!(of, Datatype::Reference { .. }) {
            let is_none =
                class.as_deref() == Some("char") || (class.as_deref() == Some("logical") && !contents.is_of_any_size);
            if (dimensions.len() == 2 || contents.is_of_any_size)
                && !is_none
                && !attributes.contains_key("MATLAB_empty")
            {
                contents.push(path.clone(), dimensions, Array::Full(set));
            }
            return Ok(());
        }
        self.check(&name, &set, None)?;
        // Elements that refer to nothing hold no matrix, nor do others of such a list.
        let Ok(members) = set.dereference() else { return Ok(()) };
        let of_cell = class.as_deref() == Some("cell");
        for (member, index) in members.into_iter().zip(0..) {
            let element = match (of_cell, path.parent()) {
                (false, Some((parent, field))) => parent.element(index, &dimensions, false).field(&field),
                _ => path.element(index, &dimensions, true),
            };
            match member {
                Object::Group(group) => self.member(group, element, depth + 1, contents)?,
                Object::Dataset(set) => self.set(set, &element, depth + 1, contents)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// References may go round in circles.
    fn count(&self, depth: usize, contents: &mut Contents) -> Result<()> {
        contents.count += 1;
        if contents.count <= MAX_ARRAYS && depth <= DEEPEST {
            return Ok(());
        }
        let expected = format!("at most {MAX_ARRAYS} arrays, at most {DEEPEST} deep");
        Err(ReadError::whole(self.path, Problem::Expected { expected, found: "more".into() }))
    }

    fn sparse(&self, name: &str, group: &Group, expected: Option<usize>) -> Result<LowerTriangle> {
        let place = || Place::Part(name.to_owned());
        let attributes = group.attrs().map_err(|error| self.wrong(name, &error))?;
        let rows = attributes.get(ROWS).and_then(whole).ok_or_else(|| {
            let problem = Problem::Expected { expected: "a number of rows".into(), found: "another attribute".into() };
            ReadError::new(self.path, Place::Part(format!("{name}: {ROWS}")), problem)
        })?;
        let order = check_order(self.path, place(), rows, expected)?;
        let names = [format!("{name}/jc"), format!("{name}/ir"), format!("{name}/data")];
        let [jc, ir, data] = ["jc", "ir", "data"].map(|part| {
            group.dataset(part).map(Box::new).map_err(|error| self.wrong(&format!("{name}/{part}"), &error))
        });
        let pointers = self.whole_numbers(&names[0], jc?, Some(order as u64 + 1))?;
        let layout =
            Layout { path: self.path, stored: Stored::Full, base: 0, names: [&names[0], &names[1], &names[2]] };
        let entries = pointers.last().copied().unwrap_or(0);
        layout.check_pointers(&pointers, entries)?;
        check_entries(self.path, place(), order, entries, expected)?;
        let indices = self.whole_numbers(&names[1], ir?, Some(entries))?;
        let values = self.values(self.checked(&names[2], data?, Some(entries))?.as_ref(), &names[2])?;
        layout.read(&pointers, &mut indices.into_iter().map(Ok), &mut values.into_iter().map(Ok))
    }

    fn full(&self, name: &str, set: &Dataset, expected: Option<usize>) -> Result<LowerTriangle> {
        let shape = set.shape().map_err(|error| self.wrong(name, &error))?;
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
        self.check(name, set, None)?;
        let values = self.values(set, name)?;
        let pointers: Vec<u64> = (0..=order as u64).map(|j| j * order as u64).collect();
        let layout = Layout { path: self.path, stored: Stored::Full, base: 0, names: ["columns", "rows", name] };
        layout.read(&pointers, &mut (0..order as u64).cycle().map(Ok), &mut values.into_iter().map(Ok))
    }

    /// The same data set, if it has `length` numbers and no more than the file can hold.
    fn checked(&self, name: &str, set: Box<Dataset>, length: Option<u64>) -> Result<Box<Dataset>> {
        self.check(name, &set, length).map(|()| set)
    }

    fn check(&self, name: &str, set: &Dataset, length: Option<u64>) -> Result<()> {
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
        Ok(())
    }

    /// Rejects an impossible number before memory is allocated for it.
    fn at_most(&self, name: &str, what: &'static str, found: u64, limit: u64) -> Result<()> {
        if found <= limit {
            return Ok(());
        }
        Err(ReadError::new(self.path, Place::Part(name.to_owned()), Problem::TooLarge { what, found, limit }))
    }

    fn whole_numbers(&self, name: &str, set: Box<Dataset>, length: Option<u64>) -> Result<Vec<u64>> {
        self.checked(name, set, length)?.read_u64().map_err(|error| self.wrong(name, &error))
    }

    fn values(&self, set: &Dataset, name: &str) -> Result<Vec<f64>> {
        set.read_f64().map_err(|error| self.wrong(name, &error))
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
