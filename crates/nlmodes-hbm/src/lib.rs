//! Mixed shooting-harmonic balance: periodic motions of linear structures behind one-sided stops, rigid or elastic.
//!
//! ```text
//! H_LL,n q_L,n + H_LN,n q_N,n = 0 ,   n = 0 … N_h                        linear degrees of freedom, in harmonics   (8)
//! K_NN q_N(t) + K_NL q_L(t) = W̄ λ(t) ,   0 ≤ g(t) ⊥ λ(t) ≥ 0           massless contacts, at each instant  (11), (13)
//! q_N,n = 𝓕_n(q_N(t))                                                   both are the same motion                 (14)
//! E_av(ω, q) = E_0                                                      its averaged kinetic energy is given     (16)
//! ```
//!
//! | symbol | meaning | unit | shape | item |
//! | --- | --- | --- | --- | --- |
//! | `ω_k²`, `Y` | modes with open contacts, as the gaps see them | rad²/s², 1/√kg | m, c × m | [`ModalStructure`] |
//! | `b(t)` | where the massless contact nodes would be without stops | m | n_N | [`PeriodicSystem`] |
//! | `q_N(t)` | where they are | m | n_N | |
//! | `A` | contact compliance `Wᵀ K_NN⁻¹ W` | m/N | c × c | [`CondensedStructure::compliance`] |
//! | `ω` | angular frequency | rad/s | | |
//! | `E_av` | averaged kinetic energy | J | | |
//!
//! [`CondensedStructure`] reduces a structure once; [`grazing`] gives the linear mode that just touches;
//! [`CondensedStructure::conservative_mode`] gives the system of equations, with its Jacobian, for
//! `nlmodes-continuation`. One evaluation costs `modes × N_h × c²` and the contact problems, whatever the size of the
//! finite-element model.
//!
//! ```
//! use nlmodes_contact::solver_by_name;
//! use nlmodes_continuation::{Bound, Continuation, ParametricSystem};
//! use nlmodes_hbm::{CondensedStructure, PeriodicSettings, Symmetry, grazing};
//! use nlmodes_linalg::sparse_from_triplets;
//! use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
//!
//! // A wall, a spring, a mass, a spring, and a massless node 1 mm from a stop.
//! let stiffness = sparse_from_triplets(2, 2, &[(0, 0, 3e4), (0, 1, -2e4), (1, 0, -2e4), (1, 1, 2e4)])?;
//! let mass = sparse_from_triplets(2, 2, &[(0, 0, 0.1)])?;
//! let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
//! let stop = Contact::rigid(1, Side::Positive, 1e-3);
//! let model = StructuralModel::new(mass, stiffness, vec![dof(1), dof(2)], vec![stop])?;
//! let structure = CondensedStructure::new(MasslessContactModel::new(&model, &Drop)?, 1)?;
//!
//! let start = grazing(&structure, 1)?;
//! let settings = (PeriodicSettings { harmonics: 7, ..PeriodicSettings::default() }, Symmetry::Even);
//! let mut problem = structure.conservative_mode(settings, start.scales(), solver_by_name("active-set")?.as_ref())?;
//! let n = problem.dim();
//! let (x, direction) = problem.start(&start);
//! let to_ten_times_the_energy = Bound { coordinate: n, min: -1.0, max: 10_f64.ln() };
//! let method = Continuation { bounds: vec![to_ten_times_the_energy], ..Continuation::default() };
//! let branch = method.run(&mut problem, &x, 0.0, &direction, |_| std::ops::ControlFlow::Continue(()))?;
//! let last = branch.points.last().expect("a branch has its start");
//! assert!(problem.omega(&last.x) > start.omega); // the stop stiffens the mode
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Main decision: the unknowns are the coefficients of `b`, not those of `q_N` as in eq. (15), because `q_N` vanishes
//! at the eigenfrequencies of the structure with its contacts held, and eq. (8) is used in a form without poles; see
//! [`CondensedStructure::conservative_mode`].
//!
//! Elastic stops, eq. (3), put `1/k_c` on the diagonal of `A`. Conventional harmonic balance, where the contact nodes
//! keep their mass and move in harmonics, is the same system for the massless tips of the stops' springs, made by
//! [`MasslessContactModel::with_spring_tips`](nlmodes_model::MasslessContactModel::with_spring_tips); see
//! [`CondensedStructure`].
//!
//! Conservative, damped and forced motions are one system, [`PeriodicSystem`], put together from a [`ModalStructure`],
//! the [`ContactOperator`] over a period and [`Closing`]. Its analyses are constructors:
//! [`PeriodicSystem::conservative_mode`], [`PeriodicSystem::damped_mode`], [`PeriodicSystem::frequency_response`],
//! [`PeriodicSystem::force_response`], [`PeriodicSystem::phase_resonance`]. [`PeriodicSystem::floquet`] gives
//! multipliers from the contact instants. Curves of them: `nlmodes::response`.
//!
//! Equation numbers: S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear modal
//! analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807. The method: F.
//! Schreyer, R. I. Leine, *A mixed shooting-harmonic balance method for unilaterally constrained mechanical systems*,
//! Archive of Mechanical Engineering 63 (2016) 297-314.

mod boundary;
mod closed_set;
mod condensed;
mod contact_operator;
mod contact_statistics;
mod error;
mod estimate;
mod history;
mod ladder;
mod periodic;
mod series;
mod start;
mod switching;
mod trigonometric;

pub use condensed::{CondensedStructure, MAX_RECORDED};
pub use contact_operator::{ContactOperator, PatternInterval, Switching};
pub use error::HbmError;
pub use estimate::{TruncationError, TruncationEstimator};
pub use history::ContactDefects;
pub use ladder::{FEW_HARMONICS, harmonics_on_the_way};
pub use periodic::{
    Bilinear, Exponential, ForceLaw, HertzStop, LawAtRest, LawForce, ModeStart, PlacedLaw, Polynomial, PowerDamper,
    PowerSpring, TableLaw, UNIT_ENERGY, about_rest_of_law, largest_value, law_length, laws_at_rest, modal_start,
    touch_spans,
};
pub use periodic::{
    Changes, Closing, ClosingEquation, Column, ContactMotion, Coordinates, DampedStop, EnergyGiven, Floquet,
    Functional, Grazing, Load, LoadTerm, MAX_HARMONICS, ManyChanges, ModalDamping, ModalStructure, ModeAtRest, Motion,
    MotionChange, MotionGradient, Opening, OperatingPoint, PartWeights, PeriodicMotion, PeriodicSettings,
    PeriodicSystem, PhaseCondition, PhaseLag, Refined, ResponseRow, Scales, Source, StructureChange, StructureState,
    StructureWeights, Watched, modal_grazing, modal_grazing_opened, modal_lift_off_opened,
};
pub use series::{RealSeries, Symmetry};
pub use start::{about_rest, grazing, grazing_opened};
