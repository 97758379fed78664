//! Motion and force of the contacts over a period, at points of the curves.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::{ContactInstant, TimeHistory};
use nlmodes::report::{PointHistories, write_histories};
use nlmodes::response::ResponseError;
use nlmodes_scene::scene::Scene;

use super::curves::ComputedResponse;
use super::model::Model;
use crate::Failure;

/// Instants of a period in `histories.npz`.
const SAMPLES: usize = 1000;

/// All contacts over a period of a point, displacements along the coordinates of their nodes; exact at the instants of
/// contact, where two instants stand a rounding apart.
///
/// # Errors
/// [`ResponseError`] where a contact problem has no solution.
pub fn of_point(
    model: &Model,
    scene: &Scene,
    (computed, point): (&ComputedResponse, usize),
    samples: usize,
    label: &str,
) -> Result<Vec<TimeHistory>, ResponseError> {
    let found = computed.motions.as_ref().and_then(|curve| curve.points.get(point));
    let Some(motion) = found.map(|point| &point.motion) else { return Ok(Vec::new()) };
    let omega = motion.at.omega;
    let pattern = model.response().contact_pattern(motion, scene.responses[computed.response].subharmonic)?;
    let stretches = pattern.stretches();
    let empty = |(side, gap): (&f64, &f64)| TimeHistory::empty(label, side * gap);
    let mut all: Vec<TimeHistory> = model.sides.iter().zip(&model.gaps).map(empty).collect();
    let mut last = f64::NEG_INFINITY;
    for (tau, stretch) in TimeHistory::exact_instants(&stretches, samples) {
        last = (tau / omega).max(f64::next_up(last));
        for ((history, state), side) in all.iter_mut().zip(pattern.state(tau, stretch)).zip(&model.sides) {
            history.push(last, state.motion.map(|m| side * m), state.force.max(0.0));
        }
    }
    let middles: Vec<Vec<bool>> = stretches
        .iter()
        .enumerate()
        .map(|(k, [from, to])| pattern.state(0.5 * (from + to), k).iter().map(|s| s.force > 0.0).collect())
        .collect();
    for (i, history) in all.iter_mut().enumerate() {
        for (pair, ends) in middles.windows(2).zip(&stretches) {
            if pair[0][i] != pair[1][i] {
                history.instants.push(ContactInstant { time: ends[1] / omega, touching: pair[1][i] });
            }
        }
    }
    Ok(all)
}

/// Writes `histories.npz`: the point with the largest contact force of each curve, the phase resonances next to the
/// levels, and what the scene asks for.
pub fn write(directory: &Path, scene: &Scene, model: &Model, curves: &[ComputedResponse]) -> Result<(), Failure> {
    let mut wanted: BTreeSet<usize> = scene.files.histories.iter().copied().collect();
    let mut first = 0;
    for computed in curves {
        let points = &computed.branch.points;
        let force = |k: &usize| points[*k].peak_contact_force;
        let largest = (0..points.len()).max_by(|a, b| force(a).total_cmp(&force(b)));
        wanted.extend(largest.map(|k| first + k));
        first += points.len();
    }
    let mut histories = PointHistories::default();
    let mut number = 0;
    for computed in curves {
        for (k, point) in computed.branch.points.iter().enumerate() {
            if wanted.contains(&number) {
                let label = format!("{}, {:.4} Hz", computed.branch.label, point.listed_omega() / TAU);
                histories.points.push(number);
                histories.motions.push(of_point(model, scene, (computed, k), SAMPLES, &label)?);
            }
            number += 1;
        }
    }
    // Where contacts switch more often than others, points have more instants: those that share a number of them are
    // written.
    let instants = |motion: &[TimeHistory]| motion.first().map_or(0, |history| history.time.len());
    let common = histories.motions.iter().map(|motion| instants(motion)).max().unwrap_or(0);
    let kept: Vec<bool> = histories.motions.iter().map(|motion| instants(motion) == common).collect();
    let mut keep = kept.iter();
    histories.points.retain(|_| *keep.next().unwrap_or(&true));
    let mut keep = kept.iter();
    histories.motions.retain(|_| *keep.next().unwrap_or(&true));
    if histories.points.is_empty() {
        return Ok(());
    }
    Ok(write_histories(directory.join("histories.npz"), &histories)?)
}
