//! Checks of responses, and the estimated errors of their numbers.

use std::f64::consts::TAU;

use nlmodes::modal::ModalPoint;
use nlmodes_scene::scene::Scene;

use super::curves::ComputedResponse;
use super::summary::imbalance;
use super::tables::points;
use crate::certificate::finer::{Compared, changes, more_modes, of_responses, open_modes, sizes};
use crate::certificate::{Certificate, Check, ErrorSource, Number, Place, SourceKind, mesh, required, residual};
use crate::model::Model;

/// Input and dissipated power agree in the equations themselves; what is left comes from where contacts open and close.
const POWER: f64 = 1e-6;

/// Of all curves together.
pub fn certificate(scene: &Scene, model: &Model, curves: &[ComputedResponse]) -> Certificate {
    let residuals = points(curves).map(|(_, _, point)| point.residual);
    let mut checks = vec![residual(residuals)];
    let words = "difference of input and dissipated power of forced motions, all points";
    checks.extend(imbalance(curves).map(|most| Check::found("power balance", most, POWER, words)));
    let (places, mut compared) = (places(curves), Compared::default());
    let mut first = 0;
    for computed in curves {
        let own = &computed.branch.points;
        for (k, found) in &computed.finer {
            let changed = found.as_ref().map(|found| changes(own, &own[*k], found));
            compared.take(places[first + k], sizes(&own[*k]), changed);
        }
        first += own.len();
    }
    let harmonics = curves.iter().flat_map(|computed| &computed.branch.points).map(|p| p.coefficients.n_harmonics());
    checks.extend(of_responses(compared, harmonics.max().unwrap_or(scene.method.harmonics), places.len()));
    checks.push(open_modes(scene, model.open_modes(), 0));
    checks.push(mesh::frequency(scene, model.reduction.as_ref()));
    checks.extend(mesh::contact_mass(model.shift));
    checks.extend(model.reduction.as_ref().and_then(|open| mesh::digits(open, scene.method.mode)));
    if let Some(share) = model.beyond_modes {
        let words =
            "what dashpots move beyond the modes that are taken, of what they hold at the frequency of the mode";
        let source = ErrorSource {
            kind: SourceKind::Dashpots,
            name: "motion of dashpots beyond the modes".to_owned(),
            command: more_modes(scene, model.open_modes().n_modes()),
        };
        checks.push(Check::estimate("dashpots", (Number::Displacement, source), share, words));
    }
    Certificate::new(&places, checks, &required(scene))
}

/// Where the points of all curves lie.
fn places(curves: &[ComputedResponse]) -> Vec<Place> {
    let place = |(point, (_, _, found)): (usize, (_, _, &ModalPoint))| Place {
        point,
        frequency_hz: found.listed_omega() / TAU,
        energy_j: None,
    };
    points(curves).enumerate().map(place).collect()
}
