//! What the mass that contacts lose does to the mode that is computed.

use std::f64::consts::TAU;

use nlmodes::model::{MassShift, MasslessContactModel, StructuralModel};
use nlmodes_scene::scene::Scene;
use nlmodes_scene::{SceneFile, short};

use crate::open_modes::OpenLinearModes;
use crate::settings::{Models, models};
use crate::{RunError, refusal};

/// Relative change of the linear frequency above which there is a warning.
pub const NOTABLE: f64 = 0.005;

/// Says by how much the linear mode of the scene is off without the mass of its contacts, and what helps; `None` below
/// [`NOTABLE`], and where the frequency is one that was measured: imposed on the mode, or met by parameters.
pub fn warning(scene: &Scene, open: &OpenLinearModes) -> Option<String> {
    shift(scene, open).and_then(|shift| warning_about(scene, &shift))
}

/// The same, of a change that is known.
pub(crate) fn warning_about(scene: &Scene, shift: &MassShift) -> Option<String> {
    (shift.relative().abs() >= NOTABLE).then(|| text(scene, shift))
}

/// What taking the mass away from the contacts does to the mode that is computed; `None` where nothing is taken, or the
/// frequency is one that was measured.
pub(crate) fn shift(scene: &Scene, open: &OpenLinearModes) -> Option<MassShift> {
    let is_imposed = scene.structure.straight().is_some_and(|structure| structure.modes.is_some());
    if is_imposed || scene.updating.is_some() || scene.is_in_open_modes() {
        return None;
    }
    MassShift::between(&open.kept.omega, &open.own.omega, scene.method.mode)
}

/// The same for a scene that is only checked.
///
/// # Errors
/// [`RunError`] if the structure cannot be made.
pub fn warning_of(file: &SceneFile) -> Result<Option<String>, RunError> {
    Ok(shift_of(file)?.and_then(|shift| warning_about(&file.scene, &shift)))
}

/// [`shift`] of a scene whose modes are not at hand.
pub(crate) fn shift_of(file: &SceneFile) -> Result<Option<MassShift>, RunError> {
    if file.scene.is_in_open_modes() {
        return Ok(None);
    }
    let Models { model, massless, .. } = models(file)?;
    Ok(shift(&file.scene, &open_modes(file, &model, &massless)?))
}

/// The linear modes with open contacts of a scene that is computed.
///
/// # Errors
/// [`RunError`] if an eigenproblem cannot be solved.
pub fn open_modes(
    file: &SceneFile,
    model: &StructuralModel,
    massless: &MasslessContactModel,
) -> Result<OpenLinearModes, RunError> {
    OpenLinearModes::new(&file.scene, model, massless)
        .map_err(|error| refusal::at(file, "method.mass_redistribution", &error))
}

/// Hz of an angular frequency, to six digits whatever its size.
fn hertz(omega: f64) -> String {
    short(omega / TAU)
}

fn text(scene: &Scene, shift: &MassShift) -> String {
    let [with, without] = [shift.with_mass, shift.without_mass].map(hertz);
    let percent = 100.0 * shift.relative();
    format!(
        "taking the mass of the contact nodes away ({rule}) moves mode {mode} from {with} to {without} Hz \
         ({percent:+.1} %): reduction.kind = \"open-modes\" keeps all of it",
        rule = scene.method.mass_redistribution.name(),
        mode = shift.mode,
    )
}
