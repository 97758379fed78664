//! The wrapper around every backend: scaling before, the judge after.

use crate::{
    LcpError, LcpMatrix, LcpStatistics, LcpWorkspace,
    sample::{Sample, Verdict},
};

/// The algorithm of a backend, in scaled units.
pub(crate) trait Method: Send {
    /// Name of the backend.
    const NAME: &'static str;

    /// Leaves the forces in `sample` and the closed contacts in `closed`, which contains a guess on entry.
    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome;
}

/// How a method ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    pub(crate) iterations: usize,
    /// The judge's verdict on the forces in the sample.
    pub(crate) verdict: Verdict,
    /// Whether the ray in the sample was verified to prove infeasibility.
    pub(crate) infeasible: bool,
}

/// A method with its sample.
pub(crate) struct Workspace<M> {
    sample: Sample,
    method: M,
}

impl<M: Method> Workspace<M> {
    pub(crate) fn new(matrix: &LcpMatrix, method: M) -> Self {
        Self { sample: Sample::new(matrix), method }
    }

    fn check_length(&self, what: &'static str, found: usize) -> Result<(), LcpError> {
        let expected = self.sample.b.len();
        if found == expected { Ok(()) } else { Err(LcpError::Dimension { what, expected, found }) }
    }

    fn error(&self, outcome: Outcome, lambda: &[f64]) -> LcpError {
        if outcome.infeasible {
            return LcpError::Infeasible { ray: self.sample.ray() };
        }
        let (iterations, violation) = (outcome.iterations, outcome.verdict.violation());
        let rounding = self.sample.rounding();
        if violation <= rounding {
            return LcpError::Rounding { solver: M::NAME, violation, rounding, lambda: lambda.to_vec() };
        }
        LcpError::NotConverged { solver: M::NAME, iterations, violation, lambda: lambda.to_vec() }
    }
}

impl<M: Method> LcpWorkspace for Workspace<M> {
    fn solve(&mut self, b: &[f64], closed: &mut [bool], lambda: &mut [f64]) -> Result<LcpStatistics, LcpError> {
        self.check_length("b", b.len())?;
        self.check_length("closed contacts", closed.len())?;
        self.check_length("lambda", lambda.len())?;
        if let Some(verdict) = self.sample.begin(b)? {
            closed.fill(false);
            lambda.fill(0.0);
            return Ok(LcpStatistics { iterations: 0, violation: verdict.violation() });
        }
        let outcome = self.method.run(&mut self.sample, closed);
        if !self.sample.unload_forces(lambda) && outcome.verdict.is_accepted() {
            return Err(LcpError::OutOfRange);
        }
        if outcome.verdict.is_accepted() {
            Ok(LcpStatistics { iterations: outcome.iterations, violation: outcome.verdict.violation() })
        } else {
            Err(self.error(outcome, lambda))
        }
    }

    fn gaps(&self, gaps: &mut [f64]) -> Result<(), LcpError> {
        self.check_length("gaps", gaps.len())?;
        self.sample.unload_gaps(gaps);
        Ok(())
    }
}
