//! The program that scripts call again.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;

/// By which it was called, where that is a file.
static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Keeps the name of the program from the arguments of the call. In a package of Python the process is the interpreter.
pub fn called_by(arguments: &[OsString]) {
    let called = arguments.first().map(PathBuf::from).filter(|path| path.is_absolute() && path.is_file());
    called.into_iter().for_each(|path| _ = PROGRAM.set(path));
}

/// Path of the program.
pub fn path() -> PathBuf {
    PROGRAM.get().cloned().or_else(|| std::env::current_exe().ok()).unwrap_or_else(|| "nlmodes-cli".into())
}
