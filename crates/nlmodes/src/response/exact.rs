//! Structures and their loads in time, and multipliers of the exact motion next to a point in harmonics.

use std::sync::Arc;

use nlmodes_hbm::{ForceLaw, Load, ModalStructure, PeriodicMotion};
use nlmodes_linalg::Mat;
use nlmodes_timestep::{ForcedMotion, ForcedStructure, TimeLaw, TimestepError};
use num_complex::Complex64;

use crate::response::{ResponseError, ResponseModel, ResponseSettings, Stability};

/// What is left of a multiplier by the residual of the motion and by rounding, over the multiplier or one.
const LEFT: f64 = 1e-6;

/// Stability of the exact motion next to one in harmonics, by shooting from its state under the same load; `None`
/// where there is no such motion, or where the fundamental of its gaps without contact forces differs from that of
/// the point by more than `same`, relative to the largest one.
pub(crate) fn exact_stability(
    structure: &ModalStructure,
    load: &Load,
    point: &PeriodicMotion,
    same: f64,
) -> Option<Stability> {
    if load.terms().is_empty() {
        return None;
    }
    let of = forced(structure, load, point.at.omega).ok()?;
    let motion = of.periodic(point.at.level, point.at.omega, 1, &state(structure, point)).ok()?;
    let off = distance(structure, point, &motion);
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

/// A law of force in time.
#[derive(Debug)]
struct InTime(Arc<dyn ForceLaw>);

impl TimeLaw for InTime {
    fn at(&self, v: f64, rate: f64) -> [f64; 3] {
        let at = self.0.at(v, rate);
        [at.force, at.stiffness, at.damping]
    }

    fn stop_gap(&self) -> Option<f64> {
        self.0.stop_gap()
    }
}

/// Adds the laws of force of a structure behind its loads; `moved` is how far a unit of each input moves the place of a
/// law beyond the modes (m), `loads` the same of each harmonic of the periodic load.
///
/// # Errors
/// [`TimestepError`] for numbers that do not fit.
pub fn push_laws(
    structure: &ModalStructure,
    forced: &mut ForcedStructure,
    moved: &dyn Fn(usize) -> Vec<f64>,
    loads: &dyn Fn(usize) -> Vec<Complex64>,
) -> Result<(), TimestepError> {
    let (m, c) = (forced.n_modes(), forced.n_contacts());
    for (l, placed) in structure.laws().iter().enumerate() {
        let mut by_inputs = moved(l);
        by_inputs.extend(&placed.laws[..=l]);
        let law = Arc::new(InTime(placed.law.clone()));
        forced.push_law(law, &placed.modes[..m], &placed.contacts[..c], &by_inputs)?;
        forced.move_law(&loads(l))?;
    }
    Ok(())
}

impl ResponseModel {
    /// The structure under its load of level one at a frequency of it (rad/s), for exact integration; without terms
    /// where nothing drives it.
    ///
    /// # Errors
    /// [`ResponseError::Integration`] for a structure that cannot be integrated exactly.
    pub fn in_time(&self, omega: f64) -> Result<ForcedStructure, ResponseError> {
        let load = self.load_if_any(&ResponseSettings::new([0.0, f64::INFINITY]))?;
        Ok(forced(self.structure(), &load, omega)?)
    }

    /// The structure without load and without what dissipates, for exact integration.
    ///
    /// # Errors
    /// [`ResponseError::Integration`] for a structure that cannot be integrated exactly.
    pub fn conservative_in_time(&self) -> Result<ForcedStructure, ResponseError> {
        let structure = self.structure().conservative()?;
        let load = Load::new(&structure, Vec::new())?;
        Ok(forced(&structure, &load, 1.0)?)
    }
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
    // Behind the gaps of the contacts a load has those of the laws.
    let of_law = |l: usize| load.terms().iter().map(|term| term.gaps[c + l] * omega.powi(term.omega_power)).collect();
    push_laws(structure, &mut forced, &|_| Vec::new(), &of_law)?;
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

/// Distance of the fundamentals of the gap that moves most, over that of the point; of structures without contacts,
/// that of their modes.
fn distance(structure: &ModalStructure, point: &PeriodicMotion, motion: &ForcedMotion) -> f64 {
    let own = point.contacts.iter().take(structure.n_contacts());
    let fundamentals = own.map(|contact| contact.free_fundamental).enumerate();
    let Some((contact, own)) = fundamentals.max_by(|a, b| a.1.norm().total_cmp(&b.1.norm())) else {
        let own = point.eta.get(1).map(Vec::as_slice).unwrap_or_default();
        let off: f64 = own.iter().enumerate().map(|(k, z)| (motion.modal_harmonic(k, 1) - z).norm_sqr()).sum();
        return (off / own.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt();
    };
    (motion.free_gap_harmonic(contact, 1) - own).norm() / own.norm()
}
