//! One run of the continuation, seen as modal points.

use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, BranchTree, Continuation, ParametricSystem, RunLog, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, TruncationEstimator};
use nlmodes_modal::{Event, ModalPoint};

use super::adaptive::Control;
use super::found::{First, Found};
use super::periodic::Periodic;
use super::prepare::{continuation, estimator, periodic};
use super::start::Seed;
use super::viewer::Viewer;
use super::{BranchError, BranchMethod, BranchProgress, BranchSettings};

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
    /// Where an accuracy is asked for; the control is that with which a run begins.
    pub(super) estimator: Option<TruncationEstimator<'s>>,
    control: Option<Control>,
    /// The branch was given up since the held modes do not reach the accuracy.
    pub too_few_modes: bool,
    /// Iterations of the contact solver in the problems before the present one.
    earlier_iterations: usize,
}

impl<'s> Tracer<'s> {
    pub fn new(
        structure: &'s CondensedStructure,
        grazing: &'s Grazing,
        settings: &BranchSettings,
        fewest: usize,
        log: &'s mut dyn RunLog,
    ) -> Result<Self, BranchError> {
        let problem = periodic(structure, settings, grazing)?;
        let viewer = Viewer::new(structure, settings, grazing)?;
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
            control: accuracy.map(|accuracy| Control::new(accuracy, settings.growth, fewest, more_modes)),
            too_few_modes: false,
            earlier_iterations: 0,
        })
    }

    /// Goes on with another number of harmonics.
    pub(super) fn set_harmonics(&mut self, harmonics: usize) -> Result<(), BranchError> {
        if harmonics == self.settings.harmonics {
            return Ok(());
        }
        self.earlier_iterations += self.problem.contact_iterations();
        self.settings.harmonics = harmonics;
        self.problem = periodic(self.structure, &self.settings, self.grazing)?;
        self.viewer.set_problem(periodic(self.structure, &self.settings, self.grazing)?, harmonics);
        if self.estimator.is_some() {
            self.estimator = Some(estimator(self.structure, &self.settings, self.grazing)?);
        }
        Ok(())
    }

    /// Iterations of the contact solver so far.
    pub fn contact_iterations(&self) -> usize {
        self.earlier_iterations + self.problem.contact_iterations()
    }

    /// Follows the branch from `seed`, its frequency over that of grazing within these limits too, and shows every
    /// point to `each`.
    pub fn trace(
        &mut self,
        seed: &Seed,
        frequency: Option<[f64; 2]>,
        first: First,
        mut each: impl FnMut(BranchProgress) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), BranchError> {
        if let Some(control) = self.control {
            return self.trace_accurately(control, seed, frequency, first, &mut each);
        }
        let method = self.within(frequency);
        let mut found = Found::new(&first);
        let viewer = &mut self.viewer;
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let watch = &self.settings.watch;
        problem.accepted(&seed.x, seed.p);
        let branch = method.run_with_log(problem, &seed.x, seed.p, &seed.direction, log, |point| {
            found.keep_unless_ended(watch, viewer, point)?.iter().map(BranchProgress::of_first).try_for_each(&mut each)
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
    ) -> Result<(Vec<Found>, BranchTree), BranchError> {
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
            // Half-branches that were open still begin, and have no points.
            let begun = all.iter().take_while(|found| !found.points.is_empty()).count().max(1);
            all.truncate(begun);
            tree.branches.truncate(begun);
            tree.branches.iter_mut().last().into_iter().for_each(|b| b.branch.stop = StopReason::Stopped);
        }
        all.iter_mut().zip(&tree.branches).for_each(|(found, b)| found.count(&b.branch));
        Ok((all, tree))
    }

    /// The continuation of the settings, the frequency over that of grazing within these limits too.
    pub(super) fn within(&self, frequency: Option<[f64; 2]>) -> Continuation {
        // The place of the frequency among the unknowns follows from the number of harmonics.
        let coordinate = self.problem.frequency_index();
        let mut method = continuation(&self.settings, self.grazing, coordinate, self.problem.dim());
        method.bounds.extend(frequency.map(|[min, max]| Bound { coordinate, min, max }));
        method
    }
}
