//! One run with the same number of harmonics.

use std::ops::ControlFlow;

use nlmodes_continuation::{EventKind, ParametricSystem, StopReason};
use nlmodes_modal::Event;

use super::carry::{Place, same_way};
use super::control::{Control, Decision};
use super::stretch::{Change, Stretch};
use crate::branches::BranchError;
use crate::branches::found::{Found, Shown};
use crate::branches::start::Seed;
use crate::branches::trace::Tracer;
use crate::branches::viewer::Viewer;

impl Tracer<'_> {
    /// One run with the same number of harmonics, and that with which it is to go on.
    pub(super) fn run(
        &mut self,
        control: &mut Control,
        from: &Seed,
        frequency: Option<[f64; 2]>,
        stretch: &mut Stretch,
        found: &mut Found,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(StopReason, Option<Change>), BranchError> {
        let method = self.within(frequency);
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
                let proven = stretch.base_is_accurate && same_way(&point.tangent, &from.direction);
                if names.contains(&Event::Harmonics) && !proven {
                    names.push(Event::HarmonicsUnproven);
                }
            }
            let Some(error) = error.filter(|_| point.events.is_empty()) else {
                stretch.waiting.push((point.clone(), error, names));
                return ControlFlow::Continue(());
            };
            if stretch.runs_back(point, &error, found, &place) {
                change = Some(Change::Undo);
                return ControlFlow::Break(());
            }
            let decision = control.decide(&error);
            match decision {
                Decision::Modes => {
                    *too_few_modes = true;
                    return ControlFlow::Break(());
                }
                Decision::More(harmonics) => {
                    if stretch.base.is_none() {
                        stretch.base = Some((point.clone(), series));
                    }
                    change = Some(Change::To(harmonics));
                    return ControlFlow::Break(());
                }
                Decision::InVain(harmonics) => {
                    change = Some(Change::BackTo(harmonics));
                    return ControlFlow::Break(());
                }
                Decision::Limit => {
                    if !std::mem::replace(&mut stretch.at_limit, true) {
                        names.push(Event::AccuracyLimit);
                    }
                    if std::mem::take(&mut stretch.in_vain) {
                        names.push(Event::HarmonicsNoHelp);
                    }
                }
                Decision::Keep | Decision::Fewer(_) => stretch.at_limit = false,
            }
            let begins = stretch.waiting.is_empty() && found.is_at_start();
            stretch.waiting.push((point.clone(), Some(error), names));
            stretch.base = Some((point.clone(), series));
            stretch.base_is_accurate = !matches!(decision, Decision::Limit);
            if begins {
                // It is shown when it is sure that the branch goes on with this number of harmonics.
                stretch.base_is_shown = stretch.known;
                found.leave_start(point);
                return ControlFlow::Continue(());
            }
            stretch.base_is_shown = true;
            stretch.tried_from = None;
            control.serves();
            show(stretch, found, viewer, each)?;
            if stretch.base_is_accurate {
                stretch.passed.push((point.clone(), series, found.points.len()));
            }
            if let Decision::Fewer(harmonics) = decision {
                change = Some(Change::To(harmonics));
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })?;
        found.count(&branch);
        // With more harmonics there is no way on, with those before there may be.
        if let (StopReason::StepTooSmall { .. }, None, Some(trial)) = (&branch.stop, change, &stretch.tried_from) {
            change = Some(Change::BackTo(trial.base.1.n_harmonics));
        }
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
