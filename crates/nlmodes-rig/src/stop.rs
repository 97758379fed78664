use crate::RigError;
use crate::error::{finite, not_negative, positive};
use crate::structure::check_shape;

/// The side of the structure on which a stop stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StopSide {
    /// Touched by a positive displacement.
    Positive,
    /// Touched by a negative displacement.
    Negative,
}

impl StopSide {
    /// +1 or −1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// What happens behind the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StopLaw {
    /// A spring, eq. (3).
    Compliant {
        /// Stiffness `k_c`, N/m.
        stiffness: f64,
    },
    /// Complementarity with a massless contact node, eqs. (5), (13): nothing is penetrated, and no parameter is needed.
    Hard,
}

/// A one-sided stop.
///
/// The point of the structure that meets it stands at `w = Σ_k φ_k q_k − side · R λ`, with `λ` the contact force and `R` the residual
/// flexibility: what the modes that were left out, among them that of a massless contact node, yield statically. So contact is the
/// quasi-static complementarity problem of eqs. (11) and (13),
///
/// ```text
/// 0 ≤ g = g_0 − side · Σ_k φ_k q_k + A λ  ⊥  λ ≥ 0 ,     A = R (hard) ,   A = R + 1/k_c (compliant)
/// ```
///
/// with the solution `λ = max(0, side · Σ_k φ_k q_k − g_0) / A`. For a finite element model with a massless contact node and all of
/// its modes, `R = 1/K_NN`.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Position along the structure, m.
    pub position: f64,
    /// Mode shapes there, 1/√kg.
    pub shape: Vec<f64>,
    /// Side on which it stands.
    pub side: StopSide,
    /// Gap at rest `g_0`, m. A negative one presses.
    pub gap: f64,
    /// Spring or hard.
    pub law: StopLaw,
    /// Residual flexibility `R`, m/N: static flexibility of the point less `Σ_k φ_k² / ω_k²`. A hard stop needs it.
    pub residual: f64,
}

impl Stop {
    /// `A`, m/N.
    pub(crate) fn flexibility(&self) -> f64 {
        match self.law {
            StopLaw::Compliant { stiffness } => self.residual + 1.0 / stiffness,
            StopLaw::Hard => self.residual,
        }
    }

    pub(crate) fn check(&self, modes: usize) -> Result<(), RigError> {
        check_shape("shape at the stop", &self.shape, modes)?;
        finite("gap (m)", self.gap)?;
        match self.law {
            StopLaw::Compliant { stiffness } => {
                positive("stiffness of the stop (N/m)", stiffness)?;
                not_negative("residual flexibility at the stop (m/N)", self.residual)?;
            }
            StopLaw::Hard if self.residual > 0.0 && self.residual.is_finite() => {}
            StopLaw::Hard => return Err(RigError::HardStopWithoutFlexibility { residual: self.residual }),
        }
        Ok(())
    }
}
