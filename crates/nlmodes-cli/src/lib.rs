//! The command line of nlmodes: from a scene file to branch, tables and figures.
//!
//! `nlmodes-scene` reads and checks scenes, [`command`] takes the command line apart, and each command is a module of its own.

/// Prints a line to standard error; one that nobody can read is no error.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}

mod check;
mod claim;
pub mod command;
mod compare;
mod experiment;
mod interrupt;
mod lcp;
mod links;
mod modes;
mod new;
mod options;
#[doc(hidden)]
pub mod readers;
mod run;
mod status;
mod updating;
mod verify;
mod virtual_test;

use nlmodes_scene as config;
pub use status::Status;
