//! Measured records to nonlinear modes: signals in, modal frequency, shape, damping and mode indicator out; and the
//! loop that holds a structure in phase resonance while they are recorded. No model of the structure is involved.
//!
//! ```text
//! q(t) = Re Σ_n ψ_n e^{inω̃t}                       whole periods of all channels, without leakage         (20)
//! q̃² = ψ₁ᴴ M ψ₁ = η₁ᴴ η₁ ,   η_n = Φ⁺ ψ_n           modal amplitude, without a mass matrix            (21), (22)
//! δ̃ = P₁ / (q̃² ω̃³)                                 damping, from the power of the force                   (28)
//! Λ = P / S                                        power-based mode indicator, +1: force and damping in balance   (19)
//! ```
//!
//! | symbol | meaning | unit | item |
//! | --- | --- | --- | --- |
//! | | channels with quantity, unit, role, position | | [`records::Record`], [`records::Channel`] |
//! | `ω̃` | modal frequency | rad/s | [`extraction::RecordExtraction`] |
//! | `q̃`, `φ̃_n` | modal amplitude, mode shapes of the harmonics | m·√kg, 1/√kg | [`extraction::ModalFigures`] |
//! | `δ̃` | modal damping coefficient | 1 | [`extraction::ModalFigures`] |
//! | `P`, `S`, `Λ` | active and apparent power, mode indicator | W, W, 1 | [`extraction::ExcitationPower`] |
//! | `ψ`, `θ` | lag of the response, phase of the drive | rad | [`nlmodes_loop::PhaseLockedLoop`] |
//!
//! ```
//! use nlmodes_experiment::extraction::{ExtractionSettings, extract};
//! use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
//!
//! // Half a second of a force in phase with a velocity of 40 Hz that has a second harmonic.
//! let angle = |j: usize| 251.3 * j as f64 / 5000.0;
//! let force: Vec<f64> = (0..2500).map(|j| angle(j).cos()).collect();
//! let velocity: Vec<f64> = (0..2500).map(|j| angle(j).cos() + 0.5 * (2.0 * angle(j)).cos()).collect();
//! let record = Record::new("half a second", 5000.0)
//!     .with(Channel::new("force", Quantity::Force, Role::Excitation, Some(0.0)), force)
//!     .with(Channel::new("velocity", Quantity::Velocity, Role::DrivePoint, Some(0.0)), velocity);
//!
//! let found = extract(&record, &ExtractionSettings { pbmif_harmonics: Some(10), ..ExtractionSettings::default() })?;
//! assert!((found.omega.value - 251.3).abs() < 1e-6);
//! let indicator = found.excitation.ok_or("no force in the record")?.pbmif.value;
//! assert!((indicator - 1.0 / 1.25_f64.sqrt()).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`records`] reads CSV, Universal File 58 and 58b, WAV, NumPy and TDMS, and writes all but the last. [`extraction`]
//! makes a modal point of a record, with the uncertainty of each figure and named findings, finds the levels of a long
//! record, and follows a free decay. [`phase_loop`] is [`nlmodes_loop`],
//! the loop as a function of values, for a real rig as for a simulated one.
//!
//! # Main decisions
//! - Fourier coefficients are those of a least squares fit of all harmonics at once: a sampling rate is no multiple of
//!   the frequency, so there is no whole number of samples in a period, and nothing leaks.
//! - Every figure is evaluated again on single periods; their spread is its uncertainty.
//! - What a careful experimenter should know (clipped, drifting, skewed, reversed …) is a
//!   [`Finding`](extraction::Finding) with its value, not an error: there is a result, with a reservation.
//! - Readers take memory as numbers come, never as a header announces.
//!
//! Equation numbers: S. Peter, F. Schreyer, R. I. Leine, *A method for numerical and experimental nonlinear modal
//! analysis of nonsmooth systems*, Mechanical Systems and Signal Processing 120 (2019) 793-807. Power quantities: S.
//! Peter, R. I. Leine, ibid. 96 (2017) 139-158.

pub mod extraction;
pub mod records;

pub use nlmodes_loop as phase_loop;
