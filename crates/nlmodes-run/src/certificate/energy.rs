//! The energy of the motion over a period: it is constant in an exact motion without damping.

use std::f64::consts::TAU;

use nlmodes::branches::{BranchError, ComputedBranch};
use nlmodes::timestep::{ContactDynamics, StateEnergy, TimestepError};
use nlmodes_scene::scene::MethodKind;

use super::{CERTIFY, Check, Sources, Worst, listed};
use crate::verify::Point;

const NAME: &str = "energy";
/// Instants of a period.
const SAMPLES: usize = 64;
/// Largest structures, in degrees of freedom, whose exact motions are checked, by default and with `--certify`: all
/// free-interface modes are computed.
const LARGEST: [usize; 2] = [120, 400];

/// Largest less smallest energy over a period, over the mean; under a weight that contacts carry, over the mean above
/// rest.
pub fn drift(computed: &ComputedBranch, points: &[usize], sources: Sources<'_>) -> Check {
    let n = computed.structure.model().dofs().len();
    let missing = |why, how| Check::missing(NAME, None, why, how);
    if computed.structure.recorded_dofs().len() < n {
        return missing(
            format!("of {n} degrees of freedom not all are kept"),
            "fewer degrees of freedom: `[reduction]`",
        );
    }
    let most = LARGEST[usize::from(sources.thorough)];
    if sources.scene.method.kind == MethodKind::Shooting && n > most {
        let how = if n <= LARGEST[1] { CERTIFY } else { "fewer degrees of freedom: `[reduction]`" };
        return missing(format!("{n} degrees of freedom, more than {most}"), how);
    }
    let mut worst = Worst::default();
    for &k in points {
        let found = Point::of_branch(sources.scene, computed, k);
        let at_rest = computed.structure.energy_at_rest().map_err(BranchError::from);
        match found.and_then(|point| Ok::<f64, BranchError>(of_point(&point, at_rest?)?)) {
            Ok(found) => worst.take(k, found),
            Err(error) => return missing(format!("point {k}: {error}"), "`verify`"),
        }
    }
    let at = listed(points, &computed.branch.points);
    let words = format!("change of the energy over a period of the motion, {at}; an exact one keeps it");
    Check::measured(NAME, worst.value, words).at(&worst)
}

fn of_point(point: &Point, at_rest: f64) -> Result<f64, TimestepError> {
    let energies = match &point.start {
        Some(start) => {
            let mut dynamics = ContactDynamics::new(point.model.clone())?;
            let state = dynamics.state(start, &vec![0.0; start.len()])?;
            dynamics.propagate(&state, TAU / point.omega)?.energies()
        }
        None => {
            let mut energy = StateEnergy::new(&point.model)?;
            let phase = |j: usize| TAU * j as f64 / SAMPLES as f64;
            let at = |j: usize| energy.of_harmonics(&point.coefficients, point.omega, phase(j));
            (0..SAMPLES).map(at).collect::<Result<_, _>>()?
        }
    };
    let mean = energies.iter().sum::<f64>() / energies.len() as f64 - at_rest;
    let [least, most] = energies.iter().fold([f64::MAX, f64::MIN], |[a, b], e| [a.min(*e), b.max(*e)]);
    Ok((most - least) / mean)
}
