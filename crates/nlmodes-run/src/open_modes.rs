//! The linear modes with open contacts, which several results are made from.

use nlmodes::model::{LinearModes, MasslessContactModel, ModelError, StructuralModel, linear_modes, open_modes};
use nlmodes_scene::scene::Scene;

/// Modes of the table.
pub(crate) const LISTED: usize = 10;

/// Linear modes with the contacts open: what the frequencies, the warning of the mass that contacts lose and the
/// participation are made from, solved once.
#[derive(Debug, Clone)]
pub struct OpenLinearModes {
    /// The modes with the mass of the contacts.
    pub kept: LinearModes,
    /// The modes of the model that the method works on.
    pub own: LinearModes,
}

impl OpenLinearModes {
    /// Of the structure of a scene, and of the model of it that the method works on.
    ///
    /// # Errors
    /// [`ModelError`] if an eigenproblem cannot be solved.
    pub fn new(scene: &Scene, model: &StructuralModel, massless: &MasslessContactModel) -> Result<Self, ModelError> {
        let count = LISTED.max(scene.method.mode);
        Ok(Self { kept: linear_modes(model.mass(), model.stiffness(), count)?, own: open_modes(massless, count)? })
    }
}
