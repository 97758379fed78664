//! A linear structure with unilateral contacts, the same structure with massless contact nodes, and its reduction to
//! few modes.
//!
//! ```text
//! M q̈ + K q = W λ ,   0 ≤ g ⊥ λ ≥ 0 ,   g = Wᵀ q + g₀                                   eqs. (4), (5)
//! ```
//!
//! [`StructuralModel`] has `M`, `K` and the contacts. A [`MassRedistribution`] splits the degrees of freedom into those
//! without contact (L) and those with contact (N) and removes the mass from N, eq. (12); the result, a
//! [`MasslessContactModel`], is the only model that mixed shooting-harmonic balance accepts. The contact nodes are then
//! in static equilibrium at any instant, eq. (13), and no impact law is needed. [`reduction`] keeps the mass of the
//! contacts, and takes few modes of the structure with the statics of the others.
//!
//! | symbol | name | unit | shape | item |
//! | --- | --- | --- | --- | --- |
//! | `M`, `K` | mass, stiffness | kg, N/m | n × n | [`StructuralModel::mass`], [`StructuralModel::stiffness`] |
//! | `M_R` | redistributed mass | kg | n × n | [`MasslessContactModel::mass`] |
//! | `K_NN`, `K_LN` | stiffness at the contact nodes | N/m | n_N × n_N, n_L × n_N | [`MasslessContactModel::k_nn`] … |
//! | `W̄` | force directions | – | n_N × c | [`MasslessContactModel::w`] |
//! | `w` | direction of a contact, `g = g₀ + wᵀ q` | – | n | [`Contact::normal`] |
//! | `g₀` | gap at rest | m | c | [`Contact::gap`] |
//! | `1/k_c` | compliance of a stop, zero for a rigid one | m/N | c | [`ContactLaw::compliance`] |
//! | `ω_0,r`, `φ_r` | linear modes | rad/s, 1/√kg | r, n × r | [`linear_modes`], [`open_modes`], [`held_modes`] |
//! | | effect of massless contacts on `ω_0,r` | – | | [`MassShift`] |
//! | `ω'_k`, `K'` | imposed frequencies, stiffness | rad/s, N/m | k, n × n | [`StructuralModel::with_frequencies`] |
//!
//! ```
//! use nlmodes_linalg::sparse_from_triplets;
//! use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel, linear_modes};
//!
//! // Two unit masses on unit springs, the second one with a stop.
//! let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
//! let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)])?;
//! let dofs = [1.0, 2.0].map(|position| Dof { node: 0, position, kind: DofKind::Axial }).to_vec();
//! let stop = Contact::rigid(1, Side::Positive, 0.1);
//! let model = StructuralModel::new(m, k, dofs, vec![stop])?;
//!
//! let massless = MasslessContactModel::new(&model, &Drop)?;
//! let modes = linear_modes(massless.mass(), massless.stiffness(), 2)?;
//! assert_eq!(modes.omega.len(), 1); // the massless node follows: one mass on one spring
//! assert!((modes.omega[0] - 1.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Equation numbers are those of S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear
//! modal analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807. Massless contact
//! nodes: H. B. Khenous, P. Laborde, Y. Renard, *Mass redistribution method for finite element contact problems in
//! elastodynamics*, European Journal of Mechanics A/Solids 27 (2008) 918-932.

mod conserve;
mod contact;
mod definite;
mod direction;
mod dof;
mod error;
mod imposed;
mod linear_modes;
mod mass_shift;
mod massless;
mod redistribution;
pub mod reduction;
mod rigid;
mod steady;
mod structure;
#[cfg(test)]
mod test_chain;

pub use conserve::Conserve;
pub use contact::{Contact, ContactLaw, DofContact, Side};
pub use definite::check_mass;
pub use direction::SparseDirection;
pub use dof::{Dof, DofIndex, DofKind};
pub use error::ModelError;
pub use imposed::{ImposedFrequencies, MAX_IMPOSED_DOFS};
pub use linear_modes::{LinearModes, held_modes, linear_modes, open_modes};
pub use mass_shift::MassShift;
pub use massless::{ContactCoordinates, MasslessContactModel};
pub use redistribution::{Drop, MassRedistribution, Move};
pub use rigid::{MassProperties, RigidMotion};
pub use steady::SteadyForce;
pub use structure::StructuralModel;
