//! Steps that a log knows from an earlier run, and those that it is to know.

use std::ops::ControlFlow;
use std::rc::Rc;

use super::Run;
use crate::predictor::Behind;
use crate::record::StepRecord;
use crate::step::BasePoint;
use crate::{ParametricSystem, StopReason};

/// Residual, over that in the log, up to which a point of the log solves the equations: the rest is rounding. Below the
/// second it does in any case, beyond the third in none.
const WORSE: f64 = 1e3;
const SOLVED: f64 = 1e-9;
const UNSOLVED: f64 = 1e-3;

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// Whether points and half-branches of a step of an earlier run solve the equations, as well as they did then: a
    /// file may have been altered.
    pub(super) fn holds(&mut self, record: &StepRecord) -> bool {
        if !record.is_of(self.system.dim()) {
            return false;
        }
        let evaluations = self.corrector.evaluations;
        let points = record.points.iter().map(|point| (point.z(), point.residual));
        let arms = record.crossing.iter().flat_map(|choice| &choice.arms).map(|arm| (arm.z.clone(), arm.residual));
        let holds = points.chain(arms).all(|(z, residual)| match self.corrector.evaluate(self.system, &z) {
            Ok(now) => now <= (WORSE * residual).clamp(SOLVED, UNSOLVED),
            // The base point of a kink, where the residual may not exist.
            Err(_) => residual.is_infinite(),
        });
        self.corrector.evaluations = evaluations;
        holds
    }

    /// Takes a step of an earlier run; `h` is its length.
    pub(super) fn repeat(&mut self, record: StepRecord, h: f64) -> ControlFlow<StopReason, f64> {
        let (from, count) = (self.branch.points.len(), record.points.len());
        for point in record.points {
            let told = self.show(&point);
            self.branch.points.push(point);
            self.go_on_if(told)?;
        }
        if record.stop.as_ref().is_some_and(StopReason::is_asked_for) {
            // Nobody asks this time: the step is to be taken to its end.
            self.branch.points.truncate(from);
            self.shown = count;
            return ControlFlow::Continue(h);
        }
        if let Some(last) = self.branch.points.last() {
            // Behind a kink the Jacobian is not known; nor is it that of another step at the start.
            if from > 0 {
                self.row = record.before.map(|_| self.base.tangent.clone());
            }
            let behind = Behind { z: self.base.z.clone(), tangent: self.base.tangent.clone() };
            let smooth = record.before.is_some() && last.pattern == self.base.pattern;
            self.base = BasePoint {
                border: None,
                behind: smooth.then_some(behind),
                z: last.z(),
                tangent: last.tangent.clone(),
                orientation: record.orientation,
                regularity: record.regularity,
                pattern: last.pattern,
            };
            self.before = record.before;
        }
        self.folds.set_senses(&record.senses);
        if let Some(choice) = record.crossing {
            let way = self.choose(&choice);
            // A branch that ends here has that for its recorded end.
            let _ = self.note(&choice, way);
            self.passed = None;
        }
        self.corrector.blur = record.blur.max(self.corrector.resolution);
        if record.rounding.len() == self.corrector.rounding.len() {
            self.corrector.rounding = record.rounding;
        }
        self.corrector.evaluations = record.evaluations;
        self.branch.refused_steps = record.refused_steps;
        record.stop.map_or(ControlFlow::Continue(record.next), ControlFlow::Break)
    }

    /// Tells the system of the base point: what it holds there, such as a phase, is in the Jacobian of the steps
    /// behind, not in that of the base point itself.
    pub(super) fn accept_foot(&mut self) {
        if let Some((p, x)) = self.base.z.split_last() {
            self.system.accepted(x, *p);
        }
    }

    /// The Jacobian at the base point, as it was found when the last of the repeated steps was taken: before the system
    /// was told of it.
    pub(super) fn restore_border(&mut self) {
        let Some(row) = self.row.take() else { return };
        let evaluations = self.corrector.evaluations;
        self.base.border = self.corrector.border_at(self.system, &self.base.z, &row).map(Rc::new);
        self.corrector.evaluations = evaluations;
    }

    /// Hands the points from number `from` on, and what goes with them, to the log.
    pub(super) fn record(
        &mut self,
        from: usize,
        outcome: ControlFlow<StopReason, f64>,
    ) -> ControlFlow<StopReason, f64> {
        self.shown = 0;
        let (next, stop) = match &outcome {
            ControlFlow::Continue(next) => (*next, None),
            ControlFlow::Break(stop) => (0.0, Some(stop.clone())),
        };
        let record = StepRecord {
            points: self.branch.points[from..].to_vec(),
            orientation: self.base.orientation,
            regularity: self.base.regularity,
            blur: if self.corrector.is_blurred() { self.corrector.blur } else { 0.0 },
            rounding: self.corrector.rounding.clone(),
            before: self.before,
            senses: self.folds.senses(),
            crossing: self.passed.take(),
            next,
            evaluations: self.corrector.evaluations,
            refused_steps: self.branch.refused_steps,
            stop,
        };
        let told = self.log.record(&self.system.scales.record_for_log(record));
        outcome?;
        if told.is_break() { ControlFlow::Break(StopReason::Stopped) } else { ControlFlow::Continue(next) }
    }
}
