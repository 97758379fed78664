use nlmodes_fem::Mesh;

use crate::check::nodes::{beside, node_at};
use crate::raw::{RawContact, RawScene, RawStructure};
use crate::rule::number;
use crate::scene::{Contact, Direction, StructureKind, Support, holds};
use crate::{Findings, Problem};

/// The contacts that are sound; those that are not are in the findings.
pub fn check(raw: &RawScene, mesh: Option<&Mesh>, findings: &mut Findings<'_>) -> Vec<Contact> {
    let written = raw.contact.as_deref().unwrap_or_default();
    let mut sound: Vec<(usize, Contact)> = Vec::new();
    for (i, contact) in written.iter().enumerate() {
        let structure = raw.structure.as_ref();
        let movable = structure.is_none_or(|structure| can_move(i, contact, structure, findings));
        let node = mesh.and_then(|mesh| node(i, contact, mesh, findings));
        if let (true, Some(node), Some(mesh)) = (movable, node, mesh) {
            let free =
                structure.is_none_or(|structure| is_free(i, contact, (node, mesh.elements()), structure, findings));
            let contact = plain(contact, node, mesh.nodes()[node]).filter(|_| free);
            sound.extend(contact.map(|contact| (i, contact)));
        }
    }
    let mut apart: Vec<(usize, Contact)> = Vec::new();
    for contact in sound {
        if apart.iter().all(|other| stand_apart(other, &contact, findings)) {
            apart.push(contact);
        }
    }
    apart.into_iter().map(|(_, contact)| contact).collect()
}

fn plain(raw: &RawContact, node: usize, at: f64) -> Option<Contact> {
    Some(Contact {
        node,
        at,
        direction: raw.direction?,
        side: raw.side?,
        gap: raw.gap_m?,
        stiffness: raw.stiffness_n_m,
    })
}

/// Whether the structure moves in the direction of the contact at all.
fn can_move(i: usize, contact: &RawContact, structure: &RawStructure, findings: &mut Findings<'_>) -> bool {
    let rod = structure.kind == Some(StructureKind::Rod) && contact.direction == Some(Direction::Transverse);
    if rod {
        let path = format!("contact.{i}.direction");
        let problem = Problem::error(format!("`{path}` cannot be \"transverse\" on a rod"));
        let problem = problem.help("a rod moves along its axis only; structure.kind = \"beam\" moves across it too");
        findings.put(&path, problem, "expected \"axial\"");
    }
    !rod
}

fn node(i: usize, contact: &RawContact, mesh: &Mesh, findings: &mut Findings<'_>) -> Option<usize> {
    let at = contact.at_m?;
    let node = node_at(mesh, at);
    if node.is_none() {
        off_node(i, at, mesh, findings);
    }
    node
}

fn off_node(i: usize, at: f64, mesh: &Mesh, findings: &mut Findings<'_>) {
    let path = format!("contact.{i}.at_m");
    let length = mesh.length();
    let [low, high] = beside(mesh, at);
    let position = |node: usize| number(mesh.nodes()[node]);
    let nearest = if low == high {
        format!("the nearest is {} m (node {low}", position(low))
    } else {
        format!("the nearest are {} m and {} m (nodes {low} and {high}", position(low), position(high))
    };
    let (found, last) = (findings.written(&path), mesh.elements());
    let label = format!("found {found}, expected the position of a node; {nearest} of {last})");
    let problem = if at > length {
        let title = format!("`{path}` lies beyond the structure, which ends at {} m", number(length));
        perhaps_millimetres(Problem::error(title), at, length)
    } else {
        let problem = Problem::error(format!("`{path}` is not at a node of the mesh"));
        match elements_with_a_node(mesh, at) {
            Some(n) => problem.help(format!("a node lies there with structure.elements = {n}")),
            None => problem,
        }
    };
    findings.put(&path, problem, label);
}

/// The next number of elements with which a node of an even mesh lies at the position, if it is not far.
fn elements_with_a_node(mesh: &Mesh, at: f64) -> Option<usize> {
    let (now, part) = (mesh.elements(), at / mesh.length());
    let lengths = mesh.element_lengths();
    let even = lengths.iter().all(|length| (length / lengths[0] - 1.0).abs() < 1e-9);
    let fits = |n: &usize| (part * *n as f64 - (part * *n as f64).round()).abs() < 1e-9 * *n as f64;
    (now + 1..=4 * now).find(|n| even && fits(n))
}

/// Adds what to write if a position beyond the end of the structure is one in millimetres.
pub fn perhaps_millimetres(problem: Problem, at: f64, length: f64) -> Problem {
    let metres = at * 1e-3;
    if metres > length || at < 10.0 * length {
        return problem;
    }
    problem.help(format!("if {} mm is meant, write {}", number(at), number(metres)))
}

/// Whether the node of the contact is free to move in its direction.
fn is_free(
    i: usize,
    contact: &RawContact,
    (node, last): (usize, usize),
    structure: &RawStructure,
    findings: &mut Findings<'_>,
) -> bool {
    let (end, support) = match node {
        0 => ("start", structure.start),
        _ if node == last => ("end", Some(structure.end.unwrap_or(Support::Free))),
        _ => return true,
    };
    let (Some(kind), Some(support), Some(direction)) = (structure.kind, support, contact.direction) else {
        return true;
    };
    let held = holds(kind, support, direction);
    if held {
        let path = format!("contact.{i}.at_m");
        let problem = Problem::error(format!("`{path}` is at the {} {end}, which does not move", support.name()));
        let label =
            format!("found {}, expected a node that moves in {} direction", findings.written(&path), direction.name());
        findings.put(&path, problem, label);
    }
    !held
}

/// Whether two stops differ, and leave room between them.
fn stand_apart((i, first): &(usize, Contact), (j, second): &(usize, Contact), findings: &mut Findings<'_>) -> bool {
    if (first.node, first.direction) != (second.node, second.direction) {
        return true;
    }
    let problem = if first.side == second.side {
        Problem::error(format!("`contact.{j}` stands where `contact.{i}` stands already")).help(
            "of two stops with the same position, direction and side only the nearer one can touch; keep that one",
        )
    } else if first.gap + second.gap < 0.0 {
        Problem::error(format!("`contact.{i}` and `contact.{j}` leave no room between them"))
            .help("the two gaps of opposite stops must not add up to less than 0 m")
    } else {
        return true;
    };
    let problem = match findings.document().place(&format!("contact.{i}")) {
        Some(place) => problem.with(place.value.clone(), "the first one"),
        None => problem,
    };
    findings.put(&format!("contact.{j}"), problem, "the second one");
    false
}
