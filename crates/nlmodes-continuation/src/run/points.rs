//! What is kept of a step: its events in their order, and its end.

use std::ops::ControlFlow;

use super::{Run, Taken, point};
use crate::corrector::Correction;
use crate::events::{Located, Search};
use crate::predictor::Behind;
use crate::step::BasePoint;
use crate::vectors::{distance, dot};
use crate::{BranchPoint, EventKind, ParametricSystem, StopReason};

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// Keeps the events of an accepted step and its end, or the point on the bound or at the start where the branch
    /// ends; and the length of the next step.
    pub(super) fn accept(&mut self, taken: Taken, h: f64, next: f64) -> ControlFlow<StopReason, f64> {
        let Taken { end, crossing, last, changes, border, .. } = &taken;
        let changes = if last.is_none() { changes.clone() } else { None };
        let ahead = |c: &Correction| dot(&c.z, &self.base.tangent) - dot(&self.base.z, &self.base.tangent);
        let length = last.as_ref().map_or(h, |(_, last)| ahead(last));
        let crossing = crossing.clone().filter(|(located, _)| located.s <= length);
        let way = crossing.as_ref().map(|(_, choice)| self.choose(choice));
        let end = last.as_ref().map_or(end, |(_, last)| last);
        match (crossing, way) {
            (Some((mut located, choice)), Some(way)) if way != Some(choice.own) => {
                let start = &choice.arms[way.unwrap_or(choice.own)];
                // What turns does so at the branch point, where the Jacobian has no tangent to offer.
                let turned = if way.is_some() { self.folds.update(&start.tangent) } else { Vec::new() };
                located.kinds.extend(turned.into_iter().map(|(_, kind)| kind));
                let (s, point) = (located.s, located.point.clone());
                self.keep_located(&point, &[], Some(located), None, s)?;
                self.note(&choice, way)?;
                return self.leave_for(start, distance(&start.z, &choice.z));
            }
            (Some((located, choice)), way) => {
                self.keep_events(end, Some(located), changes, length)?;
                self.note(&choice, way.flatten())?;
            }
            (None, _) => self.keep_events(end, None, changes, length)?,
        }
        self.go_to(end, Vec::new())?;
        self.base.border.clone_from(border);
        last.as_ref().map_or(ControlFlow::Continue(next), |(stop, _)| ControlFlow::Break(stop.clone()))
    }

    fn keep_events(
        &mut self,
        end: &Correction,
        crossing: Option<Located>,
        changes: Option<Vec<Located>>,
        h: f64,
    ) -> ControlFlow<StopReason> {
        let turned = self.folds.update(&end.tangent);
        self.keep_located(end, &turned, crossing, changes, h)
    }

    fn keep_located(
        &mut self,
        end: &Correction,
        turned: &[(usize, EventKind)],
        crossing: Option<Located>,
        changes: Option<Vec<Located>>,
        h: f64,
    ) -> ControlFlow<StopReason> {
        if h <= 0.0 {
            return ControlFlow::Continue(());
        }
        let mut search = Search { system: self.system, corrector: &mut self.corrector, base: &self.base, end, h };
        let changes = changes.unwrap_or_else(|| search.pattern_changes());
        for located in search.all(turned, changes.into_iter().chain(crossing)) {
            self.keep(point(&located.point, located.kinds))?;
        }
        ControlFlow::Continue(())
    }

    /// Keeps a point from which the branch goes on.
    pub(super) fn go_to(&mut self, c: &Correction, events: Vec<EventKind>) -> ControlFlow<StopReason> {
        let mut base = BasePoint::from(c);
        let distance = distance(&base.z, &self.base.z);
        self.before = (distance > 0.0).then_some((self.base.regularity, distance));
        let smooth = self.before.is_some() && base.pattern == self.base.pattern;
        base.behind = smooth.then(|| Behind { z: self.base.z.clone(), tangent: self.base.tangent.clone() });
        self.base = base;
        let n = c.z.len() - 1;
        self.system.accepted(&c.z[..n], c.z[n]);
        self.keep(point(c, events))
    }

    pub(super) fn keep(&mut self, mut point: BranchPoint) -> ControlFlow<StopReason> {
        let near = 2.0 * self.settings.step.min;
        let z = point.z();
        let recent = self.branch.points.iter().rev().take_while(|q| distance(&q.z(), &z) < 20.0 * near);
        let known: Vec<EventKind> =
            recent.filter(|q| distance(&q.z(), &z) < near).flat_map(|q| q.events.clone()).collect();
        let named = !point.events.is_empty();
        point.events.retain(|e| !known.contains(e));
        if named && point.events.is_empty() {
            return ControlFlow::Continue(());
        }
        let told = match self.shown.checked_sub(1) {
            Some(rest) => {
                self.shown = rest;
                ControlFlow::Continue(())
            }
            None => self.show(&point),
        };
        self.branch.points.push(point);
        self.go_on_if(told)
    }

    /// Unless the observer or the number of points says no.
    pub(super) fn go_on_if(&self, told: ControlFlow<()>) -> ControlFlow<StopReason> {
        if told.is_break() {
            return ControlFlow::Break(StopReason::Stopped);
        }
        if self.branch.points.len() >= self.settings.max_points {
            return ControlFlow::Break(StopReason::MaxPoints);
        }
        ControlFlow::Continue(())
    }
}
