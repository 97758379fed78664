//! The default: projected Gauss-Seidel, then Newton, then a primal active-set method.

mod newton;
mod primal;
mod sweeps;

pub(crate) use newton::Newton;
pub(crate) use primal::Primal;

use super::{
    closed_form::OneContact,
    workspace::{Method, Outcome, Workspace},
};
use crate::{LcpError, LcpMatrix, LcpSolver, LcpWorkspace, kernel, sample::Sample};

pub(crate) const NAME: &str = "active-set";

/// Finds the closed contacts, with an updated Cholesky factor of their block; exact up to rounding. The default.
///
/// 1. Without a guess, a few projected Gauss-Seidel sweeps give one.
/// 2. Semismooth Newton: solve the closed block, exchange every contact with a wrong sign, repeat. Usually 1 to 4 steps.
/// 3. That may cycle. When the number of wrong signs has not fallen for `patience` steps, the primal active-set method of
///    Keller takes over: contacts enter one by one, forces never pull, the energy falls at every exchange, so it ends. It
///    also treats redundant contacts, choosing an independent subset, and proves infeasibility.
///
/// One contact is solved in closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveSet {
    /// Projected Gauss-Seidel sweeps of a cold start, at most. Default 16.
    pub sweeps: usize,
    /// Newton steps without fewer wrong signs before the primal method takes over. Default 8.
    pub patience: usize,
    /// Exchanges of the primal method per contact, at most. Default 20.
    pub exchanges_per_contact: usize,
}

impl Default for ActiveSet {
    fn default() -> Self {
        Self { sweeps: 16, patience: 8, exchanges_per_contact: 20 }
    }
}

impl LcpSolver for ActiveSet {
    fn name(&self) -> &'static str {
        NAME
    }

    fn workspace(&self, a: &LcpMatrix) -> Result<Box<dyn LcpWorkspace>, LcpError> {
        if a.n_contacts() == 1 {
            return Ok(Box::new(Workspace::new(a, OneContact)));
        }
        let c = a.n_contacts();
        Ok(Box::new(Workspace::new(a, Search { settings: *self, newton: Newton::new(c), primal: Primal::default() })))
    }
}

struct Search {
    settings: ActiveSet,
    newton: Newton,
    primal: Primal,
}

impl Method for Search {
    const NAME: &'static str = NAME;

    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        if kernel::any(closed) {
            self.newton.guess(closed);
        } else {
            sweeps::run(sample, self.settings.sweeps);
            self.newton.guess_from_forces(sample);
        }
        let found = self.newton.run(sample, self.settings.patience);
        if let Some(outcome) = found.filter(|outcome| outcome.verdict.is_accepted()) {
            self.newton.unload_closed(closed);
            return outcome;
        }
        self.fall_back(sample, closed)
    }
}

impl Search {
    fn fall_back(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        sweeps::run(sample, 2 * self.settings.sweeps);
        let budget = self.settings.exchanges_per_contact * closed.len() + 100;
        let mut outcome = self.primal.run(sample, budget);
        if !outcome.infeasible && !outcome.verdict.is_accepted() {
            // The sweeps may hand over a block that is dependent but for rounding. From nothing, contacts come one at a time,
            // and the one that cannot be closed shows why.
            sample.lambda.fill(0.0);
            let first = outcome.iterations;
            outcome = self.primal.run(sample, budget);
            outcome.iterations += first;
        }
        self.primal.unload_closed(closed);
        Outcome { iterations: self.newton.iterations() + outcome.iterations, ..outcome }
    }
}
