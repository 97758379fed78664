//! Reduction of linear structures with unilateral contacts to few modes, with the statics of the truncated ones.
//!
//! ```text
//! M q̈ + K q = W λ + f ,   g = g₀ + Wᵀ q ,   0 ≤ λ ⊥ g + C λ ≥ 0
//! K φ_r = ω_r² M φ_r ,   φᵀ M φ = 1 ,   r = 1 … m                      contacts open, mass as it is
//! η̈_r + ω_r² η_r = y_rᵀ λ + φ_rᵀ f ,   g = g₀ + Y η + A λ + a f         Y = Wᵀ Φ
//! A = Wᵀ K⁻¹ W − Y Ω⁻² Yᵀ ,   a = Wᵀ K⁻¹ f − Y Ω⁻² Φᵀ f                 residual flexibility
//! q = Φ η + [K⁻¹ W − Φ Ω⁻² Yᵀ] λ + [K⁻¹ f − Φ Ω⁻² Φᵀ f]                 recovery, at the places that are asked for
//! ```
//!
//! The modes beyond the `m` retained ones respond statically (MacNeal): the static response to any contact force is
//! exact, and the frequencies with open contacts are unchanged. No mass is redistributed, yet the contacts are
//! massless: force and gap are related only by `A` at each instant, so no impact law is needed.
//!
//! | symbol | name | unit | shape | item |
//! | --- | --- | --- | --- | --- |
//! | `ω_r²` | squared open frequencies | rad²/s² | m | [`OpenModes::omega_squared`] |
//! | `Y` | the modes as the gaps see them | 1/√kg | c × m | [`OpenModes::contact_rows`] |
//! | `A` | residual flexibility | m/N | c × c | [`OpenModes::flexibility`] |
//! | `g₀`, `C` | gaps at rest, stop compliance | m, m/N | c | [`OpenModes::gaps`], [`OpenModes::stop_compliance`] |
//! | `Φᵀf`, `a` | a load | N/√kg, m | m, c | [`OpenModes::load`] |
//! | | displacement at chosen places | | | [`OpenModes::rows`] |
//! | `λ`, closed set | rest under preload and interference | N | c | [`OpenModes::rest`] |
//! | `(η, u)` | the reduced equations as a structure with massless contact nodes | | m + c | [`ReducedStructure`] |
//! | `Ω²`, `Y`, `A` | those of a structure that was reduced elsewhere | | | [`GivenModes`], [`OpenModes::given`] |
//! | | linear modes with closed contacts | rad²/s² | m | [`OpenModes::closed_modes`] |
//! | `λ_k`, `φ_k` | fixed-interface modes, massless contacts | rad²/s², 1/√kg | | [`HeldModes`] |
//! | | the structure in its lowest fixed-interface modes, massless contacts | | | [`GalerkinReduction`] |
//!
//! ```
//! use nlmodes_linalg::sparse_from_triplets;
//! use nlmodes_model::reduction::{ModeCount, OpenModes};
//!
//! // Two unit masses on unit springs, the second one in front of a stop; one of two modes is retained.
//! let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
//! let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)])?;
//! let w = sparse_from_triplets(2, 1, &[(1, 0, -1.0)])?;
//! let open = OpenModes::new(m, k, w, vec![0.1], vec![0.0], ModeCount::Lowest(1))?;
//!
//! // The mode and the residual flexibility together are the flexibility of two springs in series.
//! let y = open.contact_rows()[(0, 0)];
//! let total = y * y / open.omega_squared()[0] + open.flexibility()[(0, 0)];
//! assert!((total - 2.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! R. H. MacNeal, *A hybrid method of component mode synthesis*, Computers & Structures 1 (1971) 581-601; the massless
//! boundary of contact: D. Monjaraz-Tec, J. Gross, M. Krack, *A massless boundary component mode synthesis method for
//! elastodynamic contact problems*, Computers & Structures 260 (2022) 106698.

mod direction;
mod error;
mod galerkin;
mod given;
mod held_modes;
mod mode_count;
mod open_modes;
mod reduced;
mod residual;
mod rest;
mod rows;

pub use direction::{MatrixDirection, OpenDirections, OpenWeights};
pub use error::ReductionError;
pub use galerkin::GalerkinReduction;
pub use given::{GivenFlexibility, GivenModes, modal_flexibility};
pub use held_modes::{HeldMode, HeldModes};
pub use mode_count::ModeCount;
pub use open_modes::OpenModes;
pub use reduced::ReducedStructure;
pub use rest::{ClosedModes, RestState};
pub use rows::{ModalLoad, ResponseRows};
