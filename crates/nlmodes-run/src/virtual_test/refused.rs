//! Why a virtual test does not begin: in hertz, at the key that is to be changed, with the value that would do.

use std::f64::consts::TAU;

use nlmodes::experiment::extraction::FEWEST_PERIODS;
use nlmodes::experiment::phase_loop::PhaseLoopError;
use nlmodes::rig::RigError;
use nlmodes_scene::scene::TestScene;
use nlmodes_scene::{SceneFile, number, rounded, significant};

use super::bench::Rig;
use crate::{RunError, chain};

const RATE: &str = "virtual_test.sample_rate_hz";
const START: &str = "virtual_test.loop.start_frequency_hz";
const CUT_OFF: &str = "virtual_test.loop.cut_off_hz";

/// An error of the rig, at the key of the scene that it is about.
pub fn by_rig(file: &SceneFile<TestScene>, error: &RigError) -> RunError {
    let (path, title, label) = words(&file.scene, error);
    let said = file.error_at(path, &title, &label, &[]);
    // A motion that cannot be followed is not the scene's mistake.
    if matches!(error, RigError::Chatter { .. } | RigError::Diverged { .. }) {
        RunError::Failed(said)
    } else {
        said.into()
    }
}

/// Records that are too short for anything to be extracted from them.
///
/// # Errors
/// [`RunError::Scene`] where they hold too few periods of the mode.
pub fn short_record(file: &SceneFile<TestScene>, rig: &Rig) -> Result<(), RunError> {
    let (scene, wanted) = (&file.scene, FEWEST_PERIODS as f64);
    let hz = rig.control.resonance.omega / TAU;
    let periods = scene.schedule.record * hz;
    if periods >= wanted {
        return Ok(());
    }
    let title = format!(
        "a record of {} s holds {} periods of mode {}, which has {} Hz: nothing is extracted from less than {wanted}",
        number(scene.schedule.record),
        significant(periods, 2),
        scene.settings.mode,
        significant(hz, 5),
    );
    let label = format!("expected at least {}, in s", number(rounded_up(wanted / hz)));
    Err(file.error_at("virtual_test.schedule.record_s", &title, &label, &[]).into())
}

/// The key, the error, and the expected value.
fn words(scene: &TestScene, error: &RigError) -> (&'static str, String, String) {
    let hz = |omega: f64| significant(omega / TAU, 5);
    let (rate, mode) = (number(scene.sample_rate), scene.settings.mode);
    let at_least = |rate: f64| format!("expected at least {}, in Hz", number(rounded_up(rate)));
    match error {
        RigError::Loop(PhaseLoopError::FrequencyRange { omega, low, high }) => {
            let title = format!(
                "the loop would begin at {} Hz; it holds frequencies from half to twice that of mode {mode}",
                hz(*omega)
            );
            (START, title, format!("expected a number from {} to {}, in Hz", hz(*low), hz(*high)))
        }
        RigError::Loop(PhaseLoopError::AboveNyquist { harmonic, omega, limit }) => {
            let title = format!(
                "{rate} Hz are too few for the loop: half of them must lie above harmonic {harmonic} of {} Hz, twice \
                    the frequency of mode {mode}",
                hz(*omega)
            );
            (RATE, title, at_least(1.0 / limit * (1.0 + 1e-5)))
        }
        RigError::Loop(PhaseLoopError::CutOff { cut_off, limit, reason }) if scene.control.cut_off_hz.is_some() => {
            let title = format!("a cut-off of {} Hz is too high for the detector of the loop", hz(*cut_off));
            (CUT_OFF, title, format!("expected at most {} ({reason}), in Hz", hz(*limit)))
        }
        RigError::Loop(PhaseLoopError::CutOff { cut_off, limit, .. }) => {
            let title = format!("{rate} Hz are too few for a detector with a cut-off of {} Hz", hz(*cut_off));
            (RATE, title, at_least(scene.sample_rate * cut_off / limit))
        }
        RigError::StepTooLarge { step, limit, .. } => {
            let title = format!("{rate} Hz are too few for the fastest motion of this rig");
            (RATE, title, at_least(scene.sample_rate * step / limit))
        }
        RigError::DriveTooFast { angle, limit } => {
            let title = format!("{rate} Hz are too few for the frequency of the drive");
            (RATE, title, at_least(scene.sample_rate * angle / limit))
        }
        RigError::Loop(_) => ("virtual_test.loop", chain(error), String::new()),
        RigError::RigidStopWithoutFlexibility { .. } => ("virtual_test.stop", chain(error), String::new()),
        _ => ("virtual_test", chain(error), String::new()),
    }
}

/// To four digits, not below `x`.
fn rounded_up(x: f64) -> f64 {
    let unit = 10f64.powf(x.log10().floor() - 3.0);
    rounded((x / unit).ceil() * unit, 5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_to_be_written_is_never_below_what_is_needed() {
        for (x, text) in [(3182.73, "3183"), (0.0125664, "0.01257"), (20000.0, "20000"), (1.00001e5, "100100")] {
            assert_eq!(number(rounded_up(x)), text);
            assert!(rounded_up(x) >= x);
        }
    }
}
