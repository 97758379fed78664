use nlmodes_linalg::Mat;
use num_complex::Complex64;

use super::closing_equations::Motion;
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

/// Derivative of a structure in open modes and of its load by a parameter, per unit of that.
///
/// The modes are those that change as little as they can ([`StructureState::turn`]): their stiffness and damping are
/// full matrices, their mass stays the identity.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureChange {
    /// Of `Ω²`, m × m, and the stiffness of stops that dissipate.
    stiffness: Mat<f64>,
    /// Of `Ĉ`, m × m.
    damping: Mat<f64>,
    /// Of `Y`, c × m.
    rows: Mat<f64>,
    /// Of `A + C`, c × c.
    compliance: Mat<f64>,
    /// Of `C`, c.
    stop_compliance: Vec<f64>,
    gaps: Vec<f64>,
    /// Of the steady force, m.
    steady: Vec<f64>,
    terms: Vec<LoadTerm>,
    level: f64,
    pub(super) drive: Option<ResponseRow>,
    pub(super) watched: Option<ResponseRow>,
}

impl StructureChange {
    /// `Σ w state` over values of the parameter: with the weights of a difference quotient the derivative.
    ///
    /// # Errors
    /// [`HbmError::Size`] for states that are not of one structure, [`HbmError::LawsInGradient`] of one with springs or
    /// dampers that follow a law.
    pub fn of_differences(states: &[(StructureState<'_>, f64)]) -> Result<Self, HbmError> {
        let Some((first, _)) = states.first() else {
            return Err(HbmError::Size { what: "states of a structure", expected: 1, found: 0 });
        };
        let (m, c) = (first.structure.n_modes(), first.structure.n_contacts());
        let mut change = Self {
            stiffness: Mat::zeros(m, m),
            damping: Mat::zeros(m, m),
            rows: Mat::zeros(c, m),
            compliance: Mat::zeros(c, c),
            stop_compliance: vec![0.0; c],
            gaps: vec![0.0; c],
            steady: vec![0.0; m],
            terms: first.load.terms().iter().map(still).collect(),
            level: 0.0,
            drive: first.drive.as_ref().map(nowhere),
            watched: first.watched.as_ref().map(nowhere),
        };
        for (state, weight) in states {
            change.add(state, *weight)?;
        }
        Ok(change)
    }

    fn add(&mut self, state: &StructureState<'_>, weight: f64) -> Result<(), HbmError> {
        let structure = state.structure;
        let (m, c) = (self.stiffness.nrows(), self.gaps.len());
        let sizes = [
            ("modes of a changed structure", m, structure.n_modes()),
            ("contacts of a changed structure", c, structure.n_contacts()),
            ("terms of a changed load", self.terms.len(), state.load.terms().len()),
            ("modes with mass of a changed structure", structure.n_moving(), state.turn.nrows()),
        ];
        if let Some(&(what, expected, found)) = sizes.iter().find(|(_, expected, found)| expected != found) {
            return Err(HbmError::Size { what, expected, found });
        }
        if !structure.laws().is_empty() {
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
                let steady = if n == 0 { self.steady[k] } else { 0.0 };
                pressed - inner + steady + driven(&|term| term.modal[k])
            };
            let gap = |i: usize| {
                let moved: Complex64 = (0..m).map(|k| eta[k] * self.rows[(i, k)]).sum();
                moved + if n == 0 { self.gaps[i] } else { 0.0 } + driven(&|term| term.gaps[i])
            };
            VariedHarmonic { modal: (0..m).map(modal).collect(), gaps: (0..c).map(gap).collect() }
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

    /// Derivative of the complex amplitude of a row, `change` being that of the row, where the motion is fixed.
    pub(super) fn of_row(
        &self,
        row: &ResponseRow,
        change: &Option<ResponseRow>,
        n: usize,
        motion: &Motion,
    ) -> Complex64 {
        let at = motion.at;
        let along = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(r, z)| z * *r).sum::<Complex64>();
        let of_motion = change.as_ref().map_or(Complex64::default(), |change| {
            along(&change.modes, &(motion.eta)(n)) + along(&change.contacts, &(motion.forces)(n))
        });
        let terms = motion.load.terms().iter().enumerate().filter(|(_, term)| term.harmonic == n);
        let of_load = |(t, term): (usize, &LoadTerm)| {
            let changed = change.as_ref().and_then(|change| change.loads.get(t)).copied().unwrap_or_default();
            let own = row.loads.get(t).copied().unwrap_or_default();
            (changed * at.level + own * self.level) * at.omega.powi(term.omega_power)
        };
        of_motion + terms.map(of_load).sum::<Complex64>()
    }

    /// Of `A + C`, c × c, m/N per unit.
    pub(super) fn compliance(&self) -> &Mat<f64> {
        &self.compliance
    }

    /// Of the compliance of a stop alone.
    pub(super) fn of_stop(&self, contact: usize) -> f64 {
        self.stop_compliance[contact]
    }

    /// Of the gap of a contact.
    pub(super) fn of_gap(&self, contact: usize) -> f64 {
        self.gaps[contact]
    }

    /// Of spring and damper of the stop with this coordinate.
    pub(super) fn of_damped_stop(&self, k: usize) -> [f64; 2] {
        [self.stiffness[(k, k)], self.damping[(k, k)]]
    }
}

fn still(term: &LoadTerm) -> LoadTerm {
    let zeros = |of: &[Complex64]| vec![Complex64::default(); of.len()];
    LoadTerm { modal: zeros(&term.modal), gaps: zeros(&term.gaps), ..*term }
}

fn nowhere(row: &ResponseRow) -> ResponseRow {
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
