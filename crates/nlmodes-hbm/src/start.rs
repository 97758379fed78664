use std::f64::consts::TAU;

use nlmodes_linalg::max_norm;
use nlmodes_model::reduction::{OpenModes, RestState};
use nlmodes_model::{DofKind, MasslessContactModel};

use crate::periodic::{
    ModalStructure, ModeAtRest, STRAINLESS, modal_grazing_opened, modal_lift_off_opened, unless_touching,
};
use crate::{CondensedStructure, Grazing, HbmError};

/// Modes behind one that moves no contact among which the next one that does is sought.
const LOOKED_AT: usize = 10;

/// The grazing point of linear mode `mode` (from 1).
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`] or [`HbmError::TouchesAtRest`].
pub fn grazing(structure: &CondensedStructure, mode: usize) -> Result<Grazing, HbmError> {
    unless_touching(&structure.modal, grazing_opened(structure, mode, 1.0)?)
}

/// As [`grazing`], also where contacts touch at rest without force: these are set back by [`Grazing::opening`].
///
/// The motion has half the amplitude at which another contact would change its state, and where there is no such
/// contact the averaged kinetic energy `energy`, J: before contacts that all touch at rest, motions can be multiplied
/// by any positive number.
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`] or [`HbmError::NeverTouches`].
pub fn grazing_opened(structure: &CondensedStructure, mode: usize, energy: f64) -> Result<Grazing, HbmError> {
    // At rest and in its linear modes, what answers statically does so in harmonics and at each instant alike.
    let modal = structure.statically();
    let pressed = modal.is_pressed().then(|| structure.rest()).transpose()?;
    let begin = |mode: usize| match &pressed {
        None => modal_grazing_opened(modal, mode, energy),
        Some(rest) => about_rest(&structure.open, modal, rest, mode, energy),
    };
    let found = begin(mode).and_then(|start| structure.with_static_motion(start, pressed.as_ref()));
    found.map_err(|error| match error {
        HbmError::NeverTouches { mode, frequency_hz, .. } if !has_mass_behind_contacts(&structure.model) => {
            HbmError::NoMassBehindContacts { mode, frequency_hz }
        }
        HbmError::NeverTouches { mode, frequency_hz, ratio, is_pressed, .. } => {
            let next = (mode + 1..=mode + LOOKED_AT).find_map(|next| begin(next).ok());
            let first = next.map(|next| (next.mode, next.omega / TAU));
            HbmError::NeverTouches { mode, frequency_hz, ratio, is_pressed, first }
        }
        error => error,
    })
}

/// The linear mode `mode` (from 1) about a rest at which some stops are closed, where the first contact is about to
/// change its state; as [`modal_lift_off_opened`].
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`], or what the reduction reports.
pub fn about_rest(
    open: &OpenModes,
    structure: &ModalStructure,
    rest: &RestState,
    mode: usize,
    energy: f64,
) -> Result<Grazing, HbmError> {
    let modes = open.closed_modes(&rest.closed)?;
    let available = modes.omega_squared.len();
    let Some(k) = mode.checked_sub(1).filter(|k| *k < available) else {
        return Err(HbmError::NoSuchMode { mode, available });
    };
    let largest = max_norm(open.omega_squared().iter().copied());
    let vibrates = |square: &f64| *square > STRAINLESS * largest;
    let omega_squared = modes.omega_squared[k];
    if !vibrates(&omega_squared) {
        let first_elastic = modes.omega_squared.iter().position(vibrates).map(|k| k + 1);
        return Err(HbmError::RigidBodyMode { mode, first_elastic });
    }
    let shape: Vec<f64> = modes.eta.col(k).iter().copied().collect();
    let at = ModeAtRest { mode, omega_squared, shape: &shape, rest };
    modal_lift_off_opened(structure, at, energy)
}

/// Whether any degree of freedom that moves together with that of a contact has mass.
fn has_mass_behind_contacts(model: &MasslessContactModel) -> bool {
    let mass = model.mass();
    let together = |kind: DofKind, of: DofKind| {
        kind == of || (of == DofKind::Deflection && kind == DofKind::Rotation) || kind == DofKind::Modal
    };
    let moves = |dof: DofKind| model.contacts().iter().any(|c| together(dof, model.dofs()[c.dof].kind));
    (0..model.dofs().len()).any(|i| moves(model.dofs()[i].kind) && mass.get(i, i).is_some_and(|m| *m > 0.0))
}
