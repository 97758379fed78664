//! The lines of data under a keyword.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::elements::Shape;
use super::{Deck, Numbered};
use crate::error::{Problem, Result};
use crate::keyword;
use crate::mesh::source::Source;
use crate::text::{commas, unsigned};

/// The block under way.
pub(super) enum State {
    Other,
    Nodes { set: Option<String> },
    Elements { shape: Option<Shape>, kind: Arc<str>, set: Option<String>, begun: Vec<u64> },
    NodeSet { name: String, generate: bool },
    ElementSet { name: String, generate: bool },
    Surface { name: String },
    Elastic,
    Supports,
}

impl State {
    /// A block must not end within an element.
    pub(super) fn check_end(&self, source: &Source) -> Result<()> {
        match self {
            Self::Elements { shape: Some(shape), begun, kind, .. } if !begun.is_empty() => {
                let expected = format!("{} nodes of element {} of type {kind}", shape.nodes, begun[0]);
                let found = format!("{} before this line", begun.len() - 1);
                Err(source.error(Problem::Expected { expected, found }))
            }
            _ => Ok(()),
        }
    }
}

impl Deck {
    pub(super) fn line(&mut self, source: &Source, state: &mut State) -> Result<()> {
        match state {
            State::Other => Ok(()),
            State::Nodes { set } => self.node(source, set.as_deref()),
            State::Elements { shape: Some(shape), set, begun, kind } => {
                for field in commas(source.line()) {
                    let what = if begun.is_empty() { "number of the element" } else { "number of a node" };
                    begun.push(source.unsigned(field, what)?);
                }
                // CalculiX adds three inner nodes to each of these, as do decks derived from its results.
                if kind.starts_with("C3D8I") && begun.len() == shape.nodes + 4 {
                    begun.truncate(shape.nodes + 1);
                }
                match begun.len().cmp(&(shape.nodes + 1)) {
                    Ordering::Less => Ok(()),
                    Ordering::Equal => self.element(source, (*shape, kind), std::mem::take(begun), set.as_deref()),
                    Ordering::Greater => {
                        Err(source.expected(&format!("{} nodes of element {}", shape.nodes, begun[0])))
                    }
                }
            }
            State::Elements { shape: None, kind, .. } => {
                *self.mesh.passed_over.entry(kind.to_string()).or_default() += 1;
                Ok(())
            }
            State::NodeSet { name, generate } => self.node_set(source, name, *generate),
            State::ElementSet { name, generate } => {
                let elements = members(source, *generate, &self.element_sets, &mut self.in_sets)?;
                self.element_sets.entry(name.clone()).or_default().extend(elements);
                Ok(())
            }
            State::Surface { name } => self.surface(source, name),
            State::Elastic => {
                self.materials.elastic(source.line());
                Ok(())
            }
            State::Supports => {
                self.support(source);
                Ok(())
            }
        }
    }

    fn node(&mut self, source: &Source, set: Option<&str>) -> Result<()> {
        let fields: Vec<&[u8]> = commas(source.line()).collect();
        // Omitted coordinates are 0; Abaqus permits up to three numbers of a normal after them, which CalculiX ignores.
        if !matches!(fields.len(), 1..=7) {
            return Err(source.expected("a node: number, x, y, z"));
        }
        let number = source.unsigned(fields[0], "number of the node")?;
        let coordinate = |k: usize| match fields.get(k) {
            None | Some(&[]) => Ok(0.0),
            Some(field) => source.real(field, "coordinate"),
        };
        let place = [coordinate(1)?, coordinate(2)?, coordinate(3)?];
        if let Err(before) = self.mesh.add_node(number, place) {
            return Err(source.expected(&format!("node {number} at {before:?}, as in its earlier line")));
        }
        if let Some(set) = set {
            self.mesh.add_to_set(set, [number]);
        }
        Ok(())
    }

    fn element(
        &mut self,
        source: &Source,
        (shape, kind): (Shape, &Arc<str>),
        mut nodes: Vec<u64>,
        set: Option<&str>,
    ) -> Result<()> {
        let number = nodes.remove(0);
        if self.by_number.insert(number, self.elements.len()).is_some() {
            return Err(source.expected(&format!("element {number} once, it is there already")));
        }
        self.elements.push(Numbered { number, shape, nodes, mention: source.mention(), kind: kind.clone() });
        if let Some(set) = set {
            self.element_sets.entry(set.to_owned()).or_default().push(number);
        }
        Ok(())
    }

    fn node_set(&mut self, source: &Source, name: &str, generate: bool) -> Result<()> {
        let nodes = members(source, generate, &self.mesh.node_sets, &mut self.in_sets)?;
        // A range may pass numbers that no node has, also where its set is named.
        if !generate {
            let named = commas(source.line()).filter_map(unsigned);
            self.mentions.extend(named.map(|node| (node, source.mention())));
        }
        self.mesh.add_to_set(name, nodes);
        Ok(())
    }

    /// `element or set, S1`: the nodes of these faces.
    fn surface(&mut self, source: &Source, name: &str) -> Result<()> {
        let fields: Vec<&[u8]> = commas(source.line()).collect();
        let [what, face] = fields[..] else {
            return Err(source.expected("an element or a set of elements, and a face S1 to S6"));
        };
        let elements = match unsigned(what) {
            Some(number) => vec![number],
            None => self.element_set(source, &keyword::name(what))?.to_vec(),
        };
        let digit = face.strip_prefix(b"S").or_else(|| face.strip_prefix(b"s")).and_then(unsigned);
        let mut nodes = Vec::new();
        for element in elements.iter().filter_map(|number| self.by_number.get(number)).map(|at| &self.elements[*at]) {
            let kind = element.shape.kind;
            // Shells have SPOS and SNEG, with the same nodes.
            let face = match digit.filter(|_| kind.is_solid()) {
                Some(k) => kind.faces().get((k as usize).wrapping_sub(1)),
                None => kind.faces().first().filter(|_| !kind.is_solid()),
            };
            let face = face.ok_or_else(|| source.expected("a face that the elements have"))?;
            let local: Vec<u32> = (0..element.nodes.len() as u32).collect();
            let face = kind.face_nodes(face, &element.shape.ordered(&local));
            nodes.extend(face.iter().map(|k| element.nodes[*k as usize]));
        }
        self.mesh.add_to_set(name, nodes);
        Ok(())
    }
}

/// Most numbers that the sets of a deck name, those of ranges and of sets within sets included: a few lines could name
/// more than fit into memory.
const MOST_IN_SETS: u64 = 50_000_000;

/// Numbers of a set: those of a line, of other sets, or a range. They are counted before they are made.
fn members(source: &Source, generate: bool, known: &BTreeMap<String, Vec<u64>>, in_sets: &mut u64) -> Result<Vec<u64>> {
    let mut count = |more: u64| {
        *in_sets = in_sets.saturating_add(more);
        let all = || source.expected(&format!("sets that name at most {MOST_IN_SETS} numbers in all"));
        if *in_sets > MOST_IN_SETS { Err(all()) } else { Ok(()) }
    };
    if generate {
        let (first, last, step) = range(source)?;
        count(((last - first) / step).saturating_add(1))?;
        return Ok((first..=last).step_by(step as usize).collect());
    }
    let mut found = Vec::new();
    for field in commas(source.line()).filter(|field| !field.is_empty()) {
        match unsigned(field) {
            Some(number) => {
                count(1)?;
                found.push(number);
            }
            None => {
                let name = keyword::name(field);
                let missing =
                    || Problem::Missing { what: "set", name: name.clone(), known: known.keys().cloned().collect() };
                let set = known.get(&name).ok_or_else(|| source.error(missing()))?;
                count(set.len() as u64)?;
                found.extend(set);
            }
        }
    }
    Ok(found)
}

/// `first, last[, step]`.
fn range(source: &Source) -> Result<(u64, u64, u64)> {
    let number = |field| source.unsigned(field, "end or step of a range");
    let numbers: Vec<u64> = commas(source.line()).map(number).collect::<Result<_>>()?;
    match numbers[..] {
        [first, last] if first <= last => Ok((first, last, 1)),
        [first, last, step] if first <= last && step > 0 => Ok((first, last, step)),
        [_, _] | [_, _, _] => Err(source.expected("a range that ascends")),
        _ => Err(source.expected("a range: first, last[, step]")),
    }
}
