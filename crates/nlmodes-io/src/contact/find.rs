use std::collections::HashMap;

use super::{
    ContactChoice, ContactError, ContactNodes, ContactProblem, GapChoice, NodeContact, NormalChoice, Partner, pairs,
};
use crate::labels::Component;
use crate::mesh::Skin;
use crate::model::{FeFiles, FeModel};

/// By this the product of the normals of two contacts may differ from 1 or −1 where they have one direction: less than
/// three seconds of arc are rounding.
const ROUNDED: f64 = 1e-10;

type Vector = [f64; 3];
type Outcome<T> = Result<T, ContactProblem>;

/// All contacts of a model, in the order of the choices and of the nodes in their sets.
///
/// # Errors
/// [`ContactError`]: nodes that do not exist or are fixed along the normal, duplicate contacts, nodes without a
/// partner.
pub fn find_contacts(
    model: &FeModel,
    files: &FeFiles,
    choices: &[ContactChoice],
) -> Result<Vec<NodeContact>, ContactError> {
    let mut found: Vec<NodeContact> = Vec::new();
    let mut known: HashMap<(u64, Option<u64>), Vec<usize>> = HashMap::new();
    for (origin, choice) in choices.iter().enumerate() {
        let wrong = |problem| ContactError { contact: origin, problem };
        let one = One { model, files, choice, origin };
        for contact in one.contacts().map_err(wrong)? {
            one.check(&contact).map_err(wrong)?;
            let of_nodes = known.entry((contact.node, contact.against)).or_default();
            let product = |k: usize| dot(found[k].normal, contact.normal);
            if let Some(before) = of_nodes.iter().find(|k| product(**k) > 1.0 - ROUNDED) {
                return Err(wrong(ContactProblem::Twice { node: contact.node, before: found[*before].origin }));
            }
            let facing: Vec<usize> = of_nodes.iter().copied().filter(|k| product(*k) < ROUNDED - 1.0).collect();
            let no_room = |k: &&usize| {
                let (one, both_rigid) = (&found[**k], found[**k].stiffness.or(contact.stiffness).is_none());
                both_rigid && one.gap + contact.gap < 0.0
            };
            if let Some(&before) = facing.iter().find(no_room) {
                let (node, room, before) = (contact.node, found[before].gap + contact.gap, found[before].origin);
                return Err(wrong(ContactProblem::NoRoom { node, before, room }));
            }
            // What faces another one up to rounding moves in its direction, not in one more.
            let normal = facing.first().map_or(contact.normal, |k| found[*k].normal.map(|x| -x));
            let contact = NodeContact { normal, ..contact };
            of_nodes.push(found.len());
            found.push(contact);
        }
    }
    Ok(found)
}

struct One<'a> {
    model: &'a FeModel,
    files: &'a FeFiles,
    choice: &'a ContactChoice,
    origin: usize,
}

impl One<'_> {
    fn contacts(&self) -> Outcome<Vec<NodeContact>> {
        match &self.choice.partner {
            Partner::Wall => {
                let nodes = self.nodes(&self.choice.nodes)?;
                let normals = self.normals(&nodes)?;
                nodes.iter().zip(normals).map(|(node, normal)| self.contact(*node, None, normal, None)).collect()
            }
            Partner::Nearest(against, tolerance) => self.nearest(against, *tolerance),
            Partner::Table(path) => {
                let pairs = pairs::read(path)?;
                let bare: Vec<u64> = pairs.iter().filter(|p| p.normal_and_gap.is_none()).map(|p| p.a).collect();
                let mut normals = if bare.is_empty() { Vec::new() } else { self.normals(&bare)? }.into_iter();
                let contact = |pair: pairs::Pair| match pair.normal_and_gap {
                    Some((normal, gap)) => self.contact(pair.a, Some(pair.b), unit(pair.a, normal)?, Some(gap)),
                    None => {
                        let normal = normals.next().ok_or(ContactProblem::Unsaid { node: pair.a, what: "normal" })?;
                        self.contact(pair.a, Some(pair.b), normal, None)
                    }
                };
                let contacts: Vec<NodeContact> = pairs.into_iter().map(contact).collect::<Outcome<_>>()?;
                let ends = contacts.iter().flat_map(|c| [Some(c.node), c.against]).flatten();
                let places: Vec<Vector> = ends.filter_map(|node| self.model.place_of(node)).collect();
                let tolerance = BESIDE * extent(&places);
                let allowed = |contact: &NodeContact| tolerance + interference(contact);
                contacts.iter().try_for_each(|contact| self.check_side(contact, allowed(contact)))?;
                Ok(contacts)
            }
        }
    }

    fn contact(&self, node: u64, against: Option<u64>, normal: Vector, gap: Option<f64>) -> Outcome<NodeContact> {
        let gap = match (gap, self.choice.gap) {
            (Some(gap), _) | (None, Some(GapChoice::Same(gap))) => gap,
            (None, Some(GapChoice::WallPoint(point))) => dot(minus(point, self.place(node)?), normal),
            (None, None) => return Err(ContactProblem::Unsaid { node, what: "gap" }),
        };
        let ContactChoice { stiffness, damping, .. } = *self.choice;
        Ok(NodeContact { node, against, normal, gap, stiffness, damping, origin: self.origin })
    }

    fn nodes(&self, choice: &ContactNodes) -> Outcome<Vec<u64>> {
        match choice {
            ContactNodes::Set(name) => Ok(self.model.nodes_of_set(self.files, name)?),
            ContactNodes::Numbers(numbers) => Ok(numbers.clone()),
            ContactNodes::OfPairs => Ok(Vec::new()),
        }
    }

    fn place(&self, node: u64) -> Outcome<Vector> {
        self.model.place_of(node).ok_or(ContactProblem::NoPlace { node })
    }

    fn normals(&self, nodes: &[u64]) -> Outcome<Vec<Vector>> {
        match (self.choice.normal, &self.model.mesh) {
            (Some(NormalChoice::Vector(vector)), _) => nodes.iter().map(|node| unit(*node, vector)).collect(),
            (Some(NormalChoice::Surface), Some(mesh)) => {
                let set: Vec<u32> = nodes.iter().filter_map(|node| Some(mesh.index_of(*node)? as u32)).collect();
                let normals = Skin::of(mesh).normals_within(mesh, &set);
                let normal = |node: &u64| {
                    let normal = mesh.index_of(*node).map_or([0.0; 3], |index| normals[index]);
                    unit(*node, normal).map_err(|_| ContactProblem::NotOnSurface { node: *node })
                };
                nodes.iter().map(normal).collect()
            }
            (Some(NormalChoice::Surface), None) => {
                Err(ContactProblem::NotOnSurface { node: nodes.first().copied().unwrap_or(0) })
            }
            (None, _) => Err(ContactProblem::Unsaid { node: nodes.first().copied().unwrap_or(0), what: "normal" }),
        }
    }

    /// For each node the first one ahead on the line along its normal, within the tolerance.
    fn nearest(&self, against: &ContactNodes, tolerance: Option<f64>) -> Outcome<Vec<NodeContact>> {
        let (nodes, others) = (self.nodes(&self.choice.nodes)?, self.nodes(against)?);
        let normals = self.normals(&nodes)?;
        let places: Vec<Vector> = others.iter().map(|node| self.place(*node)).collect::<Outcome<_>>()?;
        let tolerance = tolerance.unwrap_or_else(|| BESIDE * extent(&places));
        let own: Vec<Vector> = nodes.iter().map(|node| self.place(*node)).collect::<Outcome<_>>()?;
        let reach = extent(&[own.as_slice(), &places].concat());
        let overlap = BESIDE * reach;
        let mut contacts = Vec::new();
        for ((&node, normal), place) in nodes.iter().zip(normals).zip(own) {
            let seen = |(other, number): (&Vector, &u64)| {
                let step = minus(*other, place);
                let along = dot(step, normal);
                let across = minus(step, normal.map(|n| along * n));
                Seen { number: *number, along, beside: dot(across, across).sqrt() }
            };
            let all = || places.iter().zip(&others).filter(|(_, other)| **other != node).map(seen);
            let Some(nearest) = all().min_by(|a, b| a.beside.total_cmp(&b.beside)) else {
                return Err(ContactProblem::Itself { node });
            };
            if nearest.beside > tolerance {
                let Seen { number: nearest, beside: distance, .. } = nearest;
                return Err(ContactProblem::NoPartner { node, nearest, distance, tolerance });
            }
            // Of a body with two faces the near one is in contact; faces behind the node belong to another.
            let ahead = || all().filter(|other| other.beside <= tolerance && other.along >= -overlap);
            let first = ahead().map(|other| other.along).fold(f64::INFINITY, f64::min);
            let found = ahead().filter(|other| other.along <= first + overlap);
            let found = found.min_by(|a, b| a.beside.total_cmp(&b.beside)).unwrap_or(nearest);
            let drawn = self.choice.gap.is_none().then_some(found.along);
            let drawn = drawn.map(|gap| if gap.abs() <= ROUNDING * reach { 0.0 } else { gap });
            let contact = self.contact(node, Some(found.number), normal, drawn)?;
            self.check_side(&contact, overlap + if drawn.is_some() { 0.0 } else { interference(&contact) })?;
            contacts.push(contact);
        }
        Ok(contacts)
    }

    /// The obstacle of a node is in the direction of its normal, or behind it by at most this distance (m).
    fn check_side(&self, contact: &NodeContact, allowed: f64) -> Outcome<()> {
        match (contact.against, contact.distance_in(self.model)) {
            (Some(other), Some(along)) if along < -allowed => {
                Err(ContactProblem::Behind { node: contact.node, other, normal: contact.normal, distance: -along })
            }
            _ => Ok(()),
        }
    }

    /// Nodes must be there, and one of them free to move along the normal.
    fn check(&self, contact: &NodeContact) -> Outcome<()> {
        let NodeContact { node, against, normal, .. } = *contact;
        if against == Some(node) {
            return Err(ContactProblem::Itself { node });
        }
        let nodes = std::iter::once(node).chain(against);
        if let Some(node) = nodes.into_iter().find(|node| self.model.translations_of(*node) == [None; 3]) {
            return Err(ContactProblem::NoDisplacement { node });
        }
        if contact.column(self.model, 0).iter().all(|entry| entry.2.abs() < 1e-9) {
            return Err(ContactProblem::HeldAlongNormal { node, normal });
        }
        // Along part of the normal a node may move with others, which its own rows do not show. For a deck without
        // supports it is unknown what is fixed.
        let mesh = self.model.mesh.as_ref();
        let supported = mesh.and_then(|mesh| mesh.supports.as_ref()).is_some_and(|supports| !supports.is_empty());
        let depends = |node: &u64| {
            let mut along = self.model.translations_of(*node).into_iter().zip(Component::DIRECTED).zip(normal);
            let unknown = |component| self.model.is_held(*node, component) == Some(false);
            supported && along.any(|((row, component), part)| row.is_none() && part.abs() > 1e-9 && unknown(component))
        };
        if let Some(node) = std::iter::once(node).chain(against).find(depends) {
            return Err(ContactProblem::HeldAlongNormal { node, normal });
        }
        Ok(())
    }
}

/// Fraction of the extent of the other body by which its nodes may be off the normal, and of that of both by which they
/// may be behind the node.
const BESIDE: f64 = 1e-3;

/// Distances up to this share of the extent of two bodies are rounding of their places.
const ROUNDING: f64 = 1e-9;

/// Overlap of two nodes at rest according to their gap, m.
fn interference(contact: &NodeContact) -> f64 {
    (-contact.gap).max(0.0)
}

/// A node as seen from another along its normal.
#[derive(Clone, Copy)]
struct Seen {
    number: u64,
    /// Distance along the normal, m; negative behind.
    along: f64,
    /// Distance from the normal, m.
    beside: f64,
}

fn unit(node: u64, vector: Vector) -> Outcome<Vector> {
    let length = dot(vector, vector).sqrt();
    if length.is_finite() && length > 0.0 {
        return Ok(vector.map(|x| x / length));
    }
    Err(ContactProblem::NoDirection { node })
}

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Longest side of the box around some places.
fn extent(places: &[Vector]) -> f64 {
    let side = |axis: usize| {
        let values = || places.iter().map(|place| place[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    if places.is_empty() { 0.0 } else { (0..3).map(side).fold(0.0, f64::max) }
}
