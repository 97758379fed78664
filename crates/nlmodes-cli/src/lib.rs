//! The command line of nlmodes: from a scene file to branch, tables and figures.
//!
//! [`command`] parses the command line, and each command is a separate module. `nlmodes-scene` reads and checks scenes;
//! `nlmodes-run` and `nlmodes-study` compute, write, serve the page with sliders, and supply all messages as text. This
//! crate prints them on a terminal, with progress lines, Ctrl-C and exit statuses.

/// Prints a line to standard error; failure to write it is not an error.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}

#[cfg(not(all(feature = "explore", feature = "print")))]
mod absent;
mod arguments;
mod at;
pub mod command;
mod compare;
mod design;
#[cfg(feature = "explore")]
mod explore;
mod extract;
#[cfg(feature = "print")]
mod figures;
mod follow;
mod interrupt;
mod lcp;
mod modes;
mod new;
mod observer;
mod options;
mod program;
mod progress;
mod results;
mod run;
mod settle;
mod status;
mod study;
mod terminal;
mod told;
mod verify;

pub use status::Status;
