use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use super::{RawAnalysis, RawStopLaw};
use crate::scene::MatricesKind;

/// A scene of nlmodes: a structure from the files of a finite-element program, its contacts, and how its nonlinear mode
/// is to be computed.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene of matrices")]
pub struct RawMatrixScene {
    /// The structure: its files
    pub structure: RawMatrices,
    /// One-sided contacts of nodes, any number, each under its own heading `[[contact]]`
    pub contact: Option<Vec<RawNodeContact>>,
    /// Everything else
    #[serde(flatten)]
    pub analysis: RawAnalysis,
}

/// The files of a structure.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawMatrices {
    /// Material of the structure
    #[serde(rename = "kind")]
    pub _kind: MatricesKind,
    /// Stiffness matrix: .sti (CalculiX), .mtx (Matrix Market, Abaqus, "sub.mtx#STIFFNESS"), .npz (SciPy), .mat
    /// ("model.mat#K", "model.mat#FEM.K"), .hb, .pch ("model.pch#KAAX"), also .gz; relative to the scene
    #[schemars(length(min = 1))]
    pub stiffness: String,
    /// Mass matrix, likewise
    #[schemars(length(min = 1))]
    pub mass: String,
    /// Node and direction of each row: .dof (CalculiX), .mapping (Ansys) or a table row,node,component[,x,y,z]; not
    /// needed if the matrices have them
    #[schemars(length(min = 1))]
    pub dofs: Option<String>,
    /// Mesh with positions of nodes, node sets and elements: .inp, .msh, or .bdf, .dat, .nas, .pch (Nastran)
    #[schemars(length(min = 1))]
    pub mesh: Option<String>,
    /// Format of the matrices: calculix, matrix-market, abaqus, npz, mat, harwell-boeing or dmig; default: from the
    /// names of the files
    #[schemars(length(min = 1))]
    pub format: Option<String>,
    /// Units of the files, "SI" or such as "mm-t-s"; results are in SI units
    #[schemars(length(min = 1), extend("default" = "m-kg-s"))]
    pub units: Option<String>,
    /// Nodes and node sets to be held that the files leave free
    #[serde(default)]
    #[schemars(schema_with = "numbers_or_names")]
    pub fixed: Option<Vec<NumberOrName>>,
}

/// A node or a set of nodes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum NumberOrName {
    Number(u64),
    Name(String),
}

/// Nodes one by one or as a set.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum NameOrNumbers {
    Name(String),
    Numbers(Vec<u64>),
}

/// A direction.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum RawNormal {
    Vector([f64; 3]),
    Word(String),
}

/// A contact of a node, of each node of a set, or of pairs of nodes.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(extend("required" = [], "oneRequired" = ["node", "nodes", "pairs"]))]
pub struct RawNodeContact {
    /// The node that touches
    pub node: Option<u64>,
    /// The nodes that touch, a node set of the mesh or a list of nodes; each is a contact of its own
    #[schemars(schema_with = "name_or_numbers")]
    pub nodes: Option<NameOrNumbers>,
    /// The nodes that they touch, each the nearest one along the normal; left out, they touch a rigid wall
    #[schemars(schema_with = "name_or_numbers")]
    pub against: Option<NameOrNumbers>,
    /// Table of pairs of nodes that touch, node_a,node_b[,nx,ny,nz,gap_m], relative to the scene
    #[schemars(length(min = 1))]
    pub pairs: Option<String>,
    /// How far sideways from the normal of its partner a node of `against` may be; default: a thousandth of the extent
    /// of the contact
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub pair_tolerance_m: Option<f64>,
    /// Direction from the nodes to what they touch, of any length, or "surface" for the outward normal of the mesh at
    /// each node
    #[schemars(schema_with = "vector_or_surface")]
    pub normal: Option<RawNormal>,
    /// Clearance at rest; 0 touches, a negative one presses; left out beside `against`, it is the distance of each pair
    /// along the normal in the mesh
    #[schemars(extend("unit" = "m"))]
    pub gap_m: Option<f64>,
    /// A point of the wall, which is a plane normal to `normal`: each node has its own clearance
    #[schemars(extend("unit" = "m"))]
    pub wall_point_m: Option<[f64; 3]>,
    /// How each yields and dissipates
    #[serde(flatten)]
    pub stop: RawStopLaw,
    /// Coefficient of friction for the estimate of friction power in `contacts.csv`; the motion itself is computed
    /// without friction
    #[schemars(range(min = 0.0))]
    pub friction_estimate: Option<f64>,
}

fn numbers_or_names(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array",
        "items": { "type": ["integer", "string"], "minimum": 1 },
        "expected": "nodes and names of node sets in square brackets",
    })
}

pub(super) fn name_or_numbers(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["string", "array"],
        "minLength": 1,
        "minItems": 1,
        "items": { "type": "integer", "minimum": 0 },
        "expected": "the name of a node set, or nodes in square brackets",
    })
}

fn vector_or_surface(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["string", "array"],
        "minItems": 3,
        "maxItems": 3,
        "items": { "type": "number" },
        "enum_of_text": ["surface"],
        "expected": "3 numbers in square brackets, or \"surface\"",
    })
}
