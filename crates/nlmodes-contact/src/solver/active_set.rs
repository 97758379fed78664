//! The default: projected Gauss-Seidel or gradient steps, then Newton, then a primal active-set method.

mod descent;
mod newton;
mod primal;
mod sweeps;

use descent::Descent;
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
/// 1. Without a guess, a few projected Gauss-Seidel sweeps give one; for many contacts, accelerated projected gradient
///    steps.
/// 2. Semismooth Newton: solve the closed block, exchange every contact with a wrong sign, repeat. Usually 1 to 4
///    steps.
/// 3. That may cycle. When the number of wrong signs has not fallen for `patience` steps, the primal active-set method
///    of Keller takes over: contacts enter one by one, forces are never tensile, and the energy decreases at every
///    exchange, so it terminates. It also treats redundant contacts, choosing an independent subset, and proves
///    infeasibility.
///
/// One contact is solved in closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveSet {
    /// Maximum number of sweeps or gradient steps without a guess. Default 16.
    pub sweeps: usize,
    /// Newton steps without fewer wrong signs before the primal method takes over. Default 8.
    pub patience: usize,
    /// Maximum number of exchanges of the primal method per contact. Default 20.
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
        Ok(Box::new(Workspace::new(a, Search::new(*self, c))))
    }
}

/// Number of contacts above which simultaneous steps give a better guess in the same time than one contact after the
/// other.
const ALL_AT_ONCE: usize = 16;

struct Search {
    settings: ActiveSet,
    descent: Descent,
    newton: Newton,
    primal: Primal,
}

impl Method for Search {
    const NAME: &'static str = NAME;

    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        if kernel::any(closed) {
            self.newton.guess(closed);
        } else {
            self.approach(sample);
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
    fn new(settings: ActiveSet, c: usize) -> Self {
        Self { settings, descent: Descent::default(), newton: Newton::new(c), primal: Primal::default() }
    }

    /// Forces for the initial guess.
    fn approach(&mut self, sample: &mut Sample) {
        if sample.b.len() < ALL_AT_ONCE || self.settings.sweeps == 0 {
            sweeps::run(sample, self.settings.sweeps);
        } else {
            self.descent.run(sample, self.settings.sweeps);
        }
    }

    fn fall_back(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        sweeps::run(sample, 2 * self.settings.sweeps);
        let budget = self.settings.exchanges_per_contact * closed.len() + 100;
        let mut outcome = self.primal.run(sample, budget);
        if !outcome.infeasible && !outcome.verdict.is_accepted() {
            // The sweeps may return a block that is dependent to rounding. Without a guess contacts are added one at a
            // time, and the one that cannot be closed shows the reason.
            sample.lambda.fill(0.0);
            let first = outcome.iterations;
            outcome = self.primal.run(sample, budget);
            outcome.iterations += first;
        }
        self.primal.unload_closed(closed);
        Outcome { iterations: self.newton.iterations() + outcome.iterations, ..outcome }
    }
}
