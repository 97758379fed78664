use std::f64::consts::TAU;

use nlmodes_contact::LcpMatrix;
use nlmodes_linalg::{Mat, max_norm};
use nlmodes_model::reduction::RestState;

use super::structure::ModalStructure;
use super::system::PeriodicSystem;
use crate::closed_set::ClosedSet;
use crate::{CondensedStructure, HbmError, Scales};

/// A linear mode at the amplitude at which it just touches, or at which a stop that presses is about to be left: where
/// its nonlinear modes begin.
#[derive(Debug, Clone, PartialEq)]
pub struct Grazing {
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
    /// What a length near one means for the contacts, m: the largest amplitude of one; of a stop that is about to be
    /// left, at least the static motion of its contact by that energy.
    pub length: f64,
    /// By how much contacts that touch at rest are set back, m, c: a little beyond what the mode moves them. Zero for
    /// all others.
    pub opening: Vec<f64>,
    /// The contact presses at rest, and is about to be left.
    pub lifts_off: bool,
    /// Modal coordinates at rest, m, m √kg.
    pub(crate) mean: Vec<f64>,
    /// Forces of the contacts at rest, N.
    pub(crate) forces: Vec<f64>,
    /// Modal coordinates of the mode, m, orthonormal.
    pub(crate) shape: Vec<f64>,
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
    /// The structure at rest.
    pub rest: &'a RestState,
}

/// Motion of a guard by a mode, over the largest of any open mode, below which the mode does not move it.
const UNFELT: f64 = 1e-9;

/// Guard of a contact at rest, over the largest, below which it touches without force.
const ROUNDING: f64 = 1e-10;

/// Squared open frequency, over that of the mode about rest, up to which it is that of a rigid-body motion.
const RIGID: f64 = 1e-9;

/// Squared open frequency, over the largest, up to which it is rounding.
pub(crate) const STRAINLESS: f64 = 64.0 * f64::EPSILON;

/// Of contacts that touch at rest, their distance over the amplitude of the mode before which they are set back:
/// nothing touches there, also by rounding.
const CLEAR: f64 = 1.1;

/// A mode about rest as the contacts feel it.
struct Felt {
    /// Guard of each contact at rest, and by the mode of unit amplitude.
    guards: Vec<f64>,
    slopes: Vec<f64>,
    /// Contacts that the mode moves.
    moving: Vec<usize>,
    /// Those of them that touch at rest without force.
    touching: Vec<usize>,
    /// Force of each contact by the mode of unit amplitude.
    forces: Vec<f64>,
}

impl Felt {
    fn of(structure: &ModalStructure, at: ModeAtRest<'_>) -> Result<Self, HbmError> {
        let (c, m) = (structure.n_contacts(), structure.n_moving());
        let compliance = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| structure.static_compliance(i, j)));
        let set = ClosedSet::new(&compliance.map_err(HbmError::Compliance)?, &at.rest.closed)?;
        let seen = |i: usize, eta: &[f64]| (0..m).map(|k| structure.rows()[(i, k)] * eta[k]).sum::<f64>();
        let resting: Vec<f64> = (0..c).map(|i| structure.gaps()[i] + seen(i, &at.rest.eta)).collect();
        let moved: Vec<f64> = (0..c).map(|i| seen(i, at.shape)).collect();
        let guards: Vec<f64> = (0..c).map(|i| set.guard_value(i, &resting)).collect();
        let slopes: Vec<f64> = (0..c).map(|i| set.guard_value(i, &moved)).collect();
        let largest = max_norm(guards.iter().copied());
        // Beside what any mode of that size does to the contacts.
        let most = max_norm((0..c).flat_map(|i| (0..m).map(move |k| (i, k))).map(|at| structure.rows()[at]));
        let moving: Vec<usize> = (0..c).filter(|&i| slopes[i].abs() > UNFELT * most).collect();
        // Open contacts have the gaps that they were given, those of a pressed rest come from its forces.
        let least = if at.rest.closed.contains(&true) { ROUNDING * largest } else { 0.0 };
        let touching = moving.iter().copied().filter(|&i| guards[i] <= least).collect();
        let forces = (0..c).map(|i| set.force(i, &moved)).collect();
        Ok(Self { guards, slopes, moving, touching, forces })
    }

    /// The contact, none that touches at rest, that is the first to change its state as the mode grows, and the
    /// amplitude that takes it there.
    fn first_change(&self) -> Option<(usize, f64)> {
        let amplitude = |i: usize| -self.guards[i] / self.slopes[i];
        let others = self.moving.iter().copied().filter(|i| !self.touching.contains(i));
        others.map(|i| (i, amplitude(i))).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}

/// The amplitude of a mode about rest at which the first of its contacts is about to change its state: an open one is
/// touched, or one that presses is left. Contacts that touch at rest without force are set back by
/// [`Grazing::opening`].
///
/// The motion has half the amplitude at which another contact would change its state, and where there is no such
/// contact the averaged kinetic energy `energy`, J: before contacts that all touch at rest, motions can be multiplied
/// by any positive number. [`PeriodicSystem::beside_opening`] leads from there to the motion before the contacts where
/// they are.
///
/// # Errors
/// [`HbmError::NeverTouches`] if it moves no contact, [`HbmError::Compliance`].
pub fn modal_lift_off_opened(structure: &ModalStructure, at: ModeAtRest<'_>, energy: f64) -> Result<Grazing, HbmError> {
    let omega = at.omega_squared.max(0.0).sqrt();
    let felt = Felt::of(structure, at)?;
    let mut opening = vec![0.0; structure.n_contacts()];
    let (is_pressed, frequency_hz) = (at.rest.closed.contains(&true), omega / TAU);
    let never = HbmError::NeverTouches { mode: at.mode, frequency_hz, ratio: 0.0, is_pressed, first: None };
    let (contact, amplitude) = match felt.touching.first() {
        None => felt.first_change().ok_or(never)?,
        Some(&contact) => {
            let size = felt.first_change().map_or(2.0 * energy.sqrt() / omega, |(_, a)| 0.5 * a.abs());
            felt.touching.iter().for_each(|&i| opening[i] = CLEAR * size * felt.slopes[i].abs());
            (contact, -size * felt.slopes[contact].signum())
        }
    };
    let (energy, damping) = (0.25 * at.omega_squared * amplitude * amplitude, modal_damping(structure, at.shape));
    // A stop that presses hardly moves before it is left: what this energy does to the structure is a length too.
    let moved = |i: usize| (0..at.shape.len()).map(|k| structure.rows()[(i, k)] * at.shape[k]).sum::<f64>();
    let largest = amplitude.abs() * max_norm((0..structure.n_contacts()).map(moved));
    let length = match at.rest.closed[contact] {
        true => largest.max(2.0 * (energy * compliance_at(structure, contact, at.omega_squared)).sqrt()),
        false => largest,
    };
    // Stops that dissipate yield by what their springs carry.
    let with_stops = |eta: &[f64], forces: &[f64]| {
        let yielded = structure.damped().iter().zip(&structure.omega_squared()[eta.len()..]);
        eta.iter().copied().chain(yielded.map(|(&contact, stiffness)| forces[contact] / stiffness)).collect()
    };
    Ok(Grazing {
        mode: at.mode,
        omega,
        damping_ratio: damping / (2.0 * omega),
        amplitude,
        energy,
        contact,
        length,
        opening,
        lifts_off: at.rest.closed[contact],
        mean: with_stops(&at.rest.eta, &at.rest.forces),
        forces: at.rest.forces.clone(),
        shape: with_stops(at.shape, &felt.forces),
    })
}

/// `φᵀ Ĉ φ` of a mode in the coordinates of the open modes, 1/s.
fn modal_damping(structure: &ModalStructure, shape: &[f64]) -> f64 {
    let m = structure.n_moving();
    let damping = |j: usize, k: usize| shape[j] * structure.damping().entry(j, k) * shape[k];
    (0..m).flat_map(|j| (0..m).map(move |k| (j, k))).map(|(j, k)| damping(j, k)).sum()
}

/// Static compliance of the structure at a contact, m/N, without the rigid-body motions of one that floats, which have
/// no stiffness but that of its closed contacts.
fn compliance_at(structure: &ModalStructure, contact: usize, omega_squared: f64) -> f64 {
    let elastic = (0..structure.n_moving()).filter(|&k| structure.omega_squared()[k] > RIGID * omega_squared);
    let modal = elastic.map(|k| structure.rows()[(contact, k)].powi(2) / structure.omega_squared()[k]).sum::<f64>();
    structure.static_compliance(contact, contact) + modal
}

pub(crate) fn unless_touching(structure: &ModalStructure, start: Grazing) -> Result<Grazing, HbmError> {
    match start.opening.iter().position(|by| *by > 0.0) {
        Some(contact) => Err(HbmError::TouchesAtRest { contact, gap: structure.gaps()[contact] }),
        None => Ok(start),
    }
}

/// The grazing point of open mode `mode` (from 1).
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`], [`HbmError::TouchesAtRest`] or
/// [`HbmError::PressedAtRest`].
pub fn modal_grazing(structure: &ModalStructure, mode: usize) -> Result<Grazing, HbmError> {
    unless_touching(structure, modal_grazing_opened(structure, mode, 1.0)?)
}

/// As [`modal_grazing`], also where contacts touch at rest, as [`modal_lift_off_opened`].
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`] or [`HbmError::PressedAtRest`].
pub fn modal_grazing_opened(structure: &ModalStructure, mode: usize, energy: f64) -> Result<Grazing, HbmError> {
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
    if square <= STRAINLESS * largest {
        let first_elastic = structure.omega_squared().iter().position(|w| *w > STRAINLESS * largest).map(|k| k + 1);
        return Err(HbmError::RigidBodyMode { mode, first_elastic });
    }
    let shape: Vec<f64> = (0..m).map(|j| f64::from(u8::from(j == k))).collect();
    let at = ModeAtRest { mode, omega_squared: square, shape: &shape, rest: &RestState::still(m, structure.gaps()) };
    modal_lift_off_opened(structure, at, energy)
}

impl Grazing {
    /// Scales with which the problem has numbers near one.
    pub fn scales(&self) -> Scales {
        Scales { length: self.length, omega: self.omega, energy: self.energy }
    }

    /// What the energies of the branch are counted in, as a word: `grazing`, or `lift-off` of a stop that presses.
    pub fn word(&self) -> &'static str {
        if self.lifts_off { "lift-off" } else { "grazing" }
    }

    /// The same start with the angular frequency (rad/s) and the energy (J) that another method has for it.
    pub fn counted_by(self, omega: f64, energy: f64) -> Self {
        Self { omega, energy, ..self }
    }

    /// Displacements `b` of the contact coordinates in the linear mode, in phase with it, n_N, m.
    pub fn contact_amplitudes(&self, structure: &CondensedStructure) -> Vec<f64> {
        structure.contact_positions(&self.shape).into_iter().map(|b| self.amplitude * b).collect()
    }

    /// Displacements `b` of the contact coordinates at rest, n_N, m.
    pub fn contacts_at_rest(&self, structure: &CondensedStructure) -> Vec<f64> {
        structure.contact_positions(&self.mean)
    }

    /// Whether contacts touch at rest without force: the nonlinear mode then is nowhere linear, and this is the motion
    /// before contacts that are set back.
    pub fn touches_at_rest(&self) -> bool {
        self.opening.iter().any(|by| *by > 0.0)
    }

    /// The coefficients of the structure at rest about which the mode vibrates.
    pub fn coefficients_at_rest(&self, system: &PeriodicSystem) -> Vec<f64> {
        system.coefficients_at_rest(&self.mean, &self.forces)
    }

    /// Unknowns of a conservative or damped mode at grazing, where the parameter is zero. They are exact where damping
    /// couples no modes, else a guess.
    pub fn unknowns(&self, system: &PeriodicSystem) -> Vec<f64> {
        let mut x = self.coefficients_at_rest(system);
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
