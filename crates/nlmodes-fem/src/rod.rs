use nalgebra::Matrix2;
use nlmodes_model::{DofKind, StructuralModel};

use crate::assembly::{Layout, assemble};
use crate::error::positive;
use crate::step::{check_steps, step_of};
use crate::{ElementMatrices, FemError, MassMatrix, Material, Mesh, Step, Stop, Support};

/// A straight rod that moves along its axis: `ρA ü = E A u″`.
///
/// ```
/// use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
/// use nlmodes_model::Side;
/// let rod = Rod {
///     material: Material::new(210e9, 9000.0)?,
///     area: 1.0,
///     mesh: Mesh::uniform(20.0, 100)?,
///     mass_matrix: MassMatrix::Consistent,
///     start: Support::Clamped,
///     end: Support::Free,
/// };
/// let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5);
/// let model = rod.assemble(&[stop])?;
/// assert_eq!((model.dofs().len(), model.contacts()[0].normal.entries()), (100, &[(99, -1.0)][..]));
/// # Ok::<(), nlmodes_fem::FemError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rod {
    /// Material.
    pub material: Material,
    /// Cross-section area `A`, m².
    pub area: f64,
    /// Nodes.
    pub mesh: Mesh,
    /// Consistent or lumped.
    pub mass_matrix: MassMatrix,
    /// Support at `x = 0`.
    pub start: Support,
    /// Support at `x = L`.
    pub end: Support,
}

impl Rod {
    /// Mass and stiffness of the free degrees of freedom, one per node, with the stops as contacts.
    ///
    /// # Errors
    /// [`FemError::NotPositive`] for the area, [`FemError::NoSuchDirection`] for a transverse stop,
    /// [`FemError::NotANode`], [`FemError::HeldDof`], [`FemError::NothingMoves`], [`FemError::Model`] (a gap that is
    /// not finite).
    pub fn assemble(&self, stops: &[Stop]) -> Result<StructuralModel, FemError> {
        self.assemble_stepped(&[], stops)
    }

    /// The same with the material, area and added mass of each step; beyond the last step they are those of the rod.
    ///
    /// # Errors
    /// As [`Rod::assemble`]; [`FemError::NotPositive`] for an area, [`FemError::AddedMass`], [`FemError::Step`].
    pub fn assemble_stepped(&self, steps: &[Step<f64>], stops: &[Stop]) -> Result<StructuralModel, FemError> {
        positive("cross-section area", self.area)?;
        check_steps(steps, &self.mesh)?;
        for step in steps {
            positive("cross-section area", step.section)?;
        }
        let layout = Layout {
            mesh: &self.mesh,
            kinds: &[DofKind::Axial],
            supports: [self.start, self.end],
            holds: Support::holds_of_rod,
        };
        assemble(&layout, stops, |element, length| match step_of(steps, element) {
            Some(step) => with_added_mass(&step.material, step.section, step.added_mass, length, self.mass_matrix),
            None => rod_element(&self.material, self.area, length, self.mass_matrix),
        })
    }
}

/// Two-node rod element of length `l`, with linear displacement between its nodes:
///
/// ```text
/// K = E A / l [1 −1; −1 1] ,   M = ρ A l / 6 [2 1; 1 2]  or  ρ A l / 2 [1 0; 0 1] .
/// ```
///
/// Frequencies converge with the square of `l`: from above with the consistent mass, from below with the lumped one.
pub fn rod_element(material: &Material, area: f64, length: f64, mass_matrix: MassMatrix) -> ElementMatrices<2> {
    with_added_mass(material, area, 0.0, length, mass_matrix)
}

/// [`rod_element`] with `ρA + μ` in place of `ρA`.
pub(crate) fn with_added_mass(
    material: &Material,
    area: f64,
    added_mass: f64,
    length: f64,
    mass_matrix: MassMatrix,
) -> ElementMatrices<2> {
    let mass = (material.density() * area + added_mass) * length;
    ElementMatrices {
        stiffness: Matrix2::new(1.0, -1.0, -1.0, 1.0) * (material.youngs_modulus() * area / length),
        mass: match mass_matrix {
            MassMatrix::Consistent => Matrix2::new(2.0, 1.0, 1.0, 2.0) * (mass / 6.0),
            MassMatrix::Lumped => Matrix2::identity() * (mass / 2.0),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn translation_strains_nothing_and_carries_the_whole_mass() {
        let material = Material::new(3.0, 5.0).unwrap();
        for kind in [MassMatrix::Consistent, MassMatrix::Lumped] {
            let element = rod_element(&material, 0.5, 0.25, kind);
            let one = Vector2::new(1.0, 1.0);
            assert_eq!(element.stiffness * one, Vector2::zeros());
            assert!((one.dot(&(element.mass * one)) - 5.0 * 0.5 * 0.25).abs() < 1e-15);
            assert_eq!((element.stiffness, element.mass), (element.stiffness.transpose(), element.mass.transpose()));
        }
    }

    #[test]
    fn a_stretch_by_one_needs_the_force_of_the_spring() {
        let material = Material::new(3.0, 5.0).unwrap();
        let force = rod_element(&material, 0.5, 0.25, MassMatrix::Consistent).stiffness * Vector2::new(0.0, 1.0);
        assert_eq!(force, Vector2::new(-6.0, 6.0));
    }
}
