//! Points of several methods with the same modal amplitude, whose motions are drawn over each other.

use std::f64::consts::TAU;

use nlmodes::branches::{ComputedBranch, Histories, reference_points};
use nlmodes_scene::assemble::StaticState;
use nlmodes_scene::short;

use super::curve::BranchCurve;
use crate::Failure;
use crate::curve::histories::{MAX_CURVES, Reference, SAMPLES};
use crate::curve::stops;

/// The reference points of the first branch, or the largest amplitude that all branches reach where these do not go as
/// far, with the motion of each branch there.
///
/// # Errors
/// If a periodic problem cannot be evaluated.
pub fn references(all: &[&ComputedBranch], state: Option<&StaticState>) -> Result<Vec<Reference>, Failure> {
    let Some(first) = all.first() else { return Ok(Vec::new()) };
    let shown = &all[..all.len().min(MAX_CURVES)];
    let highest = |branch: &ComputedBranch| branch.branch.points.iter().map(|p| p.modal_amplitude).fold(0.0, f64::max);
    let common = shown.iter().map(|branch| highest(branch)).fold(f64::INFINITY, f64::min);
    let points = &first.branch.points;
    let mut found: Vec<Reference> = Vec::new();
    for (number, point) in reference_points(&first.branch).into_iter().enumerate() {
        let amplitude = points[point].modal_amplitude.min(common);
        if found.iter().any(|reference| reference.amplitude == amplitude) {
            continue;
        }
        let mut motions = Vec::new();
        for branch in shown {
            let Some(solution) = branch.at_amplitude(amplitude, points[point].omega)? else { continue };
            let label = format!("{}: {:.4} Hz", branch.branch.label, solution.point.omega / TAU);
            let mut motion = Histories::of(branch).between(&solution, SAMPLES, &label)?;
            BranchCurve::new(branch, &[], state).count_from_drawing(&mut motion);
            if motion.len() > 1 {
                let names = stops::names(&BranchCurve::new(branch, &[], None)).into_iter();
                motion.iter_mut().zip(names).for_each(|(history, name)| history.label = format!("{label}, {name}"));
            }
            motions.push(motion);
        }
        let off = |k: &usize| (points[*k].modal_amplitude - amplitude).abs();
        let near = if points[point].modal_amplitude == amplitude {
            Some(point)
        } else {
            (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        // Where a branch does not go as far as the point of the first one, it is another point, and has another name.
        let name = match amplitude < points[point].modal_amplitude {
            true => "common".to_owned(),
            false => format!("P{}", number + 1),
        };
        let size = short(amplitude);
        let title = match amplitude < points[point].modal_amplitude {
            true => format!("largest modal amplitude of all branches, {size} m √kg"),
            false => format!("{name}: equal modal amplitude, {size} m √kg"),
        };
        found.push(Reference { name, amplitude, point: near.unwrap_or(point), title, motions });
    }
    Ok(found)
}
