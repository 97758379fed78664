//! What a virtual test is, and what it did, in words and in `summary.json`.

use std::f64::consts::TAU;
use std::time::Duration;

use nlmodes::modal::ModalBranch;
use nlmodes::rig::Exciter;
use nlmodes::virtual_test::TestLevel;
use serde_json::{Value, json};

use super::bench::Rig;
use crate::config::number;
use crate::config::scene::{TestScene, TestStop};

/// What `check` says.
pub fn summary(scene: &TestScene) -> String {
    let row = |name: &str, text: String| format!("  {name:<12}{text}");
    let modes = match scene.given_frequencies() {
        Some(frequencies) => {
            format!("{}; {} Hz imposed on the structure's shapes", scene.damping_ratios.len(), list(frequencies))
        }
        None => format!("{} of the structure", scene.damping_ratios.len()),
    };
    let structure = &scene.structure;
    let sensors = match scene.accelerometers.len() {
        0 => "no accelerometers".into(),
        n => format!("{n} accelerometers"),
    };
    let backbone = scene.backbone.as_ref().map_or_else(
        || "not computed".into(),
        |b| {
            let methods: Vec<&str> = b.methods.iter().map(|method| method.name()).collect();
            format!("computed with {} harmonics by {}, up to {} Hz", b.harmonics, methods.join(", "), number(b.end_hz))
        },
    );
    let records = scene.records.as_ref().map_or_else(
        || "not kept".into(),
        |kept| {
            let levels = kept.levels.as_ref().map_or_else(
                || "all levels".into(),
                |levels| format!("levels {}", levels.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
            );
            format!("{levels} as .{}", kept.format.name())
        },
    );
    let schedule = &scene.schedule;
    [
        scene.title.clone(),
        String::new(),
        row(
            "structure",
            format!(
                "{}, {} m long, {} elements",
                structure.kind().name(),
                number(structure.length),
                structure.elements
            ),
        ),
        row("modes", modes),
        row("damping", list(&scene.damping_ratios)),
        row("drive", format!("{} at {} m; {sensors}", exciter(scene), number(scene.drive))),
        row("stop", scene.stop.as_ref().map_or_else(|| "none: a linear structure".into(), stop)),
        row("sampling", format!("{} Hz, seed {}", number(scene.sample_rate), scene.seed)),
        row("levels", format!("{} {}", list(&schedule.levels), scene.exciter.unit())),
        row(
            "hold",
            format!("at most {} s each, records of {} s", number(schedule.hold.longest), number(schedule.record)),
        ),
        row("backbone", backbone),
        row("records", records),
        row("results", scene.output_directory.display().to_string()),
        String::new(),
        "The scene is sound; nothing was computed.".into(),
    ]
    .join("\n")
}

fn exciter(scene: &TestScene) -> &'static str {
    match scene.exciter {
        Exciter::Shaker(_) => "shaker",
        Exciter::IdealForce => "ideal force",
    }
}

fn stop(stop: &TestStop) -> String {
    let law = stop.stiffness.map_or_else(|| "rigid".to_owned(), |k| format!("{} N/m", number(k)));
    format!("{} m, on the {} side, gap {} m, {law}", number(stop.position), stop.side.name(), number(stop.gap))
}

fn list(values: &[f64]) -> String {
    values.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ")
}

/// What the model is, in a line: nobody should take it for the finite-element structure.
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
        "held_s": outcome.settling.duration,
        "settled": outcome.findings.is_empty(),
        "frequency_hz": steady.omega / TAU,
        "lag_deg": steady.lag.to_degrees(),
        "force_n": steady.force,
        "response_m": steady.response,
        "period_spread": steady.spread,
        "findings": findings.collect::<Vec<_>>(),
    })
}

/// The whole summary.
pub fn json(
    scene: &TestScene,
    rig: &Rig,
    levels: Vec<Value>,
    backbones: &[&ModalBranch],
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
        "exciter": exciter(scene),
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
        "complete": wrong.is_empty(),
        "incomplete_because": wrong,
        "wall_time_s": wall_time.as_secs_f64(),
    })
}
