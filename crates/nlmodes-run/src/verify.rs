//! One period of the full, unfiltered structure from a computed point.

mod error;
pub(crate) mod results;
mod text;

use std::f64::consts::TAU;

use nlmodes::branches::Watch;
use nlmodes::timestep::{
    ContactDynamics, Floquet, ModalState, PeriodicMotion, Shooting, ShootingScales, TimestepError, Verification,
};

pub use error::VerifyError;
pub use results::Point;

/// Maximum number of modes for the search for the exact motion next to the point.
const MOST_MODES: usize = 400;

/// Result for a point.
#[derive(Debug)]
pub struct Found {
    /// Modes of the full structure.
    pub modes: usize,
    /// What is missing after a period.
    pub verification: Verification,
    /// The exact motion of the same averaged kinetic energy next to it, unless the structure is too large or the point
    /// not even in time.
    pub exact: Option<Result<Exact, TimestepError>>,
}

/// The exact motion next to a point.
#[derive(Debug)]
pub struct Exact {
    /// Its start and frequency.
    pub motion: PeriodicMotion,
    /// Largest magnitude of a Floquet multiplier.
    pub largest_multiplier: f64,
    /// Whether none leaves the unit circle.
    pub stable: bool,
}

/// One period of the full, unfiltered structure from a point.
///
/// # Errors
/// [`TimestepError`] if it cannot be integrated.
pub fn verify(point: &Point) -> Result<Found, TimestepError> {
    verify_up_to(point, MOST_MODES, &Watch::default())
}

/// The same, searching for the exact motion with at most this many modes, as long as `watch` permits.
///
/// # Errors
/// [`TimestepError::Ended`] where it does not.
pub(crate) fn verify_up_to(point: &Point, most_modes: usize, watch: &Watch) -> Result<Found, TimestepError> {
    let asked = watch.clone();
    let mut dynamics = ContactDynamics::new(point.model.clone())?.asking(move || !asked.asks_to_end());
    let state = match &point.start {
        Some(displacement) => dynamics.state(displacement, &vec![0.0; displacement.len()])?,
        None => dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0)?,
    };
    let verification = Verification::new(&mut dynamics, &state, TAU / point.omega)?;
    let modes = dynamics.n_modes();
    let exact = (modes <= most_modes && point.is_even()).then(|| exact(dynamics, &state, point));
    if let Some(Err(TimestepError::Ended)) = exact {
        return Err(TimestepError::Ended);
    }
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
