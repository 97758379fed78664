//! Laws of force beside stops: springs and dampers whose force is a smooth function of displacement or velocity.

mod operator;
mod shapes;
mod start;
mod table;

use std::fmt::Debug;
use std::sync::Arc;

pub(crate) use operator::LawOperator;
pub use shapes::{Bilinear, Exponential, Polynomial, PowerDamper, PowerSpring};
pub use start::{ModeStart, law_length, modal_start};
pub use table::TableLaw;

use super::structure::ModalStructure;
use crate::HbmError;

/// The force of a law at one instant, with its derivatives.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LawForce {
    /// Force against the displacement, N.
    pub force: f64,
    /// Derivative with respect to the displacement, N/m.
    pub stiffness: f64,
    /// Derivative with respect to the velocity, N s/m.
    pub damping: f64,
}

/// A force `F(v, v̇)` that resists the displacement `v` of a place or of two places against each other.
pub trait ForceLaw: Send + Sync + Debug {
    /// The force at the displacement `v`, m, and the velocity `rate`, m/s.
    fn at(&self, v: f64, rate: f64) -> LawForce;

    /// Energy that is stored at the displacement `v`, J, zero at rest; zero for a law of the velocity.
    fn potential(&self, v: f64) -> f64;

    /// Degree of a polynomial law, for which a finite number of samples is exact; `None` for any other law.
    fn degree(&self) -> Option<usize> {
        None
    }

    /// Whether the force depends on the velocity.
    fn dissipates(&self) -> bool {
        false
    }
}

/// A law at its place: how the modes and the forces at contacts and other laws move it.
#[derive(Debug, Clone)]
pub struct PlacedLaw {
    /// The law.
    pub law: Arc<dyn ForceLaw>,
    /// Displacement of its place by the modes, m, 1/√kg.
    pub modes: Vec<f64>,
    /// Residual flexibility between the contacts and its place, c, m/N.
    pub contacts: Vec<f64>,
    /// Residual flexibility between the places of all laws and its own, m/N.
    pub laws: Vec<f64>,
}

impl ModalStructure {
    /// The same structure with these laws. Samples a period of laws that are no polynomials: `samples`, which harmonic
    /// balance takes at least fourfold its highest harmonic.
    ///
    /// # Errors
    /// [`HbmError::Size`] or [`HbmError::NotFinite`].
    pub fn with_laws(&self, laws: Vec<PlacedLaw>, samples: usize) -> Result<Self, HbmError> {
        for law in &laws {
            let sizes = [
                ("modes of a law", self.n_modes(), law.modes.len()),
                ("contacts of a law", self.n_contacts(), law.contacts.len()),
                ("places of a law", laws.len(), law.laws.len()),
            ];
            if let Some(&(what, expected, found)) = sizes.iter().find(|(_, expected, found)| expected != found) {
                return Err(HbmError::Size { what, expected, found });
            }
            if !law.modes.iter().chain(&law.contacts).chain(&law.laws).all(|v| v.is_finite()) {
                return Err(HbmError::NotFinite { what: "the place of a law" });
            }
        }
        Ok(Self { laws, law_samples: samples, ..self.clone() })
    }

    /// The laws beside the stops.
    pub fn laws(&self) -> &[PlacedLaw] {
        &self.laws
    }

    /// Number of places whose static displacement a load tells: the contacts, and the laws behind them.
    pub fn n_places(&self) -> usize {
        self.n_contacts() + self.laws.len()
    }

    /// The same structure without what dissipates.
    pub(crate) fn conservative(&self) -> Result<Self, HbmError> {
        let mut structure = self.with_damping(super::damping::ModalDamping::none(self.n_modes()))?;
        let kept: Vec<usize> = (0..self.laws.len()).filter(|&l| !self.laws[l].law.dissipates()).collect();
        let of = |l: &usize| PlacedLaw {
            laws: kept.iter().map(|&other| self.laws[*l].laws[other]).collect(),
            ..self.laws[*l].clone()
        };
        structure.laws = kept.iter().map(of).collect();
        Ok(structure)
    }
}
