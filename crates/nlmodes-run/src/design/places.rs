//! Where an exciter may push.

use nlmodes_scene::assemble::{Elements, imposed};
use nlmodes_scene::scene::TestScene;
use serde::Serialize;

use crate::Failure;
use crate::virtual_test::Rig;

/// Places along the structure.
const PLACES: usize = 20;
/// Share of its largest motion below which a mode is hardly excited.
const STILL: f64 = 0.02;

/// A place for the exciter, with what it takes there to reach the stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DrivePlace {
    /// Position, m.
    pub position_m: f64,
    /// Force at phase resonance with which the stop is just reached, N; without a stop that of a modal amplitude of
    /// one.
    pub force_n: f64,
    /// Stroke of the exciter then, m.
    pub stroke_m: f64,
    /// Motion at the stop (without one, here) that this force gives the other modes, over that of the mode.
    pub other_modes: f64,
}

/// Places along the structure at which the mode moves.
///
/// # Errors
/// What the structure has against it.
pub fn drive_places(scene: &TestScene, rig: &Rig) -> Result<Vec<DrivePlace>, Failure> {
    let elements = Elements::new(&scene.structure)?;
    let model = elements.assemble(&[])?;
    let model = imposed(&scene.structure, &model, None)?.map_or(model, |imposed| imposed.model);
    let mode = (scene.settings.mode - 1).min(rig.bench.omega.len() - 1);
    let at_stop = rig.bench.stop.as_ref().map(|stop| (rig.reduction.shape(&stop.at.weights), stop.gap.abs()));
    let mut places = Vec::new();
    for k in 1..=PLACES {
        let position = scene.structure.length * k as f64 / PLACES as f64;
        if let Ok(weights) = elements.displacement_at(&model, position) {
            places.push((position, rig.reduction.shape(&weights)));
        }
    }
    let largest = places.iter().map(|(_, shape)| shape[mode].abs()).fold(0.0, f64::max);
    places.retain(|(_, shape)| shape[mode].abs() > STILL * largest);
    let of = |(position, shape): &(f64, Vec<f64>)| {
        let (omega, zeta) = (&rig.bench.omega, &rig.bench.damping_ratios);
        let (there, amplitude) = match &at_stop {
            Some((stop, gap)) => (stop, gap / stop[mode].abs()),
            None => (shape, 1.0),
        };
        let own = omega[mode];
        let force = 2.0 * zeta[mode] * own * own * amplitude / shape[mode].abs();
        let other = |j: usize| {
            let (a, b) = (omega[j] * omega[j] - own * own, 2.0 * zeta[j] * omega[j] * own);
            (there[j] * shape[j] * force / a.hypot(b)).powi(2)
        };
        let others: f64 = (0..omega.len()).filter(|j| *j != mode).map(other).sum();
        DrivePlace {
            position_m: *position,
            force_n: force,
            stroke_m: amplitude * shape[mode].abs(),
            other_modes: others.sqrt() / (amplitude * there[mode].abs()),
        }
    };
    Ok(places.iter().map(of).collect())
}
