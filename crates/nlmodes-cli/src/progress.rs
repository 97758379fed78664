//! Progress of a run: one updated line on a terminal, plain lines elsewhere.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use nlmodes::branches::Watch;
use nlmodes::modal::ModalPoint;
use nlmodes_run::{CheckProgress, Progress};

use nlmodes_scene::scene::Scene;

use crate::options::RunOptions;
use crate::terminal::moves;

/// Time between two plain lines.
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);

/// Time after which the progress line shows the current activity instead of the last point.
const MOVING_INTERVAL: Duration = Duration::from_secs(1);

/// Parts of the progress bar.
const PARTS: u64 = 1000;

/// The progress of a branch, at the requested verbosity.
pub struct Shown {
    bar: Option<ProgressBar>,
    plain: bool,
    verbose: bool,
    progress: Progress,
    /// When something was last printed, at points or between them.
    last: Arc<Mutex<Instant>>,
    /// Current activity after the last point.
    looking: Arc<Mutex<Option<CheckProgress>>>,
}

impl Shown {
    /// Silent with `--quiet`.
    pub fn new(options: RunOptions, scene: &Scene) -> Self {
        let terminal = moves();
        Self {
            bar: (!options.quiet && terminal).then(|| bar("{spinner} [{bar:20}] {msg}", PARTS)),
            plain: !options.quiet && !terminal,
            verbose: options.verbose,
            progress: Progress::new(scene),
            last: Arc::new(Mutex::new(Instant::now())),
            looking: Arc::default(),
        }
    }

    /// Another point was found, or is repeated from an earlier run.
    pub fn point(&mut self, branch: usize, point: &ModalPoint, is_new: bool) {
        self.progress.point(point, is_new);
        if self.verbose && is_new {
            self.tell(&self.progress.in_full(branch, point));
        }
        if let Some(bar) = &self.bar {
            bar.set_position((self.progress.share().unwrap_or(0.0) * PARTS as f64) as u64);
            bar.set_message(self.progress.line());
            bar.tick();
            is_due(&self.last, Duration::ZERO);
        } else if self.plain && !self.verbose && is_due(&self.last, PLAIN_INTERVAL) {
            say!("{}", self.progress.line());
        }
    }

    /// Progress between points: prints the current search if it takes long, and ends it if `ended` returns true.
    pub fn watch(&self, ended: impl Fn() -> bool + Send + Sync + 'static) -> Watch {
        let (bar, plain, last, began) = (self.bar.clone(), self.plain, Arc::clone(&self.last), self.progress.began());
        let looking = Arc::clone(&self.looking);
        Watch::new(move |doing, evaluations| {
            if ended() {
                return ControlFlow::Break(());
            }
            let time = began.elapsed().as_secs_f64();
            // The progress line is cleared after the last point.
            if let Some(looking) = held(&looking).as_ref() {
                if (plain || bar.is_some()) && is_due(&last, PLAIN_INTERVAL) {
                    say!("{}", looking.line(time));
                }
                return ControlFlow::Continue(());
            }
            let line = || match evaluations {
                0 => format!("{doing}, {time:.0} s"),
                _ => format!("{doing}, {evaluations} evaluations, {time:.0} s"),
            };
            match &bar {
                Some(bar) if is_due(&last, MOVING_INTERVAL) => {
                    bar.set_message(line());
                    bar.tick();
                }
                None if plain && is_due(&last, PLAIN_INTERVAL) => say!("{}", line()),
                _ => {}
            }
            ControlFlow::Continue(())
        })
    }

    /// Only the first `kept` points stay.
    pub fn withdrawn(&mut self, kept: usize) {
        if self.verbose {
            self.tell(&format!("back to point {kept}, the base point of an internal-resonance branch that is skipped"));
        }
        self.progress.set_points(kept);
    }

    /// This many points exist, and the branch continues in the other direction from its start, which is found again.
    pub fn turned(&mut self, points: usize) {
        self.progress.set_points(points);
    }

    /// A check of the verification report examines a point, the given one of this many; printed from time to time.
    pub fn looking(&self, check: &'static str, point: usize, number: [usize; 2]) {
        let mut looking = held(&self.looking);
        let now = CheckProgress::new(check, point, number, looking.as_ref());
        if (self.plain || self.bar.is_some()) && is_due(&self.last, PLAIN_INTERVAL) {
            say!("{}", now.line(self.progress.began().elapsed().as_secs_f64()));
        }
        *looking = Some(now);
    }

    /// Clears the progress line.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        let repeated = self.progress.repeated();
        if repeated > 0 && (self.plain || self.bar.is_some()) {
            say!("{repeated} points were there and were taken over");
        }
    }

    fn tell(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            None => say!("{line}"),
        }
    }
}

/// A bar of this many parts.
pub fn bar(template: &str, parts: u64) -> ProgressBar {
    let style = ProgressStyle::with_template(template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(parts).with_style(style.progress_chars("=> "))
}

/// The contents, even if a thread panicked while holding the lock.
fn held<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether nothing was printed for this long; resets the time.
fn is_due(last: &Mutex<Instant>, interval: Duration) -> bool {
    let mut last = held(last);
    let due = last.elapsed() >= interval;
    if due {
        *last = Instant::now();
    }
    due
}
