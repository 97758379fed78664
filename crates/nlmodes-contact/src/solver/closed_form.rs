use super::workspace::{Method, Outcome, Workspace};
use crate::{LcpError, LcpMatrix, LcpSolver, LcpWorkspace, sample::Sample};

pub(crate) const NAME: &str = "closed-form";

/// The solution for one contact, `λ = max(0, −b / A)`: the proximal point function of eqs. (2) and (3) in closed form.
///
/// It rejects problems with more contacts with [`LcpError::TooManyContacts`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ClosedForm;

impl LcpSolver for ClosedForm {
    fn name(&self) -> &'static str {
        NAME
    }

    fn workspace(&self, a: &LcpMatrix) -> Result<Box<dyn LcpWorkspace>, LcpError> {
        let found = a.n_contacts();
        if found > 1 {
            return Err(LcpError::TooManyContacts { solver: NAME, at_most: 1, found });
        }
        Ok(Box::new(Workspace::new(a, OneContact)))
    }
}

pub(crate) struct OneContact;

impl Method for OneContact {
    const NAME: &'static str = NAME;

    /// Only called with `b < 0`.
    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        let compliance = sample.matrix().diagonal(0);
        closed[0] = compliance > 0.0;
        if closed[0] {
            sample.lambda[0] = -sample.b[0] / compliance;
            return Outcome { iterations: 1, verdict: sample.judge(), infeasible: false };
        }
        sample.ray[0] = 1.0;
        let infeasible = sample.is_proven_infeasible();
        Outcome { iterations: 1, verdict: sample.judge(), infeasible }
    }
}
