//! Stops as figures and tables name and draw them, numbered from 0, as keys of the scene are; ends that are held.

use nlmodes::modal::ModalBranch;
use nlmodes_scene::scene::Scene;
use nlmodes_scene::short;

use super::Curve;

/// Kinds of motion of rods and beams.
const AXIAL: [&str; 3] = ["axial", "deflection", "rotation"];

/// `stop 0 at 0.63 m`, and its side if there are others at the same position.
pub fn names(curve: &dyn Curve) -> Vec<String> {
    let (all, coordinates) = (curve.stops(), &curve.branch().coordinates);
    // Contacts of a structure in free-interface modes have no position along an axis.
    let is_elsewhere = coordinates.iter().any(|coordinate| !AXIAL.contains(&coordinate.kind.as_str()));
    if is_elsewhere || all.len() < curve.n_contacts() {
        return (0..curve.n_contacts()).map(|number| format!("stop {number}")).collect();
    }
    all.iter()
        .enumerate()
        .map(|(number, stop)| {
            let faces = all.iter().any(|other| other.coordinate == stop.coordinate && other.positive != stop.positive);
            let side = match (faces, stop.positive) {
                (false, _) => "",
                (true, true) => ", + side",
                (true, false) => ", − side",
            };
            format!("stop {number} at {} m{side}", short(coordinates[stop.coordinate].position))
        })
        .collect()
}

/// Kind of the coordinates that are drawn: that of the first contact, or of the first one.
fn kind(branch: &ModalBranch) -> Option<&str> {
    let shown = branch.contact_coordinate.unwrap_or(0);
    branch.coordinates.get(shown).map(|coordinate| coordinate.kind.as_str())
}

/// Whether these coordinates lie along the axis of a rod or beam; of several structures the kind ends in a number.
pub fn are_along_an_axis(branch: &ModalBranch) -> bool {
    kind(branch).and_then(|kind| kind.split('-').next()).is_some_and(|kind| AXIAL.contains(&kind))
}

/// Ends of the structure that are fixed in the direction of the first contact.
pub fn held_ends(scene: &Scene, branch: &ModalBranch) -> Vec<f64> {
    let Some(kind) = kind(branch) else { return Vec::new() };
    let number = kind.rsplit_once('-').and_then(|(_, number)| number.parse::<usize>().ok()?.checked_sub(1));
    let of_several = number.and_then(|number| scene.structure.bodies().get(number));
    let Some(length) = scene.structure.straight().or(of_several).map(|structure| structure.length) else {
        return Vec::new();
    };
    let moves = |at: f64| branch.coordinates.iter().any(|c| c.kind == kind && (c.position - at).abs() < 1e-9 * length);
    [0.0, length].into_iter().filter(|at| !moves(*at)).collect()
}
