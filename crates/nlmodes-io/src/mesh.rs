//! Nodes, elements and sets.

mod deck;
mod gmsh;
mod kind;
mod skin;
mod tributary;

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

pub use kind::ElementKind;
pub use skin::{Skin, SkinCell};

use crate::Address;
use crate::error::{Problem, ReadError, Result, shown};

/// An element of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its number in the file.
    pub number: u64,
    /// Its shape.
    pub kind: ElementKind,
    /// Indices of its nodes: corners, then the middles of edges, in the order of [`ElementKind::edges`].
    pub nodes: Vec<u32>,
}

/// Nodes with their places, elements, and named sets of nodes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Numbers of the nodes in the file.
    pub numbers: Vec<u64>,
    /// Their places, in the file's unit of length or in m after [`Mesh::scale`].
    pub places: Vec<[f64; 3]>,
    /// Elements whose shape is known.
    pub elements: Vec<Element>,
    /// Sets of nodes by name, as numbers in the file, ascending: sets of nodes, named surfaces, physical groups. Names
    /// of decks are in capitals.
    pub node_sets: BTreeMap<String, Vec<u64>>,
    /// Kinds of elements that were passed over since their shape is not known, and how many there are.
    pub passed_over: BTreeMap<String, usize>,
    /// Displacements along x, y and z that a deck holds by `*BOUNDARY`, by the number of the node; none of a mesh that
    /// knows nothing of supports.
    pub supports: Option<BTreeMap<u64, [bool; 3]>>,
    index: HashMap<u64, u32>,
}

impl Mesh {
    /// Reads a mesh: `.inp` of CalculiX or Abaqus, `.msh` of Gmsh (4.1 and 2.2, as text).
    ///
    /// # Errors
    /// [`ReadError`] with the line and what was expected there.
    pub fn read(path: &Path) -> Result<Self> {
        let address = Address { path: path.to_owned(), name: None };
        match address.ending().as_str() {
            "inp" => deck::read(path),
            "msh" => gmsh::read(path),
            ending => {
                let expected = "a mesh that ends in .inp or .msh".to_owned();
                let found = shown(format!(".{ending}").as_bytes());
                Err(ReadError::whole(path, Problem::Expected { expected, found }))
            }
        }
    }

    /// Index of the node of this number.
    pub fn index_of(&self, number: u64) -> Option<usize> {
        self.index.get(&number).map(|index| *index as usize)
    }

    /// Place of the node of this number.
    pub fn place_of(&self, number: u64) -> Option<[f64; 3]> {
        self.index_of(number).map(|index| self.places[index])
    }

    /// The node set of this name, also in capital letters.
    pub fn node_set(&self, name: &str) -> Option<&[u64]> {
        let set = self.node_sets.get(name).or_else(|| self.node_sets.get(&name.to_uppercase()));
        set.map(Vec::as_slice)
    }

    /// Multiplies all places.
    pub fn scale(&mut self, factor: f64) {
        self.places.iter_mut().flatten().for_each(|x| *x *= factor);
    }

    /// Adds a node; the place that it has already, if there is such a node at another place.
    fn add_node(&mut self, number: u64, place: [f64; 3]) -> std::result::Result<(), [f64; 3]> {
        if let Some(index) = self.index_of(number) {
            let before = self.places[index];
            return if before == place { Ok(()) } else { Err(before) };
        }
        self.index.insert(number, self.numbers.len() as u32);
        self.numbers.push(number);
        self.places.push(place);
        Ok(())
    }

    fn add_to_set(&mut self, name: &str, nodes: impl IntoIterator<Item = u64>) {
        self.node_sets.entry(name.to_owned()).or_default().extend(nodes);
    }

    fn sort_sets(&mut self) {
        for set in self.node_sets.values_mut() {
            set.sort_unstable();
            set.dedup();
        }
    }
}
