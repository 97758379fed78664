//! Motions of all contacts at points of a branch.

use nlmodes_modal::{ClosedSpan, TimeHistory};

use super::periodic::Periodic;
use super::prepare::periodic;
use super::{BranchError, ComputedBranch, PointBetween};

/// Evaluates points of a branch again, with one periodic problem for all that have as many harmonics.
pub struct Histories<'b> {
    branch: &'b ComputedBranch,
    problem: Option<(usize, Periodic<'b>)>,
}

impl<'b> Histories<'b> {
    /// Of the points of this branch.
    pub fn of(branch: &'b ComputedBranch) -> Self {
        Self { branch, problem: None }
    }

    /// Motion and force of all contacts over one period of point `point`, exact at the instants of contact: where any
    /// of them closes or opens there are two instants, a rounding apart, with what is just before and just after;
    /// `samples + 1` instants in all, some within the shortest blow too, or as many more as it takes for 65 beside the
    /// changes.
    ///
    /// # Errors
    /// [`BranchError`] if the point cannot be evaluated again.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn at(&mut self, point: usize, samples: usize, label: &str) -> Result<Vec<TimeHistory>, BranchError> {
        let branch = self.branch;
        let harmonics = branch.branch.points[point].coefficients.n_harmonics();
        Ok(self.problem(harmonics)?.time_histories(&branch.unknowns[point], samples, label)?)
    }

    /// Motion and force of each contact over one period of point `point`, at `samples` equidistant instants and the end
    /// of the period.
    ///
    /// # Errors
    /// [`BranchError`] if the point cannot be evaluated again.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn equidistant(&mut self, point: usize, samples: usize, label: &str) -> Result<Vec<TimeHistory>, BranchError> {
        let branch = self.branch;
        let harmonics = branch.branch.points[point].coefficients.n_harmonics();
        Ok(self.problem(harmonics)?.equidistant_histories(&branch.unknowns[point], samples, label)?)
    }

    /// The spans of a period of point `point` in which each contact is closed, with its force; none of exact motions,
    /// whose forces are no series.
    ///
    /// # Errors
    /// [`BranchError`] if the point cannot be evaluated again.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn closed_spans(&mut self, point: usize) -> Result<Option<Vec<Vec<ClosedSpan>>>, BranchError> {
        let branch = self.branch;
        let harmonics = branch.branch.points[point].coefficients.n_harmonics();
        Ok(self.problem(harmonics)?.closed_spans(&branch.unknowns[point])?)
    }

    /// The motion of [`at`](Self::at), of a solution between the points.
    ///
    /// # Errors
    /// [`BranchError`] if it cannot be evaluated again.
    pub fn between(
        &mut self,
        solution: &PointBetween,
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, BranchError> {
        let harmonics = solution.point.coefficients.n_harmonics();
        Ok(self.problem(harmonics)?.time_histories(&solution.unknowns, samples, label)?)
    }

    fn problem(&mut self, harmonics: usize) -> Result<&mut Periodic<'b>, BranchError> {
        let branch = self.branch;
        let kept = self.problem.take().filter(|(own, _)| *own == harmonics);
        let problem = match kept {
            Some(kept) => kept,
            None => (harmonics, periodic(&branch.structure, &branch.settings_of(harmonics), &branch.grazing)?),
        };
        Ok(&mut self.problem.insert(problem).1)
    }
}
