//! Lists and matrices of numbers, without names of rows.

use crate::error::{Problem, ReadError, Result, shown};
use crate::formats::npz;
use crate::text::{Fields, Lines, commas};
use crate::{Address, Place};

/// Numbers in none, one or two dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberTable {
    /// Lengths along the dimensions.
    pub shape: Vec<usize>,
    /// The numbers, row by row; all of them finite.
    pub values: Vec<f64>,
}

impl NumberTable {
    /// The numbers as a list, in their order: of one dimension, or of a single row or column.
    pub fn list(&self) -> Option<&[f64]> {
        match self.shape[..] {
            [] | [_] | [1, _] | [_, 1] => Some(&self.values),
            _ => None,
        }
    }

    /// `3 × 20`, or the length of a list.
    pub fn size(&self) -> String {
        match &self.shape[..] {
            [] => "1 number".to_owned(),
            [length] => format!("{length} numbers"),
            lengths => lengths.iter().map(usize::to_string).collect::<Vec<_>>().join(" × "),
        }
    }
}

/// Reads numbers from a file: an array of NumPy (`modes.npz#rows`, `rows.npy`), or lines of as many numbers each, with
/// commas or blanks between them (`rows.csv`, also .gz); behind `#` is a comment.
///
/// # Errors
/// [`ReadError`] with the position and the expected contents: another kind of file, an array that is not there or of
/// other things than real numbers, a number that is not finite, lines of unequal length, none at all.
pub fn read_numbers(address: &Address) -> Result<NumberTable> {
    let (path, name) = (&address.path, address.name.as_deref());
    let table = match address.ending().as_str() {
        "npz" => npz::read_array(path, name)?,
        ending => {
            if let Some(name) = name {
                let expected = "the file alone: only an archive .npz holds several arrays".into();
                return Err(ReadError::whole(
                    path,
                    Problem::Expected { expected, found: format!("`#{name}` behind it") },
                ));
            }
            match ending {
                "npy" => npz::read_lone_array(path)?,
                "csv" | "txt" | "dat" | "tsv" | "asc" => of_text(address)?,
                _ => {
                    let expected = "numbers in a file .npz, .npy, .csv or .txt".into();
                    let found = shown(format!(".{ending}").as_bytes());
                    return Err(ReadError::whole(path, Problem::Expected { expected, found }));
                }
            }
        }
    };
    if table.values.is_empty() {
        let expected = "at least one number".into();
        let place = name.map_or(Place::File, |name| Place::Part(name.to_owned()));
        return Err(ReadError::new(path, place, Problem::Expected { expected, found: "none".into() }));
    }
    Ok(table)
}

fn of_text(address: &Address) -> Result<NumberTable> {
    let mut lines = Lines::open(&address.path)?;
    let (mut values, mut rows, mut columns) = (Vec::new(), 0, 0);
    while lines.advance()? {
        let line = lines.line();
        let line = line.split(|b| *b == b'#').next().unwrap_or_default().trim_ascii();
        if line.is_empty() {
            continue;
        }
        let before = values.len();
        let with_commas = line.contains(&b',');
        let fields: Vec<&[u8]> = if with_commas { commas(line).collect() } else { Fields(line).collect() };
        for field in fields {
            values.push(lines.real(field, "entry of the table")?);
        }
        let found = values.len() - before;
        if rows > 0 && found != columns {
            let what = "numbers in the line, as in the first one".to_owned();
            return Err(lines.error(Problem::Size { what, expected: columns as u64, found: found as u64 }));
        }
        (rows, columns) = (rows + 1, found);
    }
    Ok(NumberTable { shape: vec![rows, columns], values })
}
