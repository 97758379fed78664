use nlmodes_fem::Mesh;

use crate::check::nodes::{beside, node_at};
use crate::check::parts::no_such_structure;
use crate::raw::{RawAgainst, RawContact, RawStructure};
use crate::rule::number;
use crate::scene::{Contact, Direction, Facing, SceneStructure, StructureKind, Support, holds};
use crate::{Findings, Problem};

/// A structure that contacts can belong to.
pub struct Body<'a> {
    pub raw: Option<&'a RawStructure>,
    pub mesh: Option<&'a Mesh>,
}

/// Positions at which contacts touch the structure with this index (from 0) of several.
pub fn stops_of(body: usize, written: &[RawContact]) -> Vec<f64> {
    let own = |contact: &RawContact| contact.at_m.filter(|_| contact.structure == Some(body as u32 + 1));
    let other = |contact: &RawContact| {
        contact.against.as_ref().and_then(|other| other.at_m.filter(|_| other.structure == Some(body as u32 + 1)))
    };
    written.iter().flat_map(|contact| [own(contact), other(contact)]).flatten().collect()
}

/// The contacts that are sound; those that are not are in the findings.
pub fn check(written: &[RawContact], bodies: &[Body<'_>], findings: &mut Findings<'_>) -> Vec<Contact> {
    let sound = written.iter().enumerate().filter_map(|(i, raw)| Some((i, sound(i, raw, bodies, findings)?)));
    let sound: Vec<(usize, Contact)> = sound.collect();
    let mut apart: Vec<(usize, Contact)> = Vec::new();
    for contact in sound {
        if apart.iter().all(|other| stand_apart(other, &contact, findings)) {
            apart.push(contact);
        }
    }
    apart.into_iter().map(|(_, contact)| contact).collect()
}

/// Contact `i`, if everything about it is sound.
fn sound(i: usize, raw: &RawContact, bodies: &[Body<'_>], findings: &mut Findings<'_>) -> Option<Contact> {
    let path = format!("contact.{i}");
    let which = "a scene of several structures says which one touches";
    let body = body(&format!("{path}.structure"), raw.structure, bodies.len(), which, findings)?;
    let own = on(body, bodies);
    findings.about_structure(own);
    let Body { raw: structure, mesh } = &bodies[body];
    let movable = structure.is_none_or(|structure| can_move(i, raw, structure, findings));
    let node = mesh.and_then(|mesh| node(&path, raw.at_m, mesh, findings));
    let free = match (movable, node, mesh) {
        (true, Some(node), Some(mesh)) => {
            structure.is_none_or(|structure| is_free(i, raw, (node, mesh.elements()), structure, findings))
        }
        _ => false,
    };
    findings.about_structure(None);
    let against = match &raw.against {
        Some(other) => Some(facing(i, raw, other, body, bodies, findings)?),
        None => None,
    };
    let (node, mesh) = (node?, mesh.as_ref()?);
    free.then_some(Contact {
        node,
        at: mesh.nodes()[node],
        direction: raw.direction?,
        side: raw.side?,
        gap: raw.gap_m?,
        stiffness: raw.stiffness_n_m,
        damping: raw.damping_n_s_m,
        structure: body,
        against,
    })
}

/// Dampers of stops: each stands beside a stiffness, and conservative modes leave it out.
pub fn dampers(
    contacts: &[Contact],
    structure: Option<&SceneStructure>,
    has_responses: bool,
    findings: &mut Findings<'_>,
) {
    let of_elements = contacts.iter().map(|contact| (contact.stiffness, contact.damping));
    let nodes = structure.and_then(SceneStructure::matrices).into_iter().flat_map(|matrices| &matrices.contacts);
    let stops = of_elements.chain(nodes.map(|contact| (contact.stiffness, contact.damping)));
    for (i, (stiffness, _)) in stops.enumerate().filter(|(_, (_, damping))| damping.is_some()) {
        let path = format!("contact.{i}.damping_n_s_m");
        if stiffness.is_none() {
            let problem = Problem::error(format!("`{path}` stands beside a rigid stop"));
            let help = "a stop that dissipates yields: its damper stands beside `stiffness_n_m`";
            findings.put(&path, problem.help(help), "expected `stiffness_n_m` in this table too");
        } else if !has_responses {
            let problem = Problem::warning(format!("`{path}` has no effect without a response"));
            let help =
                "[response] with kind = \"frequency\", \"force\", \"phase-resonance\" or \"damped-mode\" uses it";
            findings.put(&path, problem.help(help), "the scene computes the conservative nonlinear mode");
        }
    }
}

/// The structure that findings are about; none where there is one only.
fn on(body: usize, bodies: &[Body<'_>]) -> Option<usize> {
    (bodies.len() > 1).then_some(body)
}

/// Index of the structure that a table names at `path`; where there are several it must, and `which` says why.
pub fn body(path: &str, named: Option<u32>, count: usize, which: &str, findings: &mut Findings<'_>) -> Option<usize> {
    match named.map(|number| number as usize) {
        Some(number) if number <= count => Some(number - 1),
        Some(number) => {
            no_such_structure(path, number, count, findings);
            None
        }
        None if count == 1 => Some(0),
        None => {
            if !findings.has(path) {
                let key = path.rsplit('.').next().unwrap_or(path);
                let problem = Problem::error(format!("`{path}` is missing"));
                let label = format!("expected `{key}`, a whole number from 1 to {count}, in this table");
                findings.put(path, problem.help(which), label);
            }
            None
        }
    }
}

/// The node of another structure that contact `i` touches.
fn facing(
    i: usize,
    raw: &RawContact,
    other: &RawAgainst,
    own: usize,
    bodies: &[Body<'_>],
    findings: &mut Findings<'_>,
) -> Option<Facing> {
    let path = format!("contact.{i}.against");
    let number = other.structure? as usize;
    if number > bodies.len() {
        no_such_structure(&format!("{path}.structure"), number, bodies.len(), findings);
        return None;
    }
    let body = number - 1;
    if body == own {
        let problem = Problem::error(format!("`{path}.structure` is the structure that touches"));
        findings.put(&format!("{path}.structure"), problem, "expected the number of another one");
        return None;
    }
    findings.about_structure(on(body, bodies));
    let Body { raw: structure, mesh } = &bodies[body];
    let is_rod = structure.is_some_and(|structure| structure.kind == Some(StructureKind::Rod));
    let node = mesh.and_then(|mesh| node(&path, other.at_m, mesh, findings));
    findings.about_structure(None);
    if is_rod && raw.direction == Some(Direction::Transverse) {
        let problem = Problem::error(format!("`{path}` is a rod, which does not move across its axis"));
        findings.put(&path, problem, "expected a beam, or direction = \"axial\"");
        return None;
    }
    let mesh = mesh.as_ref()?;
    node.map(|node| Facing { structure: body, node, at: mesh.nodes()[node] })
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

fn node(path: &str, at: Option<f64>, mesh: &Mesh, findings: &mut Findings<'_>) -> Option<usize> {
    let node = node_at(mesh, at?);
    if node.is_none() {
        off_node(&format!("{path}.at_m"), at?, mesh, findings);
    }
    node
}

fn off_node(path: &str, at: f64, mesh: &Mesh, findings: &mut Findings<'_>) {
    let length = mesh.length();
    let [low, high] = beside(mesh, at);
    let position = |node: usize| number(mesh.nodes()[node]);
    let nearest = if low == high {
        format!("the nearest is {} m (node {low}", position(low))
    } else {
        format!("the nearest are {} m and {} m (nodes {low} and {high}", position(low), position(high))
    };
    let (found, last) = (findings.written(path), mesh.elements());
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
    findings.put(path, problem, label);
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
    let place = |contact: &Contact| {
        let other = contact.against.map(|other| (other.structure, other.node));
        (contact.structure, contact.node, contact.direction, other)
    };
    if place(first) != place(second) {
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
    let problem = match findings.place(&format!("contact.{i}")) {
        Some(place) => problem.with(place.value.clone(), "the first one"),
        None => problem,
    };
    findings.put(&format!("contact.{j}"), problem, "the second one");
    false
}
