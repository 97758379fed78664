//! Multipliers of the exact motion next to a point in harmonics.

use nlmodes_hbm::{Load, ModalStructure, PeriodicMotion};
use nlmodes_linalg::Mat;
use nlmodes_timestep::{ForcedMotion, ForcedStructure, TimestepError};
use num_complex::Complex64;

use crate::response::Stability;

/// What is left of a multiplier by the residual of the motion and by rounding, over the multiplier or one.
const LEFT: f64 = 1e-6;

/// Stability of the exact motion next to one in harmonics, by shooting from its state under the same load; `None`
/// where there is no such motion, or where the fundamental of its gaps without contact forces differs from that of
/// the point by more than `same`, relative to the largest one, or where the structure has laws, which are not
/// integrated exactly.
pub(crate) fn exact_stability(
    structure: &ModalStructure,
    load: &Load,
    point: &PeriodicMotion,
    same: f64,
) -> Option<Stability> {
    if load.terms().is_empty() || !structure.laws().is_empty() {
        return None;
    }
    let of = forced(structure, load, point.at.omega).ok()?;
    let motion = of.periodic(point.at.level, point.at.omega, 1, &state(structure, point)).ok()?;
    let off = distance(point, &motion);
    if off.is_nan() || off > same {
        return None;
    }
    let largest = motion.multipliers.first()?;
    Some(Stability::damped([largest.re, largest.im], LEFT * largest.norm().max(1.0)))
}

/// A structure for exact integration: modes, residual flexibility, stops and steady force; without laws and loads.
///
/// # Errors
/// [`TimestepError`] for a structure that cannot be integrated exactly.
pub fn exact_structure(structure: &ModalStructure) -> Result<ForcedStructure, TimestepError> {
    let (m, c) = (structure.n_moving(), structure.n_contacts());
    let damping = Mat::from_fn(m, m, |i, j| structure.damping().entry(i, j));
    let rows = Mat::from_fn(c, m, |i, k| structure.rows()[(i, k)]);
    let squares = &structure.omega_squared()[..m];
    let mut forced = ForcedStructure::new(squares, &damping, &rows, structure.compliance().a(), structure.gaps())?;
    for k in m..structure.n_modes() {
        let behind = |contact: &usize| structure.damped_stop(*contact) == Some(k);
        let Some(contact) = (0..c).find(behind) else { continue };
        forced.push_damped_stop(contact, structure.omega_squared()[k], structure.damping().entry(k, k))?;
    }
    if !structure.steady_force().is_empty() {
        forced.set_steady_force(&structure.steady_force()[..m])?;
    }
    Ok(forced)
}

/// The structure under its load at a base frequency, rad/s.
fn forced(structure: &ModalStructure, load: &Load, omega: f64) -> Result<ForcedStructure, TimestepError> {
    let (m, c) = (structure.n_moving(), structure.n_contacts());
    let mut forced = exact_structure(structure)?;
    for term in load.terms() {
        let by = omega.powi(term.omega_power);
        let scaled = |of: &[Complex64]| of.iter().map(|v| v * by).collect::<Vec<_>>();
        forced.push_load(term.harmonic, &scaled(&term.modal[..m]), &scaled(&term.gaps[..c]))?;
    }
    Ok(forced)
}

/// The state of a motion at the beginning of its period: modal coordinates, their rates, stops that dissipate.
fn state(structure: &ModalStructure, point: &PeriodicMotion) -> Vec<f64> {
    let at = |of: &[Vec<Complex64>], k: usize, order: i32| -> f64 {
        let harmonic =
            |(n, z): (usize, &Vec<Complex64>)| (Complex64::new(0.0, n as f64 * point.at.omega).powi(order) * z[k]).re;
        of.iter().enumerate().map(harmonic).sum()
    };
    let (m, stops) = (structure.n_moving(), structure.n_modes() - structure.n_moving());
    let modes = (0..2).flat_map(|order| (0..m).map(move |k| (k, order)));
    let modes = modes.map(|(k, order)| at(&point.eta, k, order));
    modes.chain((0..stops).map(|j| at(&point.stops, j, 0))).collect()
}

/// Distance of the fundamentals of the gap that moves most, over that of the point.
fn distance(point: &PeriodicMotion, motion: &ForcedMotion) -> f64 {
    let fundamentals = point.contacts.iter().map(|contact| contact.free_fundamental).enumerate();
    let Some((contact, own)) = fundamentals.max_by(|a, b| a.1.norm().total_cmp(&b.1.norm())) else { return 0.0 };
    (motion.free_gap_harmonic(contact, 1) - own).norm() / own.norm()
}
