//! A design as tables.

use nlmodes_scene::significant;

use super::Design;

/// Places for the exciter that are shown.
const SHOWN: usize = 10;

/// The design in tables of plain text.
pub fn in_words(design: &Design) -> String {
    let mut lines: Vec<String> = design.assumed.iter().map(|assumed| format!("assumed: {assumed}")).collect();
    let text = |x: f64| significant(x, 4);
    lines.push(format!("drive point {} m; places for it, with what it takes to reach the stop:", text(design.drive_m)));
    lines.push(row(["position, m", "force, N", "stroke, m", "other modes"].map(str::to_owned)));
    let step = design.drive_places.len().div_ceil(SHOWN).max(1);
    for place in design.drive_places.iter().rev().step_by(step).collect::<Vec<_>>().into_iter().rev() {
        lines.push(row([place.position_m, place.force_n, place.stroke_m, place.other_modes].map(text)));
    }
    let control = &design.control;
    lines.push(format!(
        "loop: starts at {} Hz, cut-off {} Hz, gains {} 1/s and {} 1/s², phase margin {}°, {} Hz sampling",
        text(control.start_frequency_hz),
        text(control.cut_off_hz),
        control.proportional_1_s.map_or_else(|| "–".into(), text),
        control.integral_1_s2.map_or_else(|| "–".into(), text),
        control.phase_margin_deg.map_or_else(|| "–".into(), |degrees| significant(degrees, 2)),
        text(control.sample_rate_hz)
    ));
    let head = ["level, ", "frequency, Hz", "force, N", "stroke, m", "contact, N", "settles in, s", "|μ|", "held"];
    let mut head = head.map(str::to_owned);
    head[0] += design.level_unit;
    lines.push(row(head));
    for level in &design.levels {
        let peak = |name: &str| level.peaks.iter().find(|peak| peak.channel == name).map(|peak| text(peak.value));
        let peak = |name: &str| peak(name).unwrap_or_else(|| "–".to_owned());
        let held = if level.held { "yes".to_owned() } else { format!("no: {}", level.findings.join(" ")) };
        lines.push(row([
            text(level.level),
            significant(level.frequency_hz, 6),
            text(level.force_n),
            peak("x_drive_m"),
            peak("f_contact_N"),
            text(level.settling_s),
            level.largest_multiplier.map_or_else(|| "–".to_owned(), text),
            held,
        ]));
    }
    lines.extend(design.levels.iter().filter_map(|level| level.announced.clone()));
    if !design.ranges.is_empty() {
        lines.push("sensors: largest reading, and range to choose".to_owned());
    }
    for range in &design.ranges {
        lines.push(row([
            range.channel.clone(),
            format!("{} {}", text(range.largest), range.unit),
            format!("{} {}", text(range.range), range.unit),
        ]));
    }
    if let Some(ended) = &design.ended {
        lines.push(format!("the test ended early: {ended}"));
    }
    lines.push(format!("held by {}.", design.held_by));
    lines.join("\n")
}

/// Cells in columns of a width.
fn row<const N: usize>(cells: [String; N]) -> String {
    let padded: Vec<String> = cells.iter().map(|cell| format!("{cell:>14}")).collect();
    padded.join(" ").trim_end().to_owned()
}
