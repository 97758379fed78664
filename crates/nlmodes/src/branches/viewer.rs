//! Solutions seen as modal points.

use nlmodes_continuation::{Continuation, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, Grazing};
use nlmodes_modal::ModalPoint;

use super::periodic::Periodic;
use super::prepare::periodic;
use super::resonances::resonance;
use super::{BranchError, BranchSettings};

/// What turns a solution into a modal point.
pub(super) struct Viewer<'s> {
    structure: &'s CondensedStructure,
    problem: Periodic<'s>,
    harmonics: usize,
}

impl<'s> Viewer<'s> {
    pub fn new(
        structure: &'s CondensedStructure,
        settings: &BranchSettings,
        grazing: &Grazing,
    ) -> Result<Self, BranchError> {
        Ok(Self { structure, problem: periodic(structure, settings, grazing)?, harmonics: settings.harmonics })
    }

    /// Goes on with another number of harmonics.
    pub fn set_problem(&mut self, problem: Periodic<'s>, harmonics: usize) {
        (self.problem, self.harmonics) = (problem, harmonics);
    }

    /// The modal point of a solution; `None` if it cannot be evaluated again.
    pub fn see(&mut self, x: &[f64], residual: f64) -> Option<ModalPoint> {
        let mut modal = self.problem.modal_point(x, residual).ok()?;
        let (structure, problem) = (self.structure, &mut self.problem);
        let project = || problem.modal_coordinates(structure, x, &modal.coefficients).ok();
        modal.resonance = resonance(structure, &modal, project);
        // An exact motion has more harmonics than were asked for, by which its resonances are known.
        if modal.coefficients.n_harmonics() > self.harmonics {
            modal.coefficients = modal.coefficients.truncated(self.harmonics);
        }
        Some(modal)
    }

    /// The solution across `along` from `guess`, with its residual, and its unknowns with the parameter.
    pub fn solution(&mut self, guess: &[f64], along: &[f64]) -> Option<(Vec<f64>, f64, Vec<f64>)> {
        let (p, x) = guess.split_last()?;
        self.problem.accepted(x, *p);
        let point = Continuation::default().first_point(&mut self.problem, guess, along, &mut ()).ok()??;
        let z = point.z();
        Some((point.x, point.residual, z))
    }
}
