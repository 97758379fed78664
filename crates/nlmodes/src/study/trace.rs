//! One run of the continuation, seen as modal points.

use std::ops::ControlFlow;

use nlmodes_continuation::{
    Bound, Branch, BranchPoint, BranchTree, Continuation, ParametricSystem, RunLog, StopReason,
};
use nlmodes_hbm::{CondensedStructure, Grazing, TruncationError, TruncationEstimator};
use nlmodes_modal::{Event, ModalPoint};

use super::accuracy::Control;
use super::events::event_of;
use super::left::Departure;
use super::periodic::Periodic;
use super::prepare::{continuation, estimator, periodic};
use super::resonances::Resonances;
use super::stability::{Probe, length};
use super::start::Seed;
use super::{BranchMethod, BranchSettings, StudyError, Watch};

/// Length of the step, in scaled unknowns, within which a change of stability is located, and halvings that it may take.
const CHANGE_LOCATED: f64 = 1e-7;
const MOST_HALVINGS: usize = 40;

/// A structure and its settings, and what turns solutions into modal points.
pub(super) struct Tracer<'s> {
    pub structure: &'s CondensedStructure,
    pub grazing: &'s Grazing,
    /// With the present number of harmonics.
    pub settings: BranchSettings,
    pub problem: Periodic<'s>,
    pub log: &'s mut dyn RunLog,
    /// Evaluates points while the problem is at work elsewhere.
    pub(super) viewer: Viewer<'s>,
    /// Where an accuracy is asked for.
    pub(super) estimator: Option<TruncationEstimator<'s>>,
    control: Option<Control>,
    /// The branch was given up since the held modes do not reach the accuracy.
    pub too_few_modes: bool,
    /// Iterations of the contact solver in the problems before the present one.
    earlier_iterations: usize,
}

/// What turns a solution into a modal point.
pub(super) struct Viewer<'s> {
    problem: Periodic<'s>,
    harmonics: usize,
    resonances: Resonances<'s>,
    probe: Probe,
}

impl Viewer<'_> {
    /// The modal point of a solution; `None` if it cannot be evaluated again.
    fn see(&mut self, x: &[f64], residual: f64) -> Option<ModalPoint> {
        let mut modal = self.problem.modal_point(x, residual).ok()?;
        let problem = &mut self.problem;
        modal.resonance =
            self.resonances.of(&modal, |onto| problem.modal_coordinates(x, &modal.coefficients, onto).ok());
        modal.stability = self.probe.of(&mut self.problem, x, &modal);
        // An exact motion has more harmonics than were asked for, by which its resonances are known.
        if modal.coefficients.n_harmonics() > self.harmonics {
            modal.coefficients = modal.coefficients.truncated(self.harmonics);
        }
        Some(modal)
    }

    /// The first solution between `from` and `to` whose stability is that of `to`, by bisection along the branch.
    fn change(&mut self, from: &[f64], to: &[f64], stable: bool) -> Option<(Vec<f64>, ModalPoint)> {
        let (mut low, mut high, mut found) = (from.to_vec(), to.to_vec(), None);
        let method = Continuation { max_points: 1, ..Continuation::default() };
        for _ in 0..MOST_HALVINGS {
            let along: Vec<f64> = high.iter().zip(&low).map(|(a, b)| a - b).collect();
            if length(&along) < CHANGE_LOCATED {
                break;
            }
            let middle: Vec<f64> = high.iter().zip(&low).map(|(a, b)| 0.5 * (a + b)).collect();
            let (p, x) = middle.split_last()?;
            self.problem.accepted(x, *p);
            let corrected = method.run(&mut self.problem, x, *p, &along, |_| ControlFlow::Continue(())).ok()?;
            let corrected = corrected.points.into_iter().next()?;
            let modal = self.see(&corrected.x, corrected.residual)?;
            match modal.stability?.stable == stable {
                true => {
                    high = corrected.z();
                    found = Some((corrected.x, modal));
                }
                false => low = corrected.z(),
            }
        }
        found
    }
}

/// What a run shows.
pub(super) enum Shown<'p> {
    /// A point that was found.
    Point(&'p ModalPoint),
    /// All but the first so many points of this run are found anew.
    Withdrawn(usize),
}

/// The beginning of a run.
pub(super) enum First {
    /// Its first point has this event.
    Named(Event),
    /// Its first point is known already and is not found again.
    Known,
    /// Nothing happens there.
    Plain,
}

impl<'s> Tracer<'s> {
    pub fn new(
        structure: &'s CondensedStructure,
        grazing: &'s Grazing,
        settings: &BranchSettings,
        fewest: usize,
        log: &'s mut dyn RunLog,
    ) -> Result<Self, StudyError> {
        let problem = periodic(structure, settings, grazing)?;
        let viewer = Viewer {
            problem: periodic(structure, settings, grazing)?,
            harmonics: settings.harmonics,
            resonances: Resonances::new(structure),
            probe: Probe::new(structure.model(), settings, grazing),
        };
        let accuracy = settings.accuracy.filter(|_| settings.method == BranchMethod::HarmonicBalance);
        let more_modes =
            settings.held_modes.is_none() && structure.n_held_modes() < structure.model().linear_dofs().len();
        Ok(Self {
            structure,
            grazing,
            settings: settings.clone(),
            problem,
            log,
            viewer,
            estimator: accuracy.map(|_| estimator(structure, settings, grazing)).transpose()?,
            control: accuracy.map(|accuracy| Control::new(accuracy, fewest, more_modes)),
            too_few_modes: false,
            earlier_iterations: 0,
        })
    }

    /// Goes on with another number of harmonics.
    pub(super) fn set_harmonics(&mut self, harmonics: usize) -> Result<(), StudyError> {
        if harmonics == self.settings.harmonics {
            return Ok(());
        }
        self.earlier_iterations += self.problem.contact_iterations();
        self.settings.harmonics = harmonics;
        self.problem = periodic(self.structure, &self.settings, self.grazing)?;
        self.viewer.problem = periodic(self.structure, &self.settings, self.grazing)?;
        self.viewer.harmonics = harmonics;
        if self.estimator.is_some() {
            self.estimator = Some(estimator(self.structure, &self.settings, self.grazing)?);
        }
        Ok(())
    }

    /// Iterations of the contact solver so far.
    pub fn contact_iterations(&self) -> usize {
        self.earlier_iterations + self.problem.contact_iterations()
    }

    /// Follows the branch from `seed`, within one more bound, and shows every point to `each`.
    pub fn trace(
        &mut self,
        seed: &Seed,
        bound: Option<Bound>,
        first: First,
        mut each: impl FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), StudyError> {
        if let Some(mut control) = self.control.take() {
            let outcome = self.trace_accurately(&mut control, seed, bound, first, &mut each);
            self.control = Some(control);
            return outcome;
        }
        let mut method = continuation(&self.settings, self.grazing, self.problem.frequency_index(), self.problem.dim());
        method.bounds.extend(bound);
        let mut found = Found::new(&first);
        let viewer = &mut self.viewer;
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let watch = &self.settings.watch;
        problem.accepted(&seed.x, seed.p);
        let branch = method.run_with_log(problem, &seed.x, seed.p, &seed.direction, log, |point| {
            found.keep_unless_ended(watch, viewer, point)?.iter().map(Shown::Point).try_for_each(&mut each)
        })?;
        found.count(&branch);
        Ok((found, if watch.has_ended() { StopReason::Stopped } else { branch.stop }))
    }

    /// The modal points of a tree of branches; `each` is shown every point with the number of its branch.
    pub fn trace_tree(
        &mut self,
        seed: &Seed,
        start_event: Event,
        mut each: impl FnMut(usize, &ModalPoint) -> ControlFlow<()>,
    ) -> Result<(Vec<Found>, BranchTree), StudyError> {
        let method = continuation(&self.settings, self.grazing, self.problem.frequency_index(), self.problem.dim());
        let max_branches = self.settings.max_branches;
        let mut all = vec![Found::new(&First::Named(start_event))];
        let viewer = &mut self.viewer;
        let (problem, log) = (&mut self.problem, &mut *self.log);
        problem.accepted(&seed.x, seed.p);
        let watch = &self.settings.watch;
        let mut tree = method.run_tree_with_log(
            problem,
            &seed.x,
            seed.p,
            &seed.direction,
            max_branches,
            log,
            |number, point| {
                if number == all.len() {
                    all.push(Found::new(&First::Plain));
                }
                let points = all[number].keep_unless_ended(watch, viewer, point)?;
                points.iter().try_for_each(|modal| each(number, modal))
            },
        )?;
        if watch.has_ended() {
            // Arms that were open still begin, and have no points.
            let begun = all.iter().take_while(|found| !found.points.is_empty()).count().max(1);
            all.truncate(begun);
            tree.branches.truncate(begun);
            tree.branches.iter_mut().last().into_iter().for_each(|b| b.branch.stop = StopReason::Stopped);
        }
        all.iter_mut().zip(&tree.branches).for_each(|(found, b)| found.count(&b.branch));
        Ok((all, tree))
    }

    /// Index of the frequency among the unknowns.
    pub fn frequency(&self) -> usize {
        self.problem.frequency_index()
    }
}

/// The points of a branch as they are found.
#[derive(Default)]
pub(super) struct Found {
    pub points: Vec<ModalPoint>,
    /// Scaled unknowns of each.
    pub unknowns: Vec<Vec<f64>>,
    pub evaluations: usize,
    pub refused_steps: usize,
    /// Changes of the number of harmonics, and the largest error that the held modes left out cause, by estimate.
    pub changes: usize,
    pub largest_held_modes_error: f64,
    /// Points kept when each point of the continuation had been seen.
    seen: Vec<usize>,
    start_event: Option<Event>,
    /// Where the branch leaves its nonlinear mode.
    departure: Departure,
    /// The solution kept last, with its parameter.
    last: Option<Vec<f64>>,
    /// Where the run began, and whether that point is left out.
    start: Option<Vec<f64>>,
    start_is_known: bool,
}

impl Found {
    pub(super) fn new(first: &First) -> Self {
        let start_event = if let First::Named(event) = first { Some(*event) } else { None };
        Self { start_event, start_is_known: matches!(first, First::Known), ..Self::default() }
    }

    /// The points that are kept of one of the continuation: none, itself, or before it the one at which the stability changes.
    fn keep(&mut self, viewer: &mut Viewer, point: &BranchPoint) -> &[ModalPoint] {
        let before = self.points.len();
        self.take(viewer, point);
        self.seen.push(self.points.len());
        &self.points[before..]
    }

    /// As [`Self::keep`], but nothing once the study has ended: what is found then may lack what could not be looked for any more.
    fn keep_unless_ended(
        &mut self,
        watch: &Watch,
        viewer: &mut Viewer,
        point: &BranchPoint,
    ) -> ControlFlow<(), &[ModalPoint]> {
        if watch.has_ended() {
            return ControlFlow::Break(());
        }
        let before = self.points.len();
        self.keep(viewer, point);
        if watch.has_ended() {
            self.truncate(before);
            self.seen.pop();
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(&self.points[before..])
    }

    fn take(&mut self, viewer: &mut Viewer, point: &BranchPoint) -> Option<()> {
        let is_first = self.start.is_none();
        if is_first {
            self.start = Some(point.x.clone());
            if self.start_is_known {
                return None;
            }
        } else if !point.events.is_empty() && self.is_start(point) {
            // What the continuation meets at the start is the grazing itself.
            return None;
        }
        let named = self.start_event.take_if(|_| is_first);
        self.add(viewer, point, named.into_iter().collect(), None)
    }

    /// Adds a point with these events beside those of the continuation, and before it the one at which the stability changes.
    fn add(
        &mut self,
        viewer: &mut Viewer,
        point: &BranchPoint,
        names: Vec<Event>,
        error: Option<TruncationError>,
    ) -> Option<()> {
        let mut modal = viewer.see(&point.x, point.residual)?;
        modal.events = names.into_iter().chain(point.events.iter().map(|e| event_of(*e))).collect();
        modal.error_estimate = error.map(|e| e.frequency);
        self.largest_held_modes_error = error.map_or(0.0, |e| e.held_modes).max(self.largest_held_modes_error);
        if let Some((x, change)) = self.stability_change(viewer, point, &modal) {
            self.push(change, x);
        }
        if self.departure.is_seen(&modal) {
            modal.events.push(Event::OtherMode);
        }
        viewer.probe.accepted(&modal);
        self.last = Some(point.z());
        self.push(modal, point.x.clone());
        Some(())
    }

    fn push(&mut self, modal: ModalPoint, x: Vec<f64>) {
        self.points.push(modal);
        self.unknowns.push(x);
    }

    /// The point between the last one and this at which the stability changes, if it does.
    fn stability_change(
        &self,
        viewer: &mut Viewer,
        point: &BranchPoint,
        modal: &ModalPoint,
    ) -> Option<(Vec<f64>, ModalPoint)> {
        let (before, now) = (self.points.last()?.stability?.stable, modal.stability?.stable);
        // A change of the number of harmonics is no way along which to look.
        let from = self.last.as_ref().filter(|last| before != now && last.len() == point.x.len() + 1)?;
        let (x, mut change) = viewer.change(from, &point.z(), now)?;
        change.events.push(Event::StabilityChange);
        Some((x, change))
    }

    /// A run begins, from a point that has not been seen.
    pub(super) fn begin(&mut self) {
        self.start = None;
    }

    /// Whether the first point of a run has not been left yet.
    pub(super) fn is_at_start(&self) -> bool {
        self.start.is_none()
    }

    /// A run leaves its first point.
    pub(super) fn leave_start(&mut self, point: &BranchPoint) {
        self.start = Some(point.x.clone());
    }

    /// Keeps a point with an estimate of its error and with these events.
    pub(super) fn keep_named(
        &mut self,
        viewer: &mut Viewer,
        point: &BranchPoint,
        names: Vec<Event>,
        error: Option<TruncationError>,
    ) -> &[ModalPoint] {
        let before = self.points.len();
        if point.events.is_empty() || !self.is_start(point) {
            self.add(viewer, point, names, error);
        }
        &self.points[before..]
    }

    /// Index of the point kept last when point `number` of the continuation had been seen.
    pub fn index_of(&self, number: usize) -> usize {
        self.seen.get(number).map_or(0, |n| n.saturating_sub(1))
    }

    pub(super) fn count(&mut self, branch: &Branch) {
        self.evaluations += branch.evaluations;
        self.refused_steps += branch.refused_steps;
    }

    fn is_start(&self, point: &BranchPoint) -> bool {
        self.start.as_ref().is_some_and(|first| first.iter().zip(&point.x).all(|(a, b)| (a - b).abs() < 1e-6))
    }

    /// Keeps the first `count` points.
    pub fn truncate(&mut self, count: usize) {
        self.points.truncate(count);
        self.unknowns.truncate(count);
        self.last = None;
    }

    /// Takes all points but the first `count` away.
    pub(super) fn split_off(&mut self, count: usize) -> Found {
        let (points, unknowns) = (self.points.split_off(count), self.unknowns.split_off(count));
        self.last = None;
        Found { points, unknowns, ..Found::default() }
    }

    /// Takes the points of another run behind its own.
    pub fn append(&mut self, mut other: Found) {
        self.points.append(&mut other.points);
        self.unknowns.append(&mut other.unknowns);
        self.evaluations += other.evaluations;
        self.refused_steps += other.refused_steps;
        self.changes += other.changes;
        self.largest_held_modes_error = self.largest_held_modes_error.max(other.largest_held_modes_error);
    }

    pub fn reverse(&mut self) {
        self.points.reverse();
        self.unknowns.reverse();
    }
}
