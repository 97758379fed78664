//! What was looked at in responses, and which of their numbers to use.

use std::f64::consts::TAU;

use nlmodes::modal::ModalPoint;
use nlmodes_scene::scene::Scene;

use super::curves::ComputedResponse;
use super::model::Model;
use super::summary::imbalance;
use super::tables::points;
use crate::certificate::mesh::contact_mass;
use crate::certificate::{Certificate, Check, Number, Place, residual};

/// Input and dissipated power agree in the equations themselves; what is left comes from where contacts open and close.
const POWER: f64 = 1e-6;

/// Share of a dashpot's motion that moves no result by more than a per cent.
const DASHPOTS: f64 = 1e-2;

/// How to have the rest looked at.
const LARGER: &str = "the same scene with method.harmonics twice as large, these results laid over it by [[overlay]]";

/// Of all curves together.
pub fn certificate(scene: &Scene, model: &Model, curves: &[ComputedResponse]) -> Certificate {
    let residuals = points(curves).map(|(_, _, point)| point.residual);
    let mut checks = vec![residual(residuals)];
    if curves.iter().any(|computed| computed.kind.is_forced()) {
        let words = "difference of input and dissipated power of forced motions, all points";
        checks.push(Check::found("power balance", None, imbalance(curves), POWER, words));
    }
    let harmonics = |n: Number| {
        let why = "more harmonics were not tried";
        Check::missing("harmonics", Some(n), n.limit(), why, LARGER)
    };
    checks.extend(Number::ALL.map(harmonics));
    checks.push(contact_mass(model.shift, model.reduction.is_some()));
    checks.push(modes(scene, model));
    if let Some(share) = model.beyond_modes {
        let words =
            "what dashpots move beyond the modes that are taken, of what they hold at the frequency of the mode";
        checks.push(Check::found("dashpots", None, share, DASHPOTS, words));
    }
    let place = |(point, (_, _, found)): (usize, (_, _, &ModalPoint))| Place {
        point,
        frequency_hz: found.listed_omega() / TAU,
        energy_j: None,
    };
    Certificate::new(&points(curves).enumerate().map(place).collect::<Vec<_>>(), checks)
}

/// What modes left out do to the linear frequency with the first contact closed.
fn modes(scene: &Scene, model: &Model) -> Check {
    let (of, limit) = (Some(Number::Frequency), Number::Frequency.limit());
    let open = model.open_modes();
    if open.has_all_modes() {
        return Check::found("modes", of, 0.0, limit, format!("all {} modes are kept", open.n_modes()));
    }
    let mut closed = vec![false; open.n_contacts()];
    closed.iter_mut().take(1).for_each(|first| *first = true);
    let found = scene.method.mode.checked_sub(1).and_then(|mode| open.truncation_error(&closed, mode).ok());
    match found.filter(|error| error.is_finite()) {
        Some(error) => {
            let words = "open modes: estimate from half as many, linear frequency with the first contact closed";
            Check::found("modes", of, error, limit, words)
        }
        None => {
            let why = "open modes: half as many do not reach the mode of the scene";
            Check::missing("modes", of, limit, why, "reduction.modes twice as large")
        }
    }
}
