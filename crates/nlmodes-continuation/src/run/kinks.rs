//! The way on where no step ahead exists: through kinks and branch points.

use std::ops::ControlFlow;

use super::{Run, point};
use crate::corrector::Correction;
use crate::crossing::Choice;
use crate::kink;
use crate::step::BasePoint;
use crate::vectors::{along, distance, dot};
use crate::{BranchPoint, EventKind, ParametricSystem, StopReason};

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// Through the kink at which the branch begins, where the system knows a boundary there. Elsewhere it is located
    /// first.
    pub(super) fn pass_kink_at_start(&mut self) -> Option<ControlFlow<StopReason, f64>> {
        if self.branch.points.len() != 1 {
            return None;
        }
        let near = 10.0 * self.control.limits.min;
        let [before, beyond] = [-near, near].map(|s| along(&self.base.z, s, &self.base.tangent));
        let boundary = self.system.boundary(&before, &beyond)?;
        (boundary.value(&before) > 0.0 && boundary.value(&beyond) < 0.0).then_some(())?;
        self.leave_kink()
    }

    /// Goes on along the half-branch that continues the branch through a kink or a branch point; `None` if none leaves.
    pub(super) fn pass_kink(&mut self) -> Option<ControlFlow<StopReason, f64>> {
        let bounds = &self.settings.bounds;
        let within = |z: &[f64]| bounds.iter().all(|b| b.passed_by(z[b.coordinate]).is_none());
        kink::approach(self.system, &mut self.corrector, &self.control.limits, &mut self.base, within);
        self.leave_kink()
    }

    fn leave_kink(&mut self) -> Option<ControlFlow<StopReason, f64>> {
        let (points, base, limits) = (&self.branch.points, &self.base, &self.control.limits);
        let latest = || points.iter().rev().map(|q| (q.z(), q.tangent.as_slice()));
        let way_back = |radius| kink::way_back(latest(), base, radius);
        let (found, own) = kink::way_on(self.system, &mut self.corrector, limits, base, way_back)?;
        let choice = found.choice(&self.base.z, own);
        Some(self.go_through(choice))
    }

    fn go_through(&mut self, choice: Choice) -> ControlFlow<StopReason, f64> {
        let several = choice.arms.len() > 1;
        let next = choice.arms[choice.arm(self.settings.at_branch_point)].clone();
        let mut kink = self.kink_point(&next, several);
        let mut turned = self.folds.update(&next.tangent);
        let mut beyond = Vec::new();
        if !several {
            let (base, system, corrector) = (&self.base, &mut *self.system, &mut self.corrector);
            turned.retain(|(i, kind)| {
                let found = kink::turn(system, corrector, base, &next, *i);
                found.map(|found| beyond.push(point(&found, vec![*kind]))).is_none()
            });
        }
        kink.events.extend(turned.into_iter().map(|(_, kind)| kind));
        if !kink.events.is_empty() {
            self.keep(kink)?;
        }
        beyond.into_iter().try_for_each(|q| self.keep(q))?;
        let length = distance(&next.z, &self.base.z);
        if several {
            let way = self.choose(&choice);
            self.note(&choice, way)?;
        }
        // Beyond a kink the tangent is known.
        let first = if several { length } else { self.control.initial() };
        self.leave_for(&next, first)
    }

    /// Goes on at the first point beyond a kink or a branch point, unless a bound lies in between.
    pub(super) fn leave_for(&mut self, next: &Correction, length: f64) -> ControlFlow<StopReason, f64> {
        if let Some(stop) = self.bound_before(next) {
            return ControlFlow::Break(stop?);
        }
        self.go_to(next, Vec::new())?;
        (self.before, self.base.behind) = (None, None);
        ControlFlow::Continue(length)
    }

    /// The kink with its events.
    fn kink_point(&mut self, next: &Correction, several: bool) -> BranchPoint {
        let base = &self.base;
        let mut events = Vec::new();
        // Nothing is known of a branch before it begins.
        let at_start = self.branch.points.len() == 1;
        if several {
            events.push(EventKind::BranchPoint);
        } else if !at_start && dot(&base.tangent, &next.tangent).clamp(-1.0, 1.0).acos() > self.settings.step.max_turn {
            events.push(EventKind::Kink);
        }
        if base.pattern != next.pattern {
            events.push(EventKind::PatternChange { from: base.pattern, to: next.pattern });
        }
        let residual = self.corrector.evaluate(self.system, &base.z).unwrap_or(f64::INFINITY);
        let BasePoint { z, tangent, orientation, pattern, regularity, .. } = base.clone();
        point(&Correction { z, tangent, orientation, residual, iterations: 0, pattern, regularity }, events)
    }
}
