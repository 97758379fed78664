//! Nodes whose displacements are not along the global axes.

use std::collections::HashMap;

use super::FeFiles;
use crate::error::{Problem, ReadError, Result};
use crate::formats::Format;
use crate::labels::{Component, DofLabel};
use crate::lower::Motion;
use crate::mesh::Mesh;
use crate::nastran::Directions;

/// Displacements and rotations of the files of displacements and rotations along the global axes, `q = R u` at each
/// node with axes of its own; none where there is no such node.
pub(super) fn motion(
    files: &FeFiles,
    labels: &[DofLabel],
    directions: &HashMap<u64, Directions>,
) -> Result<Option<Motion>> {
    let rows: HashMap<DofLabel, usize> = labels.iter().enumerate().map(|(row, label)| (*label, row)).collect();
    let mut motion: Motion = (0..labels.len()).map(|row| vec![(row, 1.0)]).collect();
    let mut any = false;
    for (row, label) in labels.iter().enumerate() {
        let Some(axes) = directions.get(&label.node) else { continue };
        let (three, k) = match (label.component.translation(), label.component.rotation()) {
            (Some(k), _) => ([Component::X, Component::Y, Component::Z], k),
            (_, Some(k)) => ([Component::RX, Component::RY, Component::RZ], k),
            _ => continue,
        };
        let axes = axes.ok_or_else(|| refused(files, label.node, "their coordinate system is not in the file"))?;
        let of = |component| rows.get(&DofLabel { node: label.node, component }).copied();
        let [Some(x), Some(y), Some(z)] = three.map(of) else {
            return Err(refused(
                files,
                label.node,
                "only with all three of them there do they give those along the global axes",
            ));
        };
        motion[row] = [x, y, z].into_iter().zip(axes[k]).filter(|(_, part)| *part != 0.0).collect();
        any = true;
    }
    Ok(any.then_some(motion))
}

/// Matrices along the directions of `*TRANSFORM`: those of CalculiX only if requested.
pub(super) fn check(files: &FeFiles, format: Format, labels: &[DofLabel], mesh: &Mesh) -> Result<()> {
    if format == Format::Calculix && !mesh.matrices_are_transformed {
        return Ok(());
    }
    match labels.iter().find(|label| mesh.transformed.contains(&label.node)) {
        Some(label) if format == Format::Calculix => {
            Err(refused(files, label.node, "with GLOBAL=YES, its default, CalculiX writes them along the global ones"))
        }
        Some(label) => Err(refused(files, label.node, "write the matrices without *TRANSFORM")),
        None => Ok(()),
    }
}

fn refused(files: &FeFiles, node: u64, reason: &'static str) -> ReadError {
    let found = format!("node {node} with directions of its own (CD of GRID, or *TRANSFORM)");
    let expected = "displacements along the global axes";
    ReadError::whole(&files.stiffness.path, Problem::Refused { found, expected, reason })
}
