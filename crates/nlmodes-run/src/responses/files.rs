use std::f64::consts::TAU;
use std::fs;
use std::time::Instant;

use nlmodes::report::{ReportError, ResponseFigure, ResponseLine, write_file, write_summary};
use nlmodes::response::{ResponseCurve, ResponsePoint};
use nlmodes_scene::scene::{ResponseKind, Scene};
use serde_json::{Value, json};

use super::{ComputedResponse, Model};
use crate::{Failure, RunError};

/// Columns of `branch.csv` of responses.
pub const COLUMNS: [&str; 27] = [
    "point",
    "response",
    "kind",
    "level",
    "frequency_hz",
    "energy_j",
    "total_energy_j",
    "modal_amplitude",
    "fundamental_m",
    "peak_m",
    "contact_fraction",
    "contact_intervals",
    "peak_contact_force_n",
    "residual",
    "event",
    "force_n",
    "acceleration_m_s2",
    "drive_fundamental_m",
    "drive_lag_deg",
    "input_power_w",
    "dissipated_power_w",
    "damping_ratio",
    "stable",
    "largest_multiplier",
    "multiplier_angle_deg",
    "multiplier_error",
    "curve",
];

/// Writes `branch.csv`, `summary.json` and `responses.svg`.
pub fn write(scene: &Scene, model: &Model, curves: &[ComputedResponse], began: Instant) -> Result<(), RunError> {
    let directory = &scene.output_directory;
    let unwritable = |source: ReportError| RunError::Unwritable { directory: directory.clone(), source, kept: false };
    fs::create_dir_all(directory).map_err(|source| unwritable(ReportError::Io { path: directory.clone(), source }))?;
    let table = table(model, curves).map_err(RunError::Files)?;
    write_file(directory.join("branch.csv"), &table).map_err(unwritable)?;
    if let Some(figure) = figure(scene, model, curves)? {
        figure.write(directory.join("responses.svg")).map_err(unwritable)?;
    }
    write_summary(directory.join("summary.json"), &summary(scene, model, curves, began)).map_err(unwritable)
}

fn table(model: &Model, curves: &[ComputedResponse]) -> Result<Vec<u8>, Failure> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(COLUMNS)?;
    let mut number = 0;
    for (k, computed) in curves.iter().enumerate() {
        for point in computed.curve.iter().flat_map(|curve| &curve.points) {
            table.write_record(row(number, k, model, computed, point))?;
            number += 1;
        }
    }
    Ok(table.into_inner().map_err(|error| error.into_error())?)
}

fn row(number: usize, curve: usize, model: &Model, computed: &ComputedResponse, point: &ResponsePoint) -> Vec<String> {
    let motion = &point.motion;
    let forced = computed.kind != ResponseKind::DampedMode;
    let when = |is: bool, value: f64| if is { value.to_string() } else { String::new() };
    let first = motion.contacts.first();
    let of_first = |value: &dyn Fn(&nlmodes::hbm::ContactMotion) -> f64| first.map_or(f64::NAN, value).to_string();
    let events: Vec<&str> = point.events.iter().map(|event| event.name()).collect();
    let phase = |z: num_complex::Complex64| if z.re < 0.0 { -z.norm() } else { z.norm() };
    let stability = point.stability.as_ref();
    vec![
        number.to_string(),
        computed.response.to_string(),
        computed.kind.name().to_owned(),
        when(forced, point.level),
        (point.omega / TAU).to_string(),
        motion.kinetic_energy.to_string(),
        motion.total_energy.to_string(),
        motion.modal_amplitude().to_string(),
        // A contact's own displacement points away from its stop.
        of_first(&|c| if forced { c.fundamental.norm() } else { phase(-c.fundamental * model.side()) }),
        of_first(&|c| c.peak),
        of_first(&|c| c.closed_share),
        motion.contacts.iter().map(|c| c.touches).sum::<usize>().to_string(),
        motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max).to_string(),
        point.residual.to_string(),
        events.join(" "),
        when(forced && model.unit == "N", point.level),
        when(forced && model.unit == "m/s²", point.level),
        when(forced, point.drive.norm()),
        when(forced, point.lag().to_degrees()),
        when(forced, motion.input_power),
        motion.dissipated_power.to_string(),
        when(!forced, motion.damping_ratio()),
        stability.and_then(|s| s.stable).map_or(String::new(), |stable| stable.to_string()),
        stability.map_or(String::new(), |s| s.largest.norm().to_string()),
        stability.map_or(String::new(), |s| s.largest.arg().to_degrees().to_string()),
        stability.map_or(String::new(), |s| s.error.to_string()),
        curve.to_string(),
    ]
}

fn figure(
    scene: &Scene,
    model: &Model,
    curves: &[ComputedResponse],
) -> Result<Option<nlmodes::report::Figure>, RunError> {
    let over_level = curves.iter().all(|c| c.kind == ResponseKind::Force);
    let line = |computed: &ComputedResponse| {
        let curve: &ResponseCurve = computed.curve.as_ref().ok()?;
        let abscissa = |p: &ResponsePoint| if over_level { p.level } else { p.omega / TAU };
        let at = |p: &ResponsePoint| {
            let fundamental = p.motion.contacts.first().map_or(f64::NAN, |c| c.fundamental.norm());
            (abscissa(p), fundamental, p.stability.and_then(|s| s.stable))
        };
        Some(ResponseLine { name: computed.name(model.unit), points: curve.points.iter().map(at).collect() })
    };
    let lines: Vec<ResponseLine> =
        curves.iter().filter(|c| over_level || c.kind != ResponseKind::Force).filter_map(line).collect();
    if lines.is_empty() {
        return Ok(None);
    }
    let abscissa = if over_level { format!("level in {}", model.unit) } else { "frequency in Hz".to_owned() };
    let figure = ResponseFigure::new(&lines, abscissa, "fundamental of the first contact in m");
    figure.title(scene.title.clone()).render().map(Some).map_err(|error| RunError::Files(Box::new(error)))
}

fn summary(scene: &Scene, model: &Model, curves: &[ComputedResponse], began: Instant) -> Value {
    let one = |computed: &ComputedResponse| {
        let (points, end, events) = match &computed.curve {
            Ok(curve) => {
                let named = |p: &&ResponsePoint| !p.events.is_empty();
                let at = |p: &ResponsePoint| {
                    json!({ "frequency_hz": p.omega / TAU, "level": p.level,
                            "events": p.events.iter().map(|e| e.name()).collect::<Vec<_>>() })
                };
                let events: Vec<Value> = curve.points.iter().filter(named).map(at).collect();
                (curve.points.len(), format!("{:?}", curve.end), events)
            }
            Err(why) => (0, why.clone(), Vec::new()),
        };
        json!({
            "response": computed.response,
            "kind": computed.kind.name(),
            "level": computed.level,
            "points": points,
            "events": events,
            "end": { "reason": end, "complete": computed.is_complete() },
        })
    };
    json!({
        "program": "nlmodes-cli",
        "version": env!("CARGO_PKG_VERSION"),
        "scene": scene,
        "open_modes": model.n_modes(),
        "level_unit": model.unit,
        "curves": curves.iter().map(one).collect::<Vec<_>>(),
        "wall_time_s": began.elapsed().as_secs_f64(),
    })
}
