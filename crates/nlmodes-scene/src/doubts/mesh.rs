use std::collections::HashSet;

use nlmodes_io::{Element, Mesh};

use super::Subject;

/// Share of nodes that a mesh need not know: reference nodes, masses.
const UNKNOWN: f64 = 0.1;
/// Share of elements that the matrices need not couple: parts that were removed.
const APART: f64 = 0.1;
/// Share of elements all of whose nodes may be fixed or dependent: rigid bodies.
const WITHOUT_ROWS: f64 = 0.5;

/// Signs that the mesh is that of another model.
pub fn doubts(subject: &Subject<'_>) -> Option<String> {
    let mesh = subject.model.mesh.as_ref()?;
    let parts: Vec<String> =
        [unknown(subject, mesh), apart(subject, mesh), without_rows(subject, mesh)].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| {
        format!(
            "`structure.mesh` does not look like the mesh of the matrices: {}; places, sets, normals and pictures \
            come from it",
            parts.join(", ")
        )
    })
}

/// Nodes of the matrices that are not in the mesh, except unknowns within elements and, of elements that CalculiX
/// expands, the rotations of their knots, which it numbers behind all nodes of the deck.
fn unknown(subject: &Subject<'_>, mesh: &Mesh) -> Option<String> {
    let nodes = subject.model.nodes();
    let last = mesh.numbers.iter().copied().max().filter(|_| mesh.is_expanded());
    let is_knot = |node: u64| last.is_some_and(|last| node > last);
    let is_unknown = |node: &u64| mesh.index_of(*node).is_none() && !is_knot(*node);
    let unknown: Vec<u64> = nodes.iter().copied().filter(is_unknown).collect();
    if unknown.is_empty() {
        return None;
    }
    let inner: HashSet<u64> = subject.model.nodes_without_answer().into_iter().collect();
    let count = unknown.iter().filter(|node| !inner.contains(node)).count();
    let own = nodes.iter().filter(|node| !is_knot(**node)).count() - (unknown.len() - count);
    (count as f64 > UNKNOWN * own as f64).then(|| format!("{count} of {own} nodes of the matrices are not in it"))
}

/// Elements that the stiffness does not couple.
fn apart(subject: &Subject<'_>, mesh: &Mesh) -> Option<String> {
    let free = |index: &u32| subject.model.translations_of(mesh.numbers[*index as usize]).iter().any(Option::is_some);
    let nodes = |element: &Element| -> Vec<u64> {
        element.nodes.iter().filter(|index| free(index)).map(|index| mesh.numbers[*index as usize]).collect()
    };
    let elements: Vec<Vec<u64>> = mesh.elements.iter().map(nodes).filter(|nodes| nodes.len() > 1).collect();
    let count = elements.iter().filter(|nodes| is_apart(subject, nodes)).count();
    (count as f64 > APART * elements.len() as f64)
        .then(|| format!("the stiffness does not couple the nodes of {count} of {} elements", elements.len()))
}

/// Whether the stiffness couples the first of these nodes with fewer than half of the others.
fn is_apart(subject: &Subject<'_>, nodes: &[u64]) -> bool {
    let Some((first, others)) = nodes.split_first() else { return false };
    let coupled = others.iter().filter(|other| *other == first || couples(subject, *first, **other)).count();
    2 * coupled < others.len()
}

fn couples(subject: &Subject<'_>, a: u64, b: u64) -> bool {
    let [of_a, of_b] = [a, b].map(|node| subject.model.translations_of(node));
    of_a.iter().flatten().any(|i| of_b.iter().flatten().any(|j| subject.model.stiffness.get(*i, *j) != 0.0))
}

/// Elements none of whose nodes has a row.
fn without_rows(subject: &Subject<'_>, mesh: &Mesh) -> Option<String> {
    let known: HashSet<u64> = subject.model.labels.iter().map(|label| label.node).collect();
    let none = |element: &&Element| element.nodes.iter().all(|index| !known.contains(&mesh.numbers[*index as usize]));
    let count = mesh.elements.iter().filter(none).count();
    (count as f64 > WITHOUT_ROWS * mesh.elements.len() as f64)
        .then(|| format!("{count} of its {} elements have no node with a row", mesh.elements.len()))
}
