//! The functions of `include/nlmodes_loop.h`.
//!
//! `#[unsafe(no_mangle)]`, and the symbol behind a panic, are the only places of this crate where the lint against
//! `unsafe_code` is allowed: a name without mangling could meet another of the same name in a program, which the prefix
//! `nlmodes_loop_` prevents. No block here is `unsafe`. The arguments are references that may be null; that what is not
//! null points to memory of that type, filled in where it is not only written to, is for the caller to keep, as the
//! header says.

#![allow(unsafe_code)]

use core::mem::MaybeUninit;

use crate::c_settings::CSettings;
use crate::{PhaseLoopError, Resonance, TestControl, TestInput, TestOutput, TestState};

/// Why settings are refused.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SettingsRefusal {
    /// They are not.
    None,
    /// A pointer is null.
    NullPointer,
    /// A number is not positive, is negative, or is not finite.
    Number,
    /// The start is not between the lowest and the highest frequency.
    FrequencyRange,
    /// The cut-off is too high for the frequency or the sampling.
    CutOff,
    /// Too many harmonics, sensors, modes or levels, or too few windows.
    Count,
    /// A code has no meaning.
    Code,
    /// Numbers of sensors that do not fit, or no sensor at the drive point.
    Sensors,
    /// A harmonic of the force does not answer to the drive.
    NoTransfer,
    /// A harmonic is above half the sampling frequency.
    AboveNyquist,
    /// Unstable gains.
    UnstableGains,
    /// A level is above the largest drive.
    AboveLimit,
}

impl From<PhaseLoopError> for SettingsRefusal {
    fn from(error: PhaseLoopError) -> Self {
        match error {
            PhaseLoopError::NotPositive { .. } | PhaseLoopError::NotFinite { .. } | PhaseLoopError::Negative { .. } => {
                Self::Number
            }
            PhaseLoopError::FrequencyRange { .. } => Self::FrequencyRange,
            PhaseLoopError::CutOff { .. } => Self::CutOff,
            PhaseLoopError::Harmonics { .. }
            | PhaseLoopError::ControlledHarmonics { .. }
            | PhaseLoopError::TooMany { .. }
            | PhaseLoopError::Windows { .. } => Self::Count,
            PhaseLoopError::Code { .. } => Self::Code,
            PhaseLoopError::Sensors { .. } => Self::Sensors,
            PhaseLoopError::NoTransfer { .. } => Self::NoTransfer,
            PhaseLoopError::AboveNyquist { .. } => Self::AboveNyquist,
            PhaseLoopError::UnstableGains { .. } => Self::UnstableGains,
            PhaseLoopError::AboveLimit { .. } => Self::AboveLimit,
        }
    }
}

/// Fills in defaults for a resonance (rad/s, damping ratio, both roughly), a frequency at the start (rad/s) and a
/// sampling interval (s). There are no levels yet.
#[unsafe(no_mangle)]
pub extern "C" fn nlmodes_loop_default_settings(
    settings: Option<&mut MaybeUninit<CSettings>>,
    resonance_rad_s: f64,
    damping_ratio: f64,
    start_rad_s: f64,
    step_s: f64,
) -> SettingsRefusal {
    let Some(settings) = settings else { return SettingsRefusal::NullPointer };
    settings.write(CSettings::new(Resonance { omega: resonance_rad_s, damping_ratio }, start_rad_s, step_s));
    SettingsRefusal::None
}

/// Checks the settings and makes a test of them: before the real-time task begins.
#[unsafe(no_mangle)]
pub extern "C" fn nlmodes_loop_prepare(
    settings: Option<&CSettings>,
    control: Option<&mut MaybeUninit<TestControl>>,
) -> SettingsRefusal {
    let (Some(settings), Some(control)) = (settings, control) else { return SettingsRefusal::NullPointer };
    match settings.checked().and_then(|settings| TestControl::new(&settings)) {
        Ok(made) => {
            control.write(made);
            SettingsRefusal::None
        }
        Err(error) => error.into(),
    }
}

/// The state before the first sample.
#[unsafe(no_mangle)]
pub extern "C" fn nlmodes_loop_start(
    control: Option<&TestControl>,
    state: Option<&mut MaybeUninit<TestState>>,
) -> SettingsRefusal {
    let (Some(control), Some(state)) = (control, state) else { return SettingsRefusal::NullPointer };
    state.write(control.start());
    SettingsRefusal::None
}

/// One sample: reads `input`, moves `state` on, writes `output`. The same arguments give the same bits.
#[unsafe(no_mangle)]
pub extern "C" fn nlmodes_loop_step(
    control: Option<&TestControl>,
    state: Option<&mut TestState>,
    input: Option<&TestInput>,
    output: Option<&mut MaybeUninit<TestOutput>>,
) -> SettingsRefusal {
    let (Some(control), Some(state), Some(input), Some(output)) = (control, state, input, output) else {
        return SettingsRefusal::NullPointer;
    };
    output.write(control.step(state, input));
    SettingsRefusal::None
}

/// Length of the array that `nlmodes_loop_step_flat` writes.
pub const FLAT_LENGTH: usize = 12;

/// The same for programs that pass numbers and arrays, and no structures; without controlled harmonics. Writes drive at
/// the next sample, angular frequency (rad/s), phase (rad), lag (rad), amplitudes of force (N) and response, level and
/// its index, stage, stop reason, and 1 or 0 for `recorded` and `settled`.
#[unsafe(no_mangle)]
pub extern "C" fn nlmodes_loop_step_flat(
    control: Option<&TestControl>,
    state: Option<&mut TestState>,
    force_n: f64,
    response: f64,
    stroke_m: f64,
    contact_force_n: f64,
    stop: u32,
    output: Option<&mut MaybeUninit<[f64; FLAT_LENGTH]>>,
) -> SettingsRefusal {
    let (Some(control), Some(state), Some(output)) = (control, state, output) else {
        return SettingsRefusal::NullPointer;
    };
    let input =
        TestInput { stroke: stroke_m, contact_force: contact_force_n, stop, ..TestInput::new(force_n, response) };
    let out = control.step(state, &input);
    output.write([
        out.drive,
        out.omega,
        out.phase,
        out.lag,
        out.force,
        out.response,
        out.level,
        out.level_index as f64,
        f64::from(out.stage as u32),
        f64::from(out.stop_reason as u32),
        f64::from(u8::from(out.recorded)),
        f64::from(u8::from(out.settled)),
    ]);
    SettingsRefusal::None
}

/// Bytes of `nlmodes_loop_settings`, `nlmodes_loop`, `nlmodes_loop_state`, `nlmodes_loop_input` and
/// `nlmodes_loop_output`, for programs that allocate them by their size; each is aligned to 8 bytes.
#[unsafe(no_mangle)]
pub extern "C" fn nlmodes_loop_sizes(sizes: Option<&mut MaybeUninit<[usize; 5]>>) -> SettingsRefusal {
    let Some(sizes) = sizes else { return SettingsRefusal::NullPointer };
    sizes.write([
        size_of::<CSettings>(),
        size_of::<TestControl>(),
        size_of::<TestState>(),
        size_of::<TestInput>(),
        size_of::<TestOutput>(),
    ]);
    SettingsRefusal::None
}

/// A panic would end here. The symbol is defined nowhere: a program in which anything can panic does not link.
#[cfg(feature = "panic-handler")]
mod panic {
    unsafe extern "C" {
        safe fn nlmodes_loop_can_panic() -> !;
    }

    #[panic_handler]
    fn handler(_: &core::panic::PanicInfo<'_>) -> ! {
        nlmodes_loop_can_panic()
    }
}

#[cfg(test)]
mod tests;
