use nlmodes_model::{Dof, DofKind};

use crate::timoshenko::shear_parameter;
use crate::{Beam, FemError, Mesh, Rod};

impl Beam {
    /// The deflection at any `position` (m), as a weighted sum of the degrees of freedom `dofs` of the assembled model:
    /// pairs of index and weight.
    ///
    /// The weights are the static shape functions of the element, with `s = (x − x_1)/l` and the shear parameter `Φ`:
    ///
    /// ```text
    /// w_1: (1 + Φ (1 − s) − 3s² + 2s³) / (1 + Φ)     φ_1: l (s³ − (2 + Φ/2) s² + (1 + Φ/2) s) / (1 + Φ)
    /// w_2: (Φ s + 3s² − 2s³) / (1 + Φ)               φ_2: l (s³ − (1 − Φ/2) s² − Φ/2 s) / (1 + Φ)
    /// ```
    ///
    /// A force at this position has these weights as nodal loads, and a sensor there measures `Σ weight · q`.
    ///
    /// # Errors
    /// [`FemError::OutsideMesh`].
    pub fn deflection_at(&self, dofs: &[Dof], position: f64) -> Result<Vec<(usize, f64)>, FemError> {
        let (element, s, l) = locate(&self.mesh, position)?;
        let p = shear_parameter(&self.material, &self.section, l);
        let (s2, s3) = (s * s, s * s * s);
        let scale = 1.0 / (1.0 + p);
        let weights = [
            (element, DofKind::Deflection, 1.0 + p * (1.0 - s) - 3.0 * s2 + 2.0 * s3),
            (element, DofKind::Rotation, l * (s3 - (2.0 + 0.5 * p) * s2 + (1.0 + 0.5 * p) * s)),
            (element + 1, DofKind::Deflection, p * s + 3.0 * s2 - 2.0 * s3),
            (element + 1, DofKind::Rotation, l * (s3 - (1.0 - 0.5 * p) * s2 - 0.5 * p * s)),
        ];
        Ok(of_free_dofs(dofs, weights.map(|(node, kind, weight)| (node, kind, scale * weight))))
    }
}

impl Rod {
    /// The axial displacement at any `position` (m), as a weighted sum of the degrees of freedom `dofs` of the
    /// assembled model: linear between the nodes.
    ///
    /// # Errors
    /// [`FemError::OutsideMesh`].
    pub fn displacement_at(&self, dofs: &[Dof], position: f64) -> Result<Vec<(usize, f64)>, FemError> {
        let (element, s, _) = locate(&self.mesh, position)?;
        Ok(of_free_dofs(dofs, [(element, DofKind::Axial, 1.0 - s), (element + 1, DofKind::Axial, s)]))
    }
}

/// The element that contains `position`, the fraction of it before the position, and its length.
fn locate(mesh: &Mesh, position: f64) -> Result<(usize, f64, f64), FemError> {
    // A position that equals an end to rounding is that end.
    let asked = mesh.find_node(position).map_or(position, |node| mesh.nodes()[node]);
    if !(0.0..=mesh.length()).contains(&asked) {
        return Err(FemError::OutsideMesh { asked: position, length: mesh.length() });
    }
    let after = mesh.nodes().partition_point(|x| *x <= asked).min(mesh.elements());
    let l = mesh.element_lengths()[after - 1];
    Ok((after - 1, (asked - mesh.nodes()[after - 1]) / l, l))
}

/// Fixed degrees of freedom do not move and are left out.
fn of_free_dofs<const N: usize>(dofs: &[Dof], weights: [(usize, DofKind, f64); N]) -> Vec<(usize, f64)> {
    let index = |node, kind| dofs.iter().position(|dof| dof.node == node && dof.kind == kind);
    let free = weights.into_iter().filter_map(|(node, kind, weight)| Some((index(node, kind)?, weight)));
    free.filter(|(_, weight)| *weight != 0.0).collect()
}
