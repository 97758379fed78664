use std::ops::ControlFlow;

use crate::corrector::{Correction, Corrector, Hyperplane, Surface, dot};
use crate::record::RunLog;
use crate::run::Run;
use crate::{AtBranchPoint, Branch, BranchPoint, ContinuationError, ParametricSystem, StepSettings};

/// A window of one coordinate of `z` outside of which the branch ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Index in `z = (x, p)`; n is the parameter.
    pub coordinate: usize,
    /// Lower end; −∞ for none.
    pub min: f64,
    /// Upper end; +∞ for none.
    pub max: f64,
}

/// Continuation by pseudo-arclength: its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Continuation {
    /// Step lengths and acceptance.
    pub step: StepSettings,
    /// Where the branch ends.
    pub bounds: Vec<Bound>,
    /// Unknowns whose turning points are events, beside those of the parameter.
    pub watched: Vec<usize>,
    /// Which arm is followed where more than two meet. Default its own.
    pub at_branch_point: AtBranchPoint,
    /// Most points of the branch. Default 5000.
    pub max_points: usize,
}

impl Default for Continuation {
    fn default() -> Self {
        Self {
            step: StepSettings::default(),
            bounds: Vec::new(),
            watched: Vec::new(),
            at_branch_point: AtBranchPoint::Stay,
            max_points: 5000,
        }
    }
}

impl Continuation {
    /// Follows the branch through `(x, p)` in the direction of `direction` (n + 1).
    ///
    /// The start is corrected first, across `direction`. Every point is shown to `observe` when it is found.
    ///
    /// # Errors
    /// [`ContinuationError`] only where there is nothing to return; a branch that ends early comes back with its points and its
    /// [`StopReason`](crate::StopReason).
    pub fn run<S: ParametricSystem>(
        &self,
        system: &mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
        observe: impl FnMut(&BranchPoint) -> ControlFlow<()>,
    ) -> Result<Branch, ContinuationError<S::Error>> {
        self.run_with_log(system, x, p, direction, &mut (), observe)
    }

    /// As [`run`](Self::run), each step going into a log. Where that holds the steps of an earlier run from the same start, these are
    /// not computed again: their points are shown to `observe`, and the branch goes on behind them as if it had never been cut off.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_with_log<S: ParametricSystem>(
        &self,
        system: &mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
        log: &mut dyn RunLog,
        observe: impl FnMut(&BranchPoint) -> ControlFlow<()>,
    ) -> Result<Branch, ContinuationError<S::Error>> {
        let (start, corrector) = self.start(system, x, p, direction)?;
        Ok(Run::new(self, system, observe, corrector, &start, log).finish(&start))
    }

    /// Checks the input and corrects the start.
    pub(crate) fn start<S: ParametricSystem>(
        &self,
        system: &mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
    ) -> Result<(Correction, Corrector), ContinuationError<S::Error>> {
        self.check(system, x, direction)?;
        let mut corrector = Corrector::new(x.len(), self.step.tolerance, 3 * self.step.max_iterations);
        let z: Vec<f64> = x.iter().copied().chain([p]).collect();
        corrector.evaluate(system, &z).map_err(ContinuationError::System)?;
        let start = corrector
            .correct(system, &z, &Surface::Plane(Hyperplane::through(&z, direction)))
            .map_err(|f| ContinuationError::Start { residual: f.residual, iterations: f.iterations, why: f.why })?;
        corrector.max_iterations = self.step.max_iterations;
        Ok((start, corrector))
    }

    fn check<S: ParametricSystem>(
        &self,
        system: &S,
        x: &[f64],
        direction: &[f64],
    ) -> Result<(), ContinuationError<S::Error>> {
        let n = system.dim();
        let sizes = [("the starting point", n, x.len()), ("the starting direction", n + 1, direction.len())];
        for (what, expected, found) in sizes {
            if expected != found {
                return Err(ContinuationError::Dimension { what, expected, found });
            }
        }
        let length = dot(direction, direction);
        if !(length.is_finite() && length > 0.0) {
            let what = "the squared length of the starting direction";
            return Err(ContinuationError::Setting { what, value: length, expected: "a positive number" });
        }
        for bound in &self.bounds {
            if bound.coordinate > n {
                let value = bound.coordinate as f64;
                return Err(ContinuationError::Setting { what: "bounded coordinate", value, expected: "at most n" });
            }
        }
        self.step.check()
    }
}
