//! Finite elements of straight one-dimensional structures: rods and Timoshenko beams in front of stops.
//!
//! ```text
//! rod:   ρA ü = (EA u′)′
//! beam:  ρA ẅ = (κGA (w′ − φ))′ ,   ρI φ̈ = (EI φ′)′ + κGA (w′ − φ) ,   and the rod along its axis
//! ```
//!
//! A [`Rod`] or a [`Beam`] has a [`Material`], a section, a [`Mesh`] and two [`Support`]s; `assemble` turns it and a
//! list of [`Stop`]s into a [`StructuralModel`](nlmodes_model::StructuralModel) of eqs. (4) and (5),
//! `M q̈ + K q = W λ`, with sparse matrices of the free degrees of freedom. `assemble_stepped` takes [`Step`]s along
//! which material, section and added mass differ.
//!
//! | symbol | name | unit | item |
//! | --- | --- | --- | --- |
//! | `E`, `G`, `ν`, `ρ` | moduli, Poisson's ratio, density | Pa, Pa, –, kg/m³ | [`Material`] |
//! | `A`, `I`, `κ` | area, second moment of area, shear factor | m², m⁴, – | [`Section`] |
//! | `l`, `L` | length of an element, of the structure | m | [`Mesh`] |
//! | `u`, `w`, `φ` | axial displacement, deflection, rotation | m, m, rad | [`DofKind`](nlmodes_model::DofKind) |
//! | `Φ` | shear parameter of an element | – | [`timoshenko_element`] |
//! | `g₀` | gap at rest | m | [`Stop::gap`] |
//!
//! Stress is recovered from displacements: along rods and beams by [`StressRow`]s, at the nodes of solid elements of
//! any mesh by [`NodalStress`].
//!
//! Units are given in SI, but any consistent system works, for instance millimetres, newtons, tonnes and seconds.
//!
//! ```
//! use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
//! use nlmodes_model::{Drop, MasslessContactModel, Side, linear_modes};
//!
//! let beam = Beam {
//!     material: Material::new(181.36e9, 7730.0)?,
//!     section: Section::rectangle(0.012, 0.020)?,
//!     mesh: Mesh::graded(0.62975520, 21, 9.1958536)?, // refined towards the stop
//!     mass_matrix: MassMatrix::Consistent,
//!     start: Support::Clamped,
//!     end: Support::Free,
//! };
//! let stop = Stop::rigid(0.62975520, Direction::Transverse, Side::Positive, 1.03e-3);
//! let model = MasslessContactModel::new(&beam.assemble(&[stop])?, &Drop)?;
//! let modes = linear_modes(model.mass(), model.stiffness(), 1)?;
//! assert!((modes.omega[0] / std::f64::consts::TAU - 40.10).abs() < 0.005);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Equation numbers are those of S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear
//! modal analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807.

mod assembly;
mod element;
mod error;
mod interpolation;
mod material;
mod mesh;
mod rod;
mod section;
mod solid;
mod step;
mod stop;
mod stress;
mod support;
mod timoshenko;

pub use element::{ElementMatrices, MassMatrix};
pub use error::FemError;
pub use material::Material;
pub use mesh::Mesh;
pub use rod::{Rod, rod_element};
pub use section::Section;
pub use solid::{Elastic, NodalStress, Solid, SolidShape, largest_principal, von_mises};
pub use step::Step;
pub use stop::{Direction, Stop};
pub use stress::StressRow;
pub use support::Support;
pub use timoshenko::{Beam, timoshenko_element};
