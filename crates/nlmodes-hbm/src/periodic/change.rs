use std::sync::Arc;

use nlmodes_linalg::Mat;
use num_complex::Complex64;

use super::law::{ForceLaw, PlacedLaw};
use super::load::{Load, LoadTerm, VariedHarmonic};
use super::operating_point::OperatingPoint;
use super::structure::{ModalStructure, ResponseRow};
use crate::HbmError;

/// A structure with its load at one value of a parameter.
#[derive(Debug, Clone)]
pub struct StructureState<'a> {
    /// The structure.
    pub structure: &'a ModalStructure,
    /// Its modes among those at the value about which is differentiated, `U = Φ₀ᵀ M₀ Φ` made orthogonal (modes that
    /// have mass, square): `Φ Uᵀ` changes as little as it can, so that signs and modes of one frequency do not matter.
    pub turn: Mat<f64>,
    /// Its load of level one.
    pub load: &'a Load,
    /// The level.
    pub level: f64,
    /// The drive point; none where no equation is about one.
    pub drive: Option<ResponseRow>,
    /// The displacement whose amplitude is followed.
    pub watched: Option<ResponseRow>,
}

/// Derivatives of the parts of a structure in open modes, of its load and of displacements by a parameter, per unit of
/// that.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangedParts {
    /// Of `Ω²`, m × m.
    pub stiffness: Mat<f64>,
    /// Of `Ĉ`, m × m.
    pub damping: Mat<f64>,
    /// Of `Y`, c × m.
    pub rows: Mat<f64>,
    /// Of `A`, c × c.
    pub compliance: Mat<f64>,
    /// Of the load of level one.
    pub terms: Vec<LoadTerm>,
    /// Of the drive point.
    pub drive: Option<ResponseRow>,
    /// Of the displacement whose amplitude is followed.
    pub watched: Option<ResponseRow>,
}

/// Derivative of a law of force and of its place.
#[derive(Debug, Clone)]
pub(super) struct LawChange {
    /// Of how the modes (m), the contacts (c) and the laws move its place.
    pub modes: Vec<f64>,
    pub contacts: Vec<f64>,
    pub laws: Vec<f64>,
    /// The law at several values of the parameter, with their weights in the difference quotient.
    pub law: Vec<(f64, Arc<dyn ForceLaw>)>,
}

impl PartialEq for LawChange {
    fn eq(&self, other: &Self) -> bool {
        let same = self.law.iter().zip(&other.law).all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1));
        let places = |of: &Self| [of.modes.clone(), of.contacts.clone(), of.laws.clone()];
        self.law.len() == other.law.len() && same && places(self) == places(other)
    }
}

impl LawChange {
    fn none(placed: &PlacedLaw) -> Self {
        let zeros = |of: &[f64]| vec![0.0; of.len()];
        let PlacedLaw { modes, contacts, laws, .. } = placed;
        Self { modes: zeros(modes), contacts: zeros(contacts), laws: zeros(laws), law: Vec::new() }
    }

    /// Of the force where displacement and velocity stay.
    pub fn force(&self, v: f64, rate: f64) -> f64 {
        self.law.iter().map(|(weight, law)| weight * law.at(v, rate).force).sum()
    }
}

/// Derivative of a structure in open modes and of its load by a parameter, per unit of that.
///
/// The modes are those that change as little as they can ([`StructureState::turn`]): their stiffness and damping are
/// full matrices, their mass stays the identity.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureChange {
    /// Of `Ω²`, m × m, and the stiffness of stops that dissipate.
    pub(super) stiffness: Mat<f64>,
    /// Of `Ĉ`, m × m.
    pub(super) damping: Mat<f64>,
    /// Whether that is not zero.
    pub(super) damps: bool,
    /// Of `Y`, c × m.
    pub(super) rows: Mat<f64>,
    /// Of `A + C`, c × c.
    pub(super) compliance: Mat<f64>,
    /// Of `C`, c.
    pub(super) stop_compliance: Vec<f64>,
    pub(super) gaps: Vec<f64>,
    /// Of the steady force, m.
    pub(super) steady: Vec<f64>,
    pub(super) terms: Vec<LoadTerm>,
    pub(super) level: f64,
    pub(super) laws: Vec<LawChange>,
    pub(super) drive: Option<ResponseRow>,
    pub(super) watched: Option<ResponseRow>,
}

impl StructureChange {
    /// `Σ w state` over values of the parameter: with the weights of a difference quotient the derivative.
    ///
    /// # Errors
    /// [`HbmError::Size`] for states that are not of one structure, [`HbmError::LawsInGradient`] of one with stops that
    /// follow a law of force.
    pub fn of_differences(states: &[(StructureState<'_>, f64)]) -> Result<Self, HbmError> {
        let Some((first, _)) = states.first() else {
            return Err(HbmError::Size { what: "states of a structure", expected: 1, found: 0 });
        };
        let mut change = Self {
            drive: first.drive.as_ref().map(nowhere),
            watched: first.watched.as_ref().map(nowhere),
            ..Self::none(first.structure, first.load)
        };
        for (state, weight) in states {
            change.add(state, *weight)?;
        }
        change.damps = is_any(&change.damping);
        Ok(change)
    }

    /// From the derivatives of its parts; gaps, stops and the level do not change.
    ///
    /// # Errors
    /// [`HbmError::Size`] for parts that are not of this structure and load.
    pub fn of_parts(structure: &ModalStructure, load: &Load, parts: ChangedParts) -> Result<Self, HbmError> {
        let (m, c, none) = (structure.n_modes(), structure.n_contacts(), Self::none(structure, load));
        let sizes = [
            ("modes of a changed structure", m, parts.stiffness.nrows()),
            ("modes of a changed damping", m, parts.damping.nrows()),
            ("contacts of a changed structure", c, parts.rows.nrows()),
            ("contacts of a changed compliance", c, parts.compliance.nrows()),
            ("terms of a changed load", load.terms().len(), parts.terms.len()),
        ];
        if let Some(&(what, expected, found)) = sizes.iter().find(|(_, expected, found)| expected != found) {
            return Err(HbmError::Size { what, expected, found });
        }
        if !structure.laws().is_empty() {
            return Err(HbmError::LawsInGradient);
        }
        let ChangedParts { stiffness, damping, rows, compliance, terms, drive, watched } = parts;
        let damps = is_any(&damping);
        Ok(Self { stiffness, damping, damps, rows, compliance, terms, drive, watched, ..none })
    }

    /// Nothing changes.
    pub(super) fn none(structure: &ModalStructure, load: &Load) -> Self {
        let (m, c) = (structure.n_modes(), structure.n_contacts());
        Self {
            stiffness: Mat::zeros(m, m),
            damping: Mat::zeros(m, m),
            damps: false,
            rows: Mat::zeros(c, m),
            compliance: Mat::zeros(c, c),
            stop_compliance: vec![0.0; c],
            gaps: vec![0.0; c],
            steady: vec![0.0; m],
            terms: load.terms().iter().map(still).collect(),
            level: 0.0,
            laws: structure.laws().iter().map(LawChange::none).collect(),
            drive: None,
            watched: None,
        }
    }

    fn add(&mut self, state: &StructureState<'_>, weight: f64) -> Result<(), HbmError> {
        let structure = state.structure;
        let (m, c) = (self.stiffness.nrows(), self.gaps.len());
        let sizes = [
            ("modes of a changed structure", m, structure.n_modes()),
            ("contacts of a changed structure", c, structure.n_contacts()),
            ("terms of a changed load", self.terms.len(), state.load.terms().len()),
            ("modes with mass of a changed structure", structure.n_moving(), state.turn.nrows()),
            ("laws of a changed structure", self.laws.len(), structure.laws().len()),
        ];
        if let Some(&(what, expected, found)) = sizes.iter().find(|(_, expected, found)| expected != found) {
            return Err(HbmError::Size { what, expected, found });
        }
        if structure.law_stops().next().is_some() {
            return Err(HbmError::LawsInGradient);
        }
        // Stops that dissipate stay what they are.
        let moving = structure.n_moving();
        let turn = Mat::from_fn(m, m, |i, j| match (i < moving, j < moving) {
            (true, true) => state.turn[(i, j)],
            _ => f64::from(u8::from(i == j)),
        });
        let squares = structure.omega_squared();
        let turned = |of: &dyn Fn(usize, usize) -> f64| &turn * Mat::from_fn(m, m, of) * turn.transpose();
        let stiffness = turned(&|i, j| if i == j { squares[i] } else { 0.0 });
        let damping = turned(&|i, j| structure.damping().entry(i, j));
        let rows = structure.rows() * turn.transpose();
        let (a, steady) = (structure.compliance().a(), structure.steady_force());
        for j in 0..m {
            (0..m).for_each(|i| self.stiffness[(i, j)] += weight * stiffness[(i, j)]);
            (0..m).for_each(|i| self.damping[(i, j)] += weight * damping[(i, j)]);
            (0..c).for_each(|i| self.rows[(i, j)] += weight * rows[(i, j)]);
        }
        for i in 0..c {
            (0..c).for_each(|j| self.compliance[(i, j)] += weight * a[(i, j)]);
            self.stop_compliance[i] += weight * structure.stop_compliance()[i];
            self.gaps[i] += weight * structure.gaps()[i];
        }
        if !steady.is_empty() {
            let along = |i: usize| (0..m).map(|k| turn[(i, k)] * steady[k]).sum::<f64>();
            self.steady.iter_mut().enumerate().for_each(|(i, p)| *p += weight * along(i));
        }
        for (term, other) in self.terms.iter_mut().zip(state.load.terms()) {
            add_turned(&turn, weight, &other.modal, &mut term.modal);
            term.gaps.iter_mut().zip(&other.gaps).for_each(|(to, from)| *to += from * weight);
        }
        for (own, placed) in self.laws.iter_mut().zip(structure.laws()) {
            add_turned(&turn, weight, &placed.modes, &mut own.modes);
            own.contacts.iter_mut().zip(&placed.contacts).for_each(|(to, from)| *to += weight * from);
            own.laws.iter_mut().zip(&placed.laws).for_each(|(to, from)| *to += weight * from);
            own.law.push((weight, placed.law.clone()));
        }
        self.level += weight * state.level;
        for (own, other) in [(&mut self.drive, &state.drive), (&mut self.watched, &state.watched)] {
            if let (Some(own), Some(other)) = (own, other) {
                add_turned(&turn, weight, &other.modes, &mut own.modes);
                own.contacts.iter_mut().zip(&other.contacts).for_each(|(to, from)| *to += weight * from);
                own.loads.iter_mut().zip(&other.loads).for_each(|(to, from)| *to += from * weight);
            }
        }
        Ok(())
    }

    /// The parameter as a load of each harmonic of a motion: what it takes off and adds to the modes and the gaps where
    /// the motion stays.
    pub(super) fn as_load(
        &self,
        (structure, load): (&ModalStructure, &Load),
        at: OperatingPoint,
        motion: &[(Vec<Complex64>, Vec<Complex64>)],
    ) -> Vec<VariedHarmonic> {
        let (m, c) = (self.stiffness.nrows(), self.gaps.len());
        let is_damped = !structure.damping().is_none();
        let of = |(n, (eta, forces)): (usize, &(Vec<Complex64>, Vec<Complex64>))| {
            let nu = n as f64 * at.omega;
            let held = |k: usize, j: usize| {
                Complex64::new(self.stiffness[(k, j)], if is_damped { nu * self.damping[(k, j)] } else { 0.0 })
            };
            let driven = |amplitude: &dyn Fn(&LoadTerm) -> Complex64| self.of_terms(n, at, load, amplitude);
            let modal = |k: usize| {
                let inner: Complex64 = (0..m).map(|j| held(k, j) * eta[j]).sum();
                let pressed: Complex64 = (0..c).map(|i| forces[i] * self.rows[(i, k)]).sum();
                let reacted: Complex64 = self.laws.iter().zip(&forces[c..]).map(|(law, f)| f * law.modes[k]).sum();
                let steady = if n == 0 { self.steady[k] } else { 0.0 };
                pressed + reacted - inner + steady + driven(&|term| term.modal[k])
            };
            let gap = |i: usize| {
                let moved: Complex64 = (0..m).map(|k| eta[k] * self.rows[(i, k)]).sum();
                let reacted: Complex64 = self.laws.iter().zip(&forces[c..]).map(|(law, f)| f * law.contacts[i]).sum();
                moved + reacted + if n == 0 { self.gaps[i] } else { 0.0 } + driven(&|term| term.gaps[i])
            };
            let place = |(l, law): (usize, &LawChange)| {
                let along = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(r, z)| z * *r).sum::<Complex64>();
                let reacted = along(&law.contacts, forces) + along(&law.laws, &forces[c..]);
                along(&law.modes, eta) + reacted + driven(&|term| term.gaps[c + l])
            };
            let places = (0..c).map(gap).chain(self.laws.iter().enumerate().map(place));
            VariedHarmonic { modal: (0..m).map(modal).collect(), gaps: places.collect() }
        };
        motion.iter().enumerate().map(of).collect()
    }

    /// Derivative of what the terms do in one harmonic: that of each term, and that of the level.
    fn of_terms(
        &self,
        n: usize,
        at: OperatingPoint,
        load: &Load,
        amplitude: &dyn Fn(&LoadTerm) -> Complex64,
    ) -> Complex64 {
        let changed = self.terms.iter().zip(load.terms()).filter(|(term, _)| term.harmonic == n);
        let of = |(term, own): (&LoadTerm, &LoadTerm)| {
            (amplitude(term) * at.level + amplitude(own) * self.level) * at.omega.powi(term.omega_power)
        };
        changed.map(of).sum()
    }

    /// Of `A + C`, c × c, m/N per unit.
    pub(super) fn compliance(&self) -> &Mat<f64> {
        &self.compliance
    }
}

fn is_any(matrix: &Mat<f64>) -> bool {
    (0..matrix.ncols()).any(|j| matrix.col(j).iter().any(|entry| *entry != 0.0))
}

fn still(term: &LoadTerm) -> LoadTerm {
    let zeros = |of: &[Complex64]| vec![Complex64::default(); of.len()];
    LoadTerm { modal: zeros(&term.modal), gaps: zeros(&term.gaps), ..*term }
}

pub(super) fn nowhere(row: &ResponseRow) -> ResponseRow {
    ResponseRow {
        modes: vec![0.0; row.modes.len()],
        contacts: vec![0.0; row.contacts.len()],
        loads: vec![Complex64::default(); row.loads.len()],
    }
}

/// Adds `w U v`.
fn add_turned<T>(turn: &Mat<f64>, weight: f64, from: &[T], to: &mut [T])
where
    T: Copy + std::ops::Mul<f64, Output = T> + std::ops::AddAssign,
{
    for (i, to) in to.iter_mut().enumerate() {
        for (k, from) in from.iter().enumerate() {
            *to += *from * (weight * turn[(i, k)]);
        }
    }
}
