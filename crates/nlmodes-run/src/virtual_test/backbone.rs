//! Conservative backbones of the rig's structure and stop.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ResonanceRule, Watch, compute_branch};
use nlmodes::fem::{Direction, Stop};
use nlmodes::modal::ModalBranch;
use nlmodes::model::{Drop, MasslessContactModel, Side};

use super::bench::Rig;
use crate::Failure;
use nlmodes_scene::assemble::{Elements, moving_kind};
use nlmodes_scene::scene::{self, Backbone, BackboneMethod, StructureKind, TestScene};

/// Points of a backbone at most.
const MAX_POINTS: usize = 2000;

/// Computes it from grazing, past its internal resonances, in which a test does not follow it.
///
/// By harmonic balance it is that of the modes and the stop of the rig. By mixed shooting-harmonic balance it is that
/// of the finite elements with a rigid stop and a massless contact node, with the rig's frequencies imposed: a
/// computation without contact stiffness.
///
/// # Errors
/// What the model, the method or the continuation have against it; a scene without a stop has no backbone.
pub fn compute(
    scene: &TestScene,
    rig: &Rig,
    wanted: &Backbone,
    method: BackboneMethod,
    watch: &Watch,
) -> Result<ModalBranch, Failure> {
    let mode = (scene.settings.mode - 1).min(rig.bench.omega.len() - 1);
    let (found, name) = match method {
        BackboneMethod::Hbm => (rig.bench.backbone_model(&rig.reduction)?.map(|model| (model, mode + 1)), "HBM"),
        _ => (rigid(scene, mode)?, "MS-HBM, rigid stop"),
    };
    let (model, number) = found.ok_or("there is no stop")?;
    let settings = BranchSettings {
        mode: number,
        harmonics: wanted.harmonics,
        internal_resonance: ResonanceRule::Skip,
        frequency_hz: Some([0.99 * rig.bench.omega[mode] / TAU, wanted.end_hz]),
        max_points: MAX_POINTS,
        watch: watch.clone(),
        ..BranchSettings::default()
    };
    let mut branch = compute_branch(model, &settings, |_| ControlFlow::Continue(()))?.branch;
    branch.label = computed_label(name, wanted);
    Ok(branch)
}

/// Name of a curve by this method.
pub fn computed_label(method: &str, wanted: &Backbone) -> String {
    let plural = if wanted.harmonics == 1 { "" } else { "s" };
    format!("computed: {method}, {} harmonic{plural}", wanted.harmonics)
}

/// The elements before a rigid stop, and the number of the rig's mode `mode` (from 0) among theirs, from 1: a beam has
/// axial ones too.
fn rigid(scene: &TestScene, mode: usize) -> Result<Option<(MasslessContactModel, usize)>, Failure> {
    let Some(stop) = &scene.stop else { return Ok(None) };
    let kind = scene.structure.kind();
    let direction = match kind {
        StructureKind::Rod => Direction::Axial,
        StructureKind::Beam => Direction::Transverse,
    };
    let side = match stop.side {
        scene::Side::Positive => Side::Positive,
        scene::Side::Negative => Side::Negative,
    };
    let stop = Stop::rigid(stop.position, direction, side, stop.gap);
    let model = Elements::new(&scene.structure)?.assemble(&[stop])?;
    let model = match scene.given_frequencies() {
        Some(frequencies) => {
            let omega: Vec<f64> = frequencies.iter().map(|hz| TAU * hz).collect();
            model.with_frequencies(Some(&Drop), moving_kind(kind), &omega)?.model
        }
        None => model,
    };
    let number = model.modes_of_kind(Some(&Drop), moving_kind(kind), mode + 1)?.last().map_or(mode, |k| *k) + 1;
    Ok(Some((MasslessContactModel::new(&model, &Drop)?, number)))
}
