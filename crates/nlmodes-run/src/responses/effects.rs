//! What the parameters of a scene do to the curves of its first response, as data of the page with sliders.

use nlmodes::branches::Watch;
use nlmodes::modal::{Event, GradientOf, ModalBranch, ModalPoint};
use nlmodes::report::hertz;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;
use serde_json::{Value, json};

use super::curves::ComputedResponse;
use super::picture::{levels, plain};
use crate::RunError;
use crate::model::Model;

/// Peak, largest contact force and folds of the first response at each of its levels, with what 1 % of each parameter
/// of the scene does to them, in per cent:
/// `[{ level, quantities: [{ name, value, unit, effects: { key: percent } }] }]`.
///
/// # Errors
/// As [`picture`](super::picture::picture).
pub fn effects(file: &SceneFile, watch: &Watch, structures: &Structures) -> Result<String, RunError> {
    let file = plain(file);
    let model = Model::sharing(&file, structures)?;
    let levels = levels(&file, &model, watch)?;
    let of = |one: &ComputedResponse| json!({ "level": one.branch.label, "quantities": quantities(&one.branch) });
    Ok(Value::Array(levels.iter().map(of).collect()).to_string())
}

/// Most folds that are reported.
const FOLDS: usize = 4;

fn quantities(branch: &ModalBranch) -> Vec<Value> {
    let points = &branch.points;
    let largest = |of: &dyn Fn(&ModalPoint) -> f64| points.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
    let told = |name: &str, unit: &str, point: &ModalPoint, (of, value): (GradientOf, f64)| {
        let effect = |own: &nlmodes::modal::Gradient| {
            let percent = own.of(of)? * own.value / value;
            percent.is_finite().then(|| (own.parameter.to_string(), json!(percent)))
        };
        let effects: serde_json::Map<String, Value> = point.gradients.iter().filter_map(effect).collect();
        let at = hertz(point.listed_omega());
        json!({ "name": name, "unit": unit, "value": value, "frequency": at, "effects": effects })
    };
    let mut all = Vec::new();
    if let Some(point) = largest(&|point| point.fundamental.abs()) {
        all.push(told("peak", "m", point, (GradientOf::Amplitude, point.fundamental.abs())));
    }
    if let Some(point) = largest(&|point| point.peak_contact_force).filter(|point| point.peak_contact_force > 0.0) {
        all.push(told("largest force", "N", point, (GradientOf::PeakForce, point.peak_contact_force)));
    }
    let is_fold = |k: &usize| points[*k].events.contains(&Event::Fold);
    for k in (0..points.len()).filter(is_fold).take(FOLDS) {
        let (own, at) = (&points[k], hertz(points[k].listed_omega()));
        let before = k.checked_sub(1).map_or(at, |k| hertz(points[k].listed_omega()));
        let name = if before < at { "jump up" } else { "jump down" };
        all.push(told(name, "Hz", own, (GradientOf::Frequency, at)));
    }
    all
}
