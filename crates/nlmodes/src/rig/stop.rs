use nlmodes_model::{ContactLaw, Side};

use crate::rig::RigError;
use crate::rig::error::{finite, not_negative, positive};
use crate::rig::structure::check_shape;

/// A one-sided stop.
///
/// The contact point of the structure is at `w = Σ_k φ_k q_k − side · R λ`, with the contact force `λ` and the residual
/// flexibility `R` of the truncated modes, including that of a massless contact node. Contact is therefore the
/// quasi-static complementarity problem of eqs. (11) and (13),
///
/// ```text
/// 0 ≤ g_0 − side · Σ_k φ_k q_k + A λ  ⊥  λ ≥ 0 ,     A = R (rigid) ,   A = R + 1/k_c (elastic)
/// ```
///
/// with the solution `λ = max(0, side · Σ_k φ_k q_k − g_0) / A`. For a finite element model with a massless contact
/// node and all of its modes, `R = 1/K_NN`.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Position along the structure, m.
    pub position: f64,
    /// Mode shapes there, 1/√kg.
    pub shape: Vec<f64>,
    /// Side of the stop.
    pub side: Side,
    /// Gap at rest `g_0`, m. Negative: preloaded.
    pub gap: f64,
    /// Rigid, or elastic.
    pub law: ContactLaw,
    /// Residual flexibility `R`, m/N: static flexibility of the point less `Σ_k φ_k² / ω_k²`. A rigid stop needs it.
    pub residual: f64,
}

impl Stop {
    /// `A`, m/N.
    pub(crate) fn flexibility(&self) -> f64 {
        self.residual + self.law.compliance()
    }

    pub(crate) fn check(&self, modes: usize) -> Result<(), RigError> {
        check_shape("shape at the stop", &self.shape, modes)?;
        finite("gap (m)", self.gap)?;
        match self.law {
            ContactLaw::Elastic { stiffness } => {
                positive("stiffness of the stop (N/m)", stiffness)?;
                not_negative("residual flexibility at the stop (m/N)", self.residual)?;
            }
            ContactLaw::Rigid if self.residual > 0.0 && self.residual.is_finite() => {}
            ContactLaw::Rigid => return Err(RigError::RigidStopWithoutFlexibility { residual: self.residual }),
        }
        Ok(())
    }
}
