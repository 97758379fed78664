use std::ops::ControlFlow;

use crate::continuation::Start;
use crate::corrector::Corrector;
use crate::crossing::Registry;
use crate::record::RunLog;
use crate::run::Run;
use crate::{Branch, BranchPoint, Continuation, ContinuationError, ParametricSystem, StopReason};

/// Where a branch of a tree leaves another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Index of the other branch in [`BranchTree::branches`].
    pub branch: usize,
    /// Index in [`Branch::crossings`] of that branch.
    pub crossing: usize,
}

/// A branch of a tree.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TreeBranch {
    /// Its points; the first one lies beside the branch point that it leaves.
    pub branch: Branch,
    /// Where it comes from; `None` for the first.
    pub origin: Option<Origin>,
}

/// A branch with all branches that cross it, and those that cross these.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BranchTree {
    /// Each follows the one that it leaves.
    pub branches: Vec<TreeBranch>,
    /// Half-branches that were found but not followed, since there were branches enough.
    pub not_followed: usize,
    /// Whether all half-branches of all branch points were found.
    pub complete: bool,
    /// The largest kernel of the Jacobian at a branch point; one where there is none.
    pub kernel: usize,
}

impl Continuation {
    /// Follows the branch through `(x, p)` and, from every branch point that is met, each half-branch that no branch
    /// has passed yet.
    ///
    /// A branch that comes to a branch point whose way on has been passed ends there with [`StopReason::Joined`]. At
    /// most `max_branches` are followed, breadth first. Every point is shown to `observe` with the number of its branch
    /// when it is found.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_tree<S: ParametricSystem>(
        &self,
        system: &mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
        max_branches: usize,
        observe: impl FnMut(usize, &BranchPoint) -> ControlFlow<()>,
    ) -> Result<BranchTree, ContinuationError<S::Error>> {
        self.run_tree_with_log(system, x, p, direction, max_branches, &mut (), observe)
    }

    /// As [`run_tree`](Self::run_tree), each step going into a log; steps that this holds already are not computed
    /// again, as in [`run_with_log`](Self::run_with_log).
    ///
    /// # Errors
    /// As [`run`](Self::run).
    #[expect(clippy::too_many_arguments, reason = "those of `run_tree`, and the log")]
    pub fn run_tree_with_log<S: ParametricSystem>(
        &self,
        system: &mut S,
        x: &[f64],
        p: f64,
        direction: &[f64],
        max_branches: usize,
        log: &mut dyn RunLog,
        mut observe: impl FnMut(usize, &BranchPoint) -> ControlFlow<()>,
    ) -> Result<BranchTree, ContinuationError<S::Error>> {
        let Start { settings, mut system, correction: mut start, mut corrector } =
            self.start(system, x, p, direction)?;
        let mut registry = Registry::default();
        let mut branches: Vec<TreeBranch> = Vec::new();
        let mut origin = None;
        loop {
            let number = branches.len();
            let mut watch = |point: &BranchPoint| observe(number, point);
            let run = Run::new(&settings, &mut system, &mut watch, corrector, &start, &mut *log);
            let branch = run.within(&mut registry, number).finish(&start);
            let stopped = branch.stop == StopReason::Stopped;
            branches.push(TreeBranch { branch, origin });
            if stopped || branches.len() >= max_branches {
                break;
            }
            let Some(open) = registry.next_open() else { break };
            origin = Some(Origin { branch: open.branch, crossing: open.crossing });
            start = open.start;
            corrector = Corrector::with_solver(system.solver(), x.len(), self.step.tolerance, self.step.max_iterations);
        }
        let crossings = || branches.iter().flat_map(|b| &b.branch.crossings);
        let complete = crossings().all(|c| c.complete);
        let kernel = crossings().map(|c| c.kernel).fold(1, usize::max);
        Ok(BranchTree { branches, not_followed: registry.n_open(), complete, kernel })
    }
}
