//! One run of the continuation, seen as modal points.

use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Branch, BranchPoint, BranchTree, ParametricSystem, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, MixedShooting, TruncationError, TruncationEstimator};
use nlmodes_modal::ModalPoint;

use super::events::event_name;
use super::accuracy::Control;
use super::prepare::{continuation, estimator, problem};
use super::resonances::Resonances;
use super::start::Seed;
use super::{BranchSettings, StudyError};

/// A structure and its settings, and what turns solutions into modal points.
pub(super) struct Tracer<'s> {
    pub structure: &'s CondensedStructure,
    pub grazing: &'s Grazing,
    /// With the present number of harmonics.
    pub settings: BranchSettings,
    pub problem: MixedShooting<'s>,
    /// Evaluates points while the problem is at work elsewhere.
    pub(super) viewer: MixedShooting<'s>,
    pub(super) resonances: Resonances<'s>,
    /// Where an accuracy is asked for.
    pub(super) estimator: Option<TruncationEstimator<'s>>,
    control: Option<Control>,
    /// The branch was given up since the held modes do not reach the accuracy.
    pub too_few_modes: bool,
    /// Iterations of the contact solver in the problems before the present one.
    earlier_iterations: usize,
}

/// The beginning of a run.
pub(super) enum First<'n> {
    /// Its first point has this event.
    Named(&'n str),
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
    ) -> Result<Self, StudyError> {
        let problem = problem(structure, settings, grazing)?;
        let viewer = self::problem(structure, settings, grazing)?;
        let more_modes =
            settings.held_modes.is_none() && structure.n_held_modes() < structure.model().linear_dofs().len();
        let mut tracer = Self {
            structure,
            grazing,
            settings: settings.clone(),
            problem,
            viewer,
            resonances: Resonances::new(structure),
            estimator: None,
            control: settings.accuracy.map(|accuracy| Control::new(accuracy, fewest, more_modes)),
            too_few_modes: false,
            earlier_iterations: 0,
        };
        if settings.accuracy.is_some() {
            tracer.estimator = Some(estimator(structure, settings, grazing)?);
        }
        Ok(tracer)
    }

    /// Goes on with another number of harmonics.
    pub fn set_harmonics(&mut self, harmonics: usize) -> Result<(), StudyError> {
        if harmonics == self.settings.harmonics {
            return Ok(());
        }
        self.earlier_iterations += self.problem.contact_iterations();
        self.settings.harmonics = harmonics;
        self.problem = problem(self.structure, &self.settings, self.grazing)?;
        self.viewer = problem(self.structure, &self.settings, self.grazing)?;
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
        mut each: impl FnMut(&ModalPoint) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), StudyError> {
        if let Some(mut control) = self.control.take() {
            let outcome = self.trace_accurately(&mut control, seed, bound, first, &mut each);
            self.control = Some(control);
            return outcome;
        }
        let mut method = continuation(&self.settings, self.grazing, &self.problem, self.problem.dim());
        method.bounds.extend(bound);
        let mut found = Found::new(&first);
        let (viewer, resonances) = (&mut self.viewer, &mut self.resonances);
        let branch = method.run(&mut self.problem, &seed.x, seed.p, &seed.direction, |point| {
            let Some(modal) = found.keep(viewer, resonances, point) else { return ControlFlow::Continue(()) };
            each(modal)
        })?;
        found.count(&branch);
        Ok((found, branch.stop))
    }

    /// The modal points of a tree of branches; `each` is shown every point with the number of its branch.
    pub fn trace_tree(
        &mut self,
        seed: &Seed,
        start_event: &str,
        mut each: impl FnMut(usize, &ModalPoint) -> ControlFlow<()>,
    ) -> Result<(Vec<Found>, BranchTree), StudyError> {
        let method = continuation(&self.settings, self.grazing, &self.problem, self.problem.dim());
        let max_branches = self.settings.max_branches;
        let mut all = vec![Found::new(&First::Named(start_event))];
        let (viewer, resonances) = (&mut self.viewer, &mut self.resonances);
        let tree =
            method.run_tree(&mut self.problem, &seed.x, seed.p, &seed.direction, max_branches, |number, point| {
                if number == all.len() {
                    all.push(Found::new(&First::Plain));
                }
                let Some(modal) = all[number].keep(viewer, resonances, point) else {
                    return ControlFlow::Continue(());
                };
                each(number, modal)
            })?;
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
    start_event: Option<String>,
    /// Where the run began, and whether that point is left out.
    start: Option<Vec<f64>>,
    start_is_known: bool,
}

impl Found {
    pub(super) fn new(first: &First) -> Self {
        let start_event = if let First::Named(name) = first { Some((*name).to_owned()) } else { None };
        Self { start_event, start_is_known: matches!(first, First::Known), ..Self::default() }
    }

    fn keep(
        &mut self,
        viewer: &mut MixedShooting,
        resonances: &mut Resonances,
        point: &BranchPoint,
    ) -> Option<&ModalPoint> {
        let kept = self.take(viewer, resonances, point).is_some();
        self.seen.push(self.points.len());
        if kept { self.points.last() } else { None }
    }

    fn take(&mut self, viewer: &mut MixedShooting, resonances: &mut Resonances, point: &BranchPoint) -> Option<()> {
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
        let mut modal = viewer.modal_point(&point.x, point.residual).ok()?;
        let named = self.start_event.take_if(|_| is_first);
        modal.events = named.into_iter().chain(point.events.iter().map(|e| event_name(*e).to_owned())).collect();
        modal.resonance = resonances.of(&modal);
        self.points.push(modal);
        self.unknowns.push(point.x.clone());
        Some(())
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

    /// Keeps a point with an estimate of its error, with these events beside those of the continuation.
    pub(super) fn keep_named(
        &mut self,
        viewer: &mut MixedShooting,
        resonances: &mut Resonances,
        point: &BranchPoint,
        names: Vec<String>,
        error: Option<TruncationError>,
    ) -> Option<&ModalPoint> {
        if !point.events.is_empty() && self.is_start(point) {
            return None;
        }
        let mut modal = viewer.modal_point(&point.x, point.residual).ok()?;
        modal.events = names.into_iter().chain(point.events.iter().map(|e| event_name(*e).to_owned())).collect();
        modal.resonance = resonances.of(&modal);
        modal.error_estimate = error.map(|e| e.frequency);
        self.largest_held_modes_error = error.map_or(0.0, |e| e.held_modes).max(self.largest_held_modes_error);
        self.points.push(modal);
        self.unknowns.push(point.x.clone());
        self.points.last()
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
