//! What the digits of the files leave open of the mode that is computed.

use std::f64::consts::TAU;

use nlmodes_io::FeModel;

use super::short;
use crate::assemble::OpenStructure;
use crate::rule::percent;
use crate::scene::Scene;

/// Share of a frequency that may be left open without a word.
const SMALL: f64 = 1e-3;

/// A frequency of which the last digits leave more open than that.
pub(super) fn doubt(scene: &Scene, open: &OpenStructure, model: &FeModel) -> Option<String> {
    let mode = scene.method.mode;
    let share = open.modes.left_open(mode).filter(|share| *share > SMALL)?;
    let hz = open.modes.omega_squared().get(mode.checked_sub(1)?)?.max(0.0).sqrt() / TAU;
    Some(format!(
        "the stiffness is known to {}, which leaves mode {mode} ({} Hz) open by ±{} (standard deviation): that of \
        low modes is a small difference of large entries. More \
         digits, or double precision, tell it",
        model.digits[0],
        short(hz),
        percent(share)
    ))
}
