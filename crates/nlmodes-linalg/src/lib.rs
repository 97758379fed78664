//! Linear algebra of `nlmodes`: the few factorisations and eigenproblems that its crates share.
//!
//! | problem | item |
//! | --- | --- |
//! | `A x = b`, A dense | [`DenseLu`] |
//! | `A x = b`, A sparse, symmetric positive definite | [`SparseCholesky`] |
//! | `K φ = λ M φ`, lowest λ, M symmetric positive semidefinite | [`lowest_modes`] |
//!
//! Everything is `f64` and non-generic. The generics of faer are compiled in the crate that calls them; keeping
//! them here means that they are compiled once, and that the other crates build in seconds.

mod cholesky;
mod dense;
mod error;
mod modes;
mod sparse;
mod symmetric;

pub use cholesky::SparseCholesky;
pub use dense::DenseLu;
pub use error::LinalgError;
pub use faer::Mat;
pub use modes::{Modes, lowest_modes};
pub use symmetric::symmetric_eigen;
pub use sparse::{
    SparseMatrix, Triplet, add_scaled, asymmetry, bilinear, multiply, select, sparse_from_triplets, triplets,
};
