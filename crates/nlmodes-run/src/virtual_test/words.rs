//! Levels in words, as soon as they are recorded.

use std::f64::consts::TAU;

use nlmodes::virtual_test::TestLevel;
use nlmodes_scene::scene::TestScene;

use crate::chain;

/// A level with its results and findings, in a few lines; `number` is its number among those of the scene, from 1.
pub fn in_words(scene: &TestScene, number: usize, level: &TestLevel) -> String {
    let (outcome, steady) = (&level.outcome, &level.outcome.steady);
    let mut text = format!(
        "level {number} of {}: {} {}, {:.4} Hz, lag {:.3}°, held for {:.1} s",
        scene.schedule.count,
        nlmodes_scene::number(outcome.level),
        scene.exciter.unit(),
        steady.omega / TAU,
        steady.lag.to_degrees(),
        outcome.settling
    );
    match &level.extraction {
        Ok(found) => {
            if let Some(modal) = &found.modal {
                text += &format!(", amplitude {:.4e} m√kg", modal.amplitude.value);
                text += &modal.damping.map_or_else(String::new, |damping| format!(", damping {:.3e}", damping.value));
            }
            text += &found.findings.iter().map(|finding| format!("\n  {finding}")).collect::<String>();
        }
        Err(error) => text += &format!("\n  no modal point: {}", chain(error)),
    }
    text + &outcome.findings.iter().map(|finding| format!("\n  {finding}")).collect::<String>()
}
