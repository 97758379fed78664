use std::cell::RefCell;
use std::fmt;
use std::ops::ControlFlow;
use std::rc::Rc;

use nlmodes_continuation::{Correction, RunLog, StepRecord};

/// The log to which the steps of curves go, and from which those of an earlier computation are repeated; none by
/// default.
///
/// Several curves may have one log: they are to be computed in the same order when they are repeated. Equal to its
/// clones, and to any other that keeps nothing.
#[derive(Clone, Default)]
pub struct StepLog(Option<Rc<RefCell<dyn RunLog>>>);

impl StepLog {
    /// Steps go to `log`.
    pub fn new(log: Rc<RefCell<dyn RunLog>>) -> Self {
        Self(Some(log))
    }
}

impl RunLog for StepLog {
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord> {
        self.0.as_ref().map_or_else(Vec::new, |log| log.borrow_mut().begin(start))
    }

    fn computing(&mut self, repeated: usize) -> ControlFlow<()> {
        self.0.as_ref().map_or(ControlFlow::Continue(()), |log| log.borrow_mut().computing(repeated))
    }

    fn record(&mut self, step: &StepRecord) -> ControlFlow<()> {
        self.0.as_ref().map_or(ControlFlow::Continue(()), |log| log.borrow_mut().record(step))
    }
}

impl fmt::Debug for StepLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "StepLog({})", if self.0.is_some() { "kept" } else { "none" })
    }
}

impl PartialEq for StepLog {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (None, None) => true,
            (Some(a), Some(b)) => Rc::ptr_eq(a, b),
            _ => false,
        }
    }
}
