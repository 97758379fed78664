use std::ops::ControlFlow;

use crate::corrector::{Correction, Corrector, Hyperplane, Surface, distance, dot};
use crate::{arms, events};
use crate::step::{Foot, StepSettings, step};
use crate::{Branch, BranchPoint, ContinuationError, EventKind, ParametricSystem, StopReason};

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
    /// Most points of the branch. Default 5000.
    pub max_points: usize,
}

impl Default for Continuation {
    fn default() -> Self {
        Self { step: StepSettings::default(), bounds: Vec::new(), watched: Vec::new(), max_points: 5000 }
    }
}

/// The state of a run: what `run` would otherwise carry in a dozen variables.
struct Run<'a, S, F> {
    settings: &'a Continuation,
    system: &'a mut S,
    observe: F,
    corrector: Corrector,
    branch: Branch,
    foot: Foot,
    orientation: f64,
}

impl Continuation {
    /// Follows the branch through `(x, p)` in the direction of `direction` (n + 1).
    ///
    /// The start is corrected first, across `direction`. Every point is shown to `observe` when it is found.
    ///
    /// # Errors
    /// [`ContinuationError`] only where there is nothing to return; a branch that ends early comes back with its points and its
    /// [`StopReason`].
    pub fn run<S: ParametricSystem>(
        &self,
        system: &mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
        observe: impl FnMut(&BranchPoint) -> ControlFlow<()>,
    ) -> Result<Branch, ContinuationError<S::Error>> {
        self.check(system, x, direction)?;
        let mut corrector = Corrector::new(x.len(), self.step.tolerance, 3 * self.step.max_iterations);
        let z: Vec<f64> = x.iter().copied().chain([p]).collect();
        corrector.evaluate(system, &z).map_err(ContinuationError::System)?;
        let start = corrector
            .correct(system, &z, &Surface::Plane(Hyperplane::through(&z, direction)))
            .map_err(|f| ContinuationError::Start { residual: f.residual, iterations: f.iterations })?;
        corrector.max_iterations = self.step.max_iterations;
        let foot = Foot { z: start.z.clone(), tangent: start.tangent.clone(), pattern: start.pattern };
        let stop = StopReason::MaxPoints;
        let branch = Branch { points: Vec::new(), stop, evaluations: 0, refused_steps: 0 };
        let orientation = start.orientation;
        let mut run = Run { settings: self, system, observe, corrector, branch, foot, orientation };
        run.branch.stop = match run.keep(&start, Vec::new()) {
            ControlFlow::Break(stop) => stop,
            ControlFlow::Continue(()) => run.follow(),
        };
        run.branch.evaluations = run.corrector.evaluations;
        Ok(run.branch)
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

impl<S: ParametricSystem, F: FnMut(&BranchPoint) -> ControlFlow<()>> Run<'_, S, F> {
    fn follow(&mut self) -> StopReason {
        let limits = &self.settings.step;
        let mut h = limits.initial.clamp(limits.min, limits.max);
        loop {
            match step(self.system, &mut self.corrector, limits, &self.foot, h) {
                Ok(end) => {
                    if let ControlFlow::Break(stop) = self.accept(&end, h) {
                        return stop;
                    }
                    let growth = if end.iterations <= 3 { 1.4 } else { 1.0 };
                    h = (h * growth).min(limits.max);
                }
                Err(refusal) => {
                    self.branch.refused_steps += 1;
                    if h > limits.min {
                        h = (0.5 * h).max(limits.min);
                    } else {
                        match self.pass_corner() {
                            Some(ControlFlow::Break(stop)) => return stop,
                            Some(ControlFlow::Continue(())) => h = limits.arm,
                            None => return StopReason::StepTooSmall { step: h, refusal },
                        }
                    }
                }
            }
        }
    }

    /// Goes on along the arm that continues the branch through a corner or a crossing; `None` if no arm leaves.
    fn pass_corner(&mut self) -> Option<ControlFlow<StopReason>> {
        let around = arms::around(self.system, &mut self.corrector, &self.foot, self.settings.step.arm);
        let (next, n_arms) = arms::continuation_of(&self.foot, around)?;
        let turn = arms::turn(&self.foot, &next);
        let kind = if n_arms > 2 {
            Some(EventKind::BranchPoint)
        } else {
            (turn > self.settings.step.max_turn).then_some(EventKind::Kink)
        };
        if let Some(kind) = kind {
            let mut corner = self.branch.points.last()?.clone();
            corner.events = vec![kind];
            if let ControlFlow::Break(stop) = self.keep_point(corner) {
                return Some(ControlFlow::Break(stop));
            }
        }
        self.foot = Foot { z: next.z.clone(), tangent: next.tangent.clone(), pattern: next.pattern };
        self.orientation = next.orientation;
        Some(self.keep(&next, Vec::new()))
    }

    /// Keeps the events of an accepted step and its end, or the point on the bound that it crosses.
    fn accept(&mut self, end: &Correction, h: f64) -> ControlFlow<StopReason> {
        if let Some((stop, last)) = self.bound_crossed(end) {
            self.keep_events(&last, distance(&last.z, &self.foot.z), dot_step(&last, &self.foot))?;
            self.keep(&last, Vec::new())?;
            return ControlFlow::Break(stop);
        }
        self.keep_events(end, h, h)?;
        self.keep(end, Vec::new())?;
        self.foot = Foot { z: end.z.clone(), tangent: end.tangent.clone(), pattern: end.pattern };
        self.orientation = end.orientation;
        let first = &self.branch.points[0];
        if self.branch.points.len() > 10 && distance(&first.z(), &end.z) < 0.5 * h && dot(&first.tangent, &end.tangent) > 0.9
        {
            return ControlFlow::Break(StopReason::Closed);
        }
        ControlFlow::Continue(())
    }

    fn keep_events(&mut self, end: &Correction, length: f64, h: f64) -> ControlFlow<StopReason> {
        if length <= 0.0 || h <= 0.0 {
            return ControlFlow::Continue(());
        }
        let foot = (&self.foot, self.orientation);
        let located = events::locate(self.system, &mut self.corrector, &self.settings.watched, foot, end, h);
        for event in located {
            self.keep(&event.point, vec![event.kind])?;
        }
        ControlFlow::Continue(())
    }

    fn keep(&mut self, c: &Correction, events: Vec<EventKind>) -> ControlFlow<StopReason> {
        let n = c.z.len() - 1;
        let point = BranchPoint {
            x: c.z[..n].to_vec(),
            p: c.z[n],
            tangent: c.tangent.clone(),
            residual: c.residual,
            iterations: c.iterations,
            pattern: c.pattern,
            events,
        };
        self.keep_point(point)
    }

    fn keep_point(&mut self, point: BranchPoint) -> ControlFlow<StopReason> {
        self.system.accepted(&point.x, point.p);
        let told = (self.observe)(&point);
        self.branch.points.push(point);
        if told.is_break() {
            return ControlFlow::Break(StopReason::Stopped);
        }
        if self.branch.points.len() >= self.settings.max_points {
            return ControlFlow::Break(StopReason::MaxPoints);
        }
        ControlFlow::Continue(())
    }

    /// The first bound that the step to `end` crosses, and the point of the branch on it.
    fn bound_crossed(&mut self, end: &Correction) -> Option<(StopReason, Correction)> {
        let crossed = self.settings.bounds.iter().filter_map(|b| {
            let (from, to) = (self.foot.z[b.coordinate], end.z[b.coordinate]);
            let value = if to > b.max {
                b.max
            } else if to < b.min {
                b.min
            } else {
                return None;
            };
            Some((((value - from) / (to - from)).clamp(0.0, 1.0), b.coordinate, value))
        });
        let (share, coordinate, value) = crossed.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let guess: Vec<f64> = self.foot.z.iter().zip(&end.z).map(|(a, b)| a + share * (b - a)).collect();
        let plane = Surface::Plane(Hyperplane::fixing(coordinate, value, guess.len()));
        let mut last = self.corrector.correct(self.system, &guess, &plane).ok()?;
        if dot(&last.tangent, &end.tangent) < 0.0 {
            last.tangent.iter_mut().for_each(|t| *t = -*t);
            last.orientation = -last.orientation;
        }
        Some((StopReason::Bound { coordinate, value }, last))
    }
}

/// Distance from the foot to `end` along the foot's tangent.
fn dot_step(end: &Correction, foot: &Foot) -> f64 {
    dot(&end.z, &foot.tangent) - dot(&foot.z, &foot.tangent)
}
