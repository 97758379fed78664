//! What a test should meet: the damped mode of the rig, and the motions that its loop holds.

use std::f64::consts::TAU;

use nlmodes::branches::Watch;
use nlmodes::linalg::sparse_from_triplets;
use nlmodes::modal::ModalBranch;
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::model::{ContactLaw, Side};
use nlmodes::response::{
    Damping, ResponseCurve, ResponseModel, ResponsePoint, ResponseSettings, Weights, damped_mode, phase_resonance,
};
use nlmodes::rig::RigError;
use nlmodes_scene::scene::{Backbone, BackboneMethod, TestScene};

use super::backbone::computed_label;
use super::bench::Rig;
use crate::Failure;

/// Largest energy of the damped mode over that at grazing, beyond which it is not followed whatever its frequency.
const ENERGY: f64 = 1e6;

/// The window begins at this share of the frequency of the mode.
const BELOW: f64 = 0.97;

/// Force to which phase resonance is followed where no level has one, N.
const NO_FORCE: f64 = 1.0;

/// The damped mode, or phase resonance up to the largest force of the levels (N), of the modes, the damping and the
/// stop of the rig.
///
/// # Errors
/// What the model or the method have against it; a scene without a stop has neither.
pub fn compute(
    scene: &TestScene,
    rig: &Rig,
    wanted: &Backbone,
    method: BackboneMethod,
    largest_force: f64,
    watch: &Watch,
) -> Result<ModalBranch, Failure> {
    let (model, drive) = model(rig)?;
    let mode = (scene.settings.mode - 1).min(rig.bench.omega.len() - 1);
    let settings = ResponseSettings {
        harmonics: wanted.harmonics,
        mode: mode + 1,
        lag: scene.control.lag_deg.to_radians(),
        stability: false,
        watch: watch.clone(),
        ..ResponseSettings::new([BELOW * rig.bench.omega[mode], TAU * wanted.end_hz])
    };
    let (curve, name) = match method {
        BackboneMethod::PhaseResonance => {
            let mut driven = model;
            driven.push_force_at(&drive, 1.0, 1, 0.0)?;
            driven.set_drive_at(drive)?;
            let largest = if largest_force > 0.0 { largest_force } else { NO_FORCE };
            (in_contact(phase_resonance(&driven, largest, &settings)?), "phase resonance")
        }
        _ => (damped_mode(&model, ENERGY, &settings)?, "damped mode"),
    };
    let points = curve.points.iter().map(ResponsePoint::modal_point).collect();
    Ok(ModalBranch::of_points(computed_label(name, wanted), points, curve.end))
}

/// The modes with unit mass, and the place where the exciter pushes without mass of its own, behind the flexibility of
/// the modes that are left out.
fn model(rig: &Rig) -> Result<(ResponseModel, Weights), Failure> {
    let (bench, reduction) = (&rig.bench, &rig.reduction);
    let stop = bench.stop.as_ref().ok_or("there is no stop")?;
    let (n, shape) = (bench.omega.len(), reduction.shape(&stop.at.weights));
    let compliance = match stop.law {
        ContactLaw::Elastic { stiffness } => 1.0 / stiffness,
        ContactLaw::Rigid => reduction.residual(&stop.at.weights),
    };
    if compliance <= 0.0 {
        return Err(RigError::RigidStopWithoutFlexibility { residual: compliance }.into());
    }
    let (drive, residual) = (reduction.shape(&bench.drive.weights), reduction.residual(&bench.drive.weights));
    let mass = (0..n).map(|i| (i, i, 1.0));
    let mut stiffness: Vec<(usize, usize, f64)> = (0..n).map(|i| (i, i, bench.omega[i].powi(2))).collect();
    let own: Weights = drive.iter().copied().enumerate().collect();
    let (size, place) = if residual > 0.0 {
        let k = 1.0 / residual;
        stiffness.push((n, n, k));
        stiffness.extend((0..n).flat_map(|i| [(i, n, -k * drive[i]), (n, i, -k * drive[i])]));
        stiffness
            .extend((0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| (i, j, k * drive[i] * drive[j])));
        (n + 1, vec![(n, 1.0)])
    } else {
        (n, own)
    };
    // The gap closes by what the body moves toward its stop.
    let sign = if stop.side == Side::Positive { -1.0 } else { 1.0 };
    let direction: Vec<(usize, usize, f64)> = (0..n).map(|i| (i, 0, sign * shape[i])).collect();
    let matrix = |columns, entries: &[(usize, usize, f64)]| sparse_from_triplets(size, columns, entries);
    let (mass, stiffness) = (matrix(size, &mass.collect::<Vec<_>>())?, matrix(size, &stiffness)?);
    let modes = ModeCount::Lowest(n);
    let open = OpenModes::new(mass, stiffness, matrix(1, &direction)?, vec![stop.gap], vec![compliance], modes)?;
    Ok((ResponseModel::new(open, &Damping::Ratios(bench.damping_ratios.clone()))?, place))
}

/// The points with contact, and the last one before it.
fn in_contact(mut curve: ResponseCurve) -> ResponseCurve {
    let touches = |p: &ResponsePoint| p.motion.contacts.iter().any(|c| c.touches > 0);
    let first = curve.points.iter().position(touches).unwrap_or(curve.points.len());
    curve.points.drain(..first.saturating_sub(1));
    curve
}
