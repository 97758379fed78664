//! The way on where no step ahead exists: through corners and crossings, and around tight bends.

use std::ops::ControlFlow;

use super::{Run, point};
use crate::bend::{self, Bend};
use crate::corner::{self, Passage};
use crate::corrector::Correction;
use crate::onsets;
use crate::step::Foot;
use crate::vectors::{along, distance, dot};
use crate::{BranchPoint, EventKind, Refusal, StopReason};

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// Around the tight bend at which the branch begins. Elsewhere it is located first.
    pub(super) fn around_bend_at_start(&mut self) -> Option<ControlFlow<StopReason, f64>> {
        let bend = if self.branch.points.len() == 1 { self.bend_here() } else { None }?;
        Some(self.go_around(&bend))
    }

    /// Through the corner at which the branch begins, once shorter steps are seen not to come nearer to it: where
    /// directions are nearly free all along, as beside many contacts, no expansion tells what is behind. Elsewhere it
    /// is located first.
    pub(super) fn beyond_corner_at_start(&mut self, refusal: &Refusal) -> Option<ControlFlow<StopReason, f64>> {
        if !(self.control.comes_no_nearer(refusal) && self.branch.points.len() == 1) {
            return None;
        }
        let behind = along(&self.foot.z, -10.0 * self.control.limits.min, &self.foot.tangent);
        let (limits, foot) = (&self.control.limits, &self.foot);
        let boundaries = onsets::boundaries_at(self.system, limits, foot);
        let next = corner::regular_corner(self.system, &mut self.corrector, limits, foot, &boundaries, &behind)?;
        Some(self.go_through(Passage::Corner(next)))
    }

    fn bend_here(&mut self) -> Option<Bend> {
        bend::around_bend(self.system, &mut self.corrector, &self.control.limits, &self.foot)
    }

    /// Goes on along the arm that continues the branch through a corner or a crossing; `None` if no arm leaves.
    pub(super) fn pass_corner(&mut self) -> Option<ControlFlow<StopReason, f64>> {
        let bounds = &self.settings.bounds;
        let within = |z: &[f64]| bounds.iter().all(|b| b.passed_by(z[b.coordinate]).is_none());
        let from = self.foot.clone();
        if !corner::approach(self.system, &mut self.corrector, &self.control.limits, &mut self.foot, within)
            && let Some(next) = self.step_below_the_shortest(from)
        {
            return Some(next);
        }
        if let Some(bend) = self.bend_here() {
            return Some(self.go_around(&bend));
        }
        let (points, foot) = (&self.branch.points, &self.foot);
        let latest = || points.iter().rev().map(|q| (q.z(), q.tangent.as_slice()));
        let way_back = |radius| corner::way_back(latest(), foot, radius);
        let passage = corner::pass(self.system, &mut self.corrector, &self.control.limits, 0, foot, way_back)?;
        Some(self.go_through(passage))
    }

    /// Goes on behind a bend, within which coordinates may turn.
    pub(super) fn go_around(&mut self, bend: &Bend) -> ControlFlow<StopReason, f64> {
        let corner = self.corner_point(&bend.end, false);
        if !corner.events.is_empty() {
            self.keep(corner.clone())?;
        }
        for (i, kind) in self.folds.update(&bend.end.tangent) {
            let turned = bend.turn(self.system, &mut self.corrector, &self.foot, i);
            let turned = turned.map_or_else(|| corner.clone(), |turned| point(&turned, Vec::new()));
            self.keep(BranchPoint { events: vec![kind], ..turned })?;
        }
        self.leave_for(&bend.end, distance(&bend.end.z, &self.foot.z))
    }

    /// One step of those that lead away from a point at which a longer one was refused, though there is no corner; what
    /// happens within is looked for as in any other.
    fn step_below_the_shortest(&mut self, from: Foot) -> Option<ControlFlow<StopReason, f64>> {
        let ahead = std::mem::replace(&mut self.foot, from);
        let h = corner::APPROACHING * self.control.limits.min;
        match self.try_step(h) {
            Ok(taken) => {
                let next = self.control.after_taken(h, taken.moved, &self.foot.z);
                Some(self.accept(taken, h, next))
            }
            Err(_) => {
                self.foot = ahead;
                None
            }
        }
    }

    fn go_through(&mut self, passage: Passage) -> ControlFlow<StopReason, f64> {
        let (next, choice) = match passage {
            Passage::Corner(next) => (next, None),
            Passage::Crossing(choice) => (choice.arms[choice.arm(self.settings.at_branch_point)].clone(), Some(choice)),
        };
        let mut corner = self.corner_point(&next, choice.is_some());
        corner.events.extend(self.folds.update(&next.tangent).into_iter().map(|(_, kind)| kind));
        if !corner.events.is_empty() {
            self.keep(corner)?;
        }
        if let Some(choice) = choice {
            let way = self.choose(&choice);
            self.note(&choice, way)?;
        }
        let length = distance(&next.z, &self.foot.z);
        self.leave_for(&next, length)
    }

    /// Goes on at the first point beyond a corner or a crossing, unless a bound lies in between.
    pub(super) fn leave_for(&mut self, next: &Correction, length: f64) -> ControlFlow<StopReason, f64> {
        if let Some(stop) = self.bound_before(next) {
            return ControlFlow::Break(stop?);
        }
        self.go_to(next, Vec::new())?;
        (self.before, self.foot.behind) = (None, None);
        ControlFlow::Continue(length)
    }

    /// The corner with its events.
    fn corner_point(&mut self, next: &Correction, crossing: bool) -> BranchPoint {
        let foot = &self.foot;
        let mut events = Vec::new();
        // Nothing is known of a branch before it begins.
        let at_start = self.branch.points.len() == 1;
        if crossing {
            events.push(EventKind::BranchPoint);
        } else if !at_start && dot(&foot.tangent, &next.tangent).clamp(-1.0, 1.0).acos() > self.settings.step.max_turn {
            events.push(EventKind::Kink);
        }
        if foot.pattern != next.pattern {
            events.push(EventKind::PatternChange { from: foot.pattern, to: next.pattern });
        }
        let residual = self.corrector.evaluate(self.system, &foot.z).unwrap_or(f64::INFINITY);
        let Foot { z, tangent, orientation, pattern, regularity, .. } = foot.clone();
        point(&Correction { z, tangent, orientation, residual, iterations: 0, pattern, regularity }, events)
    }
}
