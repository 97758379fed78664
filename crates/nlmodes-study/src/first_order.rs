//! What gradients say of a study: the first-order spread of each quantity, the worst corners of the box of tolerances,
//! and how much of the tolerances keeps a quantity to its limit.
//!
//! ```text
//! q(x) ≈ q(x̄) + Σ g_i (x_i − x̄_i) ,   σ_q² = Σ (g_i σ_i)²          independent tolerances, g at the means x̄
//! largest corner: x_i at the upper end where g_i > 0, else at the lower one
//! ```
//!
//! One case with the means and gradients; corners, and what limits need, are verified by a case each. All of them are
//! in the store like any other case.

mod corner;
mod limit;
mod spread;
mod stored;

pub use corner::Corner;
pub use limit::Kept;
pub use spread::{Compared, Effect};
pub use stored::{read, resolved, stored};

use serde::Serialize;

use crate::curve::{Curve, Picked, derivatives, pick};
use crate::distribution::Tolerance;
use crate::error::StudyError;
use crate::statistics::Statistics;
use crate::study::{Quantity, Study};

/// What gradients say of a study.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct FirstOrder {
    /// Why there is nothing; none where there is.
    pub reason: Option<String>,
    /// The case with the variables at their means.
    pub case: Option<String>,
    /// Of each quantity.
    pub quantities: Vec<OfQuantity>,
}

/// What gradients say of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfQuantity {
    /// Its name.
    pub quantity: String,
    /// Why it has no gradients; none where it has.
    pub reason: Option<String>,
    /// Its value at the means.
    pub value: Option<f64>,
    /// Its first-order standard deviation.
    pub std: Option<f64>,
    /// What each variable does.
    pub effects: Vec<Effect>,
    /// The standard deviation of the cases of a sampled design beside it.
    pub of_cases: Option<Compared>,
    /// Its largest and its smallest corner.
    pub corners: Vec<Corner>,
    /// How much of the tolerances keeps it to its limit.
    pub limit: Option<Kept>,
}

/// A further case of a study: its curves, or why there are none.
#[derive(Debug)]
pub enum Further {
    /// Its curves.
    Found {
        /// Name of its directory.
        id: String,
        /// The curves.
        curve: Box<Curve>,
    },
    /// It is not there yet.
    Missing,
    /// It has none, for this reason.
    Failed(String),
}

/// What comes of the case with these values of the variables, in their order.
///
/// # Errors
/// [`StudyError`] if it cannot be written.
pub type Cases<'a> = dyn FnMut(&[f64]) -> Result<Further, StudyError> + 'a;

/// The study with its tolerances, at which things are computed.
pub struct Within<'a> {
    /// The study.
    pub study: &'a Study,
    /// Of each variable.
    pub tolerances: Vec<Tolerance>,
}

/// A quantity at a point of the box, with its derivative by each variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The value.
    pub value: f64,
    /// The derivatives.
    pub by: Vec<f64>,
}

impl FirstOrder {
    /// What gradients say of the study, from cases that are there or are computed; none where it is not asked.
    ///
    /// # Errors
    /// [`StudyError`] where a case cannot be written.
    pub fn of(study: &Study, statistics: &[Statistics], cases: &mut Cases<'_>) -> Result<Option<Self>, StudyError> {
        if !study.design.first_order {
            return Ok(None);
        }
        let none = |reason: String| Ok(Some(Self { reason: Some(reason), ..Self::default() }));
        let tolerances = study.variables.iter().map(|variable| Tolerance::of(variable, &study.design));
        let tolerances: Vec<Tolerance> = match tolerances.collect() {
            Ok(tolerances) => tolerances,
            Err(reason) => return none(reason),
        };
        let means: Vec<f64> = tolerances.iter().map(|tolerance| tolerance.mean).collect();
        let (id, curve) = match cases(&means)? {
            Further::Found { id, curve } => (id, curve),
            Further::Missing => return none("the case with the means is not computed yet".to_owned()),
            Further::Failed(reason) => return none(reason),
        };
        let within = Within { study, tolerances };
        let mut quantities = Vec::new();
        for (k, quantity) in study.quantities.iter().enumerate() {
            quantities.push(within.quantity(quantity, &curve, statistics.get(k), cases)?);
        }
        Ok(Some(Self { reason: None, case: Some(id), quantities }))
    }
}

/// Derivatives of a quantity of a curve by the variables: those by the keys of each, added.
///
/// # Errors
/// Why it has no derivatives.
pub fn slope(study: &Study, quantity: &Quantity, curve: &Curve) -> Result<Vec<f64>, String> {
    let of = |keys: &Vec<String>| Ok(derivatives(curve, quantity, keys)?.iter().sum());
    study.variables.iter().map(|variable| of(&variable.keys)).collect()
}

impl Within<'_> {
    fn quantity(
        &self,
        quantity: &Quantity,
        curve: &Curve,
        statistics: Option<&Statistics>,
        cases: &mut Cases<'_>,
    ) -> Result<OfQuantity, StudyError> {
        let value = self.value(quantity, curve);
        let mut of = OfQuantity {
            quantity: quantity.name.clone(),
            reason: None,
            value,
            std: None,
            effects: Vec::new(),
            of_cases: None,
            corners: Vec::new(),
            limit: None,
        };
        match self.slope(quantity, curve) {
            Ok(slope) => {
                (of.std, of.effects) = spread::effects(self, &slope, statistics);
                of.of_cases = spread::compared(self.study, (slope.value, of.std), statistics);
                of.corners = corner::both(self, (quantity, &slope), cases)?;
                of.limit = limit::kept(self, (quantity, &slope), &of.corners, cases)?;
            }
            Err(reason) => of.reason = Some(reason),
        }
        Ok(of)
    }

    /// A quantity of a curve; none where it is not there.
    pub fn value(&self, quantity: &Quantity, curve: &Curve) -> Option<f64> {
        match pick(curve, quantity) {
            Picked::Value { value, .. } => Some(value),
            Picked::Missing(_) => None,
        }
    }

    /// A quantity of a curve with its derivatives by the variables.
    ///
    /// # Errors
    /// Why it has no derivatives.
    pub fn slope(&self, quantity: &Quantity, curve: &Curve) -> Result<Slope, String> {
        match pick(curve, quantity) {
            Picked::Value { value, .. } => Ok(Slope { value, by: slope(self.study, quantity, curve)? }),
            Picked::Missing(reason) => Err(reason),
        }
    }

    /// The quantity by its slope at the means, where the variables have these values.
    pub fn predicted(&self, slope: &Slope, at: &[f64]) -> f64 {
        let moved = slope.by.iter().zip(at).zip(&self.tolerances);
        slope.value + moved.map(|((by, x), tolerance)| by * (x - tolerance.mean)).sum::<f64>()
    }
}
