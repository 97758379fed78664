//! What would be extracted from records.

use super::{Row, row};
use crate::number;
use crate::scene::{RecordScene, SegmentRule, SegmentTold};

/// Records, channels, modes and extracted quantities.
pub fn rows(scene: &RecordScene) -> Vec<Row> {
    let settings = &scene.settings;
    let channels: Vec<&str> = scene.recording.channels.iter().map(|channel| channel.name.as_str()).collect();
    let without = match scene.structure {
        Some(_) => "of the structure, at the sensors",
        None => "none: no modal amplitude, damping and participation",
    };
    let modes = settings.linear_modes.as_ref().map_or_else(
        || without.into(),
        |modes| {
            format!("{} at {} positions, mode {} is excited", modes.n_modes(), modes.n_coordinates(), settings.mode)
        },
    );
    let rate = scene.recording.sample_rate.map_or_else(|| "of the files".into(), |rate| format!("{} Hz", number(rate)));
    let pbmif = settings.pbmif_harmonics.map_or_else(|| "all below half the sampling rate".into(), |n| n.to_string());
    let periods = settings.periods.map_or_else(|| "all".into(), |n| n.to_string());
    let harmonics = format!("{} of the shape; mode indicator: {pbmif}; periods: {periods}", settings.harmonics);
    let stop = settings.stop.map_or_else(
        || "none: no restitution and no contact stiffness".into(),
        |stop| format!("{} m, gap {} m", number(stop.position), number(stop.gap)),
    );
    vec![
        row("records", scene.files.join(", ")),
        row("sampling", rate),
        row("segments", segments(scene)),
        row("free decay", String::from(if scene.free_decay.is_some() { "at the end of each record" } else { "none" })),
        row("channels", channels.join(", ")),
        row("modes", modes),
        row("harmonics", harmonics),
        row("stop", stop),
        row("results", scene.output_directory.display().to_string()),
    ]
}

fn segments(scene: &RecordScene) -> String {
    let told = |rule: &SegmentRule| match &rule.told {
        SegmentTold::Times([from, to]) => format!("{} s to {} s", number(*from), number(*to)),
        SegmentTold::Flag(flag) => format!("where \"{flag}\" is not zero"),
        SegmentTold::Steady => "where force and motion are steady".into(),
    };
    let rules: Vec<String> = scene.segments.iter().map(told).collect();
    if rules.is_empty() { "none: a record is one level".into() } else { rules.join(", ") }
}
