//! What a run says while it computes: one line that moves on a terminal, plain lines elsewhere.

use std::f64::consts::TAU;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use nlmodes::modal::ModalPoint;

/// Time between two plain lines.
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);

/// The progress of a branch.
pub struct Progress {
    bar: Option<ProgressBar>,
    plain: bool,
    last: Instant,
    points: usize,
    event: String,
}

impl Progress {
    /// Silent if `quiet`.
    pub fn new(quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = (!quiet && terminal).then(|| {
            let style = ProgressStyle::with_template("{spinner} {msg} [{elapsed}]");
            ProgressBar::new_spinner().with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        });
        Self { bar, plain: !quiet && !terminal, last: Instant::now(), points: 0, event: String::new() }
    }

    /// Another point was found.
    pub fn point(&mut self, point: &ModalPoint) {
        self.points += 1;
        if let Some(event) = point.events.last() {
            self.event = format!(", last event: {event}");
        }
        let line = || {
            let frequency = point.omega / TAU;
            format!("{} points, {frequency:.4} Hz, {:.4e} J{}", self.points, point.kinetic_energy, self.event)
        };
        if let Some(bar) = &self.bar {
            bar.set_message(line());
            bar.tick();
        } else if self.plain && self.last.elapsed() >= PLAIN_INTERVAL {
            say!("{}", line());
            self.last = Instant::now();
        }
    }

    /// Clears the moving line.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
