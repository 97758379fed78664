//! Virtual test rig: a vibrating structure with a stop, a shaker, sensors and a level schedule under a phase-locked
//! loop.
//!
//! It simulates a test before it is built, and supplies records with known exact values for the extraction of modes.
//!
//! ```text
//! q̈_k + 2 ζ_k ω_k q̇_k + ω_k² q_k = φ_ex,k f − side · φ_s,k λ             structure, eq. (23) in modal coordinates
//! 0 ≤ g = g_0 − side · Σ_k φ_s,k q_k + A λ  ⊥  λ ≥ 0                     stop, eqs. (3), (5), (11), (13)
//! L di/dt + R i + T v_a = u ,   m_a v̇_a + c_a v_a + k_a x_a = T i − f    shaker
//! f = k_s (x_a − w_ex) + c_s (v_a − ẇ_ex)                                stinger; f is what the force sensor measures
//! ```
//!
//! `A` is the flexibility of the stop, that of a massless contact node, or both; so a rigid stop needs no impact law,
//! see [`Stop`]. The system is piecewise linear. Between contact instants it is propagated by the matrix exponential,
//! and the instants are the roots of a Taylor series, none of which is missed: energy is conserved to rounding (below
//! 1e-9 in two seconds with a hundred contacts), and a step too large for this is [rejected](RigError::StepTooLarge).
//! The drive is harmonic within a sampling interval.
//!
//! | symbol | meaning | unit | item |
//! | --- | --- | --- | --- |
//! | `ω_k`, `ζ_k` | eigenfrequencies, damping ratios | rad/s, – | [`LinearStructure`] |
//! | `φ_ex,k`, `φ_s,k` | mass-normalised shapes at drive point and stop | 1/√kg | [`DrivePoint`], [`Stop`] |
//! | `g_0`, `λ`, `A` | gap, contact force, flexibility | m, N, m/N | [`Stop`] |
//! | `u`, `f` | voltage, force on the structure | V, N | [`Shaker`], [`Exciter`] |
//!
//! A [`Session`] is a rig under the [`TestControl`](nlmodes_experiment::phase_loop::TestControl) that a real one has:
//! hardware in the loop without hardware. A [`VirtualTest`] runs through its levels, and returns a
//! [`Record`](nlmodes_experiment::records::Record) of each like a measured one, with what kept it from settling as
//! [`Finding`]s. The control has access to noisy channels only, not to the model. The same seed gives the same records.
//!
//! ```
//! use nlmodes_experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
//! use nlmodes::rig::{
//!     ControlChannels, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigSetup, Sensor, SensorPlace,
//!     VirtualTest,
//! };
//!
//! // One mode at 40 Hz with 1 % damping, an ideal force, and a loop that starts 0.3 Hz too low.
//! let omega = 2.0 * std::f64::consts::PI * 40.0;
//! let rig = RigSetup {
//!     structure: LinearStructure { omega: vec![omega], damping_ratios: vec![0.01] },
//!     drive_point: DrivePoint { position: 0.1, shape: vec![1.0], residual: 0.0 },
//!     exciter: Exciter::IdealForce,
//!     stop: None,
//!     sensors: vec![
//!         Sensor::new("force", SensorPlace::Excitation, 0.0),
//!         Sensor::new("response", SensorPlace::DrivePoint(MotionQuantity::Displacement), 1e-9),
//!     ],
//!     interval: 1.0 / 20_000.0,
//!     substeps: None,
//!     seed: 1,
//! };
//! let phase = LoopSettings::new(Resonance { omega, damping_ratio: 0.01 }, omega - 2.0, rig.interval);
//! let control = TestSettings::new(phase, LevelSchedule::new(&[0.5])?);
//! let test = VirtualTest { rig, control, channels: ControlChannels::new(0, 1), harmonics: None };
//! let levels = test.run(|_| {})?;
//! assert!(levels[0].findings.is_empty());
//! assert!((levels[0].steady.omega / omega - 1.0).abs() < 1e-6);
//! assert_eq!((levels[0].record.channels[1].name.as_str(), levels[0].record.n_samples()), ("response", 20_000));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Equation numbers: S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear modal
//! analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807.

mod chain;
mod closed_loop;
mod drive;
mod error;
mod exciter;
mod finding;
mod functional;
mod harmonics;
mod phase_plant;
mod propagator;
mod reduction;
mod sensor;
mod session;
mod state_space;
mod stop;
mod structure;
mod virtual_rig;
mod virtual_test;

pub use chain::{Chain, Converter, DropOuts, Hum, Stage};
pub use closed_loop::{HeldLevel, LevelsAhead, LockedMotion};
pub use drive::Drive;
pub use error::RigError;
pub use exciter::{Exciter, Shaker};
pub use finding::Finding;
pub use harmonics::ControlledHarmonics;
pub use nlmodes_model::{ContactLaw, Side};
pub use phase_plant::{PhaseMargin, PhasePlant};
pub use reduction::ModalReduction;
pub use sensor::{MotionQuantity, Sensor, SensorPlace};
pub use session::{ControlChannels, DRIVE_PHASE, Session};
pub use stop::Stop;
pub use structure::{DrivePoint, LinearStructure};
pub use virtual_rig::{RigSetup, VirtualRig};
pub use virtual_test::{LevelOutcome, SteadyState, VirtualTest};
