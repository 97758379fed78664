//! All arrays of numbers of a file that holds several: records of tests, tables.

use crate::Address;
use crate::error::{Place, Problem, ReadError, Result, shown};
use crate::formats::{read_hdf5_arrays, read_matlab_arrays};

/// An array of numbers with its name in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberArray {
    /// In MATLAB's notation: `force`, `run.force`, `run{2}`; below the name of the address.
    pub name: String,
    /// Its lengths in MATLAB's order, rows first.
    pub dimensions: Vec<usize>,
    /// Its numbers, column by column.
    pub values: Vec<f64>,
}

/// Reads all real arrays of numbers of a MATLAB file, version 5 to 7.3 (`.mat`), or of another HDF5 file (`.h5`,
/// `.hdf5`), of which groups count as structures; behind `#` is the structure, cell or array that is meant,
/// `run.mat#Tests{2}`. Sparse and complex arrays, texts and objects are left out.
///
/// # Errors
/// [`ReadError`] with the position and the expected contents: another kind of file, nothing below this name.
pub fn read_arrays(address: &Address) -> Result<Vec<NumberArray>> {
    let path = &address.path;
    let mut arrays = match address.ending().as_str() {
        "mat" => read_matlab_arrays(path)?,
        "h5" | "hdf5" | "hdf" => read_hdf5_arrays(path)?,
        ending => {
            let expected = "arrays in a file .mat, .h5 or .hdf5".into();
            let found = shown(format!(".{ending}").as_bytes());
            return Err(ReadError::whole(path, Problem::Expected { expected, found }));
        }
    };
    if let Some(wanted) = &address.name {
        let names: Vec<String> = arrays.iter().map(|array| array.name.clone()).collect();
        arrays.retain_mut(|array| below(&array.name, wanted).map(|rest| array.name = rest).is_some());
        if arrays.is_empty() {
            let problem = Problem::Missing { what: "array", name: wanted.clone(), known: names };
            return Err(ReadError::new(path, Place::File, problem));
        }
    }
    Ok(arrays)
}

/// The rest of a name below another one; of an array itself its last name.
fn below(name: &str, wanted: &str) -> Option<String> {
    let wanted = wanted.trim_matches('/').replace('/', ".");
    let rest = name.strip_prefix(wanted.as_str())?;
    let last = || name.rsplit('.').next().unwrap_or(name).to_owned();
    match rest.chars().next() {
        None => Some(last()),
        Some('.') => Some(rest[1..].to_owned()),
        Some('{' | '(') => Some(last()),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_count_below_the_one_that_is_asked_for() {
        assert_eq!(below("run.force", "run").as_deref(), Some("force"));
        assert_eq!(below("run.a.force", "run/a").as_deref(), Some("force"));
        assert_eq!(below("run.force", "run.force").as_deref(), Some("force"));
        assert_eq!(below("tests{2}.x.y", "tests{2}").as_deref(), Some("x.y"));
        assert_eq!(below("tests{2}", "tests").as_deref(), Some("tests{2}"));
        assert_eq!((below("running.force", "run"), below("x", "run")), (None, None));
    }
}
