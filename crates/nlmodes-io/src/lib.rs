//! Finite-element models of other programs in, ParaView files out.
//!
//! ```text
//! M q̈ + K q = 0 ,   M and K symmetric, n × n, read into their lower triangles;  row i ↔ node and component
//! ```
//!
//! | what | files | item |
//! | --- | --- | --- |
//! | matrices | of CalculiX, SciPy, Matrix Market, Abaqus, MATLAB, Ansys and Nastran: [`Format`] | [`read_matrix`] |
//! | names of the rows | CalculiX `.dof`; Ansys `.mapping`; tables `row,node,component[,x,y,z]` | [`LabelTable`] |
//! | numbers without names of rows | NumPy `.npz`, `.npy`; text with commas or blanks | [`read_numbers`] |
//! | meshes | `.inp` of CalculiX and Abaqus; Gmsh `.msh` 4.1 and 2.2 as text; bulk data of Nastran | [`Mesh`] |
//! | all of them together, in SI units | | [`FeModel`], [`FeFiles`], [`UnitSystem`] |
//! | contacts of nodes with walls and each other | pairs: `node_a,node_b[,nx,ny,nz,gap_m]` | [`find_contacts`] |
//! | their sparse directions `W` | | [`FeModel::contact_directions`] |
//! | motions of the skin of a mesh | `.vtu` and `.pvd` | [`Surface`], [`Skin`] |
//!
//! Text files may be compressed with gzip. Matrices are streamed into their lower triangle: while a file is read,
//! memory is little more than that of the final triangle, whatever a header claims. An invalid file is rejected with
//! the position, the actual and the expected contents.
//!
//! ```
//! use nlmodes_io::{FeFiles, FeModel};
//!
//! // Two masses of 1 t on springs of 1 N/mm, in CalculiX's files.
//! let directory = std::env::temp_dir().join(format!("nlmodes-io-{}", std::process::id()));
//! std::fs::create_dir_all(&directory)?;
//! let file = |name: &str, text: &str| {
//!     let path = directory.join(name);
//!     std::fs::write(&path, text).map(|()| path.to_string_lossy().into_owned())
//! };
//! let stiffness = file("two.sti", "1 1 2.0\n1 2 -1.0\n2 2 1.0\n")?;
//! let mass = file("two.mas", "1 1 1.0\n1 2 0.0\n2 2 1.0\n")?;
//! let dofs = file("two.dof", "7.3\n10.3\n")?;
//!
//! let mut files = FeFiles::new(&stiffness, &mass);
//! files.dofs = Some(dofs.into());
//! files.units = "mm-t-s".parse()?;
//! let model = FeModel::read(&files)?;
//! assert_eq!(model.stiffness.get(0, 1), -1000.0); // N/m
//! assert_eq!(model.mass_along_axes(), [0.0, 0.0, 2000.0]); // kg
//! assert_eq!(model.labels[1].to_string(), "uz of node 10");
//!
//! std::fs::write(&mass, "1 1 1.0\n1 2 0.0\n2 x 1.0\n")?;
//! let refused = FeModel::read(&files).unwrap_err().to_string();
//! assert!(refused.ends_with("two.mas:3: found `x`; expected a column from 1 to 2"));
//! # std::fs::remove_dir_all(&directory)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! No mechanics beyond that: modes, reductions and motions are for other crates.

mod address;
mod arrays;
mod build;
mod contact;
mod error;
mod formats;
mod keyword;
mod labels;
mod lower;
mod mesh;
mod model;
mod nastran;
mod numbers;
mod paraview;
mod text;
mod units;

pub use address::Address;
pub use arrays::{NumberArray, read_arrays};
pub use contact::{
    ContactChoice, ContactError, ContactNodes, ContactProblem, GapChoice, NodeContact, NormalChoice, Partner,
    find_contacts,
};
pub use error::{Place, Problem, ReadError, Result};
pub use formats::{Format, MatrixData, UnknownFormat, read_matrix};
pub use labels::{
    Component, DofLabel, LabelTable, ParameterEntry, RepeatedLabel, read_nodal_values, read_parameter_entries,
};
pub use lower::LowerTriangle;
pub use mesh::{Element, ElementKind, Mesh, Skin, SkinCell};
pub use model::{FeFiles, FeModel, NodeChoice};
pub use numbers::{NumberTable, read_numbers};
pub use paraview::{PointField, Surface};
pub use units::{UnitSystem, UnknownUnits};
