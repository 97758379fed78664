use std::io;
use std::path::PathBuf;

use nlmodes::contact::LcpError;
use thiserror::Error;

/// Why the input is not a contact problem, or the output cannot be written.
#[derive(Debug, Error)]
pub enum ProblemError {
    #[error("the file cannot be read")]
    Read(#[source] io::Error),
    #[error("this is a directory, not a file")]
    Directory,
    #[error("this is not a NumPy archive (.npz), or it is damaged")]
    NotAnArchive(#[source] io::Error),
    #[error("the archive has no array `{name}`; it has {}; expected `A` (c × c) and `b` (samples × c)", listed(found))]
    Missing { name: &'static str, found: Vec<String> },
    #[error("the array `{name}` is damaged")]
    Damaged {
        name: &'static str,
        #[source]
        source: io::Error,
    },
    #[error("the array `{name}` has {found}; expected numbers (float64) in a plain array")]
    NotNumbers { name: &'static str, found: String },
    #[error("the array `{name}` takes {bytes} bytes or more; at most {most} are read")]
    TooLarge { name: &'static str, bytes: u64, most: u64 },
    #[error("the array `{name}` has the shape {}; expected {expected}", shape(found))]
    Shape { name: &'static str, found: Vec<usize>, expected: String },
    #[error("`{name}`[{}] is {value}; expected finite numbers", indices(index))]
    NotFinite { name: &'static str, index: Vec<usize>, value: f64 },
    #[error(transparent)]
    Contact(#[from] LcpError),
    #[error("the solution cannot be written to {}", path.display())]
    Write {
        path: PathBuf,
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
