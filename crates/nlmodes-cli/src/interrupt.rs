//! Ctrl-C: the first one ends the computation, which writes its results; if there are none yet, and the second time,
//! the program ends at once.

use std::process;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Whether there are results to keep: unknown, none yet, or some.
static FOUND: AtomicU8 = AtomicU8::new(UNKNOWN);
const UNKNOWN: u8 = 0;
const NOTHING: u8 = 1;
const SOMETHING: u8 = 2;

/// Exit status of a computation that ended early.
const EARLY: i32 = 1;

/// Exit status of a program that Ctrl-C ends.
const ENDED: i32 = 130;

/// From here on Ctrl-C is only a request.
pub fn install() {
    let outcome = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            process::exit(ENDED);
        }
        if FOUND.load(Ordering::SeqCst) == NOTHING {
            say!("\ninterrupted before any point was found: there are no results");
            process::exit(EARLY);
        }
        say!("\ninterrupted: what was found is written; Ctrl-C again ends at once");
    });
    // Otherwise Ctrl-C ends the program as usual; the points found are on disk.
    if let Err(error) = outcome {
        say!("warning: Ctrl-C will end the program at once: {error}");
    }
}

/// A computation begins: until [`something_found`] there is nothing to lose, and Ctrl-C ends it at once.
pub fn nothing_found_yet() {
    _ = FOUND.compare_exchange(UNKNOWN, NOTHING, Ordering::SeqCst, Ordering::SeqCst);
}

/// There are results that the computation will write when it ends.
pub fn something_found() {
    FOUND.store(SOMETHING, Ordering::SeqCst);
}

/// Whether the user has requested the end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
