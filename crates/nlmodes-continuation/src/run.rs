//! A branch being followed: step after step, and what each outcome leads to.

mod bounds;
mod branch_points;
mod kinks;
mod points;
mod replay;
mod several;

use std::ops::ControlFlow;
use std::rc::Rc;

use crate::corrector::{Correction, Corrector};
use crate::crossing::{Choice, Registry};
use crate::events::{FoldWatch, Located};
use crate::pencil::Bordered;
use crate::record::RunLog;
use crate::scales::Scaled;
use crate::step::{BasePoint, Watched, watched_step};
use crate::step_control::StepControl;
use crate::vectors::{along, distance, dot};
use crate::{Branch, BranchPoint, Continuation, EventKind, ParametricSystem, Refusal, StopReason};

/// The state of a run: what following a branch would otherwise carry in a dozen variables.
pub(crate) struct Run<'a, 's, E> {
    settings: &'a Continuation,
    control: StepControl,
    system: &'a mut Scaled<'s, E>,
    observe: &'a mut dyn FnMut(&BranchPoint) -> ControlFlow<()>,
    corrector: Corrector,
    branch: Branch,
    base: BasePoint,
    /// Regularity of the base point before, and its distance; `None` behind a kink.
    before: Option<(f64, f64)>,
    folds: FoldWatch,
    /// What other branches have passed, and the number of this one among them.
    known: Option<(&'a mut Registry, usize)>,
    log: &'a mut dyn RunLog,
    /// The branch point that the step in progress passed.
    passed: Option<Choice>,
    /// Points of the step in progress that were shown before.
    shown: usize,
    /// The row below the Jacobian at the base point, while steps of a log are repeated.
    row: Option<Vec<f64>>,
}

/// Where a step passes a branch point, and the half-branches there.
type Crossing = (Located, Choice);

/// A step that is shown to stay on the branch.
struct Taken {
    end: Correction,
    /// Distance of the end from the tangent of the base point.
    moved: f64,
    crossing: Option<Crossing>,
    /// Where the branch ends within the step, and why.
    last: Option<(StopReason, Correction)>,
    /// Changes of the pattern, where they have been looked for.
    changes: Option<Vec<Located>>,
    /// The Jacobian at the end.
    border: Option<Rc<Bordered>>,
}

impl<'a, 's, E: std::error::Error + 'static> Run<'a, 's, E> {
    pub fn new(
        settings: &'a Continuation,
        system: &'a mut Scaled<'s, E>,
        observe: &'a mut dyn FnMut(&BranchPoint) -> ControlFlow<()>,
        corrector: Corrector,
        start: &Correction,
        log: &'a mut dyn RunLog,
    ) -> Self {
        let mut folds = FoldWatch::new(system.dim(), &settings.watched);
        folds.update(&start.tangent);
        let branch = Branch {
            points: Vec::new(),
            crossings: Vec::new(),
            stop: StopReason::MaxPoints,
            scales: system.scales.clone(),
            evaluations: 0,
            refused_steps: 0,
        };
        let base = BasePoint { border: corrector.border().map(Rc::new), ..BasePoint::from(start) };
        let (control, known, passed) = (StepControl::new(&settings.step), None, None);
        let (before, row) = (None, corrector.border_row());
        Self {
            settings,
            control,
            system,
            observe,
            corrector,
            branch,
            base,
            before,
            folds,
            known,
            log,
            passed,
            shown: 0,
            row,
        }
    }

    /// As branch `number` of several, which does not go where another has been.
    pub fn within(self, registry: &'a mut Registry, number: usize) -> Self {
        Self { known: Some((registry, number)), ..self }
    }

    /// Keeps the start and follows the branch to its end.
    pub fn finish(mut self, start: &Correction) -> Branch {
        self.branch.stop = match self.begin(start) {
            ControlFlow::Break(stop) => stop,
            ControlFlow::Continue(h) => self.follow(h),
        };
        self.branch.evaluations = self.corrector.evaluations;
        self.in_units()
    }

    /// The branch, whose points are shares of the sizes so far, in the units of the system.
    fn in_units(self) -> Branch {
        let (scales, branch) = (&self.system.scales, self.branch);
        Branch {
            points: branch.points.into_iter().map(|q| scales.point_in_units(q)).collect(),
            crossings: branch.crossings.into_iter().map(|crossing| scales.crossing_in_units(crossing)).collect(),
            stop: scales.stop_in_units(branch.stop),
            ..branch
        }
    }

    /// Shows a point to the observer.
    fn show(&mut self, point: &BranchPoint) -> ControlFlow<()> {
        (self.observe)(&self.system.scales.point_in_units(point.clone()))
    }

    /// Takes the steps that the log knows, or else keeps the start; and the length of the next step.
    fn begin(&mut self, start: &Correction) -> ControlFlow<StopReason, f64> {
        let mut h = self.control.initial();
        let mut repeated = 0;
        for record in self.log.begin(&self.system.scales.correction_for_log(start.clone())) {
            let record = self.system.scales.record_in_scales(record);
            let is_whole = !record.stop.as_ref().is_some_and(StopReason::is_asked_for);
            if repeated > 0 {
                if !is_whole {
                    // The last one, which is taken anew from here.
                    self.restore_border();
                }
                self.accept_foot();
            }
            if !self.holds(&record) {
                break;
            }
            let taken = self.repeat(record, h);
            if taken.is_break() {
                self.accept_foot();
            }
            h = taken?;
            repeated += 1;
        }
        let told = self.log.computing(repeated);
        if self.branch.points.is_empty() {
            let border = self.base.border.take();
            let outcome = self.go_to(start, Vec::new()).map_continue(|()| h);
            self.base.border = border;
            return self.record(0, outcome);
        }
        self.restore_border();
        self.accept_foot();
        if told.is_break() { ControlFlow::Break(StopReason::Stopped) } else { ControlFlow::Continue(h) }
    }

    fn follow(&mut self, mut h: f64) -> StopReason {
        loop {
            self.control.set_length(h);
            let from = self.branch.points.len();
            let refused = self.control.refused_in_a_row();
            if refused == 1 || (refused == 0 && self.corrector.is_blurred()) {
                self.look_at_rounding();
                h = h.max(self.control.limits.min);
            }
            self.corrector.max_iterations =
                self.control.limits.max_iterations * if self.control.is_precious(h) { 3 } else { 1 };
            let outcome = match self.try_step(h) {
                Ok(taken) => {
                    let next = self.control.after_taken(h, taken.moved, &self.base.z);
                    self.accept(taken, h, next)
                }
                Err(refusal) => {
                    self.branch.refused_steps += 1;
                    let beyond = if refused == 0 { self.pass_kink_at_start() } else { None };
                    match (beyond, self.shorter(h, &refusal)) {
                        (Some(outcome), _) => outcome,
                        (None, Some(shorter)) => {
                            h = shorter;
                            continue;
                        }
                        (None, None) => {
                            let (base, too_small) = (self.base.clone(), StopReason::StepTooSmall { step: h, refusal });
                            match self.pass_kink() {
                                Some(outcome) => outcome,
                                None => match self.control.begin_bend(h) {
                                    Some(shorter) => {
                                        (self.base, h) = (base, shorter);
                                        continue;
                                    }
                                    None => ControlFlow::Break(too_small),
                                },
                            }
                        }
                    }
                }
            };
            self.control.begin();
            match self.record(from, outcome) {
                ControlFlow::Break(stop) => return stop,
                ControlFlow::Continue(next) => h = next,
            }
        }
    }

    /// A shorter step than one that was refused. Where only the rounding that is assumed forbids one, that is measured
    /// first: the equations of fine meshes are small beside one.
    fn shorter(&mut self, h: f64, refusal: &Refusal) -> Option<f64> {
        let shorter = self.control.after_refused(h, refusal);
        if shorter.is_some() || !self.control.is_held_by_rounding() {
            return shorter;
        }
        self.corrector.measure_rounding(self.system, &self.base.z);
        self.look_at_rounding();
        self.control.after_refused(h, refusal)
    }

    /// How well points near the base point are known, and the shortest step that makes sense there: along directions
    /// that are nearly free, with singular values σ of the Jacobian, a residual that is zero up to rounding ε leaves a
    /// solution unknown up to ε/σ.
    fn look_at_rounding(&mut self) {
        self.corrector.look_at_rounding(self.system, &self.base.z, &self.base.tangent);
        self.control.set_blur(if self.corrector.is_blurred() { self.corrector.blur } else { 0.0 });
    }

    /// A step that stays on the branch, the branch point that it passes, if it does, and where the branch ends within
    /// it, if it does.
    fn try_step(&mut self, h: f64) -> Result<Taken, Refusal> {
        let watched = watched_step(self.system, &mut self.corrector, &self.control.limits, &self.base, h)?;
        let Watched { end, border, singular } = watched;
        let (crossing, changes) = match self.several_passed(&end, h, border.as_deref(), &singular)? {
            Some(crossing) => (Some(crossing), None),
            None => self.crossing_passed(&end, border.as_deref(), h)?,
        };
        let last = match self.bound_crossed(&end, h)? {
            None => self.closing_point(&end, h)?.map(|last| (StopReason::Closed, last)),
            bound => bound,
        };
        let moved = distance(&end.z, &along(&self.base.z, h, &self.base.tangent));
        Ok(Taken { end, moved, crossing, last, changes, border })
    }
}

/// Unit vector between two, at this share of the way.
fn between(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    let sum: Vec<f64> = from.iter().zip(to).map(|(a, b)| (1.0 - share) * a + share * b).collect();
    let length = dot(&sum, &sum).sqrt();
    sum.iter().map(|s| s / length).collect()
}

fn point(c: &Correction, events: Vec<EventKind>) -> BranchPoint {
    let n = c.z.len() - 1;
    BranchPoint {
        x: c.z[..n].to_vec(),
        p: c.z[n],
        tangent: c.tangent.clone(),
        residual: c.residual,
        iterations: c.iterations,
        pattern: c.pattern,
        events,
    }
}
