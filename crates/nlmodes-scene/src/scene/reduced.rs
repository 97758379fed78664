use std::path::PathBuf;

use nlmodes_io::{Address, UnitSystem};
use serde::{Deserialize, Serialize};

use super::{Hertz, Side};

/// A structure of which another program computed free-interface modes and the static flexibility of some displacements,
/// its rows: those of contacts, and of places where forces act.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReducedModel {
    /// Frequencies of the modes, Hz, ascending; zero for each rigid-body motion.
    pub frequencies_hz: Numbers,
    /// Displacements of the rows in the mass-normalised modes.
    pub contact_rows: Numbers,
    /// Static displacements of the rows under unit forces.
    pub flexibility: Flexibility,
    /// A mesh and the displacements of its nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<Picture>,
    /// Units of the files; numbers of the scene are in SI units.
    pub units: UnitSystem,
    /// The tables `[[contact]]`, in the order of the file.
    pub row_contacts: Vec<RowContact>,
    /// Those whose stop has a law of force, which stand behind the others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub law_contacts: Vec<LawContact<RowContact>>,
}

/// A contact whose stop has a law of force: it is no contact of the structural model, but a law beside it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LawContact<C> {
    /// Where it is, and its clearance.
    pub contact: C,
    /// Its law.
    pub hertz: Hertz,
}

/// The displacements of the nodes of a mesh in the modes of a structure that was reduced elsewhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Displacements in the mass-normalised modes.
    pub rows: Numbers,
    /// Static displacements under unit forces along the rows of the structure, of the same kind as its flexibility.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flexibility: Option<Numbers>,
    /// Table of the node and direction of each.
    pub dofs: PathBuf,
    /// Mesh with places and elements.
    pub mesh: PathBuf,
}

/// Numbers of a scene, or of a file that it names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Numbers {
    /// In a file, with its path from where the program is started.
    File(Address),
    /// A list.
    List(Vec<f64>),
    /// A list of lists, row by row.
    Table(Vec<Vec<f64>>),
}

/// Which flexibility is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Flexibility {
    /// The whole static one.
    Static(Numbers),
    /// What the modes leave of it.
    Residual(Numbers),
}

impl Flexibility {
    /// The key of the scene below `structure`.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Static(_) => "flexibility_m_n",
            Self::Residual(_) => "residual_flexibility_m_n",
        }
    }

    /// Its numbers.
    pub fn numbers(&self) -> &Numbers {
        match self {
            Self::Static(numbers) | Self::Residual(numbers) => numbers,
        }
    }
}

/// A contact of a structure that was reduced elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RowContact {
    /// Number of the row that moves toward the stop, from 1.
    pub row: usize,
    /// Whether the stop is met by positive or by negative displacements of the row.
    pub side: Side,
    /// Clearance at rest, m.
    pub gap: f64,
    /// Contact stiffness, N/m; rigid without one.
    pub stiffness: Option<f64>,
    /// Damper beside the stiffness, N s/m.
    pub damping: Option<f64>,
}
