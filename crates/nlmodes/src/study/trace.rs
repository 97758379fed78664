//! One run of the continuation, seen as modal points.

use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Branch, BranchPoint, BranchTree, ParametricSystem, RunLog, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, MixedShooting};
use nlmodes_modal::ModalPoint;

use super::events::event_name;
use super::prepare::{continuation, problem};
use super::resonances::Resonances;
use super::start::Seed;
use super::{BranchSettings, StudyError};

/// A structure and its settings, and what turns solutions into modal points.
pub(super) struct Tracer<'s> {
    pub structure: &'s CondensedStructure,
    pub grazing: &'s Grazing,
    pub settings: &'s BranchSettings,
    pub problem: MixedShooting<'s>,
    pub log: &'s mut dyn RunLog,
    /// Evaluates points while the problem is at work elsewhere.
    viewer: MixedShooting<'s>,
    resonances: Resonances<'s>,
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
        settings: &'s BranchSettings,
        log: &'s mut dyn RunLog,
    ) -> Result<Self, StudyError> {
        let problem = problem(structure, settings, grazing)?;
        let viewer = self::problem(structure, settings, grazing)?;
        let resonances = Resonances::new(structure);
        Ok(Self { structure, grazing, settings, problem, log, viewer, resonances })
    }

    /// Follows the branch from `seed`, within one more bound, and shows every point to `each`.
    pub fn trace(
        &mut self,
        seed: &Seed,
        bound: Option<Bound>,
        first: First,
        mut each: impl FnMut(&ModalPoint) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), StudyError> {
        let mut method = continuation(self.settings, self.grazing, &self.problem, self.problem.dim());
        method.bounds.extend(bound);
        let mut found = Found::new(&first);
        let (viewer, resonances) = (&mut self.viewer, &mut self.resonances);
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let branch = method.run_with_log(problem, &seed.x, seed.p, &seed.direction, log, |point| {
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
        let method = continuation(self.settings, self.grazing, &self.problem, self.problem.dim());
        let max_branches = self.settings.max_branches;
        let mut all = vec![Found::new(&First::Named(start_event))];
        let (viewer, resonances) = (&mut self.viewer, &mut self.resonances);
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let tree = method.run_tree_with_log(
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
                let Some(modal) = all[number].keep(viewer, resonances, point) else {
                    return ControlFlow::Continue(());
                };
                each(number, modal)
            },
        )?;
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
    /// Points kept when each point of the continuation had been seen.
    seen: Vec<usize>,
    start_event: Option<String>,
    /// Where the run began, and whether that point is left out.
    start: Option<Vec<f64>>,
    start_is_known: bool,
}

impl Found {
    fn new(first: &First) -> Self {
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

    /// Index of the point kept last when point `number` of the continuation had been seen.
    pub fn index_of(&self, number: usize) -> usize {
        self.seen.get(number).map_or(0, |n| n.saturating_sub(1))
    }

    fn count(&mut self, branch: &Branch) {
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
    }

    pub fn reverse(&mut self) {
        self.points.reverse();
        self.unknowns.reverse();
    }
}
