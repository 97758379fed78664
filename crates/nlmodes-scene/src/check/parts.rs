//! Point masses and springs of rods and beams.

use nlmodes_fem::Mesh;

use super::nodes::{beside, node_at};
use crate::raw::{RawSpring, RawStructure};
use crate::rule::number;
use crate::scene::{Direction, GroundSpring, MassPoint, SpringDirection, StructureKind, Support, holds};
use crate::{Diagnostic, Diagnostics};

/// A table below the heading of some structure.
pub struct Table<'a, T> {
    /// Index of that structure; none where there is one structure only.
    home: Option<usize>,
    /// Its number there.
    number: usize,
    table: &'a T,
}

/// What is fixed to one structure, wherever it is.
#[derive(Default)]
pub struct Fixed<'a> {
    pub masses: Vec<Table<'a, MassPoint>>,
    pub springs: Vec<Table<'a, RawSpring>>,
}

impl<'a> Fixed<'a> {
    /// Of the only structure of a scene.
    pub fn of_one(raw: &'a RawStructure, diagnostics: &mut Diagnostics<'_>) -> Self {
        let mut all = Self::of_each(std::slice::from_ref(raw), None, diagnostics);
        all.pop().unwrap_or_default()
    }

    /// Of each of several structures.
    pub fn of_several(raw: &'a [RawStructure], diagnostics: &mut Diagnostics<'_>) -> Vec<Self> {
        Self::of_each(raw, Some(0), diagnostics)
    }

    /// Where these are, m.
    pub fn places(&self) -> Vec<f64> {
        let masses = self.masses.iter().map(|mass| mass.table.at);
        masses.chain(self.springs.iter().map(|spring| spring.table.at_m)).collect()
    }

    fn of_each(raw: &'a [RawStructure], first: Option<usize>, diagnostics: &mut Diagnostics<'_>) -> Vec<Self> {
        let mut all: Vec<Self> = raw.iter().map(|_| Self::default()).collect();
        for (i, structure) in raw.iter().enumerate() {
            let home = first.map(|first| first + i);
            diagnostics.about_structure(home);
            for (number, table) in structure.mass_point.iter().flatten().enumerate() {
                let path = format!("structure.mass_point.{number}");
                if let Some(owner) = owner(&path, table.structure, i, raw.len(), diagnostics) {
                    all[owner].masses.push(Table { home, number, table });
                }
            }
            for (number, table) in structure.spring.iter().flatten().enumerate() {
                let path = format!("structure.spring.{number}");
                if let Some(owner) = owner(&path, table.structure.map(|n| n as usize), i, raw.len(), diagnostics) {
                    all[owner].springs.push(Table { home, number, table });
                }
            }
        }
        diagnostics.about_structure(None);
        all
    }
}

/// Index of the structure that a table names, or of that below whose heading it is.
fn owner(
    path: &str,
    named: Option<usize>,
    home: usize,
    count: usize,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<usize> {
    let Some(number) = named else { return Some(home) };
    if number <= count {
        return Some(number - 1);
    }
    no_such_structure(&format!("{path}.structure"), number, count, diagnostics);
    None
}

/// Says that there are fewer structures.
pub fn no_such_structure(path: &str, number: usize, count: usize, diagnostics: &mut Diagnostics<'_>) {
    let diagnostic = Diagnostic::error(format!("`{path}`: there is no structure {number}"));
    diagnostics.put(path, diagnostic, format!("expected a whole number from 1 to {count}, in the order of the file"));
}

/// The point masses that are sound.
pub fn masses(
    raw: &RawStructure,
    tables: &[Table<'_, MassPoint>],
    mesh: &Mesh,
    diagnostics: &mut Diagnostics<'_>,
) -> Vec<MassPoint> {
    let (mut sound, own) = (Vec::new(), diagnostics.structure());
    for Table { home, number, table: point } in tables {
        diagnostics.about_structure(*home);
        let path = format!("structure.mass_point.{number}");
        let Some(node) = node(&path, point.at, mesh, diagnostics) else { continue };
        if point.inertia > 0.0 && raw.kind == StructureKind::Rod {
            let path = format!("{path}.inertia_kg_m2");
            let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
            diagnostics.put(&path, diagnostic, "a rod does not turn");
        }
        if is_clamped(raw, node, mesh) {
            let path = format!("{path}.at_m");
            let diagnostic = Diagnostic::error(format!("`{path}` is at an end that does not move"));
            diagnostics.put(&path, diagnostic, "expected a node that moves");
            continue;
        }
        sound.push(MassPoint { node, ..**point });
    }
    diagnostics.about_structure(own);
    sound
}

/// The springs that are sound.
pub fn springs(
    raw: &RawStructure,
    tables: &[Table<'_, RawSpring>],
    mesh: &Mesh,
    diagnostics: &mut Diagnostics<'_>,
) -> Vec<GroundSpring> {
    let (mut sound, own) = (Vec::new(), diagnostics.structure());
    for Table { home, number, table: spring } in tables {
        diagnostics.about_structure(*home);
        let path = format!("structure.spring.{number}");
        let Some(node) = node(&path, spring.at_m, mesh, diagnostics) else { continue };
        let direction = spring.direction;
        if raw.kind == StructureKind::Rod && direction != SpringDirection::Axial {
            let path = format!("{path}.direction");
            let diagnostic = Diagnostic::error(format!("`{path}` cannot be \"{}\" on a rod", direction.name()));
            diagnostics.put(&path, diagnostic.help("a rod moves along its axis only"), "expected \"axial\"");
            continue;
        }
        let (key, unused) = match direction {
            SpringDirection::Rotation => ("stiffness_nm", "stiffness_n_m"),
            _ => ("stiffness_n_m", "stiffness_nm"),
        };
        if diagnostics.has(&format!("{path}.{unused}")) {
            let path = format!("{path}.{unused}");
            let diagnostic =
                Diagnostic::error(format!("`{path}` does not belong to direction = \"{}\"", direction.name()));
            diagnostics.put(&path, diagnostic, format!("expected `{key}`"));
            continue;
        }
        if is_held(raw, node, direction, mesh) {
            let path = format!("{path}.at_m");
            let diagnostic = Diagnostic::error(format!("`{path}` is at an end that does not move"));
            diagnostics.put(&path, diagnostic, "expected a node that moves in this direction");
            continue;
        }
        let stiffness = if key == "stiffness_nm" { spring.stiffness_nm } else { spring.stiffness_n_m };
        sound.extend(stiffness.map(|stiffness| GroundSpring { node, direction, stiffness }));
    }
    diagnostics.about_structure(own);
    sound
}

/// The node at a position.
fn node(path: &str, at: f64, mesh: &Mesh, diagnostics: &mut Diagnostics<'_>) -> Option<usize> {
    let found = node_at(mesh, at);
    if found.is_none() {
        let path = format!("{path}.at_m");
        let [low, high] = beside(mesh, at).map(|node| number(mesh.nodes()[node]));
        let diagnostic = Diagnostic::error(format!("`{path}` is beyond the structure, or too near to another node"));
        let label = format!("found {}, expected the position of a node: {low} or {high} m", diagnostics.written(&path));
        diagnostics.put(&path, diagnostic, label);
    }
    found
}

/// The support of a node at an end.
fn support(raw: &RawStructure, node: usize, mesh: &Mesh) -> Option<Support> {
    match node {
        0 => Some(raw.start),
        n if n == mesh.elements() => Some(raw.end.unwrap_or(Support::Free)),
        _ => None,
    }
}

fn is_clamped(raw: &RawStructure, node: usize, mesh: &Mesh) -> bool {
    let (Some(support), kind) = (support(raw, node, mesh), raw.kind) else { return false };
    support == Support::Clamped || (kind == StructureKind::Rod && holds(kind, support, Direction::Axial))
}

fn is_held(raw: &RawStructure, node: usize, direction: SpringDirection, mesh: &Mesh) -> bool {
    let (Some(support), kind) = (support(raw, node, mesh), raw.kind) else { return false };
    match direction {
        SpringDirection::Axial => holds(kind, support, Direction::Axial),
        SpringDirection::Transverse => holds(kind, support, Direction::Transverse),
        SpringDirection::Rotation => matches!(support, Support::Clamped | Support::Sliding),
    }
}
