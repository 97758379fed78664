use std::f64::consts::TAU;

use crate::check::frequencies::estimate;
use crate::rule::significant;
use crate::scene::{Scene, Start, Structure};
use crate::{Diagnostic, Diagnostics};

/// A frequency may be the mode's within this range of the closed form, which knows neither coarse meshes nor missing
/// masses.
const AROUND: [f64; 2] = [0.5, 2.0];
/// A stop on one side raises the frequency to less than twice that of the free structure.
const STIFFENED: f64 = 2.0;

/// Warns of a window or a start that does not belong to the mode.
pub fn warn(scene: &Scene, structure: &Structure, diagnostics: &mut Diagnostics<'_>) {
    let pressed = scene.contacts.iter().any(|contact| contact.gap <= 0.0);
    let given = scene.updating.is_some() || diagnostics.has("structure.modes");
    let Some(hz) = estimate(structure, scene.method.mode).filter(|hz| *hz > 0.0 && !pressed && !given) else {
        return;
    };
    let number_of_mode = scene.method.mode;
    match scene.continuation.start() {
        Start::Frequency { hz: start, .. } => {
            let path = "continuation.start_frequency_hz";
            warn_of(
                path,
                [start, start],
                [hz * AROUND[0], hz * AROUND[1] * STIFFENED],
                hz,
                number_of_mode,
                diagnostics,
            );
        }
        Start::Grazing => {
            let Some(window) = scene.continuation.frequency_hz else { return };
            let path = "continuation.frequency_hz";
            warn_of(path, window, AROUND.map(|factor| hz * factor), hz, number_of_mode, diagnostics);
        }
        Start::Energy { .. } => {}
    }
}

fn warn_of(path: &str, found: [f64; 2], wanted: [f64; 2], hz: f64, mode: usize, diagnostics: &mut Diagnostics<'_>) {
    let meets = |factor: f64| found[0] * factor <= wanted[1] && found[1] * factor >= wanted[0];
    if meets(1.0) {
        return;
    }
    let place = if found[0] > wanted[1] { "far above" } else { "far below" };
    let diagnostic = Diagnostic::warning(format!("`{path}` lies {place} mode {mode}"));
    let units = [("rad/s", 1.0 / TAU), ("1/min", 1.0 / 60.0), ("kHz", 1e3)];
    let diagnostic = match units.into_iter().find(|(_, factor)| meets(*factor)) {
        Some((unit, factor)) => {
            let write = |x: f64| significant(x * factor, 4);
            let values = if found[0] == found[1] {
                write(found[0])
            } else {
                format!("[{}, {}]", write(found[0]), write(found[1]))
            };
            diagnostic.help(format!("if {unit} are meant, write {values}; frequencies are in Hz"))
        }
        None => diagnostic
            .help("`nlmodes-cli modes` computes the linear frequencies; are material and lengths in SI units?"),
    };
    let about = significant(hz, 2);
    diagnostics.put(path, diagnostic, format!("a branch begins at the linear frequency, here some {about} Hz"));
}
