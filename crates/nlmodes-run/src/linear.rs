//! The linear modes of a scene, with and without the mass redistribution.

use std::f64::consts::TAU;

use nlmodes::model::{Drop, MasslessContactModel, StructuralModel, held_modes, linear_modes};
use serde::Serialize;

use crate::mass;
use nlmodes_scene::assemble::{StructureError, element_model, redistribution};
use nlmodes_scene::number;
use nlmodes_scene::scene::{Scene, Structure, StructureKind};

/// Modes of the table.
const COUNT: usize = 10;

/// Lowest linear frequencies, Hz.
#[derive(Debug, Clone, Default, Serialize)]
pub struct LinearFrequencies {
    /// Contacts open, contact mass kept.
    pub mass_kept: Vec<f64>,
    /// Contacts open, contact mass as the method has it, without the imposed frequencies of `[structure.modes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_the_elements: Option<Vec<f64>>,
    /// Contacts open, contact mass redistributed.
    pub mass_redistributed: Option<Vec<f64>>,
    /// Contacts held, contact mass redistributed.
    pub contacts_held: Option<Vec<f64>>,
    /// What a user should know about the mode that is computed, if it is moved by the mass that the contacts lose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_warning: Option<String>,
}

/// Computes the lowest frequencies of the scene's structure.
///
/// # Errors
/// [`StructureError`] if an eigenproblem cannot be solved.
pub fn linear_frequencies(scene: &Scene, model: &StructuralModel) -> Result<LinearFrequencies, StructureError> {
    let hertz = |omega: Vec<f64>| omega.into_iter().map(|ω| ω / TAU).collect::<Vec<f64>>();
    let mass_kept = hertz(linear_modes(model.mass(), model.stiffness(), COUNT)?.omega);
    if scene.is_in_open_modes() {
        let held = MasslessContactModel::new(model, &Drop)?;
        let contacts_held = Some(hertz(held_modes(&held, COUNT)?.omega));
        return Ok(LinearFrequencies { mass_kept, contacts_held, ..LinearFrequencies::default() });
    }
    let rule = redistribution(scene).filter(|_| !model.contacts().is_empty());
    let straight = scene.structure.straight();
    let of_the_elements = match straight.filter(|structure| structure.modes.is_some()) {
        Some(structure) => {
            let elements = element_model(structure, &scene.contacts)?;
            let redistributed = rule.map(|rule| rule.redistribute(&elements)).transpose()?;
            let mass = redistributed.as_ref().unwrap_or(elements.mass());
            Some(hertz(linear_modes(mass, elements.stiffness(), COUNT)?.omega))
        }
        None => None,
    };
    let Some(rule) = rule else {
        return Ok(LinearFrequencies { mass_kept, of_the_elements, ..LinearFrequencies::default() });
    };
    let massless = MasslessContactModel::new(model, rule)?;
    Ok(LinearFrequencies {
        mass_warning: mass::warning(scene, model, &massless)?,
        mass_kept,
        of_the_elements,
        mass_redistributed: Some(hertz(linear_modes(massless.mass(), massless.stiffness(), COUNT)?.omega)),
        contacts_held: Some(hertz(held_modes(&massless, COUNT)?.omega)),
    })
}

/// What a structure with imposed frequencies is, in a line: nobody should take it for that of the elements.
pub fn modal_model(structure: &Structure) -> Option<String> {
    let modes = structure.modes.as_ref()?;
    let list: Vec<String> = modes.frequencies_hz.iter().map(|hz| number(*hz)).collect();
    let kind = match structure.kind() {
        StructureKind::Rod => "axial",
        StructureKind::Beam => "bending",
    };
    let which = match list.len() {
        1 => format!("the lowest {kind} mode has its frequency"),
        n => format!("the lowest {n} {kind} modes have their frequencies"),
    };
    Some(format!("modal model: {which} imposed, {} Hz, on the shapes of the elements", list.join(", ")))
}
