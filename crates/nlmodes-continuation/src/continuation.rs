use std::ops::ControlFlow;

use crate::corrector::{Correction, Corrector, Hyperplane, Surface};
use crate::record::RunLog;
use crate::run::Run;
use crate::scales::{Scaled, sizes_at_rest};
use crate::vectors::dot;
use crate::{AtBranchPoint, Branch, BranchPoint, ContinuationError, ParametricSystem, Scaling, StepSettings};

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

/// Share of a coordinate by which a start on a bound may lie beyond it.
const ON_BOUND: f64 = 1e-12;

/// Largest unknown, over sizes that were found, beyond which steps grow in proportion.
const FAR: f64 = 4.0;

/// A start that has been corrected, in shares of the sizes.
pub(crate) struct Start<'s, E> {
    pub settings: Continuation,
    pub system: Scaled<'s, E>,
    pub correction: Correction,
    pub corrector: Corrector,
}

fn check_scales<E: std::error::Error + 'static>(scales: &Scaling, n: usize) -> Result<(), ContinuationError<E>> {
    let sizes = [("sizes of the unknowns", n + 1, &scales.unknowns), ("sizes of the equations", n, &scales.equations)];
    for (what, expected, sizes) in sizes {
        if sizes.len() != expected {
            return Err(ContinuationError::Dimension { what, expected, found: sizes.len() });
        }
        if let Some(&value) = sizes.iter().find(|size| !(size.is_finite() && **size > 0.0)) {
            return Err(ContinuationError::Setting { what, value, expected: "a positive number" });
        }
    }
    Ok(())
}

impl Bound {
    /// The end of the window beyond which the coordinate has this value.
    pub(crate) fn passed_by(&self, value: f64) -> Option<f64> {
        if value > self.max {
            Some(self.max)
        } else if value < self.min {
            Some(self.min)
        } else {
            None
        }
    }
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
    /// Which half-branch is followed where more than two meet. Default its own.
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
    /// [`ContinuationError`] only where there is nothing to return; a branch that ends early comes back with its points
    /// and its [`StopReason`](crate::StopReason).
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

    /// As [`run`](Self::run), each step going into a log. Where that holds the steps of an earlier run from the same
    /// start, these are not computed again: their points are shown to `observe`, and the branch goes on behind them as
    /// if it had never been cut off.
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
        mut observe: impl FnMut(&BranchPoint) -> ControlFlow<()>,
    ) -> Result<Branch, ContinuationError<S::Error>> {
        let Start { settings, mut system, correction, corrector } = self.start(system, x, p, direction)?;
        Ok(Run::new(&settings, &mut system, &mut observe, corrector, &correction, log).finish(&correction))
    }

    /// The point of a branch next to a guess `z = (x, p)`, corrected across `direction`, from which it is not followed.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn first_point<S: ParametricSystem>(
        &self,
        system: &mut S,
        z: &[f64],
        direction: &[f64],
        log: &mut dyn RunLog,
    ) -> Result<Option<BranchPoint>, ContinuationError<S::Error>> {
        let alone = Self { max_points: 1, ..self.clone() };
        let Some((p, x)) = z.split_last() else { return Ok(None) };
        let branch = alone.run_with_log(system, x, *p, direction, log, |_| ControlFlow::Continue(()))?;
        Ok(branch.points.into_iter().next())
    }

    /// Checks the input, sizes unknowns and equations, and corrects the start.
    pub(crate) fn start<'s, S: ParametricSystem>(
        &self,
        system: &'s mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
    ) -> Result<Start<'s, S::Error>, ContinuationError<S::Error>> {
        self.check(system, x, p, direction)?;
        let mut corrector =
            Corrector::with_solver(system.solver(), x.len(), self.step.tolerance, 3 * self.step.max_iterations);
        let mut z: Vec<f64> = x.iter().copied().chain([p]).collect();
        corrector.evaluate(system, &z).map_err(ContinuationError::System)?;
        let given = system.scaling();
        let of_parameter = self.bounds.iter().filter(|bound| bound.coordinate == x.len());
        let most = of_parameter.map(|bound| bound.min.abs().max(bound.max.abs())).fold(f64::INFINITY, f64::min);
        let (scales, goes_far) = match given {
            Some(given) => (given, false),
            None => {
                let at = corrector.linearization().clone();
                let rests = z.iter().all(|z| *z == 0.0);
                let at_rest = if rests { sizes_at_rest(system, &mut corrector, direction) } else { None };
                Scaling::found(&at, system.solver(), (x, p), direction, most, at_rest)
            }
        };
        check_scales(&scales, x.len())?;
        let scales = scales.rounded();
        let settings = self.in_scales(&scales, goes_far);
        let mut direction = direction.to_vec();
        scales.to_scaled(&mut z);
        scales.to_scaled(&mut direction);
        let mut system = Scaled::new(system, scales);
        let correction = corrector
            .correct(&mut system, &z, &Surface::Plane(Hyperplane::through(&z, &direction)))
            .map_err(ContinuationError::Start)?;
        corrector.max_iterations = self.step.max_iterations;
        Ok(Start { settings, system, correction, corrector })
    }

    /// These settings for unknowns that are shares of their sizes; a branch that may go far beyond these does so by
    /// steps that grow.
    fn in_scales(&self, scales: &Scaling, goes_far: bool) -> Self {
        let mut settings = self.clone();
        for bound in &mut settings.bounds {
            let size = scales.unknowns[bound.coordinate];
            (bound.min, bound.max) = (bound.min / size, bound.max / size);
        }
        if goes_far {
            settings.step.far = settings.step.far.min(FAR);
        }
        settings
    }

    fn check<S: ParametricSystem>(
        &self,
        system: &S,
        x: &[f64],
        p: f64,
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
        let setting = |what, value, expected| Err(ContinuationError::Setting { what, value, expected });
        if let Some(&watched) = self.watched.iter().find(|&&watched| watched >= n) {
            return setting("watched unknown", watched as f64, "less than n");
        }
        for Bound { coordinate, min, max } in &self.bounds {
            if *coordinate > n {
                return setting("bounded coordinate", *coordinate as f64, "at most n");
            }
            if min.is_nan() || max.is_nan() {
                return setting("bound", f64::NAN, "a number");
            }
            if min > max {
                return setting("lower bound", *min, "at most the upper one");
            }
            let value = x.get(*coordinate).copied().unwrap_or(p);
            // A start that lies on the bound may be rounded.
            let rounding = ON_BOUND * value.abs();
            if value < min - rounding || value > max + rounding {
                let (coordinate, min, max) = (*coordinate, *min, *max);
                return Err(ContinuationError::OutsideBound { coordinate, value, min, max });
            }
        }
        self.step.check()
    }
}
