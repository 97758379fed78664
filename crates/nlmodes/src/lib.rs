//! Nonlinear modes of structures that meet stops.
//!
//! A structure, modelled by finite elements, vibrates freely behind one-sided stops:
//!
//! ```text
//! M q̈ + K q = W λ ,   0 ≤ g ⊥ λ ≥ 0 ,   g = Wᵀ q + g₀                                   eqs. (4), (5)
//! ```
//!
//! Its nonlinear modes are the families of periodic solutions. This crate computes them without any contact parameter:
//! the contact nodes are made massless, so that contact is a static complementarity problem at each instant, while the
//! rest of the structure moves in a few harmonics (mixed shooting-harmonic balance). It wires the crates that do one
//! thing each:
//!
//! | crate | what |
//! | --- | --- |
//! | [`fem`] | rods and Timoshenko beams → sparse `M`, `K`, contacts |
//! | [`model`] | structures, massless contact nodes, linear modes, reduction to free- or fixed-interface modes |
//! | [`contact`] | linear complementarity problems and their solvers |
//! | [`hbm`] | mixed shooting-harmonic balance |
//! | [`continuation`] | branches of `R(x, p) = 0`, their folds, crossings and corners |
//! | [`modal`] | harmonic motions and modal quantities |
//! | [`experiment`] | measured records to modal points |
//! | [`report`] | tables and figures |
//! | [`response`] | forced responses, phase resonance, damped nonlinear modes |
//! | [`rig`] | a virtual rig: structure, stop, shaker, sensors, schedule |
//! | [`timestep`] | exact time integration: verification, shooting, Floquet multipliers |
//!
//! # The rod of Section 3
//!
//! ```
//! use nlmodes::fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
//! use nlmodes::model::{Drop, MasslessContactModel, Side};
//! use nlmodes::branches::{BranchSettings, compute_branch};
//!
//! let rod = Rod {
//!     material: Material::new(210e9, 9000.0)?,
//!     area: 1.0,
//!     mesh: Mesh::uniform(20.0, 100)?,
//!     mass_matrix: MassMatrix::Consistent,
//!     start: Support::Clamped,
//!     end: Support::Free,
//! };
//! let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5);
//! let model = MasslessContactModel::new(&rod.assemble(&[stop])?, &Drop)?;
//! let settings = BranchSettings { harmonics: 2, max_energy_ratio: Some(3.0), ..BranchSettings::default() };
//! let computed = compute_branch(model, &settings, |_| std::ops::ControlFlow::Continue(()))?;
//! let first = &computed.branch.points[0];
//! assert!((first.omega / std::f64::consts::TAU - 60.78660727).abs() < 1e-7); // the linear mode, just touching
//! assert!(computed.branch.points.iter().all(|point| point.residual < 1e-10));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Equation numbers are those of S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear
//! modal analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807.

pub mod branches;
mod finer;
pub mod least_squares;
pub mod response;
pub mod rig;
mod touching;
pub mod updating;
pub mod virtual_test;

pub use nlmodes_contact as contact;
pub use nlmodes_continuation as continuation;
pub use nlmodes_experiment as experiment;
pub use nlmodes_fem as fem;
pub use nlmodes_hbm as hbm;
pub use nlmodes_linalg as linalg;
pub use nlmodes_modal as modal;
pub use nlmodes_model as model;
pub use nlmodes_report as report;
pub use nlmodes_timestep as timestep;
