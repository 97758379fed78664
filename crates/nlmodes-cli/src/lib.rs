//! The command line of nlmodes: from a scene file to branch, tables and figures.
//!
//! [`command`] takes the command line apart, and each command is a module of its own. `nlmodes-scene` reads and checks
//! scenes, `nlmodes-run` and `nlmodes-study` compute and write and serve the page with sliders; what
//! there is to say of it comes from there in words. Here it is put on a terminal, with lines that move, Ctrl-C and exit
//! statuses.

/// Prints a line to standard error; one that nobody can read is no error.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}

mod arguments;
mod at;
pub mod command;
mod compare;
mod explore;
mod extract;
mod figures;
mod interrupt;
mod lcp;
mod modes;
mod new;
mod observer;
mod options;
mod progress;
mod run;
mod status;
mod study;
mod terminal;
mod told;
mod verify;

pub use status::Status;
