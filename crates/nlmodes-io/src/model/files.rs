use std::path::PathBuf;

use crate::{Address, Format, UnitSystem};

/// Nodes that are named one by one or as a set of the mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(untagged))]
pub enum NodeChoice {
    /// A node set of the mesh.
    Set(String),
    /// A node by its number.
    Node(u64),
}

/// The files of a model, and how they are to be understood.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeFiles {
    /// Stiffness matrix.
    pub stiffness: Address,
    /// Mass matrix.
    pub mass: Address,
    /// Table of degrees of freedom; needed unless the matrices name their rows (Abaqus, DMIG).
    pub dofs: Option<PathBuf>,
    /// Mesh with places, sets and elements.
    pub mesh: Option<PathBuf>,
    /// Format of the matrices, if not given by their file extensions.
    pub format: Option<Format>,
    /// Units of all files.
    pub units: UnitSystem,
    /// Nodes that are free in the files and are to be fixed.
    pub fixed: Vec<NodeChoice>,
}

impl FeFiles {
    /// Two matrices in SI units, and nothing else.
    pub fn new(stiffness: &str, mass: &str) -> Self {
        Self {
            stiffness: Address::parse(stiffness),
            mass: Address::parse(mass),
            dofs: None,
            mesh: None,
            format: None,
            units: UnitSystem::SI,
            fixed: Vec::new(),
        }
    }
}
