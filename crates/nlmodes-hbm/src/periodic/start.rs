use std::f64::consts::TAU;

use nlmodes_linalg::max_norm;

use super::structure::ModalStructure;
use super::system::PeriodicSystem;
use crate::closed_set::ClosedSet;
use crate::{HbmError, Scales};

/// A linear mode at the amplitude at which it just touches, or at which a stop that presses is about to be left: where
/// its nonlinear modes begin.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalGrazing {
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Angular eigenfrequency, rad/s.
    pub omega: f64,
    /// Damping ratio; of the mode alone where damping couples modes.
    pub damping_ratio: f64,
    /// Modal amplitude, m √kg; its sign brings the contact to its stop at τ = 0.
    pub amplitude: f64,
    /// Averaged kinetic energy, J.
    pub energy: f64,
    /// The contact that grazes.
    pub contact: usize,
    /// Its amplitude, m: its gap; of a stop that is about to be left, the static motion of its contact by that energy.
    pub length: f64,
    /// Modal coordinates at rest, m, m √kg.
    pub(super) mean: Vec<f64>,
    /// Those of the mode, m, orthonormal.
    pub(super) shape: Vec<f64>,
}

/// A linear mode about a rest at which some stops are closed, in the coordinates of the open modes.
#[derive(Debug, Clone, Copy)]
pub struct ModeAtRest<'a> {
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Squared angular frequency, rad²/s².
    pub omega_squared: f64,
    /// The mode, m, orthonormal.
    pub shape: &'a [f64],
    /// Modal coordinates at rest, m, m √kg.
    pub rest: &'a [f64],
    /// The contacts that are closed there, c.
    pub closed: &'a [bool],
}

/// Motion of a guard by a mode, over the largest, below which the mode does not move it.
const UNFELT: f64 = 1e-9;

/// Guard of a contact at rest, over the largest, below which it touches without force.
const ROUNDING: f64 = 1e-10;

/// Squared open frequency, over that of the mode about rest, up to which it is that of a rigid-body motion.
const RIGID: f64 = 1e-9;

/// The amplitude of a mode about rest at which the first of its contacts is about to change its state: an open one is
/// touched, or one that presses is left.
///
/// # Errors
/// [`HbmError::NeverTouches`] if it moves no contact, [`HbmError::TouchesAtRest`] for one that it moves and that
/// touches without force, [`HbmError::Compliance`].
pub fn modal_lift_off(structure: &ModalStructure, at: ModeAtRest<'_>) -> Result<ModalGrazing, HbmError> {
    let (c, m, omega) = (structure.n_contacts(), structure.n_moving(), at.omega_squared.max(0.0).sqrt());
    let set = ClosedSet::new(structure.compliance(), at.closed)?;
    let seen = |i: usize, eta: &[f64]| (0..m).map(|k| structure.rows()[(i, k)] * eta[k]).sum::<f64>();
    let resting: Vec<f64> = (0..c).map(|i| structure.gaps()[i] + seen(i, at.rest)).collect();
    let moving: Vec<f64> = (0..c).map(|i| seen(i, at.shape)).collect();
    let guards: Vec<f64> = (0..c).map(|i| set.guard_value(i, &resting)).collect();
    let slopes: Vec<f64> = (0..c).map(|i| set.guard_value(i, &moving)).collect();
    let (largest, most) = (max_norm(guards.iter().copied()), max_norm(slopes.iter().copied()));
    let felt = (0..c).filter(|&i| slopes[i].abs() > UNFELT * most);
    let first = felt.map(|i| (i, -guards[i] / slopes[i])).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    // Open contacts have the gaps that they were given, those of a pressed rest come from its forces.
    let is_pressed = at.closed.contains(&true);
    let frequency_hz = omega / TAU;
    let never = HbmError::NeverTouches { mode: at.mode, frequency_hz, ratio: 0.0, is_pressed, first: None };
    let (contact, amplitude) = first.ok_or(never)?;
    if guards[contact] <= if is_pressed { ROUNDING * largest } else { 0.0 } {
        return Err(HbmError::TouchesAtRest { contact, gap: structure.gaps()[contact] });
    }
    let damping = |j: usize, k: usize| at.shape[j] * structure.damping().entry(j, k) * at.shape[k];
    let damping: f64 = (0..m).flat_map(|j| (0..m).map(move |k| (j, k))).map(|(j, k)| damping(j, k)).sum();
    let energy = 0.25 * at.omega_squared * amplitude * amplitude;
    // The rigid-body motions of a structure that floats have no stiffness but that of its closed contacts.
    let elastic = (0..m).filter(|&k| structure.omega_squared()[k] > RIGID * at.omega_squared);
    let modal = elastic.map(|k| structure.rows()[(contact, k)].powi(2) / structure.omega_squared()[k]).sum::<f64>();
    let compliance = structure.compliance().a()[(contact, contact)] + modal;
    // A stop that presses hardly moves before it is left: what this energy does to the structure is a length.
    let length = if at.closed[contact] { 2.0 * (energy * compliance).sqrt() } else { guards[contact] };
    let padded = |eta: &[f64]| eta.iter().copied().chain(std::iter::repeat(0.0)).take(structure.n_modes()).collect();
    Ok(ModalGrazing {
        mode: at.mode,
        omega,
        damping_ratio: damping / (2.0 * omega),
        amplitude,
        energy,
        contact,
        length,
        mean: padded(at.rest),
        shape: padded(at.shape),
    })
}

/// The grazing point of open mode `mode` (from 1).
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`], [`HbmError::TouchesAtRest`] or
/// [`HbmError::PressedAtRest`].
pub fn modal_grazing(structure: &ModalStructure, mode: usize) -> Result<ModalGrazing, HbmError> {
    let m = structure.n_moving();
    if mode == 0 || mode > m {
        return Err(HbmError::NoSuchMode { mode, available: m });
    }
    if structure.is_pressed() {
        let contact = structure.gaps().iter().position(|g| *g < 0.0).unwrap_or(0);
        return Err(HbmError::PressedAtRest { contact, gap: structure.gaps()[contact] });
    }
    let k = mode - 1;
    let largest = max_norm(structure.omega_squared()[..m].iter().copied());
    let square = structure.omega_squared()[k];
    if square <= 1e-12 * largest {
        let first_elastic = structure.omega_squared().iter().position(|w| *w > 1e-12 * largest).map(|k| k + 1);
        return Err(HbmError::RigidBodyMode { mode, first_elastic });
    }
    let shape: Vec<f64> = (0..m).map(|j| f64::from(u8::from(j == k))).collect();
    let (rest, closed) = (vec![0.0; m], vec![false; structure.n_contacts()]);
    modal_lift_off(structure, ModeAtRest { mode, omega_squared: square, shape: &shape, rest: &rest, closed: &closed })
}

impl ModalGrazing {
    /// Scales with which the problem has numbers near one.
    pub fn scales(&self) -> Scales {
        Scales { length: self.length, omega: self.omega, energy: self.energy }
    }

    /// Unknowns of a conservative or damped mode at grazing, where the parameter is zero. They are exact where damping
    /// couples no modes, else a guess.
    pub fn unknowns(&self, system: &PeriodicSystem) -> Vec<f64> {
        let mut x = system.coefficients_at_rest(&self.mean);
        x.iter_mut().zip(self.cosines(system)).for_each(|(x, cosine)| *x += cosine);
        let scales = system.scales;
        let extra = system.closing.n_unknowns();
        x.push(self.omega / scales.omega);
        if extra > 1 {
            let damped = !system.structure.damping().is_none();
            x.push(if damped { 2.0 * self.damping_ratio * self.omega / scales.omega } else { 0.0 });
        }
        x
    }

    /// Direction of growing amplitude for the unknowns and the parameter.
    pub fn direction(&self, system: &PeriodicSystem) -> Vec<f64> {
        let mut t = self.cosines(system);
        t.resize(t.len() + system.closing.n_unknowns(), 0.0);
        t.push(2.0);
        t
    }

    fn cosines(&self, system: &PeriodicSystem) -> Vec<f64> {
        let (unit, width) = (system.unit(), system.series().width());
        let mut x = vec![0.0; system.n_coefficients()];
        for (k, part) in self.shape.iter().enumerate().filter(|(_, part)| **part != 0.0) {
            let shares = system.response.of_mode(k).into_iter().enumerate();
            shares.for_each(|(j, share)| x[j * width + 1] += share * part * self.amplitude / unit);
        }
        x
    }
}
