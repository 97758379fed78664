//! Control of a vibration test in phase resonance, sample by sample: phase-locked loop, amplitude, higher harmonics of
//! the force, levels, limits. Without the standard library, without memory from a heap, and without a way to panic; the
//! same code in a simulation, on a computer and on a controller, callable from C (`include/nlmodes_loop.h`).
//!
//! [`PhaseLockedLoop`] is the loop alone: phase detector, loop filter, oscillator, as in Fig. 2 of the paper.
//! [`TestControl`] is a whole test around it.
//!
//! The loop excites with `cos θ` and turns the frequency `ω = dθ/dt` until the fundamental of the response lags that of
//! the force by the phase of resonance (90 degrees for a displacement). It sees two signals and nothing else.
//!
//! ```text
//! f = Re Σ F_n e^{inθ} ,  x = Re Σ X_n e^{inθ}     phase detector, low-pass of cut-off ω_c
//! ψ = arg F_1 − arg X_1                            lag of the response
//! e = ψ_target − ψ
//! ω = ω_start + K_p e + K_i ∫ e dt                 loop filter
//! θ = ∫ ω dt                                       oscillator
//! ```
//!
//! Near a resonance `ω_0` with the decay rate `δ = ζ ω_0` the lag follows `ψ̇ = (ω − ω_b) − δ (ψ − π/2)`, with `ω_b`
//! the frequency of phase resonance. With the low-pass `ω_c / (s + ω_c)` of the detector the loop has the
//! characteristic polynomial
//!
//! ```text
//! s (s + ω_c) (s + δ) + ω_c (K_p s + K_i) ,   stable for 0 < K_i < (ω_c + δ) (δ + K_p) .
//! ```
//!
//! [`Gains::design`] chooses gains well inside, [`PhaseLockedLoop::new`] refuses any outside.
//!
//! | symbol | meaning | unit | item |
//! | --- | --- | --- | --- |
//! | `θ`, `ω` | phase and angular frequency of the drive | rad, rad/s | [`LoopState`] |
//! | `ψ` | lag of the response behind the force | rad | [`LoopState::lag`] |
//! | `F_n`, `X_n` | complex amplitudes of force and response | N; m, m/s or m/s² | [`PhaseDetector`] |
//! | `ω_c` | cut-off of the detector | rad/s | [`LoopSettings::cut_off`] |
//! | `K_p`, `K_i` | gains of the loop filter | 1/s, 1/s² | [`Gains`] |
//!
//! A [`TestControl`] adds what a test needs around the loop, in the order in which a sample passes through it:
//!
//! | part | what it does | item |
//! | --- | --- | --- |
//! | limits | stroke, contact force, force, missing samples: the drive goes to zero and stays there | [`Limits`] |
//! | levels | ramps, time to settle judged against the noise, records | [`LevelSchedule`], [`SteadyCriteria`] |
//! | higher harmonics | the power that damping takes from each harmonic of the motion | [`ForceAppropriation`] |
//! | amplitude | drive, force or response is brought to its level | [`AmplitudeSettings`] |
//!
//! # Main decisions
//! - A step is a function of settings, state and samples: the same arguments give the same bits, on every machine with
//!   IEEE 754 arithmetic, for sines and arctangents come from `libm`, not from the system.
//! - Numbers of harmonics, levels, sensors and windows have fixed limits, so that a state is a value.
//! - Settings are checked once, [`TestControl::new`]; a step cannot fail.
//!
//! ```
//! use nlmodes_loop::{LoopSettings, PhaseLockedLoop, Resonance};
//!
//! // An oscillator of 1 kg, 40 Hz and 1 % damping, and a loop that starts 1 Hz too low. Exact steps are left to a rig:
//! // here the response is integrated with small symplectic ones.
//! let (omega, damping_ratio, step) = (251.3, 0.01, 5e-5);
//! let pll = PhaseLockedLoop::new(LoopSettings::new(Resonance { omega, damping_ratio }, omega - 6.28, step))?;
//! let (mut state, mut x, mut v) = (pll.start(), 0.0, 0.0);
//! for _ in 0..200_000 {
//!     let force = state.drive_phase().cos();
//!     v += step * (force - 2.0 * damping_ratio * omega * v - omega * omega * x);
//!     x += step * v;
//!     state = pll.step(&state, state.drive_phase().cos(), x);
//! }
//! assert!(state.is_locked() && (state.omega() / omega - 1.0).abs() < 1e-3);
//! # Ok::<(), nlmodes_loop::PhaseLoopError>(())
//! ```
//!
//! The procedure is that of Section 2.3 of S. Peter, F. Schreyer, R. I. Leine, Mechanical Systems and Signal Processing
//! 120 (2019) 793-807; the loop itself is described in S. Peter, R. I. Leine, ibid. 96 (2017) 139-158. The adaptive
//! detector is the least mean squares algorithm of B. Widrow et al., *Adaptive noise cancelling*, Proceedings of the
//! IEEE 63 (1975) 1692-1716.

#![cfg_attr(not(test), no_std)]

mod adaptive;
mod amplitude;
mod appropriation;
pub mod c;
mod c_settings;
mod course;
mod demodulation;
mod detector;
mod error;
mod gains;
mod harmonics;
mod limits;
mod lock;
mod low_pass;
mod math;
mod modal_filter;
mod periods;
mod pll;
mod quantity;
mod schedule;
mod settings;
mod state;
mod steady;
mod test_control;

pub use amplitude::{AmplitudeSettings, Controlled};
pub use appropriation::{AppropriationSettings, AppropriationState, ForceAppropriation};
pub use c_settings::CSettings;
pub use detector::PhaseDetector;
pub use error::PhaseLoopError;
pub use gains::{Gains, Resonance};
pub use harmonics::MAX_HARMONICS;
pub use limits::{EmergencyReason, Limits};
pub use lock::LockSettings;
pub use low_pass::{LowPass, Order};
pub use modal_filter::{MAX_MODES, MAX_SENSORS, ModalFilter};
pub use pll::PhaseLockedLoop;
pub use quantity::ResponseQuantity;
pub use schedule::{LevelSchedule, MAX_LEVELS, Stage};
pub use settings::LoopSettings;
pub use state::LoopState;
pub use steady::{Drifts, MAX_WINDOWS, Missed, SteadyCriteria};
pub use test_control::{TestControl, TestInput, TestOutput, TestSettings, TestState};
