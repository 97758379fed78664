//! Ctrl-C: the first one ends the computation behind the step in progress, the second one ends it at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Exit status of a program that Ctrl-C ends.
const ENDED: i32 = 130;

/// From here on Ctrl-C is a request.
pub fn install() {
    let outcome = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            process::exit(ENDED);
        }
        say!("\ninterrupted: ends behind the step in progress and writes what was found; Ctrl-C again ends at once");
    });
    // Without it Ctrl-C ends the program as it ends any other; the points found are on disk.
    if let Err(error) = outcome {
        say!("warning: Ctrl-C will end the program at once: {error}");
    }
}

/// Whether the user wants it to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
