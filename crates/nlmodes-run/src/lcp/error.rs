//! Why there is no contact problem.

use std::io;
use std::path::PathBuf;

use nlmodes::contact::LcpError;
use thiserror::Error;

/// Why the input is not a contact problem, or the output cannot be written.
#[derive(Debug, Error)]
pub enum ProblemError {
    /// A file cannot be read.
    #[error("the file cannot be read")]
    Read(#[source] io::Error),
    /// There is a directory where a file was expected.
    #[error("this is a directory, not a file")]
    Directory,
    /// It is no NumPy archive, or a damaged one.
    #[error("this is not a NumPy archive (.npz), or it is damaged")]
    NotAnArchive(#[source] io::Error),
    /// Something that is needed is not there.
    #[error("the archive has no array `{name}`; it has {}; expected `A` (c × c) and `b` (samples × c)", listed(found))]
    Missing {
        /// Its name.
        name: &'static str,
        /// What was found.
        found: Vec<String>,
    },
    /// An array is damaged.
    #[error("the array `{name}` is damaged")]
    Damaged {
        /// Its name.
        name: &'static str,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// An array holds no plain numbers.
    #[error("the array `{name}` has {found}; expected numbers (float64) in a plain array")]
    NotNumbers {
        /// Its name.
        name: &'static str,
        /// What was found.
        found: String,
    },
    /// An array is too large to be read.
    #[error("the array `{name}` takes {bytes} bytes or more; at most {most} are read")]
    TooLarge {
        /// Its name.
        name: &'static str,
        /// Its size, bytes.
        bytes: u64,
        /// Most that are read, bytes.
        most: u64,
    },
    /// An array has a shape that makes no sense.
    #[error("the array `{name}` has the shape {}; expected {expected}", shape(found))]
    Shape {
        /// Its name.
        name: &'static str,
        /// What was found.
        found: Vec<usize>,
        /// What was expected.
        expected: String,
    },
    /// A number is infinite or none.
    #[error("`{name}`[{}] is {value}; expected finite numbers", indices(index))]
    NotFinite {
        /// Its name.
        name: &'static str,
        /// Its position, from 0.
        index: Vec<usize>,
        /// The number.
        value: f64,
    },
    /// The matrix is no matrix of contacts.
    #[error(transparent)]
    Contact(#[from] LcpError),
    /// The solution cannot be written.
    #[error("the solution cannot be written to {}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
}

fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().take(10).map(|name| format!("`{}`", name.escape_debug())).collect();
    match names.len() {
        0 => "none".into(),
        n if n > quoted.len() => format!("{} and {} more", quoted.join(", "), n - quoted.len()),
        _ => quoted.join(", "),
    }
}

/// A shape as Python writes it.
fn shape(lengths: &[usize]) -> String {
    let comma = if lengths.len() == 1 { "," } else { "" };
    format!("({}{comma})", indices(lengths))
}

fn indices(index: &[usize]) -> String {
    index.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}
