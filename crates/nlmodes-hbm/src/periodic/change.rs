use std::fmt;
use std::sync::Arc;

use nlmodes_linalg::{Mat, column};
use num_complex::Complex64;

use super::law::{ForceLaw, PlacedLaw, conservative};
use super::load::{Load, LoadTerm, VariedHarmonic};
use super::operating_point::OperatingPoint;
use super::structure::{ModalStructure, ResponseRow};
use super::weights::{PartWeights, StructureWeights};
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

/// Derivative of a law of force and of its place.
#[derive(Debug, Clone)]
pub(super) struct LawChange {
    /// Of how the modes (m), the contacts (c) and the laws move its place.
    pub modes: Vec<f64>,
    pub contacts: Vec<f64>,
    pub laws: Vec<f64>,
    /// The law.
    own: Arc<dyn ForceLaw>,
    /// The law at several values of the parameter, with their weights in the difference quotient; a stop with the
    /// clearance that it has.
    law: Vec<(f64, Arc<dyn ForceLaw>)>,
    /// Of the clearance of a stop, m.
    gap: f64,
}

impl PartialEq for LawChange {
    fn eq(&self, other: &Self) -> bool {
        let same = self.law.iter().zip(&other.law).all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1));
        let places = |of: &Self| [of.modes.clone(), of.contacts.clone(), of.laws.clone()];
        self.law.len() == other.law.len() && same && self.gap == other.gap && places(self) == places(other)
    }
}

impl LawChange {
    fn none(placed: &PlacedLaw) -> Self {
        let zeros = |of: &[f64]| vec![0.0; of.len()];
        let PlacedLaw { modes, contacts, laws, law } = placed;
        let [modes, contacts, laws] = [modes, contacts, laws].map(|of| zeros(of));
        Self { modes, contacts, laws, own: law.clone(), law: Vec::new(), gap: 0.0 }
    }

    /// Whether its force changes where the motion stays.
    pub fn acts(&self) -> bool {
        !self.law.is_empty()
    }

    fn add(&mut self, law: &Arc<dyn ForceLaw>, weight: f64) {
        let moved = law.stop_gap().zip(self.own.stop_gap()).map(|(gap, own)| gap - own);
        self.gap += weight * moved.unwrap_or(0.0);
        self.law.push((weight, moved.and_then(|by| law.stop_moved(by)).unwrap_or_else(|| law.clone())));
    }

    /// Of the force where displacement and velocity stay. A stop acts in the touches that it has: their ends move, but
    /// the force is zero there.
    pub fn force(&self, v: f64, rate: f64) -> f64 {
        let by_gap = if self.gap == 0.0 { 0.0 } else { -self.own.at(v, rate).stiffness * self.gap };
        self.law.iter().map(|(weight, law)| weight * law.continued(v, rate)).sum::<f64>() + by_gap
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
    /// `Σ w state` over values of the parameter beside that of `own`: with the weights of a difference quotient the
    /// derivative.
    ///
    /// # Errors
    /// [`HbmError::Size`] for states that are not of one structure.
    pub fn of_differences(own: &ModalStructure, states: &[(StructureState<'_>, f64)]) -> Result<Self, HbmError> {
        let Some((first, _)) = states.first() else {
            return Err(HbmError::Size { what: "states of a structure", expected: 1, found: 0 });
        };
        let mut change = Self {
            drive: first.drive.as_ref().map(nowhere),
            watched: first.watched.as_ref().map(nowhere),
            ..Self::none(own, first.load)
        };
        for (state, weight) in states {
            change.add(state, *weight)?;
        }
        Ok(change)
    }

    /// Nothing changes.
    pub(super) fn none(structure: &ModalStructure, load: &Load) -> Self {
        let (m, c) = (structure.n_modes(), structure.n_contacts());
        Self {
            stiffness: Mat::zeros(m, m),
            damping: Mat::zeros(m, m),
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
            own.add(&placed.law, weight);
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

    /// All its numbers in one order: of symmetric matrices the upper halves, of complex numbers the real parts and the
    /// imaginary ones times a sign. Those of the load come last, so that a motion without one has none of them.
    pub(super) fn numbers(&self, sign: f64) -> Vec<f64> {
        let mut all = Vec::new();
        for matrix in [&self.stiffness, &self.damping, &self.compliance] {
            (0..matrix.ncols()).for_each(|j| all.extend_from_slice(&column(matrix, j)[..=j]));
        }
        (0..self.rows.ncols()).for_each(|j| all.extend_from_slice(column(&self.rows, j)));
        for list in [&self.stop_compliance, &self.gaps, &self.steady] {
            all.extend_from_slice(list);
        }
        all.push(self.level);
        for law in &self.laws {
            [&law.modes, &law.contacts, &law.laws].iter().for_each(|of| all.extend_from_slice(of));
        }
        let mut loads: Vec<Complex64> =
            self.terms.iter().flat_map(|term| term.modal.iter().chain(&term.gaps)).copied().collect();
        for row in [&self.drive, &self.watched] {
            let ends = [all.len() + self.stiffness.nrows() + self.gaps.len() + self.laws.len(), loads.len()];
            if let Some(row) = row {
                all.extend(row.modes.iter().chain(&row.contacts));
                loads.extend_from_slice(&row.loads);
            }
            all.resize(ends[0], 0.0);
            loads.resize(ends[1] + self.terms.len(), Complex64::default());
        }
        all.extend(loads.iter().flat_map(|z| [z.re, sign * z.im]));
        all
    }

    /// Of `A + C`, c × c, m/N per unit.
    pub(super) fn compliance(&self) -> &Mat<f64> {
        &self.compliance
    }
}

/// Parameters whose derivatives are made from the weights of what is differentiated, without a [`StructureChange`] of
/// each.
pub trait ManyChanges: fmt::Debug + Send + Sync {
    /// The derivative of a number with these weights by each parameter.
    fn times(&self, weights: &PartWeights<'_>) -> Vec<f64>;
}

/// Derivatives by any number of parameters, of which those of a motion are products.
#[derive(Debug, Clone)]
pub struct Changes {
    /// The numbers of the parameters with a change of their own, a column each, of which some parameter changes each.
    numbers: Mat<f64>,
    /// The places of these among all numbers.
    kept: Vec<usize>,
    laws: Vec<Vec<LawChange>>,
    /// Whether each parameter, in their order, has a change of its own, and its number among those or the others.
    places: Vec<(bool, usize)>,
    many: Option<Arc<dyn ManyChanges>>,
}

impl PartialEq for Changes {
    fn eq(&self, other: &Self) -> bool {
        let many = match (&self.many, &other.many) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (own, other) => own.is_none() && other.is_none(),
        };
        let Self { numbers, kept, laws, places, .. } = self;
        many && (numbers, kept, laws, places) == (&other.numbers, &other.kept, &other.laws, &other.places)
    }
}

impl From<Vec<StructureChange>> for Changes {
    fn from(all: Vec<StructureChange>) -> Self {
        Self::new(all.into_iter().map(Some).collect(), None)
    }
}

impl Default for Changes {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl Changes {
    /// By parameters with changes of their own and, at places without, by the next of `many`.
    pub fn new(all: Vec<Option<StructureChange>>, many: Option<Arc<dyn ManyChanges>>) -> Self {
        let mut counts = [0, 0];
        let place = |change: &Option<StructureChange>| {
            let count = &mut counts[usize::from(change.is_some())];
            *count += 1;
            (change.is_some(), *count - 1)
        };
        let places = all.iter().map(place).collect();
        let all: Vec<StructureChange> = all.into_iter().flatten().collect();
        let mut changed = Vec::new();
        for change in &all {
            let numbers = change.numbers(1.0);
            changed.resize(numbers.len(), false);
            changed.iter_mut().zip(&numbers).for_each(|(changed, number)| *changed |= *number != 0.0);
        }
        let kept: Vec<usize> = (0..changed.len()).filter(|k| changed[*k]).collect();
        let (mut numbers, mut laws) = (Mat::zeros(kept.len(), all.len()), Vec::new());
        for (p, change) in all.into_iter().enumerate() {
            let own = change.numbers(1.0);
            numbers.col_mut(p).iter_mut().zip(&kept).for_each(|(to, k)| *to = own[*k]);
            laws.push(change.laws);
        }
        Self { numbers, kept, laws, places, many }
    }

    /// The same of motions without what dissipates.
    #[must_use]
    pub fn conservative(&self) -> Self {
        let mut changes = self.clone();
        for law in changes.laws.iter_mut().flatten() {
            law.own = conservative(&law.own);
            law.law.iter_mut().for_each(|(_, law)| *law = conservative(law));
        }
        changes
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The derivative by each parameter of each of the numbers that have these weights, parameters × numbers.
    ///
    /// # Panics
    /// If the changes are those of another structure.
    pub(super) fn times(&self, weights: &[&StructureWeights]) -> Mat<f64> {
        let mut by = Mat::zeros(self.kept.len(), weights.len());
        let mut many = Vec::new();
        for (k, weights) in weights.iter().enumerate() {
            if !self.kept.is_empty() {
                let all = weights.of.numbers(-1.0);
                let kept = by.col_mut(k).iter_mut().zip(&self.kept);
                kept.for_each(|(to, at)| *to = all.get(*at).copied().unwrap_or(0.0));
            }
            many.extend(self.many.as_ref().map(|many| many.times(&weights.parts())));
        }
        let found = self.numbers.transpose() * by;
        Mat::from_fn(self.places.len(), weights.len(), |row, k| match self.places[row] {
            (true, p) => found[(p, k)] + weights[k].along_laws(&self.laws[p]),
            (false, p) => many.get(k).and_then(|of| of.get(p)).copied().unwrap_or(f64::NAN),
        })
    }
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
