//! MATLAB's files: which of the two kinds one is, and what both have in common.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::{mat5, mat73};
use crate::error::{Problem, ReadError, Result};
use crate::lower::LowerTriangle;

pub(super) fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> Result<LowerTriangle> {
    let failed = |error| ReadError::whole(path, Problem::Io(error));
    let mut start = Vec::new();
    File::open(path).map_err(failed)?.take(520).read_to_end(&mut start).map_err(failed)?;
    let hdf5 = b"\x89HDF\r\n\x1a\n";
    if start.get(512..).is_some_and(|rest| rest.starts_with(hdf5)) || start.starts_with(hdf5) {
        return mat73::read(path, name, order);
    }
    match start.get(124..128) {
        Some([_, _, b'I', b'M'] | [_, _, b'M', b'I']) => mat5::read(path, name, order),
        _ => {
            let expected = "a MATLAB file of version 5 or 7.3".to_owned();
            Err(ReadError::whole(path, Problem::Expected { expected, found: crate::error::shown(&start) }))
        }
    }
}

/// The name that is asked for, or that of the only matrix.
pub(super) fn chosen(path: &Path, name: Option<&str>, known: Vec<String>) -> Result<String> {
    let problem = match (name, known.as_slice()) {
        (Some(name), _) if known.iter().any(|found| found == name) => return Ok(name.to_owned()),
        (Some(name), _) => Problem::Missing { what: "matrix", name: name.to_owned(), known },
        (None, [one]) => return Ok(one.clone()),
        (None, []) => Problem::Expected { expected: "a sparse or full matrix of numbers".into(), found: "none".into() },
        (None, [first, ..]) => {
            let file = path.file_name().map_or("model.mat".into(), |name| name.to_string_lossy());
            let example = format!("{file}#{first}");
            Problem::Ambiguous { what: "matrices", known, example }
        }
    };
    Err(ReadError::whole(path, problem))
}
