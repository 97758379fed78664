use nlmodes_contact::solver_by_name;
use nlmodes_continuation::ParametricSystem;
use nlmodes_hbm::{HbmError, PeriodicMotion, PeriodicSystem};
use num_complex::Complex64;

use super::forced::scales;
use crate::response::follow::newton;
use crate::response::{ForcePower, ResponseError, ResponseModel, ResponsePoint, ResponseSettings, Stability, Weights};

/// Forces that bring a damped structure into a nonlinear mode, and what it does under them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Appropriation {
    /// Complex amplitudes of each drive point's force, harmonic by harmonic up to those controlled, N.
    pub forces: Vec<Vec<Complex64>>,
    /// The motion under them, at the frequency of the mode; `None` where no such motion was found next to the mode.
    pub motion: Option<PeriodicMotion>,
    /// Distance of the velocities to those of the mode in the norm of the kinetic energy, over the latter; NaN without
    /// a motion.
    pub distance: f64,
    /// Whether that motion, at these forces and this frequency, comes back after a disturbance, where that was asked
    /// for.
    pub stability: Option<Stability>,
    /// Powers of the forces in that motion.
    pub power: Option<ForcePower>,
}

/// The forces at `drives` that put into each of the harmonics up to `controlled` the power that the damping takes out
/// of it, and the motion that they cause.
///
/// ```text
/// f_n,j = iν (q_nᴴ C q_n) q_n,j / Σ_j |q_n,j|² ,   n = 1 … N_c        q_n of the mode, which is conservative or damped
/// ```
///
/// Of all forces with that power these are the smallest; each is in phase with the velocity of its point. With one
/// point and one harmonic that is the force of a phase-locked loop. A force `C q̇` everywhere would give the mode
/// exactly.
///
/// # Errors
/// [`ResponseError`] where the problem cannot be set up; a motion that is not found is none.
pub fn appropriation(
    model: &ResponseModel,
    mode: &ResponsePoint,
    drives: &[Weights],
    controlled: usize,
    settings: &ResponseSettings,
) -> Result<Appropriation, ResponseError> {
    let rows = model.rows(drives)?;
    let target = &mode.motion;
    let (omega, harmonics) = (target.at.omega, target.eta.len() - 1);
    let q: Vec<Vec<Complex64>> = rows.iter().map(|row| target.displacement(row)).collect();
    let mut forces = vec![vec![Complex64::default(); controlled.min(harmonics) + 1]; drives.len()];
    for n in 1..=controlled.min(harmonics) {
        let taken = model.structure().damping().form(&target.coordinates(n));
        let size: f64 = q.iter().map(|q| q[n].norm_sqr()).sum();
        let factor = Complex64::new(0.0, n as f64 * omega * taken / size);
        forces
            .iter_mut()
            .zip(&q)
            .for_each(|(f, q)| f[n] = if size > 0.0 { factor * q[n] } else { Complex64::default() });
    }
    let mut loaded = model.without_load();
    for (force, weights) in forces.iter().zip(drives) {
        for (n, f) in force.iter().enumerate().skip(1).filter(|(_, f)| f.norm() > 0.0) {
            loaded.push_force_at(weights, f.norm(), n, f.arg())?;
        }
    }
    let own = ResponseSettings { subharmonic: 1, ..settings.clone() };
    let solver = solver_by_name(&own.contact_solver).map_err(HbmError::Compliance)?;
    let (structure, load) = (loaded.structure(), loaded.load(&own)?);
    let (periodic, scales) = (own.periodic(), scales(structure, omega));
    let mut system = PeriodicSystem::force_response(structure, load, omega, 1.0, periodic, scales, solver.as_ref())?;
    let guess = mode.coefficients_for(&system);
    let found = newton(&mut system, &guess, 1.0).filter(|x| x.len() == system.dim());
    let motion = found.as_ref().map(|x| system.motion(x, 1.0)).transpose()?;
    let stability = match found.filter(|_| own.stability) {
        Some(x) => Some(system.floquet(&x, 1.0, solver.as_ref())?.stability()),
        None => None,
    };
    let distance = motion.as_ref().map_or(f64::NAN, |motion| distance(&motion.eta, &target.eta));
    let power = match &motion {
        Some(motion) => loaded.force_power(motion, 1)?,
        None => None,
    };
    Ok(Appropriation { forces, motion, distance, stability, power })
}

/// `√(Σ ν²|η_n − η⁰_n|² / Σ ν²|η⁰_n|²)`.
fn distance(eta: &[Vec<Complex64>], target: &[Vec<Complex64>]) -> f64 {
    let zero = Complex64::default();
    let (mut off, mut all) = (0.0, 0.0);
    for n in 0..eta.len().max(target.len()) {
        let weight = (n * n) as f64;
        for k in 0..eta[0].len() {
            let at = |of: &[Vec<Complex64>]| of.get(n).map_or(zero, |eta| eta[k]);
            off += weight * (at(eta) - at(target)).norm_sqr();
            all += weight * at(target).norm_sqr();
        }
    }
    (off / all).sqrt()
}
