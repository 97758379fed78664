//! Description and outcome of a virtual test, in `summary.json`.

use std::f64::consts::TAU;
use std::time::Duration;

use nlmodes::modal::ModalBranch;
use nlmodes::virtual_test::TestLevel;
use serde_json::{Value, json};

use super::bench::Rig;
use crate::overlay::Overlaid;
use nlmodes_scene::scene::TestScene;

/// Description of the model, in one line, so that it is not mistaken for the finite-element structure.
pub fn model(scene: &TestScene, rig: &Rig) -> String {
    let (own, taken) = (hertz(&rig.of_elements), hertz(&rig.bench.omega));
    let first = format!("modal model: {} modes of the structure", taken.len());
    if scene.given_frequencies().is_none() {
        return format!("{first}, {} Hz", rounded(&own));
    }
    format!("{first} with given frequencies, {} Hz, instead of its own, {} Hz", rounded(&taken), rounded(&own))
}

fn hertz(omega: &[f64]) -> Vec<f64> {
    omega.iter().map(|omega| omega / TAU).collect()
}

fn rounded(values: &[f64]) -> String {
    values.iter().map(|x| format!("{x:.2}")).collect::<Vec<_>>().join(", ")
}

/// A level: what the rig did.
pub fn level(level: &TestLevel) -> Value {
    let (outcome, steady) = (&level.outcome, &level.outcome.steady);
    let findings = outcome.findings.iter().map(|f| json!({ "name": f.name(), "message": f.to_string() }));
    json!({
        "drive": outcome.level,
        "start_s": outcome.start,
        "held_s": outcome.settling,
        "settled": outcome.findings.is_empty(),
        "frequency_hz": steady.omega / TAU,
        "lag_deg": steady.lag.to_degrees(),
        "force_n": steady.force,
        "response_m": steady.response,
        "period_spread": outcome.drifts.spread,
        "findings": findings.collect::<Vec<_>>(),
    })
}

/// The whole summary.
pub fn json(
    scene: &TestScene,
    rig: &Rig,
    levels: Vec<Value>,
    (backbones, against): (&[&ModalBranch], &Overlaid),
    wrong: &[String],
    wall_time: Duration,
) -> Value {
    let bench = &rig.bench;
    let backbones: Vec<Value> = backbones
        .iter()
        .map(|branch| {
            json!({
                "label": branch.label,
                "points": branch.points.len(),
                "end": branch.end.message,
                "complete": branch.end.complete,
            })
        })
        .collect();
    json!({
        "program": "nlmodes-cli",
        "version": env!("CARGO_PKG_VERSION"),
        "title": scene.title,
        "structure": scene.structure,
        "model": model(scene, rig),
        "modes": {
            "frequencies_hz": hertz(&bench.omega),
            "frequencies_are_given": scene.given_frequencies().is_some(),
            "frequencies_of_the_structure_hz": hertz(&rig.of_elements),
            "damping_ratios": bench.damping_ratios,
            "drive_shape": rig.reduction.shape(&bench.drive.weights),
            "drive_residual_flexibility_m_n": rig.reduction.residual(&bench.drive.weights),
            "stop_shape": bench.stop.as_ref().map(|stop| rig.reduction.shape(&stop.at.weights)),
            "at_the_sensors": rig.modes.n_modes(),
        },
        "exciter": scene.exciter.name(),
        "drive_unit": scene.exciter.unit(),
        "drive_m": scene.drive,
        "stop": scene.stop,
        "sample_rate_hz": scene.sample_rate,
        "seed": scene.seed,
        "loop": scene.control,
        "warnings": scene.warnings,
        "levels": levels,
        "backbone": backbones.first(),
        "backbones": backbones,
        "differences": against.in_numbers(),
        "complete": wrong.is_empty(),
        "incomplete_because": wrong,
        "wall_time_s": wall_time.as_secs_f64(),
    })
}
