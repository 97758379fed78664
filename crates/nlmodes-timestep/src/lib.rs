//! Exact time integration of structures with massless contact nodes, and its applications: verification of computed
//! periodic motions, exact periodic motions by shooting (free ones and those of damped structures under periodic
//! loads), and their stability. No harmonics are involved.
//!
//! ```text
//! M_LL q̈_L + (K_LL − K_LN K_NN⁻¹ K_NL) q_L = −K_LN K_NN⁻¹ W λ          (8) in time, with q_N from (13)
//! 0 ≤ λ ⊥ A λ + Wᵀ b + g₀ ≥ 0 ,   b = −K_NN⁻¹ K_NL q_L                  (11), (13)
//! M_LL q̈_L + K_s q_L = f_s                                          while the set s of closed contacts stays the same
//! ```
//!
//! | symbol | meaning | unit | item |
//! | --- | --- | --- | --- |
//! | `z`, `ż` | modal coordinates with open contacts, and their rates | m·√kg, m·√kg/s | [`ModalState`] |
//! | `λ(t)`, `q(t)` | contact forces, displacements at any instant | N, m | [`Trajectory::at`] |
//! | `E` | kinetic and strain energy | J | [`Trajectory::energies`] |
//! | `μ` | Floquet multipliers | 1 | [`Floquet`] |
//! | `B`, `y` | reduction to fixed-interface modes, its coordinates | 1/√kg, m·√kg | [`GalerkinReduction`] |
//! | `x` | damped structure under a periodic load, its exact motion | | [`ForcedStructure`], [`ForcedMotion`] |
//! | | nonlinear mode by shooting, with its modal quantities | | [`ModeShooting`] |
//! | `𝒜` | linear equations in steps of one length | | [`LinearFlow`] |
//!
//! ```
//! use nlmodes_linalg::sparse_from_triplets;
//! use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
//! use nlmodes_timestep::{ContactDynamics, Floquet, Shooting};
//!
//! // A wall, a spring, a mass, a spring, and a massless node 1 mm from a stop.
//! let stiffness = sparse_from_triplets(2, 2, &[(0, 0, 3e4), (0, 1, -2e4), (1, 0, -2e4), (1, 1, 2e4)])?;
//! let mass = sparse_from_triplets(2, 2, &[(0, 0, 0.1)])?;
//! let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
//! let stop = Contact::rigid(1, Side::Positive, 1e-3);
//! let model = StructuralModel::new(mass, stiffness, vec![dof(1), dof(2)], vec![stop])?;
//!
//! // The periodic motion at ten times the grazing energy of the linear mode, from a rough guess.
//! let dynamics = ContactDynamics::new(MasslessContactModel::new(&model, &Drop)?)?;
//! let (mut shooting, mut x, _) = Shooting::from_grazing(dynamics, 1)?;
//! (x[0], x[1]) = (2.2 * x[0], 1.3);
//! let motion = shooting.motion_near(&x, 10_f64.ln())?;
//! assert!((motion.trajectory.end.z[0] / motion.state.z[0] - 1.0).abs() < 1e-12); // it returns
//! assert!(Floquet::new(shooting.dynamics(), &motion)?.is_stable());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Main design decision: between contact instants all modes of the structure with that set of closed contacts are
//! propagated as cosines and sines, so that the only errors are rounding errors; contact instants are roots of guards,
//! none of which is missed. This requires dense matrices, hence [`MAX_DOFS`].
//!
//! Equation numbers: S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear modal
//! analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807. Shooting and
//! multipliers: A. H. Nayfeh, B. Balachandran, *Applied Nonlinear Dynamics*, Wiley 1995, doi:10.1002/9783527617548.

mod bracket;
mod contact_motion;
mod dynamics;
mod error;
mod first_root;
mod floquet;
mod forced;
mod fourier;
mod grazing;
mod mode_shooting;
mod oscillation;
mod phase;
mod restrained;
mod shooting;
mod state_energy;
mod trajectory;
mod verification;

pub use contact_motion::ContactState;
pub use dynamics::{ContactDynamics, MAX_DOFS};
pub use error::TimestepError;
pub use floquet::{Floquet, UNIT_CIRCLE};
pub use forced::{
    Along, Blow, DEGREE, Flash, FlowSeries, ForcedMotion, ForcedStructure, LawSettings, LinearFlow, Signal,
    SignalPiece, Stretch, TURN, TimeLaw, Touch, TransientSettings,
};
pub use grazing::GrazingState;
pub use mode_shooting::{MAX_SHOOTING_MODES, ModeShooting};
pub use nlmodes_model::reduction::GalerkinReduction;
pub use shooting::{PeriodicMotion, Shooting, ShootingScales};
pub use state_energy::StateEnergy;
pub use trajectory::{ClosedInterval, ModalState, Snapshot, Trajectory};
pub use verification::Verification;
