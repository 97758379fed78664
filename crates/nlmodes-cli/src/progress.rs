//! What a run says while it computes: one line that moves on a terminal, plain lines elsewhere.

use std::f64::consts::TAU;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use nlmodes::branches::Watch;
use nlmodes::modal::{Event, ModalPoint};

use crate::options::RunOptions;
use nlmodes_scene::number;
use nlmodes_scene::scene::{Scene, Start};

/// Time between two plain lines.
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);

/// Time after which a moving line that shows the last point shows what is done since then.
const MOVING_INTERVAL: Duration = Duration::from_secs(1);

/// Parts of the moving bar.
const PARTS: u64 = 1000;

/// The progress of a branch.
pub struct Progress {
    bar: Option<ProgressBar>,
    plain: bool,
    verbose: bool,
    began: Instant,
    /// When something was said last, by points or between them.
    last: Arc<Mutex<Instant>>,
    /// What is looked at behind the last point.
    looking: Arc<Mutex<Option<Looking>>>,
    points: usize,
    repeated: usize,
    event: String,
    limits: Limits,
}

impl Progress {
    /// Silent if the user wants it quiet.
    pub fn new(options: RunOptions, scene: &Scene) -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|name| name == "dumb");
        let terminal = std::io::stderr().is_terminal() && !dumb;
        let bar = (!options.quiet && terminal).then(|| {
            let style = ProgressStyle::with_template("{spinner} [{bar:20}] {msg}");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(PARTS).with_style(style.progress_chars("=> "))
        });
        let now = Instant::now();
        Self {
            bar,
            plain: !options.quiet && !terminal,
            verbose: options.verbose,
            began: now,
            last: Arc::new(Mutex::new(now)),
            looking: Arc::default(),
            points: 0,
            repeated: 0,
            event: String::new(),
            limits: Limits::new(scene),
        }
    }

    /// Another point was found, or is repeated from an earlier run.
    pub fn point(&mut self, branch: usize, point: &ModalPoint, is_new: bool) {
        self.points += 1;
        if !is_new {
            self.repeated += 1;
        }
        if let Some(event) = point.events.last() {
            self.event = format!(", last event: {event}");
        }
        self.limits.begin(point);
        if self.verbose && is_new {
            self.tell(&self.in_full(branch, point));
        }
        if let Some(bar) = &self.bar {
            let share = self.limits.way(point, self.points).map_or(0.0, |(share, _)| share);
            bar.set_position((share * PARTS as f64) as u64);
            bar.set_message(self.line(point));
            bar.tick();
            is_due(&self.last, Duration::ZERO);
        } else if self.plain && !self.verbose && is_due(&self.last, PLAIN_INTERVAL) {
            say!("{}", self.line(point));
        }
    }

    /// Looks on between points: says what is sought where that takes long, and ends it when `ended` says so.
    pub fn watch(&self, ended: impl Fn() -> bool + Send + Sync + 'static) -> Watch {
        let (bar, plain, last, began) = (self.bar.clone(), self.plain, Arc::clone(&self.last), self.began);
        let looking = Arc::clone(&self.looking);
        Watch::new(move |doing, evaluations| {
            if ended() {
                return ControlFlow::Break(());
            }
            let time = began.elapsed().as_secs_f64();
            // Behind the last point the moving line is gone.
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
            self.tell(&format!("back to point {kept}, the foot of a tongue that is skipped"));
        }
        self.points = kept;
    }

    /// So many points are there, and the branch goes the other way from its start, which is found once more.
    pub fn turned(&mut self, points: usize) {
        self.points = points;
    }

    /// A check of the certificate looks at a point, its number among so many; said from time to time.
    pub fn looking(&self, check: &'static str, point: usize, [number, of]: [usize; 2]) {
        let mut looking = held(&self.looking);
        let began =
            looking.as_ref().filter(|known| known.check == check).map_or_else(Instant::now, |known| known.began);
        let now = looking.insert(Looking { check, point, number, of, began });
        if (self.plain || self.bar.is_some()) && is_due(&self.last, PLAIN_INTERVAL) {
            say!("{}", now.line(self.began.elapsed().as_secs_f64()));
        }
    }

    /// Clears the moving line.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        if self.repeated > 0 && (self.plain || self.bar.is_some()) {
            say!("{} points were there and were taken over", self.repeated);
        }
    }

    fn tell(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            None => say!("{line}"),
        }
    }

    /// As a line that is replaced by the next.
    fn line(&self, point: &ModalPoint) -> String {
        let (frequency, time) = (point.omega / TAU, self.began.elapsed().as_secs_f64());
        let way = self.limits.way(point, self.points);
        let way = way.map_or_else(String::new, |(share, to)| format!(", {:.0} % of the way to {to}", 100.0 * share));
        let (points, energy, event) = (self.points, point.kinetic_energy, &self.event);
        format!("{points} points, {frequency:.4} Hz, {energy:.4e} J{way}{event}, {time:.0} s")
    }

    fn in_full(&self, branch: usize, point: &ModalPoint) -> String {
        let branch = if branch == 0 { String::new() } else { format!("branch {branch}, ") };
        let (number, frequency) = (self.points - 1, point.omega / TAU);
        let events = if point.events.is_empty() { String::new() } else { format!(", {}", Event::names(&point.events)) };
        let (energy, residual) = (point.kinetic_energy, point.residual);
        format!("{branch}point {number}: {frequency:.6} Hz, {energy:.6e} J, residual {residual:.1e}{events}")
    }
}

/// A check of the certificate at one of its points.
struct Looking {
    check: &'static str,
    point: usize,
    /// Of so many, from 1.
    number: usize,
    of: usize,
    /// When the first of them was looked at.
    began: Instant,
}

impl Looking {
    /// What is done, since `time` seconds, and how long it may take by the points before.
    fn line(&self, time: f64) -> String {
        let Self { check, point, number, of, began } = self;
        let done = number - 1;
        let each = began.elapsed().as_secs_f64() / done.max(1) as f64;
        let left = match done {
            0 => String::new(),
            _ => format!(", this check some {:.0} s more", (each * (of - done) as f64).max(1.0)),
        };
        format!("certificate: {check}, point {point} ({number} of {of}), {time:.0} s{left}")
    }
}

/// What is inside, whatever happened to whoever held it.
fn held<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether nothing was said for this long; from now on something was.
fn is_due(last: &Mutex<Instant>, interval: Duration) -> bool {
    let mut last = held(last);
    let due = last.elapsed() >= interval;
    if due {
        *last = Instant::now();
    }
    due
}

/// Where a branch ends at the latest.
struct Limits {
    energy_ratio: Option<f64>,
    window: Option<[f64; 2]>,
    points: usize,
    start: Start,
    /// Frequency, Hz, and energy of the first point.
    first: Option<[f64; 2]>,
}

impl Limits {
    fn new(scene: &Scene) -> Self {
        let continuation = &scene.continuation;
        Self {
            energy_ratio: continuation.max_energy_ratio,
            window: continuation.frequency_hz,
            points: continuation.max_points,
            start: continuation.start,
            first: None,
        }
    }

    fn begin(&mut self, point: &ModalPoint) {
        self.first.get_or_insert([point.omega / TAU, point.kinetic_energy]);
    }

    /// Share of the way to the limit that is nearest, and that limit. A branch that turns back goes some of it again.
    fn way(&self, point: &ModalPoint, points: usize) -> Option<(f64, String)> {
        let [hz, energy] = self.first?;
        let grazing = match self.start {
            Start::Grazing => Some(energy),
            Start::Energy { ratio, .. } => Some(energy / ratio),
            Start::Frequency { .. } => None,
        };
        let of_energy = self.energy_ratio.zip(grazing).map(|(ratio, grazing)| {
            let share = (point.kinetic_energy / energy).ln() / (ratio * grazing / energy).ln();
            (share, format!("{} grazing energies", number(ratio)))
        });
        let of_frequency = self.window.into_iter().flatten().map(|end| {
            let share = (point.omega / TAU - hz) / (end - hz);
            (share, format!("{} Hz", number(end)))
        });
        let of_points = (points as f64 / self.points as f64, format!("{} points", self.points));
        // The later one counts where two are equal.
        let all = std::iter::once(of_points).chain(of_frequency).chain(of_energy);
        let all = all.filter(|(share, _)| share.is_finite());
        let (share, limit) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((share.clamp(0.0, 1.0) + 0.0, limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_says_how_long_it_may_take_by_the_points_before() {
        let line = |number, seconds, time| {
            let began = Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
            Looking { check: "harmonics", point: 7, number, of: 5, began }.line(time)
        };
        assert_eq!(line(1, 3, 9.0), "certificate: harmonics, point 7 (1 of 5), 9 s");
        // Two points took 10 s, three are left.
        assert_eq!(line(3, 10, 19.0), "certificate: harmonics, point 7 (3 of 5), 19 s, this check some 15 s more");
    }
}
