//! MATLAB's files: which of the two kinds one is, and what both have in common.

mod path;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub(super) use self::path::MatPath;
use super::{mat5, mat73};
use crate::NumberArray;
use crate::error::{Problem, ReadError, Result};
use crate::lower::LowerTriangle;

/// Most arrays of a file, with those in structures and cells.
pub(super) const MAX_ARRAYS: usize = 100_000;
/// Most structures and cells within each other.
pub(super) const DEEPEST: usize = 32;

/// An array of numbers in a file.
pub(super) struct Leaf {
    pub(super) path: MatPath,
    pub(super) dimensions: Vec<u64>,
}

impl Leaf {
    /// Whether it may be a matrix of a structure, and not a number or a list.
    fn is_square(&self) -> bool {
        matches!(self.dimensions[..], [rows, columns] if rows == columns && rows > 1)
    }
}

/// The two kinds of files.
enum Kind {
    Elements,
    Hdf5,
}

pub(super) fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> Result<LowerTriangle> {
    match kind(path)? {
        Kind::Elements => mat5::read(path, name, order),
        Kind::Hdf5 => mat73::read(path, name, order),
    }
}

/// All real arrays of numbers.
pub(super) fn read_arrays(path: &Path) -> Result<Vec<NumberArray>> {
    match kind(path)? {
        Kind::Elements => mat5::read_arrays(path),
        Kind::Hdf5 => mat73::read_arrays(path),
    }
}

fn kind(path: &Path) -> Result<Kind> {
    let failed = |error| ReadError::whole(path, Problem::Io(error));
    let mut start = Vec::new();
    File::open(path).map_err(failed)?.take(520).read_to_end(&mut start).map_err(failed)?;
    let hdf5 = b"\x89HDF\r\n\x1a\n";
    if start.get(512..).is_some_and(|rest| rest.starts_with(hdf5)) || start.starts_with(hdf5) {
        return Ok(Kind::Hdf5);
    }
    if let Some([_, _, b'I', b'M'] | [_, _, b'M', b'I']) = start.get(124..128) {
        return Ok(Kind::Elements);
    }
    let found = if is_version_4(&start) {
        "a file of version 4, as `save -v4` writes it".to_owned()
    } else if start.starts_with(b"# Created by Octave") {
        "a file of Octave's own text format".to_owned()
    } else {
        crate::error::shown(&start)
    };
    let expected = "a MATLAB file of version 5 to 7.3 (`save -v7 model.mat K M`, or `-v7.3`)".to_owned();
    Err(ReadError::whole(path, Problem::Expected { expected, found }))
}

/// Five whole numbers: type (machine, 0, precision, kind as digits), rows, columns, whether it is complex, length of
/// the name.
fn is_version_4(start: &[u8]) -> bool {
    let Some(head) = start.get(..20) else { return false };
    let fits = |of: fn([u8; 4]) -> u32| {
        let words: Vec<u32> = head.chunks_exact(4).map(|c| of([c[0], c[1], c[2], c[3]])).collect();
        let [kind, rows, columns, complex, name] = words[..] else { return false };
        let (machine, zero, precision, class) = (kind / 1000, kind / 100 % 10, kind / 10 % 10, kind % 10);
        let known = machine <= 4 && zero == 0 && precision <= 5 && class <= 2;
        known && rows < 1 << 31 && columns < 1 << 31 && complex <= 1 && (1..=64).contains(&name)
    };
    fits(u32::from_le_bytes) || fits(u32::from_be_bytes)
}

/// The requested array, or the only one; `objects` are variables that cannot be read.
pub(super) fn chosen(path: &Path, name: Option<&str>, known: &[Leaf], objects: &[String]) -> Result<usize> {
    let squares = known.iter().enumerate().filter(|(_, leaf)| leaf.is_square());
    let squares: Vec<usize> = squares.map(|(k, _)| k).collect();
    let all: Vec<usize> = (0..known.len()).collect();
    let candidates = if squares.is_empty() { &all } else { &squares };
    let names: Vec<String> = candidates.iter().map(|k| known[*k].path.to_string()).collect();
    let problem = match (name, candidates.as_slice()) {
        (Some(name), _) => match known.iter().position(|leaf| leaf.path.is(name)) {
            Some(at) => return Ok(at),
            None if names.is_empty() && !objects.is_empty() => without_numbers(objects),
            None => Problem::Missing { what: "matrix", name: name.to_owned(), known: names },
        },
        (None, [one]) => return Ok(*one),
        (None, []) => without_numbers(objects),
        (None, _) => {
            let file = path.file_name().map_or("model.mat".into(), |name| name.to_string_lossy());
            let example = format!("{file}#{}", names[0]);
            Problem::Ambiguous { what: "matrices", known: names, example }
        }
    };
    Err(ReadError::whole(path, problem))
}

fn without_numbers(objects: &[String]) -> Problem {
    let expected = "a sparse or full matrix of numbers, alone or in structures and cells".into();
    let found = match objects.first() {
        Some(name) => {
            format!("`{name}`, an object of a class: save its matrices by themselves (`K = {name}.K; save …`)")
        }
        None => "none".into(),
    };
    Problem::Expected { expected, found }
}
