mod rest;

use std::f64::consts::TAU;

use nlmodes_linalg::{
    DenseLu, Mat, SparseMatrix, Triplet, max_norm, select, sparse_from_triplets, symmetric_eigen, triplets,
};
use nlmodes_model::{ContactLaw, DofKind, LinearModes, linear_modes, open_modes};

use self::rest::Rest;
use crate::closed_set::ClosedSet;
use crate::energy::inner;
use crate::series::RealSeries;
use crate::{CondensedStructure, HbmError, Scales};

/// Motion of a contact, over the largest motion, below which a mode does not move it.
const NO_MOTION: f64 = 1e-9;

/// Squared angular frequency, over that of the lowest held mode, below which a mode is a rigid-body motion.
const RIGID: f64 = 1e-12;

/// Modes behind one that moves no contact among which the next one that does is sought.
const LOOKED_AT: usize = 10;

/// Most rigid-body motions of a straight structure in its plane.
const RIGID_MOTIONS: usize = 3;

/// A linear mode at the amplitude at which the state of a contact is about to change: where the nonlinear mode begins.
///
/// With open contacts that is the amplitude of first touch; a contact that is pressed at rest counts as held, and its
/// force is about to vanish once a period.
#[derive(Debug, Clone, PartialEq)]
pub struct Grazing {
    /// Number of the linear mode, from 1.
    pub mode: usize,
    /// Angular eigenfrequency `ω_0,r`, rad/s.
    pub omega: f64,
    /// Averaged kinetic energy at grazing, J.
    pub energy: f64,
    /// The contact that grazes.
    pub contact: usize,
    /// Static `b`, m, n_N.
    pub mean: Vec<f64>,
    /// Amplitude of `b` in phase with the mode, m, n_N; the contact grazes at τ = 0.
    pub fundamental: Vec<f64>,
    /// What a length near one means for the contacts, m.
    pub length: f64,
    /// By how much contacts that touch at rest stand back, m, c: so far that the mode just touches them. Zero for all
    /// others, and from [`grazing`].
    pub opening: Vec<f64>,
    /// The contact presses at rest, and is about to be left.
    pub lifts_off: bool,
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

    /// Largest amplitude of `b`, m.
    pub fn amplitude(&self) -> f64 {
        max_norm(self.fundamental.iter().copied())
    }

    /// Whether contacts touch at rest: the nonlinear mode then is nowhere linear, and
    /// [`ShrinkingGaps`](crate::ShrinkingGaps) leads to it from here.
    pub fn touches_at_rest(&self) -> bool {
        self.opening.iter().any(|o| *o > 0.0)
    }

    /// Scaled unknowns of [`crate::MixedShooting`] at grazing, where `p = 0`.
    pub fn unknowns(&self, series: RealSeries, dim: usize) -> Vec<f64> {
        let (width, scale) = (series.width(), 1.0 / self.scales().length);
        let mut x = vec![0.0; dim];
        for d in 0..self.mean.len() {
            x[d * width] = self.mean[d] * scale;
            x[d * width + 1] = self.fundamental[d] * scale;
        }
        x[self.mean.len() * width] = 1.0;
        x
    }

    /// Direction of growing amplitude at grazing, for the unknowns and the parameter.
    pub fn direction(&self, series: RealSeries, dim: usize) -> Vec<f64> {
        let (width, scale) = (series.width(), 1.0 / self.scales().length);
        let mut t = vec![0.0; dim + 1];
        for d in 0..self.mean.len() {
            t[d * width + 1] = self.fundamental[d] * scale;
        }
        t[dim] = 2.0;
        t
    }
}

/// The grazing point of linear mode `mode` (from 1).
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::NeverTouches`] or [`HbmError::TouchesAtRest`].
pub fn grazing(structure: &CondensedStructure, mode: usize) -> Result<Grazing, HbmError> {
    let start = LinearStart::of(structure, mode)?;
    match start.touching.first() {
        Some(&contact) => Err(HbmError::TouchesAtRest { contact, gap: structure.body.gaps()[contact] }),
        None => {
            let (contact, amplitude) = start.first_change().ok_or_else(|| start.never_touches(structure))?;
            Ok(start.at(contact, amplitude, vec![0.0; structure.n_contacts()]))
        }
    }
}

/// As [`grazing`], also where contacts touch at rest without force: these stand back by [`Grazing::opening`].
///
/// The motion has half the amplitude at which another contact would change its state, and where there is no such
/// contact the averaged kinetic energy `energy`, J: before contacts that all touch at rest, motions can be multiplied
/// by any positive number.
///
/// # Errors
/// [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`] or [`HbmError::NeverTouches`].
pub fn grazing_opened(structure: &CondensedStructure, mode: usize, energy: f64) -> Result<Grazing, HbmError> {
    let start = LinearStart::of(structure, mode)?;
    let Some(&contact) = start.touching.first() else { return grazing(structure, mode) };
    let amplitude = start.first_change().map_or(2.0 * energy.sqrt() / start.omega, |(_, a)| 0.5 * a.abs());
    let mut opening = vec![0.0; structure.n_contacts()];
    start.touching.iter().for_each(|&i| opening[i] = amplitude * start.slopes[i].abs());
    let toward = -amplitude * start.slopes[contact].signum();
    Ok(start.at(contact, toward, opening))
}

impl CondensedStructure {
    /// Energy at rest of a structure that a steady force presses onto its contacts, J, in which the total energy of its
    /// motions is counted; zero of others.
    ///
    /// # Errors
    /// [`HbmError`] where it does not rest.
    pub fn energy_at_rest(&self) -> Result<f64, HbmError> {
        if self.model.steady_force().is_none() { Ok(0.0) } else { Ok(Rest::of(self)?.energy) }
    }
}

/// A linear mode about rest, before its amplitude is chosen.
struct LinearStart {
    mode: usize,
    omega: f64,
    rest: Rest,
    /// `b` of the mass-normalised mode.
    unit: Vec<f64>,
    /// Guard of each contact at rest, and by the mass-normalised mode.
    guards: Vec<f64>,
    slopes: Vec<f64>,
    /// Contacts that the mode moves.
    moving: Vec<usize>,
    /// Those of them that touch at rest without force.
    touching: Vec<usize>,
    /// Largest motion at a contact over the largest motion.
    ratio: f64,
}

impl LinearStart {
    fn of(structure: &CondensedStructure, mode: usize) -> Result<Self, HbmError> {
        let rest = Rest::of(structure)?;
        let modes = separated(structure, &rest, mode)?;
        if mode == 0 || mode > modes.omega.len() {
            return Err(HbmError::NoSuchMode { mode, available: modes.omega.len() });
        }
        let omega = modes.omega[mode - 1];
        if !vibrates(structure, omega) {
            let more = modes_at_rest(structure, &rest, mode + RIGID_MOTIONS)?;
            let first_elastic = more.omega.iter().position(|omega| vibrates(structure, *omega)).map(|k| k + 1);
            return Err(HbmError::RigidBodyMode { mode, first_elastic });
        }
        let set = ClosedSet::new(structure.body.matrix(), &rest.closed)?;
        let Felt { unit, slopes, largest } = Felt::of(structure, &set, &modes, mode);
        let y_rest = projected(structure, &rest.b);
        let y_rest: Vec<f64> = y_rest.iter().zip(structure.body.gaps()).map(|(y, g)| y + g).collect();
        let guards: Vec<f64> = (0..y_rest.len()).map(|i| set.guard_value(i, &y_rest)).collect();
        let ratio = max_norm(slopes.iter().copied()) / largest;
        let moving: Vec<usize> = (0..slopes.len()).filter(|&i| slopes[i].abs() > NO_MOTION * largest).collect();
        let touching = moving.iter().copied().filter(|&i| !rest.closed[i] && guards[i].abs() <= rest.noise).collect();
        let start = Self { mode, omega, rest, unit, guards, slopes, moving, touching, ratio };
        if ratio < NO_MOTION { Err(start.never_touches(structure)) } else { Ok(start) }
    }

    fn never_touches(&self, structure: &CondensedStructure) -> HbmError {
        let (mode, frequency_hz) = (self.mode, self.omega / TAU);
        if !has_mass_behind_contacts(structure) {
            return HbmError::NoMassBehindContacts { mode, frequency_hz };
        }
        let first = self.next_that_moves_contacts(structure).ok().flatten();
        let is_pressed = self.rest.closed.contains(&true);
        HbmError::NeverTouches { mode, frequency_hz, ratio: self.ratio, is_pressed, first }
    }

    /// The next mode that moves a contact, of those that are looked at, and its frequency, Hz.
    fn next_that_moves_contacts(&self, structure: &CondensedStructure) -> Result<Option<(usize, f64)>, HbmError> {
        let set = ClosedSet::new(structure.body.matrix(), &self.rest.closed)?;
        let modes = modes_at_rest(structure, &self.rest, self.mode + LOOKED_AT)?;
        let moves = |mode: &usize| {
            let felt = Felt::of(structure, &set, &modes, *mode);
            max_norm(felt.slopes.iter().copied()) >= NO_MOTION * felt.largest
        };
        let first = (self.mode + 1..=modes.omega.len()).find(moves);
        Ok(first.map(|mode| (mode, modes.omega[mode - 1] / TAU)))
    }

    /// The contact, none that touches at rest, whose guard reaches zero first as the mode grows, and the amplitude that
    /// takes it there at τ = 0.
    fn first_change(&self) -> Option<(usize, f64)> {
        let amplitude = |i: usize| -self.guards[i] / self.slopes[i];
        let others = self.moving.iter().copied().filter(|i| !self.touching.contains(i));
        others.map(|i| (i, amplitude(i))).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }

    fn at(self, contact: usize, amplitude: f64, opening: Vec<f64>) -> Grazing {
        let energy = 0.25 * self.omega * self.omega * amplitude * amplitude;
        let fundamental: Vec<f64> = self.unit.iter().map(|b| amplitude * b).collect();
        let largest = max_norm(fundamental.iter().copied());
        // A contact that presses hardly moves `b` before it opens: what it moves then is what this energy does to the
        // structure.
        let length = largest.max(2.0 * (energy * self.rest.compliance).sqrt());
        let lifts_off = self.rest.closed[contact];
        let (mode, omega, mean) = (self.mode, self.omega, self.rest.b);
        Grazing { mode, omega, energy, contact, mean, fundamental, length, opening, lifts_off }
    }
}

/// What the contacts feel of a linear mode.
struct Felt {
    /// `b` of the mass-normalised mode.
    unit: Vec<f64>,
    /// Guard of each contact by it.
    slopes: Vec<f64>,
    /// Its largest displacement.
    largest: f64,
}

impl Felt {
    fn of(structure: &CondensedStructure, set: &ClosedSet, modes: &LinearModes, mode: usize) -> Self {
        let shape: Vec<f64> = modes.shapes.col(mode - 1).iter().copied().collect();
        let unit = free_position(structure, &shape);
        let y = projected(structure, &unit);
        let slopes = (0..y.len()).map(|i| set.guard_value(i, &y)).collect();
        let displaced = structure.model.dofs().iter().zip(&shape).filter(|(dof, _)| dof.kind != DofKind::Rotation);
        let largest = max_norm(displaced.map(|(_, v)| *v));
        Self { unit, slopes, largest }
    }
}

/// `Wᵀ b`.
fn projected(structure: &CondensedStructure, b: &[f64]) -> Vec<f64> {
    let w = structure.model.w();
    (0..w.ncols()).map(|i| (0..w.nrows()).map(|d| w[(d, i)] * b[d]).sum()).collect()
}

/// Relative difference below which two frequencies count as one.
const REPEATED: f64 = 1e-9;

/// The modes at rest up to `mode`. Of those with its frequency (equal bodies), which are any combinations of each
/// other, the ones that move the contacts most come first: others are no limits of nonlinear modes.
fn separated(structure: &CondensedStructure, rest: &Rest, mode: usize) -> Result<LinearModes, HbmError> {
    let mut wanted = mode + 1;
    let mut modes = modes_at_rest(structure, rest, wanted)?;
    let Some(omega) = mode.checked_sub(1).and_then(|k| modes.omega.get(k)).copied() else { return Ok(modes) };
    let is_same = |other: &f64| (other - omega).abs() <= REPEATED * omega;
    while modes.omega.len() == wanted && modes.omega.last().is_some_and(is_same) {
        wanted *= 2;
        modes = modes_at_rest(structure, rest, wanted)?;
    }
    let same: Vec<usize> = (0..modes.omega.len()).filter(|&k| is_same(&modes.omega[k])).collect();
    if same.len() < 2 || !vibrates(structure, omega) {
        return Ok(modes);
    }
    let w = structure.model.w();
    let moved = |k: usize| {
        let shape: Vec<f64> = modes.shapes.col(k).iter().copied().collect();
        let b = free_position(structure, &shape);
        (0..w.ncols()).map(|i| (0..w.nrows()).map(|d| w[(d, i)] * b[d]).sum()).collect::<Vec<f64>>()
    };
    let rows: Vec<Vec<f64>> = same.iter().map(|&k| moved(k)).collect();
    let strength = Mat::from_fn(same.len(), same.len(), |i, j| inner(&rows[i], &rows[j]));
    let failed = |source| HbmError::Linalg { what: "modes with the same frequency", source };
    let (_, turn) = symmetric_eigen(&strength).map_err(failed)?;
    let shapes = modes.shapes.clone();
    for (place, &k) in same.iter().enumerate() {
        let column = same.len() - 1 - place;
        for i in 0..shapes.nrows() {
            modes.shapes[(i, k)] =
                same.iter().enumerate().map(|(j, &other)| turn[(j, column)] * shapes[(i, other)]).sum();
        }
    }
    Ok(modes)
}

/// Whether a mode has a frequency beside that of the lowest held mode.
fn vibrates(structure: &CondensedStructure, omega: f64) -> bool {
    omega.is_finite() && omega * omega > RIGID * structure.held.modes.first().map_or(0.0, |m| m.lambda)
}

/// Whether any degree of freedom that moves together with that of a contact has mass.
fn has_mass_behind_contacts(structure: &CondensedStructure) -> bool {
    let (model, mass) = (&structure.model, structure.model.mass());
    let together = |kind: DofKind, of: DofKind| {
        kind == of || (of == DofKind::Deflection && kind == DofKind::Rotation) || kind == DofKind::Modal
    };
    let moves = |dof: DofKind| model.contacts().iter().any(|c| together(dof, model.dofs()[c.dof].kind));
    (0..model.dofs().len()).any(|i| moves(model.dofs()[i].kind) && mass.get(i, i).is_some_and(|m| *m > 0.0))
}

/// Linear modes with the contacts that are closed at rest held, rigidly or by their springs; shapes over all degrees of
/// freedom.
fn modes_at_rest(structure: &CondensedStructure, rest: &Rest, mode: usize) -> Result<LinearModes, HbmError> {
    let model = &structure.model;
    let (mut held, mut springs) = (Vec::new(), Vec::new());
    for (contact, _) in model.contacts().iter().zip(&rest.closed).filter(|(_, closed)| **closed) {
        match contact.law {
            ContactLaw::Rigid => held.push(contact.dof),
            ContactLaw::Elastic { stiffness } => springs.push((contact.dof, contact.dof, stiffness)),
        }
    }
    if held.is_empty() && springs.is_empty() {
        return Ok(open_modes(model, mode)?);
    }
    let stiffness = with_springs(model.stiffness(), &springs)?;
    if held.is_empty() {
        return Ok(linear_modes(model.mass(), &stiffness, mode)?);
    }
    let free: Vec<usize> = (0..model.dofs().len()).filter(|i| !held.contains(i)).collect();
    let part = |m| {
        select(m, &free, &free)
            .map_err(|source| HbmError::Linalg { what: "structure with pressed contacts held", source })
    };
    let modes = linear_modes(&part(model.mass())?, &part(&stiffness)?, mode)?;
    let mut shapes = Mat::zeros(model.dofs().len(), modes.omega.len());
    for (i, &dof) in free.iter().enumerate() {
        (0..modes.omega.len()).for_each(|k| shapes[(dof, k)] = modes.shapes[(i, k)]);
    }
    Ok(LinearModes { omega: modes.omega, shapes })
}

fn with_springs(stiffness: &SparseMatrix, springs: &[Triplet]) -> Result<SparseMatrix, HbmError> {
    let entries: Vec<Triplet> = triplets(stiffness).chain(springs.iter().copied()).collect();
    sparse_from_triplets(stiffness.nrows(), stiffness.ncols(), &entries)
        .map_err(|source| HbmError::Linalg { what: "stiffness with the springs of pressed stops", source })
}

/// `b = −K_NN⁻¹ K_NL q_L` of a shape over all degrees of freedom.
fn free_position(structure: &CondensedStructure, shape: &[f64]) -> Vec<f64> {
    let model = &structure.model;
    let q_l: Vec<f64> = model.linear_dofs().iter().map(|&i| shape[i]).collect();
    let n = structure.n_contact_dofs();
    let mut b: Vec<f64> = (0..n)
        .map(|d| {
            let column: Vec<f64> = model.k_ln().col(d).iter().copied().collect();
            -inner(&column, &q_l)
        })
        .collect();
    DenseLu::factor(model.k_nn()).expect("K_NN was factored when the structure was condensed").solve_in_place(&mut b);
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_touch_at_rest_where_one_of_them_had_to_stand_back() {
        let at = |opening: &[f64]| Grazing {
            lifts_off: false,
            mode: 1,
            omega: 1.0,
            energy: 1.0,
            contact: 0,
            mean: vec![0.0; 2],
            fundamental: vec![1.0, 0.5],
            length: 1.0,
            opening: opening.to_vec(),
        };
        assert!(!at(&[0.0, 0.0]).touches_at_rest());
        assert!(at(&[0.0, 1e-9]).touches_at_rest() && at(&[0.2, 0.1]).touches_at_rest());
    }
}
