//! The energy of the motion over a period: it is constant in an exact motion without damping.

use std::f64::consts::TAU;

use nlmodes::study::{ComputedBranch, StudyError};
use nlmodes::timestep::{ContactDynamics, TimestepError};

use super::{CERTIFY, Check, Number, Sources, Worst, listed};
use crate::verify::Point;

const NAME: &str = "energy";
const OF: Option<Number> = Some(Number::Displacement);
/// A motion whose energy changes by a twentieth is off by some per cent at some instant.
const LIMIT: f64 = 5e-2;
/// Instants of a period.
const SAMPLES: usize = 64;
/// Largest structures that are looked at, degrees of freedom, if not all is asked for and if it is: all modes of the open structure are computed.
const LARGEST: [usize; 2] = [120, 400];

/// Largest less smallest energy over a period, over the mean.
pub fn drift(computed: &ComputedBranch, points: &[usize], sources: Sources<'_>) -> Check {
    let n = computed.structure.model().dofs().len();
    let most = LARGEST[usize::from(sources.thorough)];
    if n > most {
        let how = if n <= LARGEST[1] { CERTIFY } else { "fewer degrees of freedom: `[reduction]`" };
        return Check::missing(NAME, OF, LIMIT, format!("{n} degrees of freedom, more than {most}"), how);
    }
    let mut worst = Worst::default();
    for &k in points {
        let found = Point::of_branch(sources.scene, computed, k);
        match found.and_then(|point| Ok::<f64, StudyError>(of_point(&point)?)) {
            Ok(found) => worst.take(k, found),
            Err(error) => return Check::missing(NAME, OF, LIMIT, format!("point {k}: {error}"), "`verify`"),
        }
    }
    let words = format!("change of the energy over a period of the motion, {}; an exact one keeps it", listed(points));
    Check::found(NAME, OF, worst.value, LIMIT, words).at(worst)
}

fn of_point(point: &Point) -> Result<f64, TimestepError> {
    let mut dynamics = ContactDynamics::new(point.model.clone())?;
    let energies = match &point.start {
        Some(start) => {
            let state = dynamics.state(start, &vec![0.0; start.len()])?;
            dynamics.propagate(&state, TAU / point.omega)?.energies()
        }
        None => {
            let at = |j: usize| {
                let phase = TAU * j as f64 / SAMPLES as f64;
                let state = dynamics.state_of_harmonics(&point.coefficients, point.omega, phase)?;
                dynamics.energy(&state)
            };
            (0..SAMPLES).map(at).collect::<Result<_, _>>()?
        }
    };
    let mean = energies.iter().sum::<f64>() / energies.len() as f64;
    let [least, most] = energies.iter().fold([f64::MAX, f64::MIN], |[a, b], e| [a.min(*e), b.max(*e)]);
    Ok((most - least) / mean)
}
