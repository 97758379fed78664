//! Terminal output: messages to standard error, results to standard output.

use std::io::{self, IsTerminal, Write};

use nlmodes_run::{RunError, chain};
use nlmodes_scene::SceneError;

use crate::Status;

/// Prints one or several lines to standard output. A closed pipe, as in `| head`, is not an error.
pub fn print(text: &str) -> Status {
    match writeln!(io::stdout(), "{text}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            say!("error: cannot write to standard output: {error}");
            Status::EndedEarly
        }
        _ => Status::Done,
    }
}

/// Whether standard error is a terminal on which a line can be updated: `TERM` is not `dumb`.
pub fn moves() -> bool {
    let dumb = std::env::var_os("TERM").is_some_and(|name| name == "dumb");
    io::stderr().is_terminal() && !dumb
}

/// Whether colours are permitted too: `NO_COLOR` is unset or empty.
pub fn wants_colours() -> bool {
    moves() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Prints the errors of a scene.
pub fn refuse(error: &SceneError) -> Status {
    say!("{}", error.text(wants_colours()));
    Status::Wrong
}

/// Prints why there are no results.
pub fn refuse_run(error: &RunError) -> Status {
    match error {
        RunError::Scene(said) | RunError::Failed(said) => _ = refuse(said),
        RunError::Foreign { .. } => {
            say!("error: {error}");
            say!("  `--out DIR` writes to another directory, `--force` overwrites what is there");
        }
        RunError::Link { .. } => {
            say!("error: {error}\nremove it, or choose another directory with --out");
        }
        RunError::Unwritable { directory, source, kept } => {
            say!("error: {}", chain(source));
            if *kept {
                let place = directory.display();
                say!("what was found until then is in {place}; with `--resume` the run goes on from there");
            } else {
                say!("expected a directory for the results that can be created and written; nothing was kept");
            }
        }
        RunError::NotRecorded { directory, .. } => {
            say!("error: {error}");
            say!("what was recorded until then is in {}", directory.display());
        }
        _ => say!("error: {error}"),
    }
    if error.is_of_the_call() { Status::Wrong } else { Status::EndedEarly }
}
