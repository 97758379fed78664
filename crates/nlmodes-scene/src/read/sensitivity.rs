//! A scene at other values of the parameters by which its curves are differentiated.

use super::{Read, one_state};
use crate::check::sensitivity::{QUOTIENT, STEP, overrides};
use crate::scene::SceneState;
use crate::text::Text;
use crate::{Diagnostic, SceneError, SceneFile};

/// Reads the scene at other values of each of its parameters.
///
/// # Errors
/// [`SceneError`] at the parameter with which the scene is none.
pub fn add_states(text: &Text<'_>, given: &[String], method: usize, file: &mut SceneFile) -> Result<(), SceneError> {
    let mut sensitivities = file.scene.sensitivities.clone();
    for (number, sensitivity) in sensitivities.iter_mut().enumerate().filter(|(_, own)| own.entries.is_empty()) {
        for (times, weight) in QUOTIENT {
            let step = STEP * times;
            let more = overrides(sensitivity, 1.0 + step, &file.document);
            let all: Vec<String> = given.iter().cloned().chain(more).collect();
            let read = one_state(Read::new(text, &all, method));
            let mut scene = read.map_err(|error| refused(file, number, &error))?.scene;
            scene.sensitivities.clear();
            let weight = weight / (12.0 * STEP * sensitivity.value);
            sensitivity.states.push(SceneState { scene, weight });
        }
    }
    file.scene.sensitivities = sensitivities;
    Ok(())
}

/// The overrides with which the parameter with this number has another value, as `--set` takes them: with the length of
/// the structure all positions along it move.
pub fn overrides_at(file: &SceneFile, number: usize, value: f64) -> Vec<String> {
    let own = file.scene.sensitivities.get(number);
    own.map_or_else(Vec::new, |own| overrides(own, value / own.value, &file.document))
}

/// Why a scene is none with a parameter a little beside its value.
fn refused(file: &SceneFile, number: usize, error: &SceneError) -> SceneError {
    let key = &file.scene.sensitivities[number].key;
    let why: Vec<String> = error.diagnostics().iter().map(Diagnostic::sentence).collect();
    let title = format!("a thousandth beside its value, `{key}` makes the scene another one: {}", why.join("; "));
    let help = match key.rsplit('.').next().is_some_and(|name| name.starts_with("at_")) {
        true => {
            "a place at an end of the structure, or next to another part, cannot vary on both sides; compare two runs"
        }
        false => "gradients need the scene on both sides of the value",
    };
    file.error_at(&format!("sensitivity.{number}.key"), &title, "expected a parameter that may vary", &[help])
}
