//! Whoever looks on while a run computes: signals and progress of Python.

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use nlmodes::branches::{FOLLOWING, Watch};
use nlmodes_run::{Event, Observer};
use pyo3::prelude::*;

/// Time between two looks at Python, which may be busy elsewhere.
const INTERVAL: Duration = Duration::from_millis(50);

/// Asks Python from time to time whether to go on, and tells it how far a run is.
pub struct Looking {
    progress: Option<Py<PyAny>>,
    last: Mutex<Instant>,
    raised: Mutex<Option<PyErr>>,
    ended: AtomicBool,
    points: AtomicUsize,
    /// Frequency of the last point, Hz, and what happened last.
    told: Mutex<(Option<f64>, String)>,
}

fn of<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Looking {
    /// Tells `progress`, if there is one: `progress(points, frequency_hz, text)`.
    pub fn new(progress: Option<Py<PyAny>>) -> Arc<Self> {
        Arc::new(Self {
            progress,
            last: Mutex::new(Instant::now()),
            raised: Mutex::new(None),
            ended: AtomicBool::new(false),
            points: AtomicUsize::new(0),
            told: Mutex::new((None, String::new())),
        })
    }

    /// Whether Ctrl-C was pressed, or `progress` raised something.
    pub fn has_ended(&self) -> bool {
        if self.ended.load(Ordering::Relaxed) {
            return true;
        }
        {
            let mut last = of(&self.last);
            if last.elapsed() < INTERVAL {
                return false;
            }
            *last = Instant::now();
        }
        self.look()
    }

    /// Looks at once.
    pub fn look(&self) -> bool {
        let seen = Python::attach(|py| {
            py.check_signals()?;
            let Some(progress) = &self.progress else { return Ok(()) };
            let (frequency, text) = of(&self.told).clone();
            progress.call1(py, (self.points.load(Ordering::Relaxed), frequency, text)).map(drop)
        });
        match seen {
            Ok(()) => false,
            Err(error) => {
                of(&self.raised).get_or_insert(error);
                self.ended.store(true, Ordering::Relaxed);
                true
            }
        }
    }

    /// What was raised, if anything was.
    pub fn raised(&self) -> Option<PyErr> {
        of(&self.raised).take()
    }

    /// Takes note of how far it is.
    pub fn tell(&self, done: usize, text: String) {
        self.points.store(done, Ordering::Relaxed);
        of(&self.told).1 = text;
    }

    fn doing(&self, doing: &str) {
        if doing != FOLLOWING && self.progress.is_some() {
            of(&self.told).1 = doing.to_owned();
        }
    }
}

/// Takes the events of a run.
pub struct Onlooker {
    /// Shared with the watch of its branches.
    pub looking: Arc<Looking>,
    /// What the run warned of.
    pub warnings: Vec<String>,
}

impl Observer for Onlooker {
    fn event(&mut self, event: Event<'_>) {
        match event {
            Event::Warning(text) if !self.warnings.iter().any(|known| known == text) => {
                self.warnings.push(text.to_owned());
            }
            Event::Point { point, .. } => {
                self.looking.points.fetch_add(1, Ordering::Relaxed);
                let mut told = of(&self.looking.told);
                told.0 = Some(point.omega / TAU);
                told.1 = point.events.last().map_or("", |event| event.name()).to_owned();
            }
            Event::Curve { number, of, name } => {
                self::of(&self.looking.told).1 = format!("{name} ({number} of {of})");
            }
            Event::CurveDone { outcome: Ok((points, _)), .. } => {
                self.looking.points.fetch_add(points, Ordering::Relaxed);
            }
            Event::Level { number, level, .. } => {
                self.looking.points.store(number, Ordering::Relaxed);
                of(&self.looking.told).0 = Some(level.outcome.steady.omega / TAU);
            }
            _ => {}
        }
    }

    fn is_cancelled(&self) -> bool {
        self.looking.has_ended()
    }

    fn watch(&self) -> Watch {
        let looking = Arc::clone(&self.looking);
        Watch::new(move |doing, _| {
            looking.doing(doing);
            if looking.has_ended() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    }
}
