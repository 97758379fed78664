//! One run with the same number of harmonics.

use std::ops::ControlFlow;

use nlmodes_continuation::{EventKind, ParametricSystem, StopReason};
use nlmodes_modal::Event;

use super::carry::{Place, same_way};
use super::control::{Control, Decision};
use super::stretch::{Base, Change, Stretch};
use crate::branches::BranchError;
use crate::branches::found::{Found, Shown};
use crate::branches::start::Seed;
use crate::branches::trace::Tracer;
use crate::branches::viewer::Viewer;

impl Tracer<'_> {
    /// One run with the same number of harmonics, and how it is to go on.
    pub(super) fn run(
        &mut self,
        control: &mut Control,
        from: &Seed,
        stretch: &mut Stretch,
        found: &mut Found,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(StopReason, Option<Change>), BranchError> {
        let method = self.within(stretch.frequency);
        stretch.waiting.clear();
        found.begin();
        let (mut change, mut is_first) = (None, true);
        let (Some(estimator), Some(problem)) = (self.estimator.as_mut(), self.problem.harmonics()) else {
            return Ok((StopReason::Stopped, None));
        };
        let (viewer, too_few_modes) = (&mut self.viewer, &mut self.too_few_modes);
        let series = problem.series();
        let place = Place { series, contacts: self.structure.n_contact_dofs(), energy: self.grazing.energy };
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let watch = &self.settings.watch;
        problem.accepted(&from.x, from.p);
        let branch = method.run_with_log(problem, &from.x, from.p, &from.direction, log, |point| {
            if watch.has_ended() {
                return ControlFlow::Break(());
            }
            let singular = point.events.iter().any(|e| matches!(e, EventKind::BranchPoint | EventKind::Kink));
            let error = (!singular).then(|| estimator.estimate(&point.x, point.p, &point.tangent));
            let mut names = Vec::new();
            if std::mem::take(&mut is_first) {
                names.clone_from(&stretch.first);
                let proven = stretch.base.as_ref().is_none_or(|base| base.is_accurate)
                    && same_way(&point.tangent, &from.direction);
                if names.contains(&Event::Harmonics) && !proven {
                    names.push(Event::HarmonicsUnproven);
                }
            }
            let Some(error) = error.filter(|_| point.events.is_empty()) else {
                stretch.waiting.push((point.clone(), error, names));
                return ControlFlow::Continue(());
            };
            if let Some(base) = stretch.change_that_runs_back(point, &error, found, &place) {
                change = Some(Change::Undo(base));
                return ControlFlow::Break(());
            }
            let begins = stretch.waiting.is_empty() && found.is_at_start();
            let here =
                |is_accurate, is_shown, shown| Base { point: point.clone(), series, is_accurate, is_shown, shown };
            let is_accurate = match control.decide(&error) {
                Decision::Modes => {
                    *too_few_modes = true;
                    return ControlFlow::Break(());
                }
                Decision::More(harmonics) => {
                    let base = stretch.base.clone().unwrap_or_else(|| here(false, stretch.known, found.points.len()));
                    change = Some(Change::From(base, harmonics));
                    return ControlFlow::Break(());
                }
                Decision::Limit { tried_here } => {
                    if !std::mem::replace(&mut stretch.at_limit, true) {
                        names.push(Event::AccuracyLimit);
                    }
                    if tried_here {
                        names.push(Event::HarmonicsNoHelp);
                    }
                    false
                }
                Decision::Keep => {
                    stretch.at_limit = false;
                    true
                }
            };
            stretch.waiting.push((point.clone(), Some(error), names));
            if begins {
                // It is shown when it is sure that the branch goes on with this number of harmonics.
                stretch.counts(here(is_accurate, stretch.known, found.points.len()));
                found.leave_start(point);
                return ControlFlow::Continue(());
            }
            show(stretch, found, viewer, each)?;
            stretch.counts(here(is_accurate, true, found.points.len()));
            ControlFlow::Continue(())
        })?;
        found.count(&branch);
        // With more harmonics there is no way on, with those before there may be.
        let back = match branch.stop {
            StopReason::StepTooSmall { .. } if change.is_none() => stretch.change_without_points(found),
            StopReason::Closed if change.is_none() => stretch.changes.pop(),
            _ => None,
        };
        let change = change.or(back.map(Change::Undo));
        if change.is_none() && !self.too_few_modes {
            let _ = show(stretch, found, viewer, each);
        }
        Ok((branch.stop, change))
    }
}

/// Shows the points that wait.
fn show(
    stretch: &mut Stretch,
    found: &mut Found,
    viewer: &mut Viewer,
    each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
) -> ControlFlow<()> {
    for (point, error, names) in stretch.waiting.drain(..) {
        if std::mem::take(&mut stretch.known) {
            continue;
        }
        found.keep_named(viewer, &point, names, error).iter().map(Shown::Point).try_for_each(&mut *each)?;
    }
    ControlFlow::Continue(())
}
