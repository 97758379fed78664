//! Linear complementarity problems of frictionless contact, with interchangeable solvers.
//!
//! ```text
//! 0 ≤ g ⊥ λ ≥ 0 ,   g = A λ + b
//! ```
//!
//! Each of c contacts is open (`g > 0`, `λ = 0`) or closed (`g = 0`, `λ > 0`), or both vanish. `A` is symmetric and
//! positive semidefinite, so the same forces minimise the energy `½ λᵀ A λ + bᵀ λ` over `λ ≥ 0`: there is a solution
//! unless gaps contradict each other, the gaps are unique, and so are the forces if `A` is regular. Otherwise contacts
//! are redundant, and an independent subset of them is chosen to carry the forces.
//!
//! | symbol | in code | meaning | unit | shape |
//! | --- | --- | --- | --- | --- |
//! | `A` | [`LcpMatrix`] | compliance of the body at the contacts, `Wᵀ K_NN⁻¹ W` | m/N | c × c |
//! | `b` | `b` | gaps without contact forces | m | c |
//! | `λ` | `lambda` | contact forces | N | c |
//! | `g` | `gaps` | gaps | m | c |
//! | `a` | `closed` | closed contacts | | c flags |
//! | | [`LcpMatrix::violation`] | `max \|min(D⁻¹ λ, D g)\| / max \|D b\|`, `D = diag(A)^-1/2` | 1 | |
//!
//! A stop with a finite stiffness `k_c` is the same problem with `1/k_c` added to the diagonal of `A`.
//!
//! ```
//! use nlmodes_contact::{LcpMatrix, Mat, solver_by_name};
//! // A beam under two stops: 2 µm per N under the load, 1 µm per N across.
//! let a = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 2e-6 } else { 1e-6 }))?;
//! let solver = solver_by_name("active-set")?;
//! let mut workspace = solver.workspace(&a)?;
//! // Without forces it would be 1 mm inside the first stop and 0.2 mm away from the second.
//! let (mut closed, mut lambda, mut gaps) = ([false; 2], [0.0; 2], [0.0; 2]);
//! let statistics = workspace.solve(&[-1e-3, 2e-4], &mut closed, &mut lambda)?;
//! workspace.gaps(&mut gaps)?;
//! assert_eq!(closed, [true, false]);
//! assert!((lambda[0] - 500.0).abs() < 1e-9 && (gaps[1] - 7e-4).abs() < 1e-15);
//! assert!(statistics.violation < 1e-10);
//! # Ok::<(), nlmodes_contact::LcpError>(())
//! ```
//!
//! # The judge
//! Solvers fail in different ways and report success in different norms. Here all of them get the problem in the same
//! units (the diagonal of `A` and the largest entry of `b` of order one, by powers of two, so without rounding), and
//! one function outside of them recomputes the gaps and decides: a violation above 1e-10 is an error, whatever the
//! solver reports. The claim that a problem is infeasible is accepted only with a verified proof.
//!
//! # Which solver
//! | name | settings | when |
//! | --- | --- | --- |
//! | `active-set` | [`ActiveSet`] | by default; exact, fastest with and without a guess |
//! | `proximal` | [`Proximal`] | comparison with the projection fixed point of the literature; well-conditioned `A` |
//! | `clarabel` | [`Clarabel`] | comparison with an independent interior-point code; slow, no warm start |
//! | `lemke` | [`Lemke`] | an exact independent check, up to a few hundred contacts |
//! | `closed-form` | [`ClosedForm`] | one contact; `active-set` uses it automatically |
//!
//! [`Series`] solves the samples of a period with one matrix and warm starts, and gives the derivatives of forces, gaps
//! and displacements at each. [`ContactBody`] makes the problem from directions, compliance and gaps of a body.
//! [`balance`] finds where a body with motions without stiffness rests on its contacts.
//! [`conformance`] has the suite that each of these passes; a backend of your own can be tested with it in one line.
//!
//! All of them pass the whole suite, `closed-form` its problems of one contact. They return an error if a solution
//! cannot be verified, because the forces are so large that rounding them changes the gaps by more than the judge
//! permits, from about 1e5 times `max |b|` in scaled units on ([`LcpError::Rounding`]). Without the final exact
//! solution, `proximal` fails for condition numbers above about 1e6 and `clarabel` for most problems in which a gap and
//! its force both vanish.
//!
//! # References
//! - E. L. Keller, The general quadratic optimization problem, Math. Program. 5 (1973) 311-337.
//! - J. J. Júdice, F. M. Pires, A block principal pivoting algorithm for large-scale strictly monotone linear
//!   complementarity problems, Comput. Oper. Res. 21 (1994) 587-596, doi:10.1016/0305-0548(94)90106-6.
//! - R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, SIAM 2009, doi:10.1137/1.9780898719000.
//! - Y. Fathi, Computational complexity of LCPs associated with positive definite symmetric matrices, Math. Program. 17
//!   (1979) 335-344.
//! - B. O'Donoghue, E. Candès, Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15 (2015)
//!   715-732, doi:10.1007/s10208-013-9150-3.
//! - P. J. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic objectives,
//!   arXiv:2405.12762.

mod balance;
mod block;
mod body;
pub mod conformance;
mod error;
mod factor;
mod kernel;
mod problem;
mod sample;
mod scaled;
mod series;
mod solver;
mod tile;

pub use balance::{Balance, balance};
pub use block::ClosedBlock;
pub use body::{ClosedResponse, ContactBody};
pub use error::LcpError;
pub use nlmodes_linalg::Mat;
pub use problem::LcpMatrix;
pub use series::{Series, SeriesSolution, Start};
pub use solver::{
    LcpSolver, LcpStatistics, LcpWorkspace, SOLVER_NAMES, active_set::ActiveSet, clarabel::Clarabel,
    closed_form::ClosedForm, lemke::Lemke, proximal::Proximal, solver_by_name,
};
