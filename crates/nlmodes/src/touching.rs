//! The way to motions before contacts that touch at rest, of a mode or a phase resonance.

use std::ops::ControlFlow;

use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Bound, Continuation, ParametricSystem, RunLog, StepSettings, StopReason, Watch, Watched};
use nlmodes_hbm::{FEW_HARMONICS, HbmError, PeriodicSystem, harmonics_on_the_way};
use nlmodes_modal::EndReason;

use crate::branches::homotopy::{self, Effort};
use crate::response::{curve_end, newton};

/// How contacts are closed that touch at rest.
pub(crate) struct Closing<'a> {
    pub step: &'a StepSettings,
    /// Of the contact problems.
    pub solver: &'a dyn LcpSolver,
    pub watch: &'a Watch,
}

/// Most points on the way from contacts that are set back to contacts that touch.
const MOST: usize = 1000;

/// Why a way does not arrive.
pub(crate) enum NotClosed {
    /// It leads no further.
    Lost {
        /// Share of the opening that is left.
        left: f64,
        why: String,
    },
    /// It was asked to end.
    Ended,
    /// The problem cannot be set up.
    Problem(HbmError),
}

impl From<HbmError> for NotClosed {
    fn from(error: HbmError) -> Self {
        Self::Problem(error)
    }
}

impl Closing<'_> {
    /// Unknowns before contacts that touch at rest without force: those to which `x` lead, the motion at the parameter
    /// zero before contacts that are set back by `opening` (m, c), as these are closed.
    ///
    /// They are closed with few harmonics, whose curves little interrupts, and the motion is then corrected with more
    /// and more.
    ///
    /// # Errors
    /// [`NotClosed`], of the fewest harmonics where none arrives.
    pub fn unknowns(
        &self,
        system: &PeriodicSystem,
        x: &[f64],
        opening: &[f64],
        log: &mut dyn RunLog,
    ) -> Result<Vec<f64>, NotClosed> {
        let (all, least) = (system.series().n_harmonics, system.load().highest_harmonic().max(1));
        let few = FEW_HARMONICS.into_iter().filter(|few| (least..all).contains(few));
        let mut failure = None;
        for first in few.chain([all]) {
            match self.refined_from(system, x, opening, first, log) {
                Err(lost @ NotClosed::Lost { .. }) => _ = failure.get_or_insert(lost),
                outcome => return outcome,
            }
        }
        Err(failure.unwrap_or(NotClosed::Ended))
    }

    fn refined_from(
        &self,
        system: &PeriodicSystem,
        x: &[f64],
        opening: &[f64],
        first: usize,
        log: &mut dyn RunLog,
    ) -> Result<Vec<f64>, NotClosed> {
        let few = system.with_harmonics(first, self.solver)?;
        let (mut series, start) = (few.series(), few.resized(x, system.series()));
        let mut x = self.closed(few, &start, opening, log)?;
        for harmonics in harmonics_on_the_way(first, system.series().n_harmonics) {
            if self.watch.asks_to_end() {
                return Err(NotClosed::Ended);
            }
            let mut finer = system.with_harmonics(harmonics, self.solver)?;
            let guess = finer.resized(&x, series);
            finer.hold_phase(&guess);
            series = finer.series();
            let found = newton(&mut finer, &guess, 0.0).or_else(|| {
                let (z, dim) = ([&guess[..], &[0.0]].concat(), finer.dim());
                homotopy::solve(&mut finer, &z, dim, self.step, Effort::FULL, log).map(|(x, _)| x)
            });
            x = found.ok_or_else(|| {
                let why = format!("Newton's method fails with {harmonics} harmonics");
                NotClosed::Lost { left: 0.0, why }
            })?;
        }
        Ok(x)
    }

    /// The motion to which that before contacts that are set back leads as they are closed.
    pub fn closed(
        &self,
        mut system: PeriodicSystem,
        x: &[f64],
        opening: &[f64],
        log: &mut dyn RunLog,
    ) -> Result<Vec<f64>, NotClosed> {
        system.hold_phase(x);
        let mut closing = system.beside_opening(opening)?;
        let dim = closing.dim();
        let bounds = vec![Bound { coordinate: dim, min: 0.0, max: 1.5 }];
        let method = Continuation { step: self.step.clone(), bounds, max_points: MOST, ..Continuation::default() };
        let mut direction = vec![0.0; dim + 1];
        direction[dim] = -1.0;
        let mut closing = Watched { system: &mut closing, watch: self.watch };
        let branch = method.run_with_log(&mut closing, x, 1.0, &direction, log, |_| ControlFlow::Continue(()));
        if self.watch.has_ended() {
            return Err(NotClosed::Ended);
        }
        let branch = branch.map_err(|error| NotClosed::Lost { left: 1.0, why: error.to_string() })?;
        match (branch.stop, branch.points.into_iter().next_back()) {
            (StopReason::Bound { value: 0.0, .. }, Some(last)) => Ok(last.x),
            (stop, last) => {
                let left = last.map_or(1.0, |last| last.p * last.p);
                let end = curve_end(&stop, MOST, |_, _| (EndReason::Limit, "it turned back".to_owned()));
                Err(NotClosed::Lost { left, why: end.message })
            }
        }
    }
}

/// Direction in which a motion is multiplied, of its unknowns `x` beside those at rest, as the parameter grows.
pub(crate) fn growing(system: &PeriodicSystem, x: &[f64], rest: &[f64], by_parameter: f64) -> Vec<f64> {
    let n = system.n_coefficients();
    let mut direction: Vec<f64> = x[..n].iter().zip(rest).map(|(x, rest)| by_parameter * (x - rest)).collect();
    direction.resize(x.len(), 0.0);
    direction.push(1.0);
    direction
}
