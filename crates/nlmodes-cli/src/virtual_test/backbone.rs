//! The conservative backbone of the rig's modes and stop.

use std::error::Error;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::modal::ModalBranch;
use nlmodes::study::{BranchSettings, ResonanceRule, compute_branch};

use super::bench::Rig;
use crate::config::scene::Backbone;

/// Points of the backbone at most.
const MAX_POINTS: usize = 2000;

/// Computes it from grazing, past its internal resonances, in which a test does not follow it.
///
/// # Errors
/// What the model, the harmonic balance or the continuation have against it; a scene without a stop has no backbone.
pub fn compute(rig: &Rig, wanted: Backbone, mode: usize) -> Result<ModalBranch, Box<dyn Error>> {
    let model = rig.bench.backbone_model(&rig.reduction)?.ok_or("there is no stop")?;
    let linear = rig.bench.omega[(mode - 1).min(rig.bench.omega.len() - 1)] / TAU;
    let settings = BranchSettings {
        mode,
        harmonics: wanted.harmonics,
        internal_resonance: ResonanceRule::Skip,
        frequency_hz: Some([0.99 * linear, wanted.end_hz]),
        max_points: MAX_POINTS,
        ..BranchSettings::default()
    };
    let mut branch = compute_branch(model, &settings, |_| ControlFlow::Continue(()))?.branch;
    branch.label = format!("computed, {} harmonics", wanted.harmonics);
    Ok(branch)
}
