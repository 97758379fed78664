//! `nlmodes-cli verify`: one period of the full, unfiltered structure from a computed point.

pub(crate) mod error;
pub(crate) mod results;
mod text;

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::Args;
use nlmodes::timestep::{
    ContactDynamics, Floquet, ModalState, PeriodicMotion, Shooting, ShootingScales, TimestepError, Verification,
};

use crate::Status;
use crate::command::print;
use crate::run::chain;
use error::VerifyError;
use results::Point;

/// Most modes with which the exact motion next to the point is looked for.
const MOST_MODES: usize = 400;

/// What stands on the command line.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directory that `run` has written, or a folder of one of its branches
    #[arg(value_name = "RESULTS")]
    results: PathBuf,
    /// Number of the point, as in branch.csv
    #[arg(long, value_name = "N")]
    point: usize,
}

/// Verifies the point and prints what comes out.
pub fn run(arguments: &Arguments) -> Status {
    let point = match Point::read(&arguments.results, arguments.point) {
        Ok(point) => point,
        Err(error) => return refuse(arguments, &error, Status::Wrong),
    };
    match verify(&point) {
        Ok(found) => print(text::of(&point, &found).trim_end()),
        Err(error @ TimestepError::TooLarge { .. }) => refuse(arguments, &error.into(), Status::Wrong),
        Err(error) => refuse(arguments, &error.into(), Status::EndedEarly),
    }
}

fn refuse(arguments: &Arguments, error: &VerifyError, status: Status) -> Status {
    say!("error: {}: {}", arguments.results.display(), chain(error));
    status
}

/// What is said about a point.
struct Found {
    modes: usize,
    verification: Verification,
    /// The exact motion of the same averaged kinetic energy next to it, unless the structure is too large or the point not even in time.
    exact: Option<Result<Exact, TimestepError>>,
}

struct Exact {
    motion: PeriodicMotion,
    largest_multiplier: f64,
    stable: bool,
}

fn verify(point: &Point) -> Result<Found, TimestepError> {
    let mut dynamics = ContactDynamics::new(point.model.clone())?;
    let state = match &point.start {
        Some(displacement) => dynamics.state(displacement, &vec![0.0; displacement.len()])?,
        None => dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0)?,
    };
    let verification = Verification::new(&mut dynamics, &state, TAU / point.omega)?;
    let modes = dynamics.n_modes();
    let exact = (modes <= MOST_MODES && point.is_even()).then(|| exact(dynamics, &state, point));
    Ok(Found { modes, verification, exact })
}

fn exact(mut dynamics: ContactDynamics, state: &ModalState, point: &Point) -> Result<Exact, TimestepError> {
    let omega = point.omega;
    let energy = match point.start {
        // The coefficients leave out what lies beyond the last harmonic.
        Some(_) => PeriodicMotion::new(&mut dynamics, state.clone(), omega)?.kinetic_energy,
        None => dynamics.averaged_kinetic_energy(&point.coefficients, omega)?,
    };
    let mut shooting = Shooting::new(dynamics, ShootingScales { omega, energy })?;
    let guess = shooting.unknowns(state, omega);
    let motion = shooting.motion_near(&guess, 0.0)?;
    let floquet = Floquet::new(shooting.dynamics(), &motion)?;
    Ok(Exact { motion, largest_multiplier: floquet.largest(), stable: floquet.is_stable() })
}
