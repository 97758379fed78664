//! Who looks on while a branch is computed, and may end it.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, AtomicUsize, Ordering};

use nlmodes_continuation::{
    Boundary, Correction, LinearSolver, Linearization, ParametricSystem, RunLog, Scaling, StepRecord,
};
use thiserror::Error;

/// What a computation is doing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Doing {
    /// It computes linear modes.
    Modes,
    /// It seeks the beginning of a branch, at the linear mode.
    Start,
    /// It seeks the backbone at a frequency, Hz: a start there, or the way on behind a tongue.
    BackboneAtFrequency(f64),
    /// It seeks the backbone at an averaged kinetic energy, over that at grazing.
    BackboneAtEnergy(f64),
    /// It seeks the motion before contacts that touch at rest.
    Touching,
    /// It brings a virtual test to its next level.
    Level,
    /// It follows a branch.
    Branch,
}

impl Doing {
    const fn code(self) -> (u8, f64) {
        match self {
            Self::Modes => (0, 0.0),
            Self::Start => (1, 0.0),
            Self::BackboneAtFrequency(hz) => (2, hz),
            Self::BackboneAtEnergy(ratio) => (3, ratio),
            Self::Touching => (4, 0.0),
            Self::Level => (5, 0.0),
            Self::Branch => (6, 0.0),
        }
    }

    fn from_code(code: u8, value: f64) -> Self {
        match code {
            0 => Self::Modes,
            1 => Self::Start,
            2 => Self::BackboneAtFrequency(value),
            3 => Self::BackboneAtEnergy(value),
            4 => Self::Touching,
            5 => Self::Level,
            _ => Self::Branch,
        }
    }
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Modes => write!(f, "computing linear modes"),
            Self::Start => write!(f, "looking for the beginning of the branch"),
            Self::BackboneAtFrequency(hz) => write!(f, "looking for the backbone at {hz:.4} Hz"),
            Self::BackboneAtEnergy(ratio) => write!(f, "looking for the backbone at {ratio} grazing energies"),
            Self::Touching => write!(f, "looking for the motion before contacts that touch at rest"),
            Self::Level => write!(f, "bringing the rig to its next level"),
            Self::Branch => write!(f, "following the branch"),
        }
    }
}

/// Somebody who is told what a computation is doing before each evaluation of its equations, some thousand times a
/// second, and may end it there.
///
/// Clones watch together: one that has been ended ends all. Watches are equal if they are clones of each other, or
/// nobody looks on.
#[derive(Clone, Default)]
pub struct Watch(Option<Arc<Watching>>);

struct Watching {
    ask: Box<dyn Fn(Doing, usize) -> ControlFlow<()> + Send + Sync>,
    doing: (AtomicU8, AtomicU64),
    evaluations: AtomicUsize,
    ended: AtomicBool,
}

impl Watch {
    /// `ask` is told what is done, and the number of evaluations since that began.
    pub fn new(ask: impl Fn(Doing, usize) -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        let (code, value) = Doing::Modes.code();
        Self(Some(Arc::new(Watching {
            ask: Box::new(ask),
            doing: (AtomicU8::new(code), AtomicU64::new(value.to_bits())),
            evaluations: AtomicUsize::new(0),
            ended: AtomicBool::new(false),
        })))
    }

    /// Whether the computation was asked to end.
    pub fn has_ended(&self) -> bool {
        self.0.as_ref().is_some_and(|watching| watching.ended.load(Ordering::Relaxed))
    }

    /// Asks whether to end, for whoever computes by other means than a branch.
    pub fn asks_to_end(&self) -> bool {
        self.evaluates().is_err()
    }

    /// Something else is done from here on.
    pub(crate) fn begins(&self, doing: Doing) -> Result<(), Ended> {
        let Some(watching) = &self.0 else { return Ok(()) };
        let (code, value) = doing.code();
        watching.doing.0.store(code, Ordering::Relaxed);
        watching.doing.1.store(value.to_bits(), Ordering::Relaxed);
        watching.evaluations.store(0, Ordering::Relaxed);
        watching.ask()
    }

    /// Equations are about to be evaluated.
    pub(super) fn evaluates(&self) -> Result<(), Ended> {
        let Some(watching) = &self.0 else { return Ok(()) };
        watching.evaluations.fetch_add(1, Ordering::Relaxed);
        watching.ask()
    }
}

impl Watching {
    fn ask(&self) -> Result<(), Ended> {
        let (code, value) = (self.doing.0.load(Ordering::Relaxed), self.doing.1.load(Ordering::Relaxed));
        let doing = Doing::from_code(code, f64::from_bits(value));
        if self.ended.load(Ordering::Relaxed) || (self.ask)(doing, self.evaluations.load(Ordering::Relaxed)).is_break()
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
pub(super) struct Watched<'a, S> {
    pub system: &'a mut S,
    pub watch: &'a Watch,
}

/// Why watched equations are not evaluated.
#[derive(Debug, Error)]
pub(super) enum WatchedError<E: std::error::Error + 'static> {
    #[error(transparent)]
    Ended(#[from] Ended),
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
pub(super) struct WatchedLog<'a> {
    pub log: &'a mut dyn RunLog,
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
