//! Laws of force beside stops: springs and dampers whose force is a smooth function of displacement or velocity.

mod hertz;
mod operator;
mod rest;
mod shapes;
mod start;
mod table;
mod touches;

use std::fmt::Debug;
use std::sync::Arc;

pub use hertz::HertzStop;
pub(crate) use operator::{LawOperator, StopMotion};
pub use rest::{LawAtRest, about_rest_of_law, laws_at_rest};
pub use shapes::{Bilinear, Exponential, Polynomial, PowerDamper, PowerSpring};
pub use start::{ModeStart, UNIT_ENERGY, law_length, modal_start};
pub use table::TableLaw;
pub use touches::touch_spans;
pub(crate) use touches::value as law_value;

use super::structure::ModalStructure;
use crate::HbmError;
use crate::error::agrees;

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

    /// What a law that dissipates leaves where nothing does; `None` where nothing is left.
    fn without_dissipation(&self) -> Option<Arc<dyn ForceLaw>> {
        None
    }

    /// Clearance at rest of a law that is a stop, m: it pushes, and not before `v` is greater. `None` of any other law.
    fn stop_gap(&self) -> Option<f64> {
        None
    }

    /// A law that is a stop, as seen from a place that is so much nearer to it, m: with what is left of its clearance,
    /// negative where it presses there. `None` of any other law.
    fn stop_moved(&self, by: f64) -> Option<Arc<dyn ForceLaw>> {
        let _ = by;
        None
    }

    /// The force, N; of a stop as it goes on beyond the end of its touch, so that a slightly other one, which is left a
    /// little earlier, differs smoothly.
    fn continued(&self, v: f64, rate: f64) -> f64 {
        self.at(v, rate).force
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
            agrees("modes of a law", self.n_modes(), law.modes.len())?;
            agrees("contacts of a law", self.n_contacts(), law.contacts.len())?;
            agrees("places of a law", laws.len(), law.laws.len())?;
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

    /// The laws that are stops, which motions tell as contacts behind those of the structure.
    pub fn law_stops(&self) -> impl Iterator<Item = &PlacedLaw> {
        self.laws.iter().filter(|placed| placed.law.stop_gap().is_some())
    }

    /// Number of places whose static displacement a load tells: the contacts, and the laws behind them.
    pub fn n_places(&self) -> usize {
        self.n_contacts() + self.laws.len()
    }

    /// The same structure without what dissipates.
    ///
    /// # Errors
    /// [`HbmError::Size`], not for the damping of none.
    pub fn conservative(&self) -> Result<Self, HbmError> {
        let mut structure = self.with_damping(super::damping::ModalDamping::none(self.n_modes()))?;
        structure.laws.iter_mut().for_each(|placed| placed.law = conservative(&placed.law));
        Ok(structure)
    }
}

/// What a law does where nothing dissipates: one without a force keeps the place of a law of which nothing is left.
pub(super) fn conservative(law: &Arc<dyn ForceLaw>) -> Arc<dyn ForceLaw> {
    match law.dissipates() {
        false => law.clone(),
        true => law.without_dissipation().unwrap_or_else(|| Arc::new(Polynomial { coefficients: Vec::new() })),
    }
}
