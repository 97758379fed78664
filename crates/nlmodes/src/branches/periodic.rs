//! The periodic problem of a branch, in harmonics or exact.

use nlmodes_continuation::{Boundary, Linearization, ParametricSystem, Scaling};
use nlmodes_hbm::{CondensedStructure, Grazing, HbmError, PeriodicSystem};
use nlmodes_modal::{ClosedSpan, HarmonicCoefficients, ModalPoint, TimeHistory};
use nlmodes_timestep::{ModeShooting, TimestepError};
use thiserror::Error;

use super::{BranchSettings, Ended, Watch};

/// Why a periodic problem cannot be evaluated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PeriodicError {
    /// In harmonics.
    #[error(transparent)]
    Harmonics(#[from] HbmError),
    /// By exact integration.
    #[error(transparent)]
    Exact(#[from] TimestepError),
    /// The computation was asked to end.
    #[error(transparent)]
    Ended(#[from] Ended),
}

/// Equations of periodic motions, as a system for continuation that is watched.
pub(super) struct Periodic<'s> {
    equations: Equations<'s>,
    watch: Watch,
}

enum Equations<'s> {
    Harmonics(&'s CondensedStructure, Box<PeriodicSystem>),
    Exact(Box<ModeShooting>),
}

impl<'s> Periodic<'s> {
    pub fn in_harmonics(structure: &'s CondensedStructure, problem: PeriodicSystem, settings: &BranchSettings) -> Self {
        Self { equations: Equations::Harmonics(structure, Box::new(problem)), watch: settings.watch.clone() }
    }

    pub fn exact(problem: ModeShooting, settings: &BranchSettings) -> Self {
        Self { equations: Equations::Exact(Box::new(problem)), watch: settings.watch.clone() }
    }

    /// Unknowns at grazing and the direction of growing amplitude.
    pub fn start(&self, grazing: &Grazing) -> (Vec<f64>, Vec<f64>) {
        match &self.equations {
            Equations::Harmonics(_, problem) => problem.start(grazing),
            Equations::Exact(problem) => problem.start(),
        }
    }

    /// The problem in harmonics, if it is one.
    pub fn harmonics(&self) -> Option<&PeriodicSystem> {
        match &self.equations {
            Equations::Harmonics(_, problem) => Some(problem),
            Equations::Exact(_) => None,
        }
    }

    /// Index of the frequency among the unknowns.
    pub fn frequency_index(&self) -> usize {
        match &self.equations {
            Equations::Harmonics(_, problem) => problem.n_coefficients(),
            Equations::Exact(problem) => problem.frequency_index(),
        }
    }

    /// Angular frequency of the unknowns `x`, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        match &self.equations {
            Equations::Harmonics(_, problem) => problem.omega(x),
            Equations::Exact(problem) => problem.omega(x),
        }
    }

    /// Iterations of the contact solver.
    pub fn contact_iterations(&self) -> usize {
        match &self.equations {
            Equations::Harmonics(_, problem) => problem.contact_iterations(),
            Equations::Exact(_) => 0,
        }
    }

    /// The point with the unknowns `x`; that of an exact motion may have more harmonics than were asked for.
    pub fn modal_point(&mut self, x: &[f64], residual: f64) -> Result<ModalPoint, PeriodicError> {
        Ok(match &mut self.equations {
            Equations::Harmonics(structure, problem) => structure.modal_point(problem, x, residual)?,
            Equations::Exact(problem) => problem.modal_point(x, residual)?,
        })
    }

    /// Coordinates of the point with the unknowns `x` in the open modes of the structure; `motion` is what it does.
    pub fn modal_coordinates(
        &mut self,
        structure: &CondensedStructure,
        x: &[f64],
        motion: &HarmonicCoefficients,
    ) -> Result<HarmonicCoefficients, PeriodicError> {
        Ok(match &mut self.equations {
            Equations::Harmonics(_, problem) => problem.motion(x, 0.0)?.modal_coefficients(),
            // Exact motions are those of all degrees of freedom.
            Equations::Exact(_) => structure.modal_coordinates(motion, usize::MAX)?,
        })
    }

    /// Motion and force of all contacts over a period, exact at the instants of contact.
    pub fn time_histories(
        &mut self,
        x: &[f64],
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, PeriodicError> {
        Ok(match &mut self.equations {
            Equations::Harmonics(structure, problem) => {
                problem.time_histories(x, structure.model().contacts(), samples, label)?
            }
            Equations::Exact(problem) => problem.time_histories(x, samples, label)?,
        })
    }

    /// Motion and force of each contact over a period, at equidistant instants.
    pub fn equidistant_histories(
        &mut self,
        x: &[f64],
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, PeriodicError> {
        Ok(match &mut self.equations {
            Equations::Harmonics(structure, problem) => {
                problem.equidistant_histories(x, structure.model().contacts(), samples, label)?
            }
            Equations::Exact(problem) => problem.equidistant_histories(x, samples, label)?,
        })
    }

    /// The spans of a period in which each contact is closed, with its force as a series; none of an exact motion,
    /// whose forces are none.
    pub fn closed_spans(&mut self, x: &[f64]) -> Result<Option<Vec<Vec<ClosedSpan>>>, PeriodicError> {
        Ok(match &mut self.equations {
            Equations::Harmonics(_, problem) => Some(problem.closed_spans(x)?),
            Equations::Exact(_) => None,
        })
    }
}

impl ParametricSystem for Periodic<'_> {
    type Error = PeriodicError;

    fn dim(&self) -> usize {
        match &self.equations {
            Equations::Harmonics(_, problem) => problem.dim(),
            Equations::Exact(problem) => problem.dim(),
        }
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), PeriodicError> {
        self.watch.evaluates()?;
        match &mut self.equations {
            Equations::Harmonics(_, problem) => Ok(problem.linearize(x, p, out)?),
            Equations::Exact(problem) => Ok(problem.linearize(x, p, out)?),
        }
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling::unit(self.dim()))
    }

    fn pattern(&self) -> u64 {
        match &self.equations {
            Equations::Harmonics(_, problem) => problem.pattern(),
            Equations::Exact(problem) => problem.pattern(),
        }
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        match &mut self.equations {
            Equations::Harmonics(_, problem) => problem.pattern_at(z),
            Equations::Exact(_) => None,
        }
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        match &mut self.equations {
            Equations::Harmonics(_, problem) => problem.boundary(from, to),
            // Halving finds its changes.
            Equations::Exact(_) => None,
        }
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        match &mut self.equations {
            Equations::Harmonics(_, problem) => problem.accepted(x, p),
            Equations::Exact(problem) => problem.accepted(x, p),
        }
    }
}
