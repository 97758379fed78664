//! Solutions seen as modal points.

use std::ops::ControlFlow;

use nlmodes_continuation::{Continuation, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, Grazing};
use nlmodes_modal::ModalPoint;

use super::periodic::Periodic;
use super::prepare::periodic;
use super::resonances::resonance;
use super::stability::{Probe, length};
use super::{BranchError, BranchSettings};

/// Length of the step, in scaled unknowns, within which a change of stability is located, and halvings that it may
/// take.
const CHANGE_LOCATED: f64 = 1e-7;
const MOST_HALVINGS: usize = 40;

/// What turns a solution into a modal point.
pub(super) struct Viewer<'s> {
    structure: &'s CondensedStructure,
    problem: Periodic<'s>,
    harmonics: usize,
    probe: Probe,
}

impl<'s> Viewer<'s> {
    pub fn new(
        structure: &'s CondensedStructure,
        settings: &BranchSettings,
        grazing: &Grazing,
    ) -> Result<Self, BranchError> {
        Ok(Self {
            structure,
            problem: periodic(structure, settings, grazing)?,
            harmonics: settings.harmonics,
            probe: Probe::new(structure.model(), settings, grazing),
        })
    }

    /// Goes on with another number of harmonics.
    pub fn set_problem(&mut self, problem: Periodic<'s>, harmonics: usize) {
        (self.problem, self.harmonics) = (problem, harmonics);
    }

    /// A point was kept.
    pub fn accepted(&mut self, point: &ModalPoint) {
        self.probe.accepted(point);
    }

    /// Points whose stability was left out since its budget was used up.
    pub fn without_stability(&self) -> usize {
        self.probe.left_out()
    }

    /// The modal point of a solution; `None` if it cannot be evaluated again.
    pub fn see(&mut self, x: &[f64], residual: f64) -> Option<ModalPoint> {
        let mut modal = self.problem.modal_point(x, residual).ok()?;
        let (structure, problem) = (self.structure, &mut self.problem);
        let project = || problem.modal_coordinates(structure, x, &modal.coefficients).ok();
        modal.resonance = resonance(structure, &modal, project);
        modal.stability = self.probe.of(&mut self.problem, x, &modal);
        // An exact motion has more harmonics than were asked for, by which its resonances are known.
        if modal.coefficients.n_harmonics() > self.harmonics {
            modal.coefficients = modal.coefficients.truncated(self.harmonics);
        }
        Some(modal)
    }

    /// The first solution between `from` and `to` whose stability is that of `to`, by bisection along the branch.
    pub fn change(&mut self, from: &[f64], to: &[f64], stable: Option<bool>) -> Option<(Vec<f64>, ModalPoint)> {
        let (mut low, mut high, mut found) = (from.to_vec(), to.to_vec(), None);
        let method = Continuation { max_points: 1, ..Continuation::default() };
        for _ in 0..MOST_HALVINGS {
            let along: Vec<f64> = high.iter().zip(&low).map(|(a, b)| a - b).collect();
            if length(&along) < CHANGE_LOCATED {
                break;
            }
            let middle: Vec<f64> = high.iter().zip(&low).map(|(a, b)| 0.5 * (a + b)).collect();
            let (p, x) = middle.split_last()?;
            self.problem.accepted(x, *p);
            let corrected = method.run(&mut self.problem, x, *p, &along, |_| ControlFlow::Continue(())).ok()?;
            let corrected = corrected.points.into_iter().next()?;
            let modal = self.see(&corrected.x, corrected.residual)?;
            match modal.stability?.stable == stable {
                true => {
                    high = corrected.z();
                    found = Some((corrected.x, modal));
                }
                false => low = corrected.z(),
            }
        }
        found
    }
}
