use num_complex::Complex64;

use super::ForcedStructure;
use crate::TimestepError;
use crate::error::{agrees, fits};

/// Degree of the polynomials by which loads are given piece by piece.
pub const DEGREE: usize = 11;

/// A load in time, in pieces: over each it is a polynomial.
pub trait Signal: Send + Sync {
    /// The piece that begins at an instant (s): the end of the piece before, the beginning of the motion, or any
    /// instant within a piece that continues.
    fn piece(&self, from: f64) -> SignalPiece;
}

/// `u(from + t) = Σ_j u_j t^j` until an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalPiece {
    /// `u_j`, in the unit of the load per s^j.
    pub coefficients: [f64; DEGREE + 1],
    /// Its end, s; infinite for what does not change any more.
    pub until: f64,
    /// Whether the next piece goes on where this one ends with all its derivatives: it may then be taken earlier, so
    /// that no step ends there.
    pub continues: bool,
}

impl SignalPiece {
    /// A value until an instant.
    pub fn constant(value: f64, until: f64) -> Self {
        let mut coefficients = [0.0; DEGREE + 1];
        coefficients[0] = value;
        Self { coefficients, until, continues: false }
    }
}

/// Where a load of any course in time acts.
#[derive(Debug, Clone)]
pub(super) struct Input {
    /// Modal forces and contributions to the gaps per unit of the load, m and c.
    pub modal: Vec<f64>,
    pub gaps: Vec<f64>,
}

/// A displacement that is observed: `Σ modes z + Σ contacts λ + Σ inputs u + F Σ Re(loads e^{inΩt})`.
#[derive(Debug, Clone)]
pub(super) struct Observed {
    pub modes: Vec<f64>,
    pub contacts: Vec<f64>,
    pub inputs: Vec<f64>,
    /// Empty where the periodic loads move nothing beyond the modes.
    pub loads: Vec<Complex64>,
}

impl ForcedStructure {
    /// Adds a load of any course in time: modal forces (m, √kg m/s² per unit of the load), and what it does to the gaps
    /// beyond the modes (c, m per unit). Its course is a [`Signal`] of the motion; in periodic motions it is zero.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`], [`TimestepError::NotFinite`].
    pub fn push_input(&mut self, modal: &[f64], gaps: &[f64]) -> Result<(), TimestepError> {
        fits("modal forces of the load", self.n_modes(), modal)?;
        fits("gaps of the load", self.n_contacts(), gaps)?;
        self.inputs.push(Input { modal: modal.to_vec(), gaps: gaps.to_vec() });
        let places = self.laws.iter_mut().map(|at| &mut at.place);
        self.observed.iter_mut().chain(places).for_each(|observed| observed.inputs.push(0.0));
        Ok(())
    }

    /// Adds a displacement that is observed in transient motions: of the modes (m), of contact forces beyond the modes
    /// (c, m/N), and of the inputs that are there (m per unit).
    ///
    /// # Errors
    /// [`TimestepError::Dimension`], [`TimestepError::NotFinite`].
    pub fn push_observed(&mut self, modes: &[f64], contacts: &[f64], inputs: &[f64]) -> Result<(), TimestepError> {
        fits("modes of an observed displacement", self.n_modes(), modes)?;
        fits("contacts of an observed displacement", self.n_contacts(), contacts)?;
        fits("loads of an observed displacement", self.inputs.len(), inputs)?;
        let (modes, contacts, inputs) = (modes.to_vec(), contacts.to_vec(), inputs.to_vec());
        self.observed.push(Observed { modes, contacts, inputs, loads: Vec::new() });
        Ok(())
    }

    /// Says how far each harmonic of the periodic load moves the observed displacement that was added last beyond the
    /// modes, m per unit of level, in the order in which they were pushed.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`].
    pub fn move_observed(&mut self, by_loads: &[Complex64]) -> Result<(), TimestepError> {
        let loads = self.moving(by_loads)?;
        self.observed.iter_mut().last().into_iter().for_each(|last| last.loads.clone_from(&loads));
        Ok(())
    }

    /// As [`move_observed`](Self::move_observed), of the place of the law that was added last.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`].
    pub fn move_law(&mut self, by_loads: &[Complex64]) -> Result<(), TimestepError> {
        let loads = self.moving(by_loads)?;
        self.laws.iter_mut().last().into_iter().for_each(|last| last.place.loads.clone_from(&loads));
        Ok(())
    }

    fn moving(&self, by_loads: &[Complex64]) -> Result<Vec<Complex64>, TimestepError> {
        agrees("harmonics of the load at a place", self.loads.len(), by_loads.len())?;
        Ok(by_loads.to_vec())
    }

    /// Sets modal forces that do not change in time (m, √kg m/s²).
    ///
    /// # Errors
    /// [`TimestepError::Dimension`], [`TimestepError::NotFinite`].
    pub fn set_steady_force(&mut self, modal: &[f64]) -> Result<(), TimestepError> {
        fits("modal steady forces", self.n_modes(), modal)?;
        self.steady = modal.to_vec();
        Ok(())
    }
}
