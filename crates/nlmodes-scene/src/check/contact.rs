mod hertz;

pub use hertz::{check as check_laws, law, laws_apart};

use nlmodes_fem::Mesh;

use crate::check::nodes::{beside, node_at};
use crate::check::parts::no_such_structure;
use crate::raw::{RawAgainst, RawContact, RawStructure};
use crate::rule::number;
use crate::scene::{Contact, Direction, Facing, SceneStructure, StructureKind, Support, holds};
use crate::{Diagnostic, Diagnostics};

/// A structure that contacts can belong to.
pub struct Body<'a> {
    pub raw: &'a RawStructure,
    pub mesh: &'a Mesh,
}

/// Positions at which contacts touch the structure with this index (from 0) of several.
pub fn stops_of(body: usize, written: &[RawContact]) -> Vec<f64> {
    let number = body as u32 + 1;
    let own = |contact: &RawContact| (contact.structure == Some(number)).then_some(contact.at_m);
    let other = |contact: &RawContact| {
        contact.against.as_ref().filter(|other| other.structure == number).map(|other| other.at_m)
    };
    written.iter().flat_map(|contact| [own(contact), other(contact)]).flatten().collect()
}

/// The contacts that are sound; those that are not are in the diagnostics.
pub fn check(written: &[RawContact], bodies: &[Body<'_>], diagnostics: &mut Diagnostics<'_>) -> Vec<Contact> {
    let sound = written.iter().enumerate().filter_map(|(i, raw)| Some((i, sound(i, raw, bodies, diagnostics)?)));
    let sound: Vec<(usize, Contact)> = sound.collect();
    let mut apart: Vec<(usize, Contact)> = Vec::new();
    for contact in sound {
        if apart.iter().all(|other| stand_apart(other, &contact, diagnostics)) {
            apart.push(contact);
        }
    }
    apart.into_iter().map(|(_, contact)| contact).collect()
}

/// Contact `i`, if everything about it is sound.
fn sound(i: usize, raw: &RawContact, bodies: &[Body<'_>], diagnostics: &mut Diagnostics<'_>) -> Option<Contact> {
    let path = format!("contact.{i}");
    let which = "a scene of several structures says which one touches";
    let body = body(&format!("{path}.structure"), raw.structure, bodies.len(), which, diagnostics)?;
    let own = on(body, bodies);
    diagnostics.about_structure(own);
    let Body { raw: structure, mesh } = &bodies[body];
    let movable = can_move(i, raw, structure, diagnostics);
    let node = node(&path, raw.at_m, mesh, diagnostics);
    let free = movable && node.is_some_and(|node| is_free(i, raw, (node, mesh.elements()), structure, diagnostics));
    diagnostics.about_structure(None);
    let against = match &raw.against {
        Some(other) => Some(facing(i, raw, other, body, bodies, diagnostics)?),
        None => None,
    };
    let hertz = hertz::law(i, &raw.stop, raw.friction_estimate, diagnostics);
    let node = node?;
    free.then_some(Contact {
        hertz,
        node,
        at: mesh.nodes()[node],
        direction: raw.direction,
        side: raw.side,
        gap: raw.gap_m,
        stiffness: raw.stop.stiffness_n_m,
        damping: raw.stop.damping_n_s_m,
        friction_estimate: raw.friction_estimate,
        structure: body,
        against,
    })
}

/// Dampers of stops: each acts beside a stiffness, and conservative modes leave it out.
pub fn dampers(
    contacts: &[Contact],
    structure: Option<&SceneStructure>,
    has_responses: bool,
    diagnostics: &mut Diagnostics<'_>,
) {
    let of_elements = contacts.iter().map(|contact| (contact.stiffness, contact.damping));
    let nodes = structure.and_then(SceneStructure::matrices).into_iter().flat_map(|matrices| &matrices.contacts);
    let rows = structure.and_then(SceneStructure::reduced).into_iter().flat_map(|model| &model.row_contacts);
    let stops = of_elements.chain(nodes.map(|contact| (contact.stiffness, contact.damping)));
    let stops = stops.chain(rows.map(|contact| (contact.stiffness, contact.damping)));
    for (i, (stiffness, _)) in stops.enumerate().filter(|(_, (_, damping))| damping.is_some()) {
        let path = format!("contact.{i}.damping_n_s_m");
        if stiffness.is_none() {
            let diagnostic = Diagnostic::error(format!("`{path}` has no effect on a rigid stop"));
            let help = "a stop that dissipates also yields: its damper goes with `stiffness_n_m`";
            diagnostics.put(&path, diagnostic.help(help), "expected `stiffness_n_m` in this table too");
        } else if !has_responses {
            let diagnostic = Diagnostic::warning(format!("`{path}` has no effect without a response"));
            let help =
                "[response] with kind = \"frequency\", \"force\", \"phase-resonance\" or \"damped-mode\" uses it";
            diagnostics.put(&path, diagnostic.help(help), "the scene computes the conservative nonlinear mode");
        }
    }
}

/// The structure that diagnostics are about; none where there is one only.
fn on(body: usize, bodies: &[Body<'_>]) -> Option<usize> {
    (bodies.len() > 1).then_some(body)
}

/// Index of the structure that a table names at `path`; where there are several it must, and `which` says why.
pub fn body(
    path: &str,
    named: Option<u32>,
    count: usize,
    which: &str,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<usize> {
    match named.map(|number| number as usize) {
        Some(number) if number <= count => Some(number - 1),
        Some(number) => {
            no_such_structure(path, number, count, diagnostics);
            None
        }
        None if count == 1 => Some(0),
        None => {
            let key = path.rsplit('.').next().unwrap_or(path);
            let diagnostic = Diagnostic::error(format!("`{path}` is missing"));
            let label = format!("expected `{key}`, a whole number from 1 to {count}, in this table");
            diagnostics.put(path, diagnostic.help(which), label);
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
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Facing> {
    let path = format!("contact.{i}.against");
    let number = other.structure as usize;
    if number > bodies.len() {
        no_such_structure(&format!("{path}.structure"), number, bodies.len(), diagnostics);
        return None;
    }
    let body = number - 1;
    if body == own {
        let diagnostic = Diagnostic::error(format!("`{path}.structure` is the structure that touches"));
        diagnostics.put(&format!("{path}.structure"), diagnostic, "expected the number of another one");
        return None;
    }
    diagnostics.about_structure(on(body, bodies));
    let Body { raw: structure, mesh } = &bodies[body];
    let is_rod = structure.kind == StructureKind::Rod;
    let node = node(&path, other.at_m, mesh, diagnostics);
    diagnostics.about_structure(None);
    if is_rod && raw.direction == Direction::Transverse {
        let diagnostic = Diagnostic::error(format!("`{path}` is a rod, which does not move across its axis"));
        diagnostics.put(&path, diagnostic, "expected a beam, or direction = \"axial\"");
        return None;
    }
    node.map(|node| Facing { structure: body, node, at: mesh.nodes()[node] })
}

/// Whether the structure moves in the direction of the contact at all.
fn can_move(i: usize, contact: &RawContact, structure: &RawStructure, diagnostics: &mut Diagnostics<'_>) -> bool {
    let rod = structure.kind == StructureKind::Rod && contact.direction == Direction::Transverse;
    if rod {
        let path = format!("contact.{i}.direction");
        let diagnostic = Diagnostic::error(format!("`{path}` cannot be \"transverse\" on a rod"));
        let diagnostic =
            diagnostic.help("a rod moves along its axis only; structure.kind = \"beam\" moves across it too");
        diagnostics.put(&path, diagnostic, "expected \"axial\"");
    }
    !rod
}

fn node(path: &str, at: f64, mesh: &Mesh, diagnostics: &mut Diagnostics<'_>) -> Option<usize> {
    let node = node_at(mesh, at);
    if node.is_none() {
        off_node(&format!("{path}.at_m"), at, mesh, diagnostics);
    }
    node
}

fn off_node(path: &str, at: f64, mesh: &Mesh, diagnostics: &mut Diagnostics<'_>) {
    let length = mesh.length();
    let [low, high] = beside(mesh, at);
    let position = |node: usize| number(mesh.nodes()[node]);
    let nearest = if low == high {
        format!("the nearest is {} m (node {low}", position(low))
    } else {
        format!("the nearest are {} m and {} m (nodes {low} and {high}", position(low), position(high))
    };
    let (found, last) = (diagnostics.written(path), mesh.elements());
    let label = format!("found {found}, expected the position of a node; {nearest} of {last})");
    let diagnostic = if at > length {
        let title = format!("`{path}` is beyond the structure, which ends at {} m", number(length));
        perhaps_millimetres(Diagnostic::error(title), at, length)
    } else {
        Diagnostic::error(format!("`{path}` is too close to another node to get one of its own"))
    };
    diagnostics.put(path, diagnostic, label);
}

/// Adds what to write if a position beyond the end of the structure is one in millimetres.
pub fn perhaps_millimetres(diagnostic: Diagnostic, at: f64, length: f64) -> Diagnostic {
    let metres = at * 1e-3;
    if metres > length || at < 10.0 * length {
        return diagnostic;
    }
    diagnostic.help(format!("if {} mm is meant, write {}", number(at), number(metres)))
}

/// Whether the node of the contact is free to move in its direction.
fn is_free(
    i: usize,
    contact: &RawContact,
    (node, last): (usize, usize),
    structure: &RawStructure,
    diagnostics: &mut Diagnostics<'_>,
) -> bool {
    let (end, support) = match node {
        0 => ("start", structure.start),
        _ if node == last => ("end", structure.end.unwrap_or(Support::Free)),
        _ => return true,
    };
    let direction = contact.direction;
    let held = holds(structure.kind, support, direction);
    if held {
        let path = format!("contact.{i}.at_m");
        let diagnostic = Diagnostic::error(format!("`{path}` is at the {} {end}, which does not move", support.name()));
        let label = format!(
            "found {}, expected a node that moves in {} direction",
            diagnostics.written(&path),
            direction.name()
        );
        diagnostics.put(&path, diagnostic, label);
    }
    !held
}

/// Whether two stops differ, and leave room between them.
fn stand_apart(
    (i, first): &(usize, Contact),
    (j, second): &(usize, Contact),
    diagnostics: &mut Diagnostics<'_>,
) -> bool {
    let place = |contact: &Contact| {
        let other = contact.against.map(|other| (other.structure, other.node));
        (contact.structure, contact.node, contact.direction, other)
    };
    if place(first) != place(second) {
        return true;
    }
    let diagnostic = if first.side == second.side {
        Diagnostic::error(format!("`contact.{j}` is at the same place as `contact.{i}`")).help(
            "of two stops with the same position, direction and side only the nearer one can touch; keep that one",
        )
    } else if first.gap + second.gap < 0.0 {
        Diagnostic::error(format!("`contact.{i}` and `contact.{j}` leave no room between them"))
            .help("the two gaps of opposite stops must not add up to less than 0 m")
    } else {
        return true;
    };
    let diagnostic = match diagnostics.place(&format!("contact.{i}")) {
        Some(place) => diagnostic.with(place.value.clone(), "the first one"),
        None => diagnostic,
    };
    diagnostics.put(&format!("contact.{j}"), diagnostic, "the second one");
    false
}
