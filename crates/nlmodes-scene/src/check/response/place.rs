//! Where loads act and motions are looked at.

use nlmodes_fem::Mesh;

use crate::check::contact::{Body, body, perhaps_millimetres};
use crate::check::nodes::node_at;
use crate::raw::{RawDirection, RawPlace, RawStructure};
use crate::rule::number;
use crate::scene::{BaseDirection, Direction, Place, StructureKind, Support, holds};
use crate::{Diagnostic, Diagnostics};

/// What the structure of a scene has as places.
pub enum Places<'a> {
    /// Positions along a rod or beam.
    Along(&'a Body<'a>),
    /// Nodes of files.
    Nodes,
    /// Positions along several rods and beams.
    Bodies(&'a [Body<'a>]),
    /// Rows of a structure that was reduced elsewhere.
    Rows,
}

impl<'a> Places<'a> {
    /// The rod or beam with its mesh.
    pub fn straight(&self) -> Option<&'a Body<'a>> {
        match self {
            Self::Along(body) => Some(body),
            Self::Nodes | Self::Bodies(_) | Self::Rows => None,
        }
    }

    /// Whether each of several structures has damping of its own.
    pub fn are_damped(&self) -> bool {
        let Self::Bodies(bodies) = self else { return false };
        bodies.iter().all(|body| body.raw.damping.is_some())
    }

    /// The direction in which a base shakes: several structures along their axes if one of them is a rod.
    pub fn base_direction(
        &self,
        path: &str,
        written: Option<&RawDirection>,
        diagnostics: &mut Diagnostics<'_>,
    ) -> Option<BaseDirection> {
        let kind = match self {
            Self::Nodes => return vector(path, written, diagnostics).map(BaseDirection::Vector),
            // What needs a direction is refused as a whole.
            Self::Rows => return None,
            Self::Along(body) => body.raw.kind,
            Self::Bodies(bodies) => {
                let mut kinds = bodies.iter().map(|body| body.raw.kind);
                if kinds.any(|kind| kind == StructureKind::Rod) { StructureKind::Rod } else { StructureKind::Beam }
            }
        };
        direction(kind, path, written, diagnostics).map(BaseDirection::Along)
    }

    /// The place that is written under the keys of position, node, direction, structure and row.
    pub fn place(&self, written: &RawPlace, keys: &[String; 5], diagnostics: &mut Diagnostics<'_>) -> Option<Place> {
        let [at_key, node_key, direction_key, structure_key, row_key] = keys.each_ref().map(String::as_str);
        if !matches!(self, Self::Rows) && written.row.is_some() {
            let diagnostic =
                Diagnostic::error(format!("`{row_key}` is a row of a structure that was reduced elsewhere"));
            let own = if matches!(self, Self::Nodes) { node_key } else { at_key };
            let short = own.rsplit('.').next().unwrap_or(own);
            diagnostics.put(row_key, diagnostic, format!("expected `{short}` in its place"));
            return None;
        }
        let (index, Body { raw: structure, mesh }) = match self {
            Self::Nodes => {
                if written.structure.is_some() {
                    let diagnostic =
                        Diagnostic::error(format!("`{structure_key}` is a number of several rods and beams"));
                    diagnostics.put(structure_key, diagnostic, "matrices from files are one structure: leave this out");
                    return None;
                }
                let keys = [at_key, node_key, direction_key];
                return of_node(keys, written, diagnostics);
            }
            Self::Rows => return of_row(keys, written, diagnostics),
            Self::Along(alone) => (body(structure_key, written.structure, 1, "", diagnostics)?, *alone),
            Self::Bodies(bodies) => {
                let which = "a scene of several structures says which one is meant";
                let index = body(structure_key, written.structure, bodies.len(), which, diagnostics)?;
                (index, &bodies[index])
            }
        };
        let kind = structure.kind;
        if written.node.is_some() {
            let diagnostic = Diagnostic::error(format!("`{node_key}` names a node of a structure from files"));
            let short = at_key.rsplit('.').next().unwrap_or(at_key);
            diagnostics.put(node_key, diagnostic, format!("expected `{short}`, a position along the axis"));
            return None;
        }
        let direction = direction(kind, direction_key, written.direction.as_ref(), diagnostics);
        let Some(at) = written.at_m else {
            let diagnostic = Diagnostic::error(format!("`{at_key}` is missing"));
            diagnostics.put(at_key, diagnostic, "expected a position along the axis, in m");
            return None;
        };
        let direction = direction?;
        let moves = moves((kind, structure, mesh), at_key, at, direction, diagnostics);
        moves.then_some(Place::Along { at, direction, structure: index })
    }
}

/// The direction of a motion along or across the axis; `None` where it is wrong, which is in the diagnostics.
fn direction(
    kind: StructureKind,
    path: &str,
    written: Option<&RawDirection>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Direction> {
    let own = if kind == StructureKind::Rod { Direction::Axial } else { Direction::Transverse };
    match written {
        None => Some(own),
        Some(RawDirection::Word(Direction::Transverse)) if kind == StructureKind::Rod => {
            let diagnostic = Diagnostic::error(format!("`{path}` cannot be \"transverse\" on a rod"));
            diagnostics.put(path, diagnostic.help("a rod moves along its axis only"), "expected \"axial\"");
            None
        }
        Some(RawDirection::Word(direction)) => Some(*direction),
        Some(RawDirection::Vector(_)) => {
            let diagnostic = Diagnostic::error(format!("`{path}` is a vector, which rods and beams do not need"));
            diagnostics.put(path, diagnostic, "expected \"axial\" or \"transverse\"");
            None
        }
    }
}

/// Whether the structure is there and moves.
fn moves(
    (kind, structure, mesh): (StructureKind, &RawStructure, &Mesh),
    path: &str,
    at: f64,
    direction: Direction,
    diagnostics: &mut Diagnostics<'_>,
) -> bool {
    let length = mesh.length();
    let node = node_at(mesh, at);
    if node.is_none() && at > length {
        let title = format!("`{path}` is beyond the structure, which ends at {} m", number(length));
        let diagnostic = perhaps_millimetres(Diagnostic::error(title), at, length);
        diagnostics.put(path, diagnostic, format!("expected a position from 0 to {} m", number(length)));
        return false;
    }
    let (end, support) = match node {
        Some(0) => ("start", structure.start),
        Some(node) if node == mesh.elements() => ("end", structure.end.unwrap_or(Support::Free)),
        _ => return true,
    };
    let held = holds(kind, support, direction);
    if held {
        let diagnostic = Diagnostic::error(format!("`{path}` is at the {} {end}, which does not move", support.name()));
        diagnostics.put(path, diagnostic, format!("expected a place that moves in {} direction", direction.name()));
    }
    !held
}

/// A node of a structure from files with its direction.
fn of_node(
    [at_key, node_key, direction_key]: [&str; 3],
    written: &RawPlace,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Place> {
    if written.at_m.is_some() {
        let diagnostic = Diagnostic::error(format!("`{at_key}` is a position along a rod or beam"));
        diagnostics.put(at_key, diagnostic, "expected the number of a node of the files");
        return None;
    }
    if written.node.is_none() {
        let diagnostic = Diagnostic::error(format!("`{node_key}` is missing"));
        diagnostics.put(node_key, diagnostic, "expected the number of a node of the files");
    }
    let direction = vector(direction_key, written.direction.as_ref(), diagnostics)?;
    Some(Place::Node { node: written.node?, direction })
}

/// A row of a structure that was reduced elsewhere, which has its direction.
fn of_row(keys: &[String; 5], written: &RawPlace, diagnostics: &mut Diagnostics<'_>) -> Option<Place> {
    let [at, node, direction, structure, row] = keys.each_ref().map(String::as_str);
    let others = [
        (at, written.at_m.is_some()),
        (node, written.node.is_some()),
        (direction, written.direction.is_some()),
        (structure, written.structure.is_some()),
    ];
    let short = row.rsplit('.').next().unwrap_or(row);
    if let Some((key, _)) = others.into_iter().find(|(_, there)| *there) {
        let diagnostic =
            Diagnostic::error(format!("`{key}` is not possible for a structure that was reduced elsewhere"));
        let diagnostic = diagnostic.help("its places are the rows of `structure.contact_rows`, each in its direction");
        diagnostics.put(key, diagnostic, format!("expected `{short}`, the number of a row from 1"));
        return None;
    }
    if written.row.is_none() {
        let diagnostic = Diagnostic::error(format!("`{row}` is missing"));
        diagnostics.put(row, diagnostic, "expected the number of a row of `structure.contact_rows`, from 1");
    }
    Some(Place::Row { row: written.row? as usize })
}

/// Three numbers as a unit vector.
fn vector(path: &str, written: Option<&RawDirection>, diagnostics: &mut Diagnostics<'_>) -> Option<[f64; 3]> {
    if let Some(RawDirection::Vector(v)) = written
        && let [x, y, z] = v[..]
        && let length = (x * x + y * y + z * z).sqrt()
        && length > 0.0
    {
        return Some([x / length, y / length, z / length]);
    }
    let diagnostic = Diagnostic::error(format!("`{path}` must be a vector"));
    diagnostics.put(path, diagnostic, "expected 3 numbers in square brackets, not all 0");
    None
}
