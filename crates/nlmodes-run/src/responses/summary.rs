//! `summary.json` of responses.

use std::path::Path;
use std::time::Instant;

use nlmodes::modal::ModalPoint;
use nlmodes::report::write_summary;
use nlmodes_scene::scene::Scene;
use serde_json::{Value, json};

use super::curves::ComputedResponse;
use super::levels::Level;
use super::sweeps::Sweep;
use super::tables::points;
use super::viewed::{Viewed, pictured_of, viewed};
use crate::Failure;
use crate::certificate::Certificate;
use crate::curve::space::Period;
use crate::curve::summary::{AtRest, ContactAt, End, Reduction, Resonance, Stability, largest_residual, place};
use crate::model::Model;

/// Writes it.
pub fn write(
    directory: &Path,
    (scene, model): (&Scene, &Model),
    (curves, sweeps): (&[ComputedResponse], &[Sweep]),
    (certificate, levels): (&Certificate, &[Level]),
    period: Option<&Period>,
    began: Instant,
) -> Result<(), Failure> {
    let hertz: Vec<f64> =
        model.open_modes().omega_squared().iter().map(|w| nlmodes::report::hertz(w.max(0.0).sqrt())).collect();
    let structure = model.response().structure();
    let ratio = |k: usize| structure.damping().entry(k, k) / (2.0 * structure.omega_squared()[k].max(0.0).sqrt());
    let (mut first, mut all, mut motion) = (0, Vec::new(), None);
    let shown = viewed(scene, model, curves);
    let pictured = shown.get(pictured_of(&shown)).map(Viewed::number);
    for (number, computed) in curves.iter().enumerate() {
        all.push(curve(computed, first));
        let period = period.filter(|_| pictured == Some(number));
        motion = motion.or(period.and_then(|period| place(&computed.branch.points, first, period.point)));
        first += computed.branch.points.len();
    }
    let open = model.reduction.as_ref();
    let content = json!({
        "program": "nlmodes-cli",
        "version": env!("CARGO_PKG_VERSION"),
        "scene": scene,
        "open_frequencies_hz": hertz,
        "open_damping_ratios": (0..hertz.len()).map(ratio).collect::<Vec<f64>>(),
        "reduction": open.map(|open| Reduction::new(scene, open, 0)),
        "contacts": ContactAt::all(open),
        "rest": AtRest::all(model.state.as_ref()),
        "stress_left_out": model.stress_left_out(scene),
        "motion": motion,
        "level_unit": model.unit,
        "points": first,
        "curves": all,
        "levels": levels,
        "sweeps": sweeps.iter().map(Sweep::summary).collect::<Vec<_>>(),
        "complete": curves.iter().all(ComputedResponse::is_complete),
        "largest_residual": largest_residual(points(curves).map(|(_, _, point)| point)),
        "largest_power_imbalance": imbalance(curves),
        "errors": certificate.by_number(),
        "certificate": certificate,
        "wall_time_s": began.elapsed().as_secs_f64(),
    });
    Ok(write_summary(directory.join("summary.json"), &content)?)
}

/// Largest difference of input and dissipated power, over the latter, of forced motions; `None` where no motion
/// dissipates more than the rounding of its energy, as under a force on a stop that stays closed.
pub fn imbalance(curves: &[ComputedResponse]) -> Option<f64> {
    let of = |point: &ModalPoint| {
        let driven = point.driven?;
        let (input, out) = (driven.input_power?, driven.dissipated_power);
        let is_known = out > f64::EPSILON * driven.omega * point.total_energy;
        is_known.then(|| (input / out - 1.0).abs())
    };
    points(curves).filter_map(|(_, _, point)| of(point)).reduce(f64::max)
}

/// A curve whose first point is the row `first` of `branch.csv`.
fn curve(computed: &ComputedResponse, first: usize) -> Value {
    let branch = &computed.branch;
    let at = |point: &ModalPoint| {
        json!({
            "frequency_hz": nlmodes::report::hertz(point.listed_omega()),
            "level": point.driven.and_then(|driven| driven.level).unwrap_or(0.0),
            "drive_fundamental_m": point.driven.and_then(|driven| driven.drive).map_or(0.0, |drive| drive.norm()),
        })
    };
    let with = |(i, point): (usize, &ModalPoint)| {
        let mut event = at(point);
        event["point"] = json!(first + i);
        event["events"] = json!(point.events.iter().map(|e| e.name()).collect::<Vec<_>>());
        event
    };
    let events = branch.points.iter().enumerate().filter(|(_, p)| !p.events.is_empty()).map(with);
    let unknown = branch.points.iter().filter(|p| p.stability.is_some_and(|s| s.stable.is_none())).count();
    json!({
        "response": computed.response + 1,
        "kind": computed.kind.name(),
        "name": branch.label,
        "level": computed.level,
        "detached": computed.is_detached,
        "first_point": first,
        "points": branch.points.len(),
        "events": events.collect::<Vec<Value>>(),
        "internal_resonances": Resonance::all(&branch.points, first),
        "phase_resonances": computed.at_levels.iter().map(at).collect::<Vec<Value>>(),
        "stability": Stability::new(&branch.points, first, None),
        "points_of_uncertain_stability": unknown,
        "end": End::from(&branch.end),
        "wall_time_s": computed.wall_time.as_secs_f64(),
    })
}
