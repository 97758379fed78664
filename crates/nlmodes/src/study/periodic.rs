//! The periodic problem of a study, in harmonics or exact.

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{Grazing, HbmError, MixedShooting};
use nlmodes_modal::{ModalPoint, TimeHistory};
use nlmodes_timestep::{ModeShooting, TimestepError};
use thiserror::Error;

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
}

/// Equations of periodic motions, as a system for continuation.
pub(super) enum Periodic<'s> {
    Harmonics(Box<MixedShooting<'s>>),
    Exact(Box<ModeShooting>),
}

impl Periodic<'_> {
    /// Unknowns at grazing and the direction of growing amplitude.
    pub fn start(&self, grazing: &Grazing) -> (Vec<f64>, Vec<f64>) {
        match self {
            Self::Harmonics(problem) => {
                let (series, dim) = (problem.series(), problem.dim());
                (grazing.unknowns(series, dim), grazing.direction(series, dim))
            }
            Self::Exact(problem) => problem.start(),
        }
    }

    /// The problem in harmonics, if it is one.
    pub fn harmonics(&self) -> Option<&MixedShooting<'_>> {
        match self {
            Self::Harmonics(problem) => Some(problem),
            Self::Exact(_) => None,
        }
    }

    /// Index of the frequency among the unknowns.
    pub fn frequency_index(&self) -> usize {
        match self {
            Self::Harmonics(problem) => problem.frequency_index(),
            Self::Exact(problem) => problem.frequency_index(),
        }
    }

    /// Angular frequency of the unknowns `x`, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        match self {
            Self::Harmonics(problem) => problem.omega(x),
            Self::Exact(problem) => problem.omega(x),
        }
    }

    /// Iterations of the contact solver.
    pub fn contact_iterations(&self) -> usize {
        match self {
            Self::Harmonics(problem) => problem.contact_iterations(),
            Self::Exact(_) => 0,
        }
    }

    /// The point with the unknowns `x`; that of an exact motion may have more harmonics than were asked for.
    pub fn modal_point(&mut self, x: &[f64], residual: f64) -> Result<ModalPoint, PeriodicError> {
        Ok(match self {
            Self::Harmonics(problem) => problem.modal_point(x, residual)?,
            Self::Exact(problem) => problem.modal_point(x, residual)?,
        })
    }

    /// Motion and force of a contact over a period.
    pub fn time_history(
        &mut self,
        x: &[f64],
        contact: usize,
        samples: usize,
        label: &str,
    ) -> Result<TimeHistory, PeriodicError> {
        Ok(match self {
            Self::Harmonics(problem) => problem.time_history(x, contact, samples, label)?,
            Self::Exact(problem) => problem.time_history(x, contact, samples, label)?,
        })
    }
}

impl ParametricSystem for Periodic<'_> {
    type Error = PeriodicError;

    fn dim(&self) -> usize {
        match self {
            Self::Harmonics(problem) => problem.dim(),
            Self::Exact(problem) => problem.dim(),
        }
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), PeriodicError> {
        match self {
            Self::Harmonics(problem) => Ok(problem.linearize(x, p, out)?),
            Self::Exact(problem) => Ok(problem.linearize(x, p, out)?),
        }
    }

    fn pattern(&self) -> u64 {
        match self {
            Self::Harmonics(problem) => problem.pattern(),
            Self::Exact(problem) => problem.pattern(),
        }
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        match self {
            Self::Harmonics(problem) => problem.accepted(x, p),
            Self::Exact(problem) => problem.accepted(x, p),
        }
    }
}
