//! The linear frequency compared with that of the next finer mesh, and with the mass of the contacts.

use nlmodes::model::{MassShift, linear_modes};
use nlmodes_scene::assemble::element_model;
use nlmodes_scene::scene::{Scene, SceneStructure, Structure};

use super::{Check, Number};
use crate::mass::NOTABLE;

const MESH: &str = "mesh";
const MASS: &str = "contact mass";
const OF: Option<Number> = Some(Number::Frequency);
/// Most elements of the finer mesh: its modes take a fraction of a second.
const MOST: usize = 2000;

/// Change of the linear frequency of the mode with twice as many elements; contacts open, their mass kept.
pub fn frequency(scene: &Scene) -> Check {
    let limit = Number::Frequency.limit();
    let missing = |why: &str, how| Check::missing(MESH, OF, limit, why, how);
    let own = match &scene.structure {
        SceneStructure::Straight(own) => own,
        SceneStructure::Several(_) => return missing("there are several structures", "elements twice as many in each"),
        SceneStructure::Matrices(_) => {
            return missing("the structure comes from files", "a finer mesh in the program that wrote them");
        }
    };
    if own.modes.is_some() {
        return missing("frequencies are imposed on the modes", "the same scene without [structure.modes]");
    }
    let Some(finer) = own.with_twice_the_elements() else {
        return missing("parts stand at nodes that a finer mesh has elsewhere", "structure.elements twice as large");
    };
    if finer.elements > MOST {
        return missing("more than 1000 elements", "structure.elements twice as large");
    }
    let mode = scene.method.mode;
    match (omega(own, mode), omega(&finer, mode)) {
        (Some(coarse), Some(fine)) if fine > 0.0 => {
            let words = format!(
                "linear frequency of mode {mode} with {} elements for {}; forces were not compared. Says nothing where the elements are the structure, as in a chain of masses",
                finer.elements, own.elements
            );
            Check::found(MESH, OF, (coarse / fine - 1.0).abs(), limit, words)
        }
        _ => missing("the linear modes of the finer mesh were not found", "structure.elements twice as large"),
    }
}

fn omega(structure: &Structure, mode: usize) -> Option<f64> {
    let model = element_model(structure, &[]).ok()?;
    let found = linear_modes(model.mass(), model.stiffness(), mode).ok()?;
    found.omega.get(mode.checked_sub(1)?).copied()
}

/// Change of the linear frequency by the mass that the contacts lose.
pub(crate) fn contact_mass(shift: Option<MassShift>, is_in_open_modes: bool) -> Check {
    match shift {
        Some(shift) => {
            let words = format!("linear frequency of mode {} without the mass of the contact nodes", shift.mode);
            Check::found(MASS, OF, shift.relative().abs(), NOTABLE, words)
        }
        None if is_in_open_modes => Check::found(MASS, OF, 0.0, NOTABLE, "no mass is taken away"),
        None => {
            let why = "the frequency is one that was measured: imposed, or met by parameters";
            Check::missing(MASS, OF, NOTABLE, why, "the same scene without it")
        }
    }
}
