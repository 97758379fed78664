//! A branch along which the number of harmonics follows an error estimate.

mod carry;

use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, BranchPoint, EventKind, ParametricSystem, StopReason};
use nlmodes_hbm::{RealSeries, TruncationError};
use nlmodes_modal::Event;

use self::carry::{LIKE, Place, same_way};
use super::StudyError;
use super::accuracy::{Control, Decision};
use super::prepare::continuation;
use super::stability::length;
use super::start::Seed;
use super::trace::{First, Found, Shown, Tracer, Viewer};

/// Points that are gone back where none is found.
const BACK: [usize; 4] = [1, 3, 6, 10];

/// Share of the unknowns within which points with different numbers of harmonics are the same, if that many in a row are.
const BACK_WITHIN: f64 = 0.02;
const SURELY_BACK: usize = 3;

/// Logarithm of the energy by which a branch from grazing is back on the linear mode below it.
const BELOW: f64 = 1e-4;

/// A point that was shown with its accuracy, the layout of its unknowns, and the number of points shown by then.
type Passed = (BranchPoint, RealSeries, usize);

/// Points that wait to be shown until one without events behind them counts, and where the branch goes on if none does.
struct Stretch {
    /// The last point without events that counts, and the layout of its unknowns.
    base: Option<(BranchPoint, RealSeries)>,
    base_is_shown: bool,
    /// Whether its error is as small as was asked for: then the branch with more harmonics is near.
    base_is_accurate: bool,
    waiting: Vec<(BranchPoint, Option<TruncationError>, Vec<Event>)>,
    /// Events of the first point of the next run.
    first: Vec<Event>,
    /// Points without events that were shown with this accuracy, each with the number of points shown by then.
    passed: Vec<Passed>,
    /// Most points that were shown when some were taken back. Only a branch that has come further is taken back again, or there would be
    /// no end to it where numbers of harmonics lead back to each other.
    furthest: usize,
    /// The first point of the next run is known and is not kept.
    known: bool,
    at_limit: bool,
    /// Where more harmonics are tried until points with them are shown.
    tried_from: Option<Trial>,
    /// They have not helped, which the next point is to say.
    in_vain: bool,
    /// Changes of the number of harmonics, until they are undone.
    changes: Vec<Undo>,
    /// Points in a row since the last one that lie where the branch has been before it.
    back: usize,
    /// The branch began at grazing, with growing energy.
    from_grazing: bool,
}

/// Where the number of harmonics was changed.
struct Undo {
    base: (BranchPoint, RealSeries),
    base_is_accurate: bool,
    /// Points shown by then, and of these the accurate ones.
    kept: usize,
    passed: usize,
}

/// Where more harmonics are tried from, and what was taken back for it.
struct Trial {
    base: (BranchPoint, RealSeries),
    base_is_shown: bool,
    base_is_accurate: bool,
    first: Vec<Event>,
    known: bool,
    taken_back: Option<(Found, Vec<Passed>)>,
}

/// Why a run with one number of harmonics gives way to another.
#[derive(Clone, Copy)]
enum Change {
    /// This number takes over.
    To(usize),
    /// More than this number have been tried in vain.
    BackTo(usize),
    /// Since the last one the branch runs back to where it came from.
    Undo,
}

impl Tracer<'_> {
    /// [`Tracer::trace`] with as many harmonics as the accuracy takes.
    ///
    /// A point whose estimate is too large does not count: the branch goes back to the last one without events, whose estimate is
    /// not, so that the branch with more harmonics is near, and goes on from there with more. The energy is kept. The
    /// new tangent points to the same side as the old one by the way in which it is computed, and is compared with it.
    pub(super) fn trace_accurately(
        &mut self,
        control: &mut Control,
        seed: &Seed,
        bound: Option<Bound>,
        first: First,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), StudyError> {
        let mut found = Found::new(&First::Plain);
        if self.too_few_modes {
            return Ok((found, StopReason::Stopped));
        }
        let mut stretch = Stretch {
            base: None,
            base_is_shown: matches!(first, First::Known),
            base_is_accurate: true,
            waiting: Vec::new(),
            passed: Vec::new(),
            furthest: 0,
            first: if let First::Named(event) = first { vec![event] } else { Vec::new() },
            known: matches!(first, First::Known),
            at_limit: false,
            tried_from: None,
            in_vain: false,
            changes: Vec::new(),
            back: 0,
            from_grazing: matches!(first, First::Named(Event::Grazing)),
        };
        let mut from = seed.clone();
        self.set_harmonics(from.harmonics)?;
        control.changed(from.harmonics);
        loop {
            let outcome = self.run(control, &from, bound, &mut stretch, &mut found, each);
            if self.settings.watch.has_ended() && !found.points.is_empty() {
                return Ok((found, StopReason::Stopped));
            }
            let (stop, change) = outcome?;
            let Some(change) = change else { return Ok((found, stop)) };
            from = match change {
                Change::BackTo(harmonics) => {
                    if give_back(&mut stretch, &mut found, each).is_break() {
                        return Ok((found, StopReason::Stopped));
                    }
                    let Some(base) = stretch.base.clone() else { return Ok((found, stop)) };
                    let seed = self.back_to(control, &mut stretch, &mut found, base, harmonics)?;
                    control.stay();
                    seed
                }
                Change::Undo => {
                    let Some(undo) = stretch.changes.pop() else { return Ok((found, stop)) };
                    stretch.back = 0;
                    found.truncate(undo.kept);
                    stretch.passed.truncate(undo.passed);
                    if each(Shown::Withdrawn(found.points.len())).is_break() {
                        return Ok((found, StopReason::Stopped));
                    }
                    (stretch.base_is_shown, stretch.base_is_accurate) = (true, undo.base_is_accurate);
                    (stretch.base, stretch.tried_from, stretch.in_vain) = (Some(undo.base.clone()), None, true);
                    let (base, series) = undo.base;
                    let seed = self.unchanged(control, &mut stretch, base, series)?;
                    control.undo();
                    seed
                }
                Change::To(harmonics) => {
                    let Some(base) = stretch.base.clone() else { return Ok((found, stop)) };
                    stretch.begin_trial(&base, harmonics);
                    let before = found.points.len();
                    let undo = stretch.undo(&base, found.points.len());
                    let seed = self.go_on_with(control, &mut stretch, &mut found, base, harmonics)?;
                    if seed.harmonics != undo.base.1.n_harmonics && found.points.len() == undo.kept {
                        stretch.changes.push(undo);
                        stretch.back = 0;
                    }
                    if found.points.len() < before && each(Shown::Withdrawn(found.points.len())).is_break() {
                        return Ok((found, StopReason::Stopped));
                    }
                    seed
                }
            };
        }
    }

    /// The beginning with another number of harmonics at the base, or if there is none some points earlier, or else with the same number.
    fn go_on_with(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        found: &mut Found,
        (base, series): (BranchPoint, RealSeries),
        harmonics: usize,
    ) -> Result<Seed, StudyError> {
        if let Some(seed) = self.carried_over(found, &base, series, harmonics, true)? {
            return Ok(taken_over(control, stretch, found, seed));
        }
        if let Some(seed) = self.taken_back(stretch, found, series, harmonics)? {
            control.changed(seed.harmonics);
            control.pause();
            return Ok(seed);
        }
        if harmonics > series.n_harmonics {
            control.stay();
        } else {
            control.pause();
        }
        self.unchanged(control, stretch, base, series)
    }

    /// The beginning at the base with its own number of harmonics.
    fn unchanged(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        base: BranchPoint,
        series: RealSeries,
    ) -> Result<Seed, StudyError> {
        if stretch.base_is_shown {
            (stretch.first, stretch.known) = (Vec::new(), true);
        }
        let harmonics = series.n_harmonics;
        self.set_harmonics(harmonics)?;
        control.changed(harmonics);
        Ok(Seed { x: base.x, p: base.p, direction: base.tangent, harmonics })
    }

    /// The beginning at the base after more harmonics have been tried from there: with the best of them, or its own.
    fn back_to(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        found: &mut Found,
        (base, series): (BranchPoint, RealSeries),
        harmonics: usize,
    ) -> Result<Seed, StudyError> {
        stretch.in_vain = true;
        let better = match harmonics > series.n_harmonics {
            true => self.carried_over(found, &base, series, harmonics, true)?,
            false => None,
        };
        let Some(seed) = better else { return self.unchanged(control, stretch, base, series) };
        Ok(taken_over(control, stretch, found, seed))
    }

    /// One run with the same number of harmonics, and that with which it is to go on.
    fn run(
        &mut self,
        control: &mut Control,
        from: &Seed,
        bound: Option<Bound>,
        stretch: &mut Stretch,
        found: &mut Found,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(StopReason, Option<Change>), StudyError> {
        let mut method = continuation(&self.settings, self.grazing, self.problem.frequency_index(), self.problem.dim());
        method.bounds.extend(bound);
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

    /// The beginning with more harmonics some points earlier, where the branches are nearer; the points since then are taken back.
    fn taken_back(
        &mut self,
        stretch: &mut Stretch,
        found: &mut Found,
        series: RealSeries,
        harmonics: usize,
    ) -> Result<Option<Seed>, StudyError> {
        let shown = found.points.len();
        if harmonics <= series.n_harmonics || shown <= stretch.furthest {
            return Ok(None);
        }
        for back in BACK {
            let Some(index) = stretch.passed.len().checked_sub(back + 1) else { return Ok(None) };
            let (base, series, kept) = stretch.passed[index].clone();
            if let Some(seed) = self.carried_over(found, &base, series, harmonics, false)? {
                stretch.furthest = shown;
                let passed = stretch.passed.split_off(index + 1);
                let mut taken_back = (found.split_off(kept), passed);
                if let Some(trial) = &mut stretch.tried_from {
                    if let Some((points, mut passed)) = trial.taken_back.take() {
                        taken_back.0.append(points);
                        taken_back.1.append(&mut passed);
                    }
                    trial.taken_back = Some(taken_back);
                }
                found.changes += 1;
                (stretch.base, stretch.base_is_shown, stretch.base_is_accurate) = (Some((base, series)), true, true);
                (stretch.first, stretch.known) = (vec![Event::Harmonics], false);
                return Ok(Some(seed));
            }
        }
        Ok(None)
    }
}

impl Stretch {
    /// What it takes to undo a change of the number of harmonics at this base, when so many points are shown.
    fn undo(&self, base: &(BranchPoint, RealSeries), kept: usize) -> Undo {
        Undo { base: base.clone(), base_is_accurate: self.base_is_accurate, kept, passed: self.passed.len() }
    }

    /// Whether the branch has come back to where it was before the last change of the number of harmonics, and goes back along that.
    fn runs_back(&mut self, point: &BranchPoint, error: &TruncationError, found: &Found, place: &Place) -> bool {
        let Some(undo) = self.changes.last() else { return false };
        if self.from_grazing && point.p < -BELOW {
            return true;
        }
        let near = (LIKE * error.motion * length(&point.x)).max(BACK_WITHIN * length(&point.x));
        let back = place.passed_before(point, near, found, undo.kept);
        self.back = if back { self.back + 1 } else { 0 };
        self.back >= SURELY_BACK
    }

    /// More harmonics are tried from this base, if they are not from an earlier one.
    fn begin_trial(&mut self, base: &(BranchPoint, RealSeries), harmonics: usize) {
        if self.tried_from.is_some() || harmonics <= base.1.n_harmonics {
            return;
        }
        self.in_vain = false;
        self.tried_from = Some(Trial {
            base: base.clone(),
            base_is_shown: self.base_is_shown,
            base_is_accurate: self.base_is_accurate,
            first: self.first.clone(),
            known: self.known,
            taken_back: None,
        });
    }
}

/// The beginning at the base with another number of harmonics, which counts as a change where the base is shown.
fn taken_over(control: &mut Control, stretch: &mut Stretch, found: &mut Found, seed: Seed) -> Seed {
    if stretch.base_is_shown {
        (stretch.first, stretch.known) = (vec![Event::Harmonics], false);
        found.changes += 1;
    }
    control.changed(seed.harmonics);
    seed
}

/// Goes back to where more harmonics were tried from, with the points that were taken back for it.
fn give_back(
    stretch: &mut Stretch,
    found: &mut Found,
    each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let Some(trial) = stretch.tried_from.take() else { return ControlFlow::Continue(()) };
    stretch.base = Some(trial.base);
    (stretch.base_is_shown, stretch.base_is_accurate) = (trial.base_is_shown, trial.base_is_accurate);
    (stretch.first, stretch.known) = (trial.first, trial.known);
    let Some((points, mut passed)) = trial.taken_back else { return ControlFlow::Continue(()) };
    stretch.passed.append(&mut passed);
    let before = found.points.len();
    found.append(points);
    found.points[before..].iter().map(Shown::Point).try_for_each(each)
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
