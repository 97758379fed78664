//! Positions along a structure at which its motion is shown.

use nlmodes_modal::ModalBranch;

/// A position along the structure and the coordinate there, none if it is clamped.
pub(crate) type Station = (f64, Option<usize>);

/// Kind of the contact coordinate, or of the first one if there is no contact.
pub(crate) fn kind(branch: &ModalBranch) -> &str {
    let index = branch.contact_coordinate.unwrap_or(0);
    branch.coordinates.get(index).map_or("", |coordinate| &coordinate.kind)
}

/// The motion of a kind of coordinates, without the structure number: `axial` of `axial-2`.
pub(crate) fn motion_of(kind: &str) -> &str {
    kind.split('-').next().unwrap_or(kind)
}

/// Name of the displacement of a kind of coordinates.
pub(crate) fn word(kind: &str) -> &'static str {
    match motion_of(kind) {
        "axial" => "axial displacement",
        "deflection" => "deflection",
        "rotation" => "rotation",
        _ => "displacement",
    }
}

/// Position of the first contact.
pub(crate) fn contact_position(branch: &ModalBranch) -> Option<f64> {
    branch.coordinates.get(branch.contact_coordinate?).map(|coordinate| coordinate.position)
}

/// All positions in ascending order, each once; a coordinate has priority over a clamp.
pub(crate) fn stations(branch: &ModalBranch, kind: &str, clamped: &[f64]) -> Vec<Station> {
    let coordinates = branch.coordinates.iter().enumerate().filter(|(_, coordinate)| coordinate.kind == kind);
    let free = coordinates.map(|(index, coordinate)| (coordinate.position, Some(index)));
    let clamped = clamped.iter().map(|position| (*position, None));
    let mut stations: Vec<Station> = free.chain(clamped).filter(|(position, _)| position.is_finite()).collect();
    stations.sort_by(|a, b| a.0.total_cmp(&b.0));
    stations.dedup_by(|a, b| a.0 == b.0);
    stations
}

/// At most `most` stations, evenly chosen, including the ends, and in addition those at the positions `kept`.
pub(crate) fn thinned(stations: Vec<Station>, most: usize, kept: &[f64]) -> Vec<Station> {
    let n = stations.len();
    if n <= most {
        return stations;
    }
    let mut chosen: Vec<usize> = (0..most).map(|k| k * (n - 1) / (most - 1)).collect();
    chosen.extend(kept.iter().filter_map(|at| stations.iter().position(|(position, _)| position == at)));
    chosen.sort_unstable();
    chosen.dedup();
    chosen.into_iter().map(|index| stations[index]).collect()
}
