//! Linear algebra of `nlmodes`: the factorisations and eigenproblems that its crates share.
//!
//! | problem | symbols | shape | item |
//! | --- | --- | --- | --- |
//! | `A x = b`, A dense | `P A = L U` | n × n | [`DenseLu`] |
//! | `e^A`, A dense | scaling and squaring | n × n | [`matrix_exponential`] |
//! | `A x = b`, A sparse | `P A Q = L U` | n × n | [`SparseLu`] |
//! | `A x = b`, A sparse, symmetric positive definite | `P A Pᵀ = L Lᵀ` | n × n | [`SparseCholesky`] |
//! | its elimination order, memory and work in advance | `P` | n × n | [`CholeskyPlan`] |
//! | `K φ = λ M φ`, lowest λ, M positive semidefinite | λ in rad²/s² | n × n, φ: n × modes | [`lowest_modes`] |
//! | the same with statics `K x = f`, factored once | `K + sM = L Lᵀ` | n × n | [`Pencil`] |
//! | what digits of `K`, `M` leave open of λ | σ_λ in rad²/s² | one a mode | [`Digits`], [`Written`], [`Openness`] |
//! | `K z = 0` and `M z = 0` | `z` | n × motions | [`CommonMotions`] |
//! | `A x = μ x`, A dense | μ complex | n × n | [`eigenvalues`] |
//! | sums, products and parts of sparse matrices | | | [`sparse_from_triplets`], [`multiply`], [`select`] … |
//!
//! Everything is `f64` and non-generic. The generics of faer are compiled in the calling crate; here they are compiled
//! once, so that the other crates build in seconds.
//!
//! ```
//! use nlmodes_linalg::{SparseCholesky, lowest_modes, sparse_from_triplets};
//!
//! // A clamped rod of two elements with E = A = ρ = 1 and L = 2.
//! let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)])?;
//! let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 0.5)])?;
//!
//! let mut displacement = [0.0, 3.0]; // a force of 3 at the end
//! SparseCholesky::factor(&k, "stiffness matrix")?.solve_in_place(&mut displacement);
//! assert!((displacement[0] - 3.0).abs() < 1e-14 && (displacement[1] - 6.0).abs() < 1e-14);
//!
//! let modes = lowest_modes(&k, &m, 1)?;
//! assert!((modes.eigenvalues[0] - (2.0 - 2.0_f64.sqrt())).abs() < 1e-14);
//! # Ok::<(), nlmodes_linalg::LinalgError>(())
//! ```

mod cholesky;
mod compressed;
mod dense;
mod digits;
mod eigenvalues;
mod error;
mod exponential;
mod modes;
mod ordering;
mod quadrature;
mod sparse;
mod sparse_lu;
mod symmetric;
mod threads;

pub use cholesky::{CholeskyPlan, SparseCholesky};
pub use compressed::sparse_from_columns;
pub use dense::{DenseLu, add_product, column, column_mut};
pub use digits::{Digits, rounded};
pub use eigenvalues::eigenvalues;
pub use error::LinalgError;
pub use exponential::matrix_exponential;
pub use faer::Mat;
pub use modes::{CommonMotions, Modes, Openness, Origin, Pencil, Written, lowest_modes};
pub use quadrature::gauss_legendre;
pub use sparse::{
    SparseMatrix, Triplet, add_scaled, asymmetry, bilinear, max_norm, multiply, multiply_many, multiply_transposed,
    select, sparse_from_triplets, triplets,
};
pub use sparse_lu::SparseLu;
pub use symmetric::symmetric_eigen;
pub use threads::Worker;
