use std::sync::Arc;

use nlmodes_linalg::{Mat, SparseMatrix, sparse_from_triplets};
use nlmodes_model::reduction::{ModeCount, OpenModes};
use nlmodes_model::{Dof, DofKind};

use crate::rig::{DrivePoint, RigError};

/// A component is at rest if it is below this fraction of the largest one of the mode.
const REST: f64 = 1e-9;

/// A finite-element structure with open contacts, reduced to its lowest modes and the static flexibility of the others:
/// [`OpenModes`] without contacts, restricted to the modes in which the measured coordinates move.
///
/// A point of the structure is a list of degrees of freedom with weights, `w = Σ weight · q`. Its shape is
/// `φ_k = Σ weight · Φ_k`, its residual flexibility `pᵀ K⁻¹ p − Σ_k φ_k² / ω_k²` with `p` the weights as a load. With
/// massless contact nodes ([`MasslessContactModel`], mass `M_R`) the residual at a contact contains the flexibility
/// `1/K_NN` of its node: what a rigid [`Stop`](crate::rig::Stop) needs.
///
/// [`MasslessContactModel`]: nlmodes_model::MasslessContactModel
#[derive(Debug, Clone)]
pub struct ModalReduction {
    omega: Vec<f64>,
    open: OpenModes,
    /// Columns of the modes that are kept.
    kept: Vec<usize>,
}

impl ModalReduction {
    /// The lowest `count` modes in which degrees of freedom of this kind move.
    ///
    /// # Errors
    /// [`RigError::Reduction`] or [`RigError::Statics`] if modes or static deflections cannot be computed,
    /// [`RigError::TooFewModes`].
    pub fn new(
        mass: &SparseMatrix,
        stiffness: &SparseMatrix,
        dofs: &[Dof],
        kind: DofKind,
        count: usize,
    ) -> Result<Self, RigError> {
        let (mass, stiffness) = (Arc::new(mass.clone()), Arc::new(stiffness.clone()));
        let nothing = sparse_from_triplets(dofs.len(), 0, &[])?;
        // There are modes of other kinds in between: twice the number is nearly always enough.
        let mut wanted = (2 * count + 4).min(dofs.len());
        loop {
            let modes = ModeCount::Lowest(wanted);
            let open =
                OpenModes::new(Arc::clone(&mass), Arc::clone(&stiffness), nothing.clone(), vec![], vec![], modes)?;
            let mut kept: Vec<usize> = (0..open.n_modes()).filter(|&k| moves(open.shapes(), k, dofs, kind)).collect();
            if kept.len() >= count {
                kept.truncate(count);
                let omega = kept.iter().map(|&k| open.omega_squared()[k].sqrt()).collect();
                // Modes of other kinds do not move the points.
                let open = open.truncated(kept.last().map_or(1, |last| last + 1))?;
                return Ok(Self { omega, open, kept });
            }
            if wanted == dofs.len() {
                return Err(RigError::TooFewModes { wanted: count, found: kept.len() });
            }
            wanted = (2 * wanted).min(dofs.len());
        }
    }

    /// Angular eigenfrequencies, rad/s.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Mass-normalised shapes at a point, 1/√kg.
    ///
    /// # Panics
    /// If a degree of freedom does not exist.
    pub fn shape(&self, point: &[(usize, f64)]) -> Vec<f64> {
        let of = |&k: &usize| point.iter().map(|&(dof, weight)| weight * self.open.shapes()[(dof, k)]).sum();
        self.kept.iter().map(of).collect()
    }

    /// Residual flexibility at a point, m/N. Zero to rounding if no mode was truncated.
    ///
    /// A point between nodes loads them by its weights: the deformation of the element between its nodes is not
    /// included.
    ///
    /// # Panics
    /// If a degree of freedom does not exist.
    pub fn residual(&self, point: &[(usize, f64)]) -> f64 {
        let mut load = Mat::zeros(self.open.n_dofs(), 1);
        point.iter().for_each(|&(dof, weight)| load[(dof, 0)] += weight);
        let answer = self.open.residual_answer(load);
        let residual: f64 = point.iter().map(|&(dof, weight)| weight * answer[(dof, 0)]).sum();
        residual.max(0.0)
    }

    /// The point as a drive point; `position` in m.
    pub fn drive_point(&self, position: f64, point: &[(usize, f64)]) -> DrivePoint {
        DrivePoint { position, shape: self.shape(point), residual: self.residual(point) }
    }
}

fn moves(shapes: &Mat<f64>, k: usize, dofs: &[Dof], kind: DofKind) -> bool {
    let largest = |of: &dyn Fn(&Dof) -> bool| {
        let components = dofs.iter().enumerate().filter(|(_, dof)| of(dof)).map(|(i, _)| shapes[(i, k)].abs());
        components.fold(0.0, f64::max)
    };
    largest(&|dof| dof.kind == kind) > REST * largest(&|_| true)
}
