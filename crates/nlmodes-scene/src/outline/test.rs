//! What a virtual test would test.

use super::{Row, law, list, row};
use crate::number;
use crate::scene::{TestScene, TestStop};

/// Structure, rig, levels and records written.
pub fn rows(scene: &TestScene) -> Vec<Row> {
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
    vec![
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
        row("drive", format!("{} at {} m; {sensors}", scene.exciter.name(), number(scene.drive))),
        row("stop", scene.stop.as_ref().map_or_else(|| "none: a linear structure".into(), stop)),
        row("sampling", format!("{} Hz, seed {}", number(scene.sample_rate), scene.seed)),
        row("levels", format!("{} {}", list(&schedule.levels().collect::<Vec<_>>()), scene.exciter.unit())),
        row(
            "hold",
            format!("at most {} s each, records of {} s", number(schedule.settling.longest), number(schedule.record)),
        ),
        row("backbone", backbone),
        row("records", records),
        row("results", scene.output_directory.display().to_string()),
    ]
}

fn stop(stop: &TestStop) -> String {
    let law = law(stop.stiffness);
    format!("{} m, on the {} side, gap {} m, {law}", number(stop.position), stop.side.name(), number(stop.gap))
}
