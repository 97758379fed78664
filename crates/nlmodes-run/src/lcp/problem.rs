//! Contact problems from a file.

use std::path::Path;

use nlmodes::contact::{LcpMatrix, Mat};

use super::archive::{Archive, Array};
use super::error::ProblemError;

/// Contact problems with one matrix.
pub struct Problem {
    /// `A`, checked.
    pub matrix: LcpMatrix,
    /// `b`, m, one sample after the other.
    pub b: Vec<f64>,
}

impl Problem {
    /// Number of samples.
    pub fn n_samples(&self) -> usize {
        self.b.len() / self.matrix.n_contacts()
    }
}

/// Reads `A` and `b` from a NumPy archive.
///
/// # Errors
/// [`ProblemError`] if they are not there, or no contact problem.
pub fn read(path: &Path) -> Result<Problem, ProblemError> {
    let mut archive = Archive::open(path)?;
    let (a, b) = (archive.array("A")?, archive.array("b")?);
    let c = order(&a)?;
    check_samples(&b, c)?;
    check_finite("A", &a)?;
    check_finite("b", &b)?;
    let matrix = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| a.values[i * c + j]))?;
    Ok(Problem { matrix, b: b.values })
}

fn order(a: &Array) -> Result<usize, ProblemError> {
    match *a.shape {
        [rows, columns] if rows == columns && rows > 0 => Ok(rows),
        _ => {
            let expected = "as many rows as columns, one for each contact".to_owned();
            Err(ProblemError::Shape { name: "A", found: a.shape.clone(), expected })
        }
    }
}

fn check_samples(b: &Array, c: usize) -> Result<(), ProblemError> {
    match *b.shape {
        [found] if found == c => Ok(()),
        [samples, found] if found == c && samples > 0 => Ok(()),
        _ => {
            let expected = format!("(samples, {c}) or ({c},): `A` has {c} contact(s)");
            Err(ProblemError::Shape { name: "b", found: b.shape.clone(), expected })
        }
    }
}

fn check_finite(name: &'static str, array: &Array) -> Result<(), ProblemError> {
    let Some(at) = array.values.iter().position(|v| !v.is_finite()) else { return Ok(()) };
    let index = match *array.shape {
        [_, columns] => vec![at / columns, at % columns],
        _ => vec![at],
    };
    Err(ProblemError::NotFinite { name, index, value: array.values[at] })
}
