//! Who looks on while something is computed, and may end it.

use std::borrow::Cow;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use thiserror::Error;

use crate::{Boundary, Correction, LinearSolver, Linearization, ParametricSystem, RunLog, Scaling, StepRecord};

/// What is done before anything else is reported.
const BEGINNING: &str = "computing linear modes";

/// Somebody who is notified of what a computation is doing before each evaluation of its equations, some thousand times
/// a second, and may end it there.
///
/// Clones watch together: one that has been ended ends all. Watches are equal if they are clones of each other, or
/// nobody looks on.
#[derive(Clone, Default)]
pub struct Watch(Option<Arc<Watching>>);

/// Who is notified of what is done, and after how many evaluations.
type Ask = dyn Fn(&str, usize) -> ControlFlow<()> + Send + Sync;

struct Watching {
    ask: Box<Ask>,
    doing: Mutex<Cow<'static, str>>,
    evaluations: AtomicUsize,
    ended: AtomicBool,
}

impl Watch {
    /// `ask` is notified of what is done, in words, and the number of evaluations since that began.
    pub fn new(ask: impl Fn(&str, usize) -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(Watching {
            ask: Box::new(ask),
            doing: Mutex::new(Cow::Borrowed(BEGINNING)),
            evaluations: AtomicUsize::new(0),
            ended: AtomicBool::new(false),
        })))
    }

    /// Ends the computation once this is so.
    pub fn until(is_over: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self::new(move |_, _| if is_over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    /// Whether the computation was asked to end.
    pub fn has_ended(&self) -> bool {
        self.0.as_ref().is_some_and(|watching| watching.ended.load(Ordering::Relaxed))
    }

    /// Asks whether to end, for whoever computes by other means than equations, or between points.
    pub fn asks_to_end(&self) -> bool {
        self.evaluates().is_err()
    }

    /// The same for whoever is notified of each point.
    pub fn lets_go_on(&self) -> ControlFlow<()> {
        if self.asks_to_end() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Something else is done from here on.
    ///
    /// # Errors
    /// [`Ended`] where it was asked to end.
    pub fn begins(&self, doing: impl Into<Cow<'static, str>>) -> Result<(), Ended> {
        let Some(watching) = &self.0 else { return Ok(()) };
        *watching.doing.lock().unwrap_or_else(PoisonError::into_inner) = doing.into();
        watching.evaluations.store(0, Ordering::Relaxed);
        watching.ask()
    }

    /// Equations are about to be evaluated.
    ///
    /// # Errors
    /// [`Ended`] where it was asked to end.
    pub fn evaluates(&self) -> Result<(), Ended> {
        let Some(watching) = &self.0 else { return Ok(()) };
        watching.evaluations.fetch_add(1, Ordering::Relaxed);
        watching.ask()
    }
}

impl Watching {
    fn ask(&self) -> Result<(), Ended> {
        let doing = self.doing.lock().unwrap_or_else(PoisonError::into_inner);
        if self.ended.load(Ordering::Relaxed) || (self.ask)(&doing, self.evaluations.load(Ordering::Relaxed)).is_break()
        {
            self.ended.store(true, Ordering::Relaxed);
            return Err(Ended);
        }
        Ok(())
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Watch(somebody)" } else { "Watch(nobody)" })
    }
}

impl PartialEq for Watch {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (None, None) => true,
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// The computation was asked to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("it was asked to end")]
pub struct Ended;

/// Equations that are not evaluated any more once the computation has ended.
#[derive(Debug)]
pub struct Watched<'a, S> {
    /// The equations.
    pub system: &'a mut S,
    /// Who may end them.
    pub watch: &'a Watch,
}

/// Why watched equations are not evaluated.
#[derive(Debug, Error)]
pub enum WatchedError<E: std::error::Error + 'static> {
    /// The computation was asked to end.
    #[error(transparent)]
    Ended(#[from] Ended),
    /// The equations themselves refuse.
    #[error(transparent)]
    System(E),
}

impl<S: ParametricSystem> ParametricSystem for Watched<'_, S> {
    type Error = WatchedError<S::Error>;

    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Self::Error> {
        self.watch.evaluates()?;
        self.system.linearize(x, p, out).map_err(WatchedError::System)
    }

    fn solver(&self) -> Box<dyn LinearSolver> {
        self.system.solver()
    }

    fn scaling(&self) -> Option<Scaling> {
        self.system.scaling()
    }

    fn pattern(&self) -> u64 {
        self.system.pattern()
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        self.system.pattern_at(z)
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        self.system.boundary(from, to)
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        self.system.accepted(x, p);
    }
}

/// A log to which nothing comes after the study has ended: what a run does whose equations fail belongs to no branch.
pub struct WatchedLog<'a> {
    /// The log.
    pub log: &'a mut dyn RunLog,
    /// Who may end the study.
    pub watch: Watch,
}

impl RunLog for WatchedLog<'_> {
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord> {
        if self.watch.has_ended() { Vec::new() } else { self.log.begin(start) }
    }

    fn computing(&mut self, repeated: usize) -> ControlFlow<()> {
        if self.watch.has_ended() { ControlFlow::Break(()) } else { self.log.computing(repeated) }
    }

    fn record(&mut self, step: &StepRecord) -> ControlFlow<()> {
        if self.watch.has_ended() { ControlFlow::Break(()) } else { self.log.record(step) }
    }
}
