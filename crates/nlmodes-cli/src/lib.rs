//! The command line of nlmodes: from a scene file to branch, tables and figures.
//!
//! [`config`] reads and checks scenes, [`command`] takes the command line apart, and each command is a module of its own.

/// Prints a line to standard error; one that nobody can read is no error.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}

mod assemble;
mod check;
pub mod command;
mod compare;
pub mod config;
mod experiment;
mod lcp;
mod links;
mod memory;
mod modes;
#[doc(hidden)]
pub mod readers;
mod run;
mod status;
mod updating;
mod verify;
mod virtual_test;

pub use status::Status;
