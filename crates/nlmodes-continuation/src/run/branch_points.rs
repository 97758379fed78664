//! Branch points that a step passes, and which of their half-branches the branch takes.

use std::ops::ControlFlow;

use super::{Crossing, Run, between};
use crate::branching;
use crate::corrector::Correction;
use crate::crossing::Choice;
use crate::events::{Located, Search};
use crate::pencil::{Bordered, GROWN, GROWN_NEAR};
use crate::singular::NEARLY_FREE;
use crate::step::reach;
use crate::vectors::{along, dot};
use crate::{BranchPoint, EventKind, Refusal, StopReason};

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// The branch point within a step, if there is one, and the changes of the pattern, where they have been looked
    /// for.
    ///
    /// `det [J; tᵀ]` keeps its sign along a curve, kinks included, unless other branches cross it. So a change of
    /// sign without a branch point is a jump to another half-branch.
    pub(super) fn crossing_passed(
        &mut self,
        end: &Correction,
        border: Option<&Bordered>,
        h: f64,
    ) -> Result<(Option<Crossing>, Option<Vec<Located>>), Refusal> {
        let mut search = Search { system: self.system, corrector: &mut self.corrector, base: &self.base, end, h };
        if end.orientation * self.base.orientation < 0.0 {
            let crossing = search.crossing().ok_or(Refusal::CrossingNotLocated)?;
            let choice = self.arms_at(&crossing, end, h).ok_or(Refusal::OtherArm)?;
            return Ok((Some((crossing, choice)), None));
        }
        let changes = search.pattern_changes();
        Ok((self.touched_corner(&changes, end, border, h), Some(changes)))
    }

    /// A change of the pattern within a step at which the kink of another curve touches this one: that leaves the
    /// sign of `det [J; tᵀ]` as it was, but the Jacobian becomes singular there.
    fn touched_corner(
        &mut self,
        changes: &[Located],
        end: &Correction,
        border: Option<&Bordered>,
        h: f64,
    ) -> Option<Crossing> {
        changes.iter().find_map(|change| {
            if !self.becomes_singular(&change.point.z, border) {
                return None;
            }
            let change = Located { kinds: vec![EventKind::BranchPoint], ..change.clone() };
            let choice = self.arms_at(&change, end, h)?;
            Some((change, choice))
        })
    }

    /// Whether the Jacobian at a point of a step is nearly singular beside those at its ends and those close by, or
    /// where the former are not known by itself.
    pub(super) fn becomes_singular(&mut self, z: &[f64], end: Option<&Bordered>) -> bool {
        let (Some(base), Some(end)) = (self.base.border.clone(), end) else {
            return self.corrector.evaluate(self.system, z).is_ok()
                && self.corrector.singular_directions().is_some_and(|free| free.ratio <= NEARLY_FREE);
        };
        let Some(at) = self.corrector.border_at(self.system, z, &self.base.tangent) else { return true };
        // A contact that closes is stiff beside one that is open: only what is singular in terms of both ends is so by
        // itself.
        [&*base, end].into_iter().all(|end| at.is_singular_beside(end, GROWN))
            && self.is_singular_beside_neighbours(&at, z)
    }

    /// Whether this Jacobian, at `z`, is nearly singular beside those on the branch at the least distance at which
    /// half-branches are looked for: where others meet it, it is so to the last digits of the place.
    fn is_singular_beside_neighbours(&mut self, at: &Bordered, z: &[f64]) -> bool {
        let s = dot(z, &self.base.tangent) - dot(&self.base.z, &self.base.tangent);
        let near = 10.0 * self.control.limits.min;
        [-near, near].into_iter().all(|d| {
            let reached = reach(self.system, &mut self.corrector, &self.base, s + d).ok();
            let beside = reached.and_then(|_| self.corrector.border());
            beside.is_none_or(|beside| at.is_singular_beside(&beside, GROWN_NEAR))
        })
    }

    /// The half-branches at a point of a step; `None` if only two meet.
    pub(super) fn arms_at(&mut self, at: &Located, end: &Correction, h: f64) -> Option<Choice> {
        // The Jacobian has no tangent to offer where half-branches meet.
        let tangent = between(&self.base.tangent, &end.tangent, at.s / h);
        let z = &at.point.z;
        let way_back = |radius: f64| along(z, -radius, &tangent);
        let found = branching::half_branches(self.system, &mut self.corrector, &self.control.limits, z, way_back)?;
        let own = found.straightest(z)?;
        (found.onward.len() > 1 || !found.isolated).then(|| found.choice(z, own))
    }

    /// The half-branch on which the branch is to leave a branch point; `None` if that has been passed before.
    pub(super) fn choose(&mut self, choice: &Choice) -> Option<usize> {
        let arm = choice.arm(self.settings.at_branch_point);
        let number = self.branch.crossings.len();
        let free = self.known.as_mut().is_none_or(|(registry, branch)| registry.enter(choice, arm, *branch, number));
        self.passed = Some(choice.clone());
        free.then_some(arm)
    }

    /// Notes the branch point, whose point has been kept; the branch ends there if it has no way to go.
    pub(super) fn note(&mut self, choice: &Choice, way: Option<usize>) -> ControlFlow<StopReason> {
        let named = |q: &BranchPoint| q.events.contains(&EventKind::BranchPoint);
        let point = self.branch.points.iter().rposition(named).unwrap_or(0);
        self.branch.crossings.push(choice.crossing(point, way));
        if way.is_some() { ControlFlow::Continue(()) } else { ControlFlow::Break(StopReason::Joined) }
    }
}
