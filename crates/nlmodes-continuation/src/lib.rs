//! Numerical continuation of `R(x, p) = 0`, n equations for n unknowns and one parameter.
//!
//! ```text
//! R : ℝⁿ × ℝ → ℝⁿ ,   z = (x, p) ,   R(z) = 0 ,   J = ∂R/∂z   (n × (n + 1))
//! ```
//!
//! The curve is followed by steps of pseudo-arclength: predict along the unit tangent `t` (`J t = 0`), correct by
//! Newton on the hyperplane across it. So turning points in `p` and in any unknown are nothing special. Made for
//! residuals that are only piecewise smooth: a step counts only when prediction, correction, turn of the tangent and a
//! check at half the step agree, and what the branch passed is located and named.
//!
//! `det [J; tᵀ]` keeps its sign along a curve, kinks included, until another curve crosses. So a step upon which it
//! changes is accepted only where more than two half-branches are found to meet; otherwise it has jumped and is
//! shortened. How often it vanishes within a step is determined by the eigenvalues of the Jacobian at its end in terms
//! of that at its beginning: a step that passes more than one such point is shortened until they are distinguished, or
//! are one. The half-branches of a point are those along the tangents of the smooth pieces that meet there, those of
//! the quadratic branching equation where the kernel has two dimensions, or found by deflated Newton's method where it
//! has more; each is confirmed by a correction. Only such a search need not be complete, and says so
//! ([`Crossing::complete`]). The branch goes on along its own, or along another ([`AtBranchPoint`]);
//! [`Continuation::run_tree`] follows them all.
//!
//! | symbol | item | shape |
//! | --- | --- | --- |
//! | `R`, `J` | [`Linearization`] of a [`ParametricSystem`] | n, n × (n + 1) |
//! | `z` | unknowns, then parameter | n + 1 |
//! | `t` | [`BranchPoint::tangent`] | n + 1 |
//! | `h` | step along the curve, [`StepSettings`] | |
//!
//! Linear systems are solved by a [`LinearSolver`]: all entries of the Jacobian unless the system says otherwise, or by
//! sparse LU factorisation ([`SparseSolver`]) for thousands of unknowns (example `bratu_plane`).
//!
//! Lengths, distances and tolerances are shares of the sizes of unknowns and equations, [`Scaling`]: those that the
//! system gives, or else those that are found from the starting point and the Jacobian there. So no problem needs to be
//! scaled for it.
//!
//! ```
//! use nlmodes_continuation::{Bound, Continuation, EventKind, Linearization, ParametricSystem};
//!
//! struct Circle;
//! impl ParametricSystem for Circle {
//!     type Error = std::convert::Infallible;
//!     fn dim(&self) -> usize { 1 }
//!     fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Self::Error> {
//!         out.residual[0] = x[0] * x[0] + p * p - 1.0;
//!         (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (2.0 * x[0], 2.0 * p);
//!         Ok(())
//!     }
//! }
//!
//! let settings = Continuation { bounds: vec![Bound { coordinate: 0, min: -0.5, max: 2.0 }], ..Default::default() };
//! let branch = settings.run(&mut Circle, &[1.0], 0.0, &[0.0, 1.0], |_| std::ops::ControlFlow::Continue(()))?;
//! let fold = branch.points.iter().find(|q| q.events.contains(&EventKind::ParameterFold)).expect("the circle turns");
//! assert!((fold.p - 1.0).abs() < 1e-10 && fold.x[0].abs() < 1e-6);
//! assert!((branch.points.last().unwrap().x[0] + 0.5).abs() < 1e-10);
//! # Ok::<(), nlmodes_continuation::ContinuationError<std::convert::Infallible>>(())
//! ```
//!
//! References: E. L. Allgower, K. Georg, *Introduction to Numerical Continuation Methods*, SIAM 2003,
//! doi:10.1137/1.9780898719154; A. Dhooge, W. Govaerts, Yu. A. Kuznetsov, *MATCONT*, ACM TOMS 29 (2003),
//! doi:10.1145/779359.779362.

mod boundaries;
mod boundary;
mod branch;
mod branching;
mod budget;
pub mod conformance;
mod continuation;
mod corrector;
mod crossing;
mod error;
mod events;
mod half_branches;
mod kink;
mod pencil;
mod predictor;
mod record;
mod refusal;
mod roots;
mod run;
mod scales;
mod signs;
mod singular;
mod solver;
mod step;
mod step_control;
mod system;
mod tree;
mod vectors;
mod watch;

pub use boundary::Boundary;
pub use branch::{Branch, BranchPoint, EventKind, StopReason};
pub use budget::Budget;
pub use continuation::{Bound, Continuation};
pub use corrector::{Correction, Corrector, Hyperplane};
pub use crossing::{Arm, AtBranchPoint, Choice, Crossing};
pub use error::ContinuationError;
pub use record::{RunLog, StepRecord};
pub use refusal::{CorrectionFailure, NewtonFailure, Refusal};
pub use scales::Scaling;
pub use solver::{DenseSolver, LinearSolver, SparseSolver};
pub use step::StepSettings;
pub use system::{Linearization, ParametricSystem};
pub use tree::{BranchTree, Origin, TreeBranch};
pub use watch::{Ended, Watch, Watched, WatchedError, WatchedLog};
