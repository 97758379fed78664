//! The command line, `nlmodes` and `nlmodes-cli` on the path of an installed package.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Executes a command of the command line, whose first argument is the name of the program, and gives its exit status.
/// A wrong call, `--help` and `--version` end the process.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| nlmodes_cli::command::run_with(arguments).code())
}
