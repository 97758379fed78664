//! Character of linear modes: axial or bending, rigid or not, and whether a stop is at one of their nodes.

use nlmodes::linalg::multiply_many;
use nlmodes::model::{DofKind, LinearModes, StructuralModel};

/// Share of the kinetic energy from which on a mode is called by one kind of motion.
const MOSTLY: f64 = 0.98;
/// Displacement at a stop, relative to the largest of the mode, below which the stop is at a node.
const AT_NODE: f64 = 1e-3;
/// Squared angular frequency, over the highest that is known, below which a mode is a rigid motion.
const RIGID: f64 = 1e-9;
/// Least square of the mass-weighted product of two shapes by which modes of two models are the same.
const SAME: f64 = 0.5;

/// A few words on each mode: `axial`, `bending, node at stop 1`, …; empty for modal coordinates.
pub fn characters(model: &StructuralModel, modes: &LinearModes) -> Vec<String> {
    let moved = multiply_many(model.mass(), &modes.shapes);
    let highest = modes.omega.last().copied().unwrap_or(0.0);
    let of = |r: usize| {
        let shape: Vec<f64> = (0..modes.shapes.nrows()).map(|i| modes.shapes[(i, r)]).collect();
        let share = |kinds: &[DofKind]| -> f64 {
            let dofs = model.dofs().iter().enumerate().filter(|(_, dof)| kinds.contains(&dof.kind));
            dofs.map(|(i, _)| shape[i] * moved[(i, r)]).sum()
        };
        let mut words = Vec::new();
        if modes.omega[r].powi(2) <= RIGID * highest.powi(2) {
            words.push("rigid body".to_owned());
        }
        words.extend(motion(share).map(str::to_owned));
        words.extend(nodes(model, &shape));
        words.join(", ")
    };
    (0..modes.omega.len()).map(of).collect()
}

/// The kind of motion in which nearly all of the kinetic energy is.
fn motion(share: impl Fn(&[DofKind]) -> f64) -> Option<&'static str> {
    let motions: [(&str, &[DofKind]); 5] = [
        ("axial", &[DofKind::Axial]),
        ("bending", &[DofKind::Deflection, DofKind::Rotation]),
        ("along x", &[DofKind::X]),
        ("along y", &[DofKind::Y]),
        ("along z", &[DofKind::Z]),
    ];
    motions.into_iter().find(|(_, kinds)| share(kinds) > MOSTLY).map(|(name, _)| name)
}

/// The stops at nodes of a shape.
fn nodes(model: &StructuralModel, shape: &[f64]) -> Option<String> {
    let is_length = |kind: DofKind| kind.translation_axis().is_some();
    let moving = model.dofs().iter().zip(shape).filter(|(dof, _)| is_length(dof.kind));
    let largest = moving.fold(0.0, |m: f64, (_, u)| m.max(u.abs()));
    let stops = model.contacts().iter().enumerate();
    let still = stops.filter(|(_, contact)| contact.normal.dot(shape).abs() < AT_NODE * largest);
    let numbers: Vec<String> = still.map(|(number, _)| number.to_string()).collect();
    let word = if numbers.len() > 1 { "stops" } else { "stop" };
    (!numbers.is_empty()).then(|| format!("does not move {word} {}", numbers.join(", ")))
}

/// For each mode of a model, which of `others`, with another mass of the same degrees of freedom, is the same one: it
/// has the largest mass-weighted product of shapes.
pub fn same_modes(model: &StructuralModel, modes: &LinearModes, others: &LinearModes) -> Vec<Option<usize>> {
    if modes.shapes.nrows() != others.shapes.nrows() {
        return (0..modes.omega.len()).map(|k| (k < others.omega.len()).then_some(k)).collect();
    }
    let moved = multiply_many(model.mass(), &others.shapes);
    let product = |r: usize, s: usize, of: &LinearModes| -> f64 {
        (0..moved.nrows()).map(|i| of.shapes[(i, r)] * moved[(i, s)]).sum()
    };
    let norms: Vec<f64> = (0..others.omega.len()).map(|s| product(s, s, others)).collect();
    let of = |r: usize| {
        let alike = (0..norms.len()).map(|s| (s, product(r, s, modes).powi(2) / norms[s]));
        alike.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, square)| *square > SAME).map(|(s, _)| s)
    };
    (0..modes.omega.len()).map(of).collect()
}
