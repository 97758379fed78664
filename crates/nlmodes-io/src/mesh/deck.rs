//! `.inp` of CalculiX and Abaqus: nodes, elements, sets and surfaces of a flat deck.

mod blocks;
mod elements;
mod materials;
mod supports;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use self::blocks::State;
use self::elements::{Shape, shape};
use self::materials::Materials;
use super::source::{Mention, Source};
use super::{Behaviour, Element, Mesh};
use crate::error::{Place, Problem, ReadError, Result};
use crate::keyword::Keyword;
use crate::text::unsigned;

/// Keywords that make nodes or elements which no line of the deck holds, or turn axes: a mesh without heeding them
/// would be wrong.
const REFUSED: [(&str, &str); 10] = [
    ("NGEN", "generated nodes are not read; write the deck with all its nodes"),
    ("NFILL", "generated nodes are not read; write the deck with all its nodes"),
    ("NCOPY", "generated nodes are not read; write the deck with all its nodes"),
    ("ELGEN", "generated elements are not read; write the deck with all its elements"),
    ("ELCOPY", "generated elements are not read; write the deck with all its elements"),
    ("NMAP", "mapped nodes are not read; write the deck with all its nodes"),
    ("SYSTEM", "only global axes are read"),
    ("PART", "parts have node numbers of their own; write a deck without parts and assemblies"),
    ("INSTANCE", "instances have node numbers of their own; write a deck without parts and assemblies"),
    ("SUBMODEL", "nodes of another model are not read"),
];

pub(super) fn read(path: &Path) -> Result<Mesh> {
    let mut deck = Deck::default();
    deck.mesh.supports = Some(BTreeMap::new());
    let mut source = Source::open(path)?;
    let mut state = State::Other;
    while source.advance()? {
        let line = source.line().trim_ascii();
        if line.is_empty() || line.starts_with(b"**") {
            continue;
        }
        if line.starts_with(b"*") {
            state.check_end(&source)?;
            let keyword = source.keyword()?;
            state = deck.begin(&mut source, &keyword)?;
        } else {
            deck.line(&source, &mut state)?;
        }
    }
    state.check_end(&source)?;
    deck.finish(path)
}

/// An element whose nodes are still numbers.
struct Numbered {
    number: u64,
    shape: Shape,
    nodes: Vec<u64>,
    mention: Mention,
    kind: Arc<str>,
}

#[derive(Default)]
struct Deck {
    mesh: Mesh,
    elements: Vec<Numbered>,
    by_number: HashMap<u64, usize>,
    element_sets: BTreeMap<String, Vec<u64>>,
    materials: Materials,
    mentions: Vec<(u64, Mention)>,
    /// Node sets with directions of their own.
    transformed: Vec<String>,
    /// Numbers that the lines of sets have named so far.
    in_sets: u64,
}

impl Deck {
    fn begin(&mut self, source: &mut Source, keyword: &Keyword) -> Result<State> {
        if let Some((name, reason)) = REFUSED.iter().find(|(name, _)| *name == keyword.name) {
            let found = format!("*{name}");
            return Err(source.error(Problem::Refused { found, expected: "a flat deck in global axes", reason }));
        }
        Ok(match keyword.name.as_str() {
            "INCLUDE" => {
                let name = source.need(keyword, "INPUT")?;
                source.include(&name)?;
                State::Other
            }
            "NODE" => {
                if keyword.option("SYSTEM").is_some_and(|system| system != "R") {
                    return Err(source.expected("coordinates along global axes (SYSTEM=R)"));
                }
                State::Nodes { set: keyword.option("NSET") }
            }
            "ELEMENT" => {
                let kind = source.need(keyword, "TYPE")?;
                let (shape, kind) = (shape(&kind), Arc::from(kind));
                State::Elements { shape, kind, set: keyword.option("ELSET"), begun: Vec::new() }
            }
            "NSET" => {
                let name = source.need(keyword, "NSET")?;
                let nodes = match keyword.option("ELSET") {
                    Some(set) => self.nodes_of_elements(source, &set)?,
                    None => Vec::new(),
                };
                self.mesh.add_to_set(&name, nodes);
                State::NodeSet { name, generate: keyword.has("GENERATE") }
            }
            "ELSET" => State::ElementSet { name: source.need(keyword, "ELSET")?, generate: keyword.has("GENERATE") },
            "SURFACE" => {
                let name = source.need(keyword, "NAME")?;
                match keyword.option("TYPE").as_deref() {
                    Some("NODE") => State::NodeSet { name, generate: false },
                    _ => State::Surface { name },
                }
            }
            "MATERIAL" => {
                self.materials.begin(keyword.option("NAME"));
                State::Other
            }
            "ELASTIC" if matches!(keyword.option("TYPE").as_deref(), None | Some("ISO" | "ISOTROPIC")) => {
                State::Elastic
            }
            "SOLID SECTION" => {
                self.materials.section(keyword.option("ELSET"), keyword.option("MATERIAL"));
                State::Other
            }
            "BOUNDARY" => State::Supports,
            "TRANSFORM" => {
                self.transformed.push(source.need(keyword, "NSET")?);
                State::Other
            }
            "RIGID BODY" => {
                let node = keyword.option("ROT NODE").and_then(|node| unsigned(node.as_bytes()));
                self.mesh.rotations.extend(node);
                State::Other
            }
            "FREQUENCY" => {
                // CalculiX transforms its matrices only if requested.
                self.mesh.matrices_are_transformed |= keyword.option("GLOBAL").as_deref() == Some("NO");
                State::Other
            }
            _ => State::Other,
        })
    }

    /// Elements of a set by its name.
    fn element_set(&self, source: &Source, set: &str) -> Result<&[u64]> {
        let known = || self.element_sets.keys().cloned().collect();
        let missing = || source.error(Problem::Missing { what: "element set", name: set.to_owned(), known: known() });
        self.element_sets.get(set).map(Vec::as_slice).ok_or_else(missing)
    }

    fn nodes_of_elements(&self, source: &Source, set: &str) -> Result<Vec<u64>> {
        let elements = self.element_set(source, set)?.iter().filter_map(|number| self.by_number.get(number));
        Ok(elements.flat_map(|at| self.elements[*at].nodes.iter().copied()).collect())
    }

    /// All nodes must be there.
    fn finish(mut self, path: &Path) -> Result<Mesh> {
        if self.mesh.numbers.is_empty() {
            let expected = "nodes (*NODE)".to_owned();
            return Err(ReadError::whole(path, Problem::Ended { expected }));
        }
        self.transform();
        let mut elastic = self.materials.of_elements(&self.element_sets);
        for element in std::mem::take(&mut self.elements) {
            self.expand(&element);
            let index = |node: &u64| self.mesh.index_of(*node).map(|k| k as u32);
            let index = |node: &u64| index(node).ok_or_else(|| missing(*node, &element.mention));
            let nodes: Vec<u32> = element.nodes.iter().map(index).collect::<Result<_>>()?;
            let nodes = element.shape.ordered(&nodes);
            let elastic = elastic.remove(&element.number);
            self.mesh.behaviours.push(Behaviour { kind: element.kind.clone(), elastic });
            self.mesh.elements.push(Element { number: element.number, kind: element.shape.kind, nodes });
        }
        if let Some((node, mention)) = self.mentions.iter().find(|(node, _)| self.mesh.index_of(*node).is_none()) {
            return Err(missing(*node, mention));
        }
        let known = &self.mesh.index;
        self.mesh.node_sets.values_mut().for_each(|set| set.retain(|node| known.contains_key(node)));
        self.mesh.sort_sets();
        Ok(self.mesh)
    }
}

impl Deck {
    /// Nodes with directions of their own: what holds them along some of these is not known along the global ones.
    fn transform(&mut self) {
        for set in std::mem::take(&mut self.transformed) {
            self.mesh.transformed.extend(self.mesh.node_set(&set).unwrap_or_default().to_vec());
        }
        let transformed = &self.mesh.transformed;
        if let Some(supports) = &mut self.mesh.supports {
            supports.retain(|node, held| !transformed.contains(node) || *held == [true; 3]);
        }
    }

    /// Notes what CalculiX makes of the nodes of an element.
    fn expand(&mut self, element: &Numbered) {
        let Some(expansion) = element.shape.expansion else { return };
        for (k, node) in element.nodes.iter().enumerate() {
            let new = expansion.expanded(k, element.shape.nodes);
            self.mesh.expanded.entry(*node).and_modify(|known| *known = known.with(new)).or_insert(new);
        }
    }
}

fn missing(node: u64, (path, line): &Mention) -> ReadError {
    let (expected, found) = ("nodes of the deck".to_owned(), format!("node {node}, which is not there"));
    ReadError::new(path, Place::Line(*line), Problem::Expected { expected, found })
}
