use crate::{FemError, Material, Mesh};

/// A part of a rod (`S` the area, m²) or beam (`S` its [`Section`](crate::Section)) with its own values, from the end
/// of the previous step, or from the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<S> {
    /// Node at which it ends.
    pub to_node: usize,
    /// Material.
    pub material: Material,
    /// Cross section.
    pub section: S,
    /// Mass per length `μ` in addition to that of the section, kg/m, such as a filling. It moves with the structure
    /// along and across the axis, and has no rotary inertia.
    pub added_mass: f64,
}

/// The step in which an element lies.
pub(crate) fn step_of<S>(steps: &[Step<S>], element: usize) -> Option<&Step<S>> {
    steps.iter().find(|step| element < step.to_node)
}

pub(crate) fn check_steps<S>(steps: &[Step<S>], mesh: &Mesh) -> Result<(), FemError> {
    let mut from = 0;
    for (step, found) in steps.iter().enumerate() {
        if found.to_node <= from || found.to_node > mesh.elements() {
            return Err(FemError::Step { step, from, to: found.to_node, last: mesh.elements() });
        }
        from = found.to_node;
        if !(found.added_mass >= 0.0 && found.added_mass.is_finite()) {
            return Err(FemError::AddedMass { step, value: found.added_mass });
        }
    }
    Ok(())
}
