use crate::rig::RigError;
use crate::rig::error::{finite, not_negative, positive};

/// A linear structure in mass-normalised modal coordinates with modal damping.
///
/// ```text
/// q̈_k + 2 ζ_k ω_k q̇_k + ω_k² q_k = Σ_j φ_jk f_j
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinearStructure {
    /// Angular eigenfrequencies `ω_k` with all stops open, rad/s.
    pub omega: Vec<f64>,
    /// Damping ratios `ζ_k`.
    pub damping_ratios: Vec<f64>,
}

impl LinearStructure {
    /// Number of modes.
    pub fn modes(&self) -> usize {
        self.omega.len()
    }

    pub(crate) fn check(&self) -> Result<(), RigError> {
        if self.damping_ratios.len() != self.modes() || self.modes() == 0 {
            let what = "damping ratios".to_owned();
            return Err(RigError::ModeCount { what, modes: self.modes(), found: self.damping_ratios.len() });
        }
        self.omega.iter().try_for_each(|&ω| positive("eigenfrequency (rad/s)", ω).map(drop))?;
        self.damping_ratios.iter().try_for_each(|&ζ| not_negative("damping ratio", ζ).map(drop))
    }
}

/// The drive point.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivePoint {
    /// Position along the structure, m.
    pub position: f64,
    /// Mode shapes there, 1/√kg.
    pub shape: Vec<f64>,
    /// Residual flexibility of the truncated modes, m/N: `w = Σ_k φ_k q_k + residual · f`.
    ///
    /// The static flexibility of the point less `Σ_k φ_k² / ω_k²`. Zero neglects those modes altogether.
    pub residual: f64,
}

impl DrivePoint {
    pub(crate) fn check(&self, modes: usize) -> Result<(), RigError> {
        check_shape("shape at the drive point", &self.shape, modes)?;
        not_negative("residual flexibility at the drive point (m/N)", self.residual).map(drop)
    }
}

pub(crate) fn check_shape(what: &str, shape: &[f64], modes: usize) -> Result<(), RigError> {
    if shape.len() != modes {
        return Err(RigError::ModeCount { what: what.to_owned(), modes, found: shape.len() });
    }
    shape.iter().try_for_each(|&φ| finite("mode shape (1/√kg)", φ).map(drop))
}
