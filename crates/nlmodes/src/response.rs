//! Forced responses, phase resonance and damped nonlinear modes of structures behind one-sided stops, rigid or elastic.
//!
//! ```text
//! η̈ + Ĉ η̇ + Ω² η = Yᵀ λ + p(t) ,   0 ≤ λ ⊥ (A + C) λ + g₀ + Y η + a(t) ≥ 0    in open modes, residual flexibility A
//! ```
//!
//! | analysis | parameter | unknowns beside the motion | item |
//! | --- | --- | --- | --- |
//! | response at a level over the frequency | Ω | | [`frequency_response`] |
//! | response at a frequency over the level | F | | [`force_response`] |
//! | phase resonance: the drive point lags the force by 90° | ln F | Ω | [`phase_resonance`] |
//! | damped nonlinear mode (extended periodic motion concept) | ln E_av | ω, ξ | [`damped_mode`] |
//! | conservative nonlinear mode | ln E_av | ω | [`conservative_mode`] |
//! | force appropriation: what drives the damped structure into a mode | | | [`appropriation`] |
//! | motions of twice the period of the load, from period doublings | Ω | | [`branching_responses`] |
//! | detached curve through a phase resonance | Ω | | [`detached_response`] |
//! | fold, first touch, or mode at an energy over a parameter of the structure | q | Ω, or ω | [`OverParameter`] |
//!
//! [`ResponseModel`] puts damping and loads on a structure reduced by [`nlmodes_model::reduction`]. Each analysis gives
//! a [`ResponseCurve`]: its motions with powers, contacts, stability, what was passed, and why it ended. Curves go
//! through folds and corners, and end at the window: no frequency and no level turns negative. Nothing is printed.
//!
//! ```
//! use nlmodes_linalg::sparse_from_triplets;
//! use nlmodes_model::{Contact, Dof, DofKind, Side, StructuralModel};
//! use nlmodes_model::reduction::{ModeCount, OpenModes};
//! use nlmodes::response::{Damping, ResponseModel, ResponseSettings, frequency_response};
//!
//! // Two masses on springs; a spring of 100 N/m stands 1 m before the first one, a force of 0.1 N drives the second.
//! let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
//! let k = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)])?;
//! let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
//! let elastic = nlmodes_model::ContactLaw::Elastic { stiffness: 100.0 };
//! let stop = Contact { law: elastic, ..Contact::rigid(0, Side::Positive, 1.0) };
//! let model = StructuralModel::new(m, k, vec![dof(0), dof(1)], vec![stop])?;
//! let open = OpenModes::of_model(&model, ModeCount::Lowest(2))?;
//! let mut model = ResponseModel::new(open, &Damping::Rayleigh { mass: 0.0, stiffness: 0.03 })?;
//! model.push_force(1, 1.0, 1, 0.0)?;
//! model.set_drive(1)?;
//!
//! let settings = ResponseSettings { harmonics: 7, ..ResponseSettings::new([0.4, 1.0]) };
//! let curve = frequency_response(&model, 0.1, &settings)?;
//! assert!(curve.end.complete);
//! let peak = curve.points.iter().map(|point| point.drive.norm()).fold(0.0, f64::max);
//! assert!((peak - 0.9363).abs() < 3e-2); // 0.93630677 with 63 harmonics
//! assert!(curve.points.iter().all(|point| (point.motion.input_power - point.motion.dissipated_power).abs() < 1e-10));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod analyses;
mod base_motion;
mod curve;
mod damping;
mod direction;
mod error;
mod exact;
mod finer;
mod follow;
mod history;
mod linear;
mod losses;
mod model;
mod over_parameter;
mod peaks;
mod recovery;
mod sensitivity;
mod settings;
mod step_log;

pub use analyses::{
    Appropriation, appropriation, branching_responses, conservative_mode, damped_mode, detached_response,
    force_response, frequency_response, lies_on, phase_resonance, response_from_other_end,
};
pub use base_motion::{BaseMotion, BaseUnit};
pub use nlmodes_modal::{BranchEnd, EndReason, Event, Stability};

pub use crate::finer::FinerSettings;
pub use curve::{ResponseCurve, ResponsePoint, curve_end, energy_bound, frequency_bound};
pub use damping::{Damping, Dashpot};
pub use error::ResponseError;
pub use exact::{exact_structure, push_laws};
pub use finer::FinerPoint;
pub(crate) use follow::newton;
pub use history::{ContactPattern, ContactState};
pub use model::{HeldByLaws, ResponseModel, Weights};
pub use over_parameter::{AtValue, Family, OverParameter, ParameterCurve, ParameterPoint};
pub use recovery::ForcePower;
pub use sensitivity::{Gradients, ParameterState, mode_gradients};
pub use settings::ResponseSettings;
pub use step_log::StepLog;
