use nlmodes_hbm::ModalDamping;
use nlmodes_linalg::Mat;

use crate::response::Weights;

/// Damping of a structure with its contacts open.
#[derive(Debug, Clone, PartialEq)]
pub enum Damping {
    /// Damping ratios mode by mode; the last one is repeated.
    Ratios(Vec<f64>),
    /// `C = mass M + stiffness K`, 1/s and s.
    Rayleigh {
        /// Factor of the mass, 1/s.
        mass: f64,
        /// Factor of the stiffness, s.
        stiffness: f64,
    },
    /// `Ĉ = Φᵀ C Φ` in the free-interface modes, m × m, symmetric, 1/s.
    Coupled(Mat<f64>),
}

/// A dashpot between a place of the structure and the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Dashpot {
    /// The displacement whose rate it damps, as degrees of freedom with weights.
    pub at: Weights,
    /// Its constant, N s/m.
    pub damping: f64,
}

impl Damping {
    /// Derivative of what damps a mode by its `ω²`, `dĉ/dω²` (s), where it is a function of that; none of damping that
    /// couples modes.
    pub(crate) fn slope(&self, mode: usize, omega_squared: f64) -> Option<f64> {
        match self {
            Self::Ratios(ratios) => {
                let ratio = ratios.get(mode).or(ratios.last()).copied().unwrap_or(0.0);
                Some(if omega_squared > 0.0 { ratio / omega_squared.sqrt() } else { 0.0 })
            }
            Self::Rayleigh { stiffness, .. } => Some(*stiffness),
            Self::Coupled(_) => None,
        }
    }

    pub(crate) fn modal(&self, omega_squared: &[f64]) -> ModalDamping {
        match self {
            Self::Ratios(ratios) => ModalDamping::ratios(omega_squared, ratios),
            Self::Rayleigh { mass, stiffness } => ModalDamping::rayleigh(omega_squared, *mass, *stiffness),
            Self::Coupled(all) => {
                let is_coupled = |(i, j): (usize, usize)| i != j && all[(i, j)] != 0.0;
                let (rows, columns) = (all.nrows(), all.ncols());
                match (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).any(is_coupled) {
                    true => ModalDamping::Full(all.clone()),
                    false => ModalDamping::Diagonal((0..rows.min(columns)).map(|k| all[(k, k)]).collect()),
                }
            }
        }
    }
}
