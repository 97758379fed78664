//! Linear modes from which no branch begins, or none with contact.

use std::f64::consts::TAU;

use super::short;
use crate::assemble::OpenStructure;
use crate::scene::Scene;

/// Squared frequencies that differ by less than this share are not told apart.
const EQUAL: f64 = 1e-8;
/// Share of a row up to which another one is in its direction, or a contact not moved.
const SMALL: f64 = 1e-6;

/// What stands against the mode of which the nonlinear one is wanted; nothing of rigid-body motions, which are refused.
pub(super) fn doubts(scene: &Scene, open: &OpenStructure) -> Vec<String> {
    let mode = scene.method.mode.wrapping_sub(1);
    let Ok((rigid, _)) = open.modes.rigid_motions() else { return Vec::new() };
    if !scene.responses.is_empty() || !(rigid..open.modes.n_modes()).contains(&mode) {
        return Vec::new();
    }
    [repeated(open, mode), floating(open, rigid)].into_iter().flatten().collect()
}

/// Another mode of the same frequency, of which and the first the contacts see different combinations.
fn repeated(open: &OpenStructure, mode: usize) -> Option<String> {
    let (squares, rows) = (open.modes.omega_squared(), open.modes.contact_rows());
    let same = |k: &usize| *k != mode && (squares[*k] - squares[mode]).abs() <= EQUAL * squares[mode];
    let other = (0..squares.len()).find(same)?;
    let row = |i: usize| [rows[(i, mode)], rows[(i, other)]];
    let crossed = |i: usize, j: usize| {
        let ([a, b], [c, d]) = (row(i), row(j));
        (a * d - b * c).abs() > SMALL * a.hypot(b) * c.hypot(d)
    };
    let contacts = open.modes.n_contacts();
    (0..contacts).any(|i| (0..i).any(|j| crossed(i, j))).then(|| {
        format!(
            "modes {} and {} have the same frequency ({} Hz): any combination of them is a linear mode, the contacts do not agree on one, and no branch may begin there. A little \
             that breaks the symmetry, 1e-6 of the mass on one side, gives each its own",
            mode + 1,
            other + 1,
            short(squares[mode].max(0.0).sqrt() / TAU)
        )
    })
}

/// A structure with one rigid-body motion, in which all contacts push it to one side: the mean of what acts on it
/// vanishes in a periodic motion.
fn floating(open: &OpenStructure, rigid: usize) -> Option<String> {
    let pushed: Vec<f64> = (0..open.modes.n_contacts()).map(|i| open.modes.contact_rows()[(i, 0)]).collect();
    let largest = pushed.iter().fold(0.0_f64, |most, push| most.max(push.abs()));
    let one_sided = |side: f64| pushed.iter().all(|push| side * push > SMALL * largest);
    (rigid == 1 && (one_sided(1.0) || one_sided(-1.0))).then(|| {
        "the structure floats, and all contacts push it to the same side: their mean force vanishes in a periodic motion, so that none with contact exists. Stops on the other \
         side, or a support, hold it"
            .to_owned()
    })
}
