//! What a motion in time would be.

use super::responses::{dampings, place};
use super::{Row, list, row};
use crate::number;
use crate::scene::{BaseDirection, Course, LoadOn, Scene, TransientLoad, TransientStart};

/// Rows about damping, loads, and the motion; none for other scenes.
pub fn rows(scene: &Scene) -> Vec<Row> {
    let Some(transient) = &scene.transient else { return Vec::new() };
    let several = scene.structure.bodies().len() > 1;
    let mut rows = dampings(scene);
    rows.extend(transient.loads.iter().enumerate().map(|(i, of)| row(format!("load {i}"), load(of, several))));
    let from = match &transient.from {
        TransientStart::Rest => "rest".to_owned(),
        TransientStart::Static => "where static loads and stops leave it".to_owned(),
        TransientStart::Point { results, point } => format!("point {point} of {}", results.display()),
    };
    rows.push(row("transient", format!("{} s from {from}", number(transient.duration))));
    rows
}

fn load(load: &TransientLoad, several: bool) -> String {
    let (at, unit) = match &load.on {
        LoadOn::Force(at) => (place(at, several), "N"),
        LoadOn::Base(BaseDirection::Along(direction)) => {
            (format!("the base in {} direction", direction.name()), "m/s²")
        }
        LoadOn::Base(BaseDirection::Vector(v)) => (format!("the base along [{}]", list(v)), "m/s²"),
    };
    let course = match &load.course {
        Course::Sine { amplitude, frequency_hz, phase_deg } => {
            let ahead = if *phase_deg == 0.0 { String::new() } else { format!(", {}° ahead", number(*phase_deg)) };
            format!("{} {unit} at {} Hz{ahead}", number(*amplitude), number(*frequency_hz))
        }
        Course::Chirp { amplitude, from_hz, to_hz, back, length } => {
            let back = if *back { " and back" } else { "" };
            let [amplitude, from, to, length] = [amplitude, from_hz, to_hz, length].map(|v| number(*v));
            format!("{amplitude} {unit} from {from} to {to} Hz{back} in {length} s")
        }
        Course::Table(path) => path.display().to_string(),
        Course::Noise { rms, band_hz: [low, high], seed } => {
            let [rms, low, high] = [rms, low, high].map(|v| number(*v));
            format!("noise of {rms} {unit} (effective) from {low} to {high} Hz, seed {seed}")
        }
        Course::HalfSine { peak, width } => format!("half sine of {} {unit}, {} s", number(*peak), number(*width)),
        Course::Impact { impulse } => format!("blow of {} N s", number(*impulse)),
    };
    let begin = if load.start == 0.0 { String::new() } else { format!(", from {} s on", number(load.start)) };
    format!("{at}, {course}{begin}")
}
