//! Nodes, elements and sets.

mod bulk;
mod deck;
mod gmsh;
mod kind;
mod skin;
mod source;
mod tributary;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;
use std::sync::Arc;

pub(crate) use bulk::included;
pub use kind::ElementKind;
pub use skin::{Skin, SkinCell};

use crate::Address;
use crate::error::{Problem, ReadError, Result, shown};
use crate::labels::DofLabel;
use crate::nastran::Directions;

/// An element of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its number in the file.
    pub number: u64,
    /// Its shape.
    pub kind: ElementKind,
    /// Indices of its nodes: corner nodes, then midside nodes, in the order of [`ElementKind::edges`].
    pub nodes: Vec<u32>,
}

/// What CalculiX makes of a node of a shell, beam, truss, plane or axisymmetric element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Expanded {
    /// Nodes that all move with it within the plane z = 0.
    InPlane,
    /// So many nodes, whose mean motion is its own.
    Copies(usize),
    /// Number of adjacent nodes: it is a hinge between elements.
    Hinge(usize),
    /// Elements of both kinds meet.
    Mixed,
}

impl Expanded {
    /// What becomes of the node where another element meets it.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::InPlane, Self::InPlane) => Self::InPlane,
            (Self::Copies(a), Self::Copies(b)) => Self::Copies(a.max(b)),
            (Self::Hinge(a), Self::Hinge(b)) => Self::Hinge(a + b),
            _ => Self::Mixed,
        }
    }
}

/// What a deck says of an element beside its nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Behaviour {
    /// Its type, as `C3D20R`.
    pub kind: Arc<str>,
    /// Young's modulus, in the file's unit or in Pa after [`Mesh::scale_stress`], and Poisson's ratio; none of a
    /// material that is not linear elastic and isotropic, or not there.
    pub elastic: Option<[f64; 2]>,
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
    /// Displacements along x, y and z that a deck holds by `*BOUNDARY`, `SPC` or `SPC1`, by the number of the node;
    /// none of a mesh that knows nothing of supports.
    pub supports: Option<BTreeMap<u64, [bool; 3]>>,
    /// Type in a deck and material of each element, in their order; empty where no deck tells them.
    pub(crate) behaviours: Vec<Behaviour>,
    index: HashMap<u64, u32>,
    /// Directions of nodes whose displacements are not along the global axes (`CD` of Nastran's `GRID`).
    pub(crate) directions: HashMap<u64, Directions>,
    /// Nodes with directions of their own in a deck (`*TRANSFORM`), and whether its matrices have them too.
    pub(crate) transformed: BTreeSet<u64>,
    pub(crate) matrices_are_transformed: bool,
    /// Nodes of a deck whose displacements are the rotations of a rigid body (`ROT NODE`).
    pub(crate) rotations: BTreeSet<u64>,
    /// Nodes of a deck that CalculiX replaces by several ones: shells, beams, plane and axisymmetric elements.
    pub(crate) expanded: BTreeMap<u64, Expanded>,
}

impl Mesh {
    /// Reads a mesh: `.inp` of CalculiX or Abaqus, `.msh` of Gmsh (4.1 and 2.2, as text), bulk data of Nastran.
    ///
    /// # Errors
    /// [`ReadError`] with the line and the expected contents.
    pub fn read(path: &Path) -> Result<Self> {
        let address = Address { path: path.to_owned(), name: None };
        match address.ending().as_str() {
            "inp" => deck::read(path),
            "msh" => gmsh::read(path),
            "bdf" | "dat" | "nas" | "fem" | "pch" => bulk::read(path),
            ending => {
                let expected = "a mesh that ends in .inp, .msh, .bdf, .dat, .nas, .fem or .pch".to_owned();
                let found = shown(format!(".{ending}").as_bytes());
                Err(ReadError::whole(path, Problem::Expected { expected, found }))
            }
        }
    }

    /// Index of the node of this number.
    pub fn index_of(&self, number: u64) -> Option<usize> {
        self.index.get(&number).map(|index| *index as usize)
    }

    /// Whether CalculiX makes solids of some of its elements: shells, beams, trusses, plane and axisymmetric ones.
    pub fn is_expanded(&self) -> bool {
        !self.expanded.is_empty()
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

    /// Whether a deck holds a displacement.
    pub(crate) fn holds(&self, label: DofLabel) -> bool {
        let held = self.supports.as_ref().and_then(|supports| supports.get(&label.node));
        label.component.translation().zip(held).is_some_and(|(axis, held)| held[axis])
    }

    /// Type in the deck, Young's modulus (Pa) and Poisson's ratio of the element with this index; none where one of
    /// these is not known.
    pub fn elasticity(&self, element: usize) -> Option<(&str, [f64; 2])> {
        let behaviour = self.behaviours.get(element)?;
        Some((&behaviour.kind, behaviour.elastic?))
    }

    /// Multiplies all Young's moduli.
    pub(crate) fn scale_stress(&mut self, factor: f64) {
        self.behaviours.iter_mut().flat_map(|behaviour| &mut behaviour.elastic).for_each(|[e, _]| *e *= factor);
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
