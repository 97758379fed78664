//! The trait of the backends, and what they share.

pub(crate) mod active_set;
pub(crate) mod clarabel;
pub(crate) mod closed_form;
pub(crate) mod lemke;
pub(crate) mod polish;
pub(crate) mod proximal;
pub(crate) mod workspace;

use crate::{ActiveSet, Clarabel, ClosedForm, LcpError, LcpMatrix, Lemke, Proximal};

/// A method for contact problems, with its settings. [`LcpWorkspace`] does the work.
pub trait LcpSolver: std::fmt::Debug + Send + Sync {
    /// Name in scenes and on the command line.
    fn name(&self) -> &'static str;

    /// Prepares the solution of problems with the matrix `a`: factors, scales, allocates.
    ///
    /// # Errors
    /// [`LcpError`] if this backend cannot treat `a`.
    fn workspace(&self, a: &LcpMatrix) -> Result<Box<dyn LcpWorkspace>, LcpError>;
}

/// Solves a series of problems with one `A` and changing `b`, without allocating once its work space has grown.
pub trait LcpWorkspace: Send {
    /// Solves `0 ≤ A λ + b ⊥ λ ≥ 0`.
    ///
    /// `closed` (c) is the initial guess of the closed contacts on entry and the closed contacts on return; `lambda`
    /// (c) is overwritten with the forces. No contact closed means no guess. Where contacts are redundant, `closed` is
    /// the independent subset that was chosen to carry the forces.
    ///
    /// # Errors
    /// [`LcpError`]: not finite, infeasible, not converged, or beyond rounding; then `lambda` holds the best iterate.
    fn solve(&mut self, b: &[f64], closed: &mut [bool], lambda: &mut [f64]) -> Result<LcpStatistics, LcpError>;

    /// Writes the gaps `A λ + b` (c, m) of the last problem solved, as the judge computed them.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `gaps` has not c entries.
    fn gaps(&self, gaps: &mut [f64]) -> Result<(), LcpError>;
}

/// Cost and accuracy of a solution.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct LcpStatistics {
    /// Iterations, in the unit of the backend.
    pub iterations: usize,
    /// Scaled complementarity violation, as [`LcpMatrix::violation`] computes it.
    pub violation: f64,
}

/// Names of all backends, the default first.
pub const SOLVER_NAMES: [&str; 5] = [active_set::NAME, proximal::NAME, clarabel::NAME, lemke::NAME, closed_form::NAME];

/// The backend of that name with its default settings.
///
/// # Errors
/// [`LcpError::UnknownSolver`], which lists the names.
pub fn solver_by_name(name: &str) -> Result<Box<dyn LcpSolver>, LcpError> {
    match name {
        active_set::NAME => Ok(Box::new(ActiveSet::default())),
        proximal::NAME => Ok(Box::new(Proximal::default())),
        clarabel::NAME => Ok(Box::new(Clarabel::default())),
        lemke::NAME => Ok(Box::new(Lemke::default())),
        closed_form::NAME => Ok(Box::new(ClosedForm)),
        _ => Err(LcpError::UnknownSolver { name: name.to_owned(), known: SOLVER_NAMES.to_vec() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_gives_the_backend_of_that_name() {
        for name in SOLVER_NAMES {
            assert_eq!(solver_by_name(name).unwrap().name(), name);
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_all_names() {
        let message = solver_by_name("newton").unwrap_err().to_string();
        assert!(SOLVER_NAMES.iter().all(|name| message.contains(name)), "{message}");
    }
}
