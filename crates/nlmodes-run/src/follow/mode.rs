//! A mode at an energy over a parameter.

use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, StabilityRule, Watch, compute_branch};
use nlmodes::modal::ModalPoint;
use nlmodes::response::{AtValue, OverParameter};
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::number;

use super::family::Texts;
use super::{FollowError, FollowSettings, Followed};
use crate::gradients::{self, with_modes};
use crate::settings::{Models, branch_settings, models_sharing, starts};
use crate::{Failure, chain, refusal};

/// Relative difference of energies that are the same.
const SAME_ENERGY: f64 = 1e-6;

/// Follows the mode at the energy (J).
pub fn follow(
    texts: &Texts,
    settings: &FollowSettings,
    energy: f64,
    (structures, watch): (&Structures, &Watch),
) -> Result<Vec<Followed>, FollowError> {
    let file = &texts.base;
    if !file.scene.responses.is_empty() {
        return Err(FollowError::NoCurve(
            "the scene has responses; a mode at an energy is that of a scene without [response]".to_owned(),
        ));
    }
    let Models { massless, open, .. } = models_sharing(file, structures)?;
    let modes = open.as_ref().map_or(0, |open| open.modes.n_modes());
    let own = BranchSettings {
        start: starts(file.scene.continuation.start()).0,
        stability: StabilityRule::Never,
        watch: watch.clone(),
        ..branch_settings(&file.scene)
    };
    let branch = |ratio: Option<f64>| {
        let settings = BranchSettings { max_energy_ratio: ratio.or(own.max_energy_ratio), ..own.clone() };
        let goes_on = |_: &ModalPoint| match ratio.is_none() || watch.has_ended() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        compute_branch(massless.clone(), &settings, goes_on).map_err(|error| refusal::of_branch(file, &error))
    };
    let first = branch(None)?.branch.points.first().map_or(f64::NAN, |point| point.kinetic_energy);
    // A branch ends exactly at its largest energy.
    let computed = match energy > first {
        true => branch(Some(energy / first))?,
        false => branch(None)?,
    };
    let is_there = |point: &&ModalPoint| (point.kinetic_energy / energy - 1.0).abs() < SAME_ENERGY;
    let Some(nearest) = computed.branch.points.last().filter(is_there) else {
        let last = computed.branch.points.last().map_or(f64::NAN, |point| point.kinetic_energy);
        let [first, last, energy] = [first, last, energy].map(number);
        let why = format!(
            "the branch goes from {first} to {last} J, and is never at {energy} J: {}",
            computed.branch.end.message
        );
        return Err(FollowError::NoCurve(why));
    };
    let response = gradients::settings(&file.scene, nearest.coefficients.n_harmonics(), watch.clone());
    let mut family = |value: f64| -> Result<AtValue, String> {
        let words = |error: Failure| chain(error.as_ref());
        let mut there = texts.at(value)?;
        there.scene = with_modes(&there.scene, modes);
        let of = gradients::at_value(&there.scene, texts.number, structures, &response);
        of.map_err(words)
    };
    let mut over =
        OverParameter { family: &mut family, value: texts.value(), window: settings.window, settings: &response };
    let curve = over.mode(nearest, energy, own.symmetry)?;
    Ok(vec![Followed::new(format!("mode {} at {} J", own.mode, number(energy)), &curve, 1)])
}
