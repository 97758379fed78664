//! How far the structure moves elsewhere while a contact just touches.

use std::f64::consts::TAU;

use super::{Subject, short};
use crate::assemble::OpenStructure;
use crate::scene::Scene;

/// Largest displacement, relative to the size of the structure and to the closing gap, without warning.
const LARGE: (f64, f64) = (0.02, 5.0);

/// A mode that hardly moves the contacts: where one of them touches, displacements elsewhere are not small any more.
pub(super) fn doubt(scene: &Scene, open: &OpenStructure, subject: &Subject) -> Option<String> {
    if !scene.responses.is_empty() {
        return None;
    }
    let (modes, mode) = (&open.modes, scene.method.mode.checked_sub(1)?);
    let rows = modes.contact_rows();
    if mode >= modes.n_modes() || modes.gaps().iter().any(|gap| *gap <= 0.0) {
        return None;
    }
    let touching = |i: usize| modes.gaps()[i] / rows[(i, mode)].abs();
    let first = (0..modes.n_contacts()).min_by(|&i, &j| touching(i).total_cmp(&touching(j)))?;
    let amplitude = touching(first);
    let labels = subject.model.labels.iter().enumerate();
    let moving = labels.filter(|(_, label)| label.component.translation().is_some());
    let moved = moving.map(|(row, label)| (label.node, amplitude * modes.shapes()[(row, mode)].abs()));
    let (farthest, largest) = moved.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, largest)| largest.is_finite())?;
    let (gap, size) = (modes.gaps()[first], subject.extent()?);
    if largest <= LARGE.0 * size || largest <= LARGE.1 * gap {
        return None;
    }
    let hz = modes.omega_squared()[mode].max(0.0).sqrt() / TAU;
    Some(format!(
        "mode {} ({} Hz) hardly moves the contacts: where node {} has gone its gap of {} m and touches, node {} is \
            displaced by {} m, in a structure of {} m. `method.mode` \
         chooses another mode; displacements are taken as small",
        scene.method.mode,
        short(hz),
        subject.found.get(first)?.node,
        short(gap),
        farthest,
        short(largest),
        short(size)
    ))
}
