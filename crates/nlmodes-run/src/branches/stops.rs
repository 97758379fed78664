//! The stops of a branch, as figures and tables name and draw them: numbered from 0, as keys of the scene are.

use nlmodes::branches::ComputedBranch;
use nlmodes::model::DofContact;
use nlmodes::report::StopLine;

/// Kinds of motion of rods and beams.
const AXIAL: [&str; 3] = ["axial", "deflection", "rotation"];

/// All stops, in the order of the scene.
pub fn lines(computed: &ComputedBranch) -> Vec<StopLine> {
    let line = |contact: &DofContact| {
        Some(StopLine {
            // What is recorded is numbered, which of large structures is not every degree of freedom.
            coordinate: computed.structure.recorded_index(contact.dof)?,
            position: contact.side.sign() * contact.gap,
            positive: contact.side.sign() > 0.0,
        })
    };
    // Contacts are among the recorded ones, whatever the size.
    computed.structure.model().contacts().iter().filter_map(line).collect()
}

/// `stop 0 at 0.63 m`, and its side if there are others at the same position.
pub fn names(computed: &ComputedBranch) -> Vec<String> {
    let all = lines(computed);
    // Contacts of a structure in free-interface modes have no position along an axis.
    if computed.branch.coordinates.iter().any(|coordinate| !AXIAL.contains(&coordinate.kind.as_str())) {
        return (0..computed.structure.n_contacts()).map(|number| format!("stop {number}")).collect();
    }
    let place = |stop: &StopLine| computed.branch.coordinates[stop.coordinate].position;
    let name = |(number, stop): (usize, &StopLine)| {
        let faces = all.iter().any(|other| other.coordinate == stop.coordinate && other.positive != stop.positive);
        let side = match (faces, stop.positive) {
            (false, _) => "",
            (true, true) => ", + side",
            (true, false) => ", − side",
        };
        format!("stop {number} at {} m{side}", short(place(stop)))
    };
    all.iter().enumerate().map(name).collect()
}

/// A position, or another size, with six digits at most.
pub fn short(position: f64) -> String {
    let text = format!("{position:.5e}");
    nlmodes_scene::number(text.parse().unwrap_or(position))
}
