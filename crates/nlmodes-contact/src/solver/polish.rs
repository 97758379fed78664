//! From approximate forces to the exact closed set.

use super::{
    active_set::{Newton, Primal},
    workspace::Outcome,
};
use crate::sample::Sample;

/// Reads the closed set off approximate forces, solves its block exactly and corrects a few signs.
///
/// Only a few, since it must not replace the method that computed the forces.
#[derive(Debug)]
pub(crate) struct Polish {
    newton: Newton,
    primal: Primal,
    approximate: Vec<f64>,
}

impl Polish {
    pub(crate) fn new(c: usize) -> Self {
        Self { newton: Newton::new(c), primal: Primal::default(), approximate: Vec::with_capacity(c) }
    }

    /// If the result is accepted, it is in `sample` and `closed`; otherwise the forces are unchanged, as the outcome
    /// indicates.
    pub(crate) fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        self.approximate.clone_from(&sample.lambda);
        let before = sample.judge();
        self.newton.guess_from_forces(sample);
        let quick = self.newton.run(sample, 1);
        if let Some(outcome) = quick.filter(|outcome| outcome.verdict.is_accepted()) {
            self.newton.unload_closed(closed);
            return outcome;
        }
        sample.lambda.copy_from_slice(&self.approximate);
        sample.clamp(before);
        // Redundant contacts: an independent subset that carries the same forces.
        let exact = self.primal.run(sample, closed.len() / 4 + 8);
        if exact.verdict.is_accepted() || exact.infeasible {
            self.primal.unload_closed(closed);
            return exact;
        }
        sample.lambda.copy_from_slice(&self.approximate);
        Outcome { iterations: 0, verdict: sample.judge(), infeasible: false }
    }
}
