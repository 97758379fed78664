//! Which levels of a test phase control can hold, before it is run.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::Watch;
use nlmodes::rig::{HeldLevel, LevelsAhead, LockedMotion, RigError, VirtualTest};
use nlmodes_scene::scene::TestScene;
use nlmodes_scene::{number, significant};

/// Angle of a multiplier, degrees, from which on what it leads to repeats itself after two periods.
const TWO_PERIODS: f64 = 179.0;

/// The levels with their multipliers, as far as the fundamental of the force alone is controlled; none where higher
/// harmonics are.
///
/// # Errors
/// Those of the rig; [`RigError::Interrupted`].
pub fn levels_ahead(test: &VirtualTest, watch: &Watch) -> Result<Vec<HeldLevel>, RigError> {
    if test.harmonics.is_some() {
        return Ok(Vec::new());
    }
    LevelsAhead::new(test)?.all(|| if watch.has_ended() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
}

/// Why a level is not held, if it is not; `number` is its number among those of the scene, from 1.
pub fn warning(scene: &TestScene, number_of_level: usize, level: &HeldLevel) -> Option<String> {
    let longest = scene.schedule.settling.longest;
    if level.is_held(longest) {
        return None;
    }
    let why = match &level.motion {
        None => "no periodic motion at phase resonance was found there".to_owned(),
        Some(motion) if !motion.is_held() => {
            let angle = motion.multipliers.first().map_or(0.0, |μ| μ.arg().abs().to_degrees());
            let (hz, largest) = (significant(motion.omega / TAU, 6), significant(motion.largest(), 4));
            let loses = format!("its motion, {hz} Hz, is left by a factor of {largest} a period");
            let loses = loses + if angle > TWO_PERIODS { " for one of two periods" } else { "" };
            match &level.by_amplitude {
                Some(tried) if tried.is_held() => {
                    loses + "; with the amplitude of the response under control it is held"
                }
                Some(tried) => {
                    let largest = significant(tried.largest(), 4);
                    format!("{loses}, with the amplitude of the response under control by {largest}")
                }
                None => loses,
            }
        }
        Some(_) if level.after_lost => {
            "it is held once it is there, but the motion that leads there is not, and may go elsewhere".to_owned()
        }
        Some(_) => format!(
            "it takes some {} s to settle, longer than `longest_hold_s` = {}",
            significant(level.settling, 2),
            number(longest)
        ),
    };
    let (unit, drive) = (scene.exciter.unit(), number(level.level));
    let will =
        if level.after_lost && level.motion.as_ref().is_some_and(LockedMotion::is_held) { "may" } else { "will" };
    Some(format!("phase control {will} not hold level {number_of_level}, {drive} {unit}: {why}"))
}
