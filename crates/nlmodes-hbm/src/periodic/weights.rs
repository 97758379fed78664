use nlmodes_linalg::Mat;
use num_complex::Complex64;

use super::change::{LawChange, StructureChange, nowhere};
use super::closing_equations::Motion;
use super::load::{Load, LoadTerm};
use super::operating_point::OperatingPoint;
use super::structure::{ModalStructure, ResponseRow};

/// Derivative of a number of a motion by everything of its structure in open modes and its load: a weight for each
/// entry of a [`StructureChange`]; of products with complex weights the real part counts.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureWeights {
    pub(super) of: StructureChange,
    /// Of the force of each law, at the displacements and velocities of a period.
    pub(super) laws: Vec<Vec<LawSample>>,
}

/// The weights of what entries of stiffness and mass change of a structure and its load. Matrices that are symmetric
/// have all of a pair above the diagonal; of products with complex weights the real part counts.
#[derive(Debug, Clone, Copy)]
pub struct PartWeights<'a> {
    /// Of `Ω²` and the stiffness of stops that dissipate, m × m.
    pub stiffness: &'a Mat<f64>,
    /// Of `Ĉ`, m × m.
    pub damping: &'a Mat<f64>,
    /// Of `Y`, c × m.
    pub rows: &'a Mat<f64>,
    /// Of `A`, c × c.
    pub compliance: &'a Mat<f64>,
    /// Of the load of level one.
    pub terms: &'a [LoadTerm],
    /// Of the drive point.
    pub drive: Option<&'a ResponseRow>,
    /// Of the displacement whose amplitude is followed.
    pub watched: Option<&'a ResponseRow>,
    laws: &'a [LawChange],
}

impl<'a> PartWeights<'a> {
    /// Of how modes (m), contacts (c) and laws move the place of each law.
    pub fn laws(&self) -> impl Iterator<Item = [&'a [f64]; 3]> {
        self.laws.iter().map(|law| [law.modes.as_slice(), &law.contacts, &law.laws])
    }
}

/// An instant of the motion of a law, and what the derivative of its force there counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LawSample {
    /// Displacement, m.
    pub v: f64,
    /// Velocity, m/s.
    pub rate: f64,
    /// Weight, per N.
    pub weight: f64,
}

/// The terms of a motion by which a change acts on its modes and gaps, one harmonic after the other.
pub(super) struct Acted<'a> {
    /// Weights of loads of the modes (m) and of what opens the gaps and moves the laws behind them.
    pub modal: &'a [Vec<Complex64>],
    pub gaps: &'a [Vec<Complex64>],
}

impl StructureWeights {
    /// Nothing counts.
    pub(super) fn none(structure: &ModalStructure, load: &Load) -> Self {
        Self { of: StructureChange::none(structure, load), laws: vec![Vec::new(); structure.laws().len()] }
    }

    /// The derivative by a parameter that changes the structure like this.
    ///
    /// # Panics
    /// If the change is one of another structure.
    pub fn along(&self, change: &StructureChange) -> f64 {
        let products = self.of.numbers(-1.0).iter().zip(change.numbers(1.0)).map(|(w, of)| w * of).sum::<f64>();
        products + self.along_laws(&change.laws)
    }

    /// The weights of what entries of stiffness and mass change.
    pub(super) fn parts(&self) -> PartWeights<'_> {
        let StructureChange { stiffness, damping, rows, compliance, terms, laws, drive, watched, .. } = &self.of;
        let (drive, watched) = (drive.as_ref(), watched.as_ref());
        PartWeights { stiffness, damping, rows, compliance, terms, laws, drive, watched }
    }

    /// What the forces of laws do, where the motion stays.
    pub(super) fn along_laws(&self, laws: &[LawChange]) -> f64 {
        let of = |(samples, law): (&Vec<LawSample>, &LawChange)| {
            samples.iter().map(|at| at.weight * law.force(at.v, at.rate)).sum::<f64>()
        };
        self.laws.iter().zip(laws).filter(|(_, law)| law.acts()).map(of).sum()
    }

    /// Adds the weights below the diagonals of what is symmetric to those above, which are its
    /// [numbers](StructureChange::numbers).
    pub(super) fn fold(&mut self) {
        for matrix in [&mut self.of.stiffness, &mut self.of.damping, &mut self.of.compliance] {
            for j in 0..matrix.ncols() {
                for i in j + 1..matrix.nrows() {
                    matrix[(j, i)] += std::mem::take(&mut matrix[(i, j)]);
                }
            }
        }
    }

    /// Adds other weights times a factor.
    pub(super) fn add(&mut self, factor: f64, other: &Self) {
        for (to, from) in self.laws.iter_mut().zip(&other.laws) {
            to.extend(from.iter().map(|at| LawSample { weight: factor * at.weight, ..*at }));
        }
        let (own, other) = (&mut self.of, &other.of);
        let matrices = [
            (&mut own.stiffness, &other.stiffness),
            (&mut own.damping, &other.damping),
            (&mut own.rows, &other.rows),
            (&mut own.compliance, &other.compliance),
        ];
        for (to, from) in matrices {
            for j in 0..to.ncols() {
                to.col_mut(j).iter_mut().zip(from.col(j).iter()).for_each(|(to, from)| *to += factor * from);
            }
        }
        let lists = [
            (&mut own.stop_compliance, &other.stop_compliance),
            (&mut own.gaps, &other.gaps),
            (&mut own.steady, &other.steady),
        ];
        lists.into_iter().for_each(|(to, from)| add_scaled(factor, from, to));
        for (to, from) in own.terms.iter_mut().zip(&other.terms) {
            add_scaled(factor, &from.modal, &mut to.modal);
            add_scaled(factor, &from.gaps, &mut to.gaps);
        }
        own.level += factor * other.level;
        for (to, from) in own.laws.iter_mut().zip(&other.laws) {
            add_scaled(factor, &from.modes, &mut to.modes);
            add_scaled(factor, &from.contacts, &mut to.contacts);
            add_scaled(factor, &from.laws, &mut to.laws);
        }
        for (to, from) in [(&mut own.drive, &other.drive), (&mut own.watched, &other.watched)] {
            let Some(from) = from else { continue };
            let to = to.get_or_insert_with(|| nowhere(from));
            add_scaled(factor, &from.modes, &mut to.modes);
            add_scaled(factor, &from.contacts, &mut to.contacts);
            add_scaled(factor, &from.loads, &mut to.loads);
        }
    }

    /// Adds the factor times the derivative of the complex amplitude of the drive point in harmonic n.
    pub(super) fn add_drive(&mut self, factor: Complex64, row: &ResponseRow, n: usize, motion: &Motion) {
        let to = self.of.drive.get_or_insert_with(|| nowhere(row));
        self.of.level += weigh_row(factor, to, row, n, motion);
    }

    /// The same of the displacement whose amplitude is followed.
    pub(super) fn add_watched(&mut self, factor: Complex64, row: &ResponseRow, n: usize, motion: &Motion) {
        let to = self.of.watched.get_or_insert_with(|| nowhere(row));
        self.of.level += weigh_row(factor, to, row, n, motion);
    }

    /// Adds what a change does as a load of each harmonic of a motion, [`StructureChange::as_load`] transposed.
    pub(super) fn add_load(
        &mut self,
        (structure, load): (&ModalStructure, &Load),
        at: OperatingPoint,
        motion: &[(Vec<Complex64>, Vec<Complex64>)],
        acted: &Acted<'_>,
    ) {
        let is_damped = !structure.damping().is_none();
        let (m, c) = (structure.n_modes(), structure.n_contacts());
        for (n, (eta, forces)) in motion.iter().enumerate() {
            let (modal, gaps, nu) = (&acted.modal[n], &acted.gaps[n], n as f64 * at.omega);
            for j in 0..m {
                for (k, modal) in modal.iter().enumerate() {
                    let both = modal * eta[j];
                    self.of.stiffness[(k, j)] -= both.re;
                    if is_damped {
                        self.of.damping[(k, j)] += nu * both.im;
                    }
                }
                for i in 0..c {
                    self.of.rows[(i, j)] += (modal[j] * forces[i] + gaps[i] * eta[j]).re;
                }
            }
            let (reactions, places) = (&forces[c..], &gaps[c..]);
            for (l, law) in self.of.laws.iter_mut().enumerate() {
                let (f, g) = (reactions[l], places[l]);
                (0..m).for_each(|k| law.modes[k] += (modal[k] * f + g * eta[k]).re);
                (0..c).for_each(|i| law.contacts[i] += (gaps[i] * f + g * forces[i]).re);
                law.laws.iter_mut().zip(reactions).for_each(|(to, f)| *to += (g * f).re);
            }
            if n == 0 {
                self.of.steady.iter_mut().zip(modal).for_each(|(to, w)| *to += w.re);
                self.of.gaps.iter_mut().zip(gaps).for_each(|(to, w)| *to += w.re);
            }
            for (to, own) in self.of.terms.iter_mut().zip(load.terms()).filter(|(term, _)| term.harmonic == n) {
                let power = at.omega.powi(own.omega_power);
                to.modal.iter_mut().zip(modal).for_each(|(to, w)| *to += w * (at.level * power));
                to.gaps.iter_mut().zip(gaps).for_each(|(to, w)| *to += w * (at.level * power));
                let of = |w: &[Complex64], own: &[Complex64]| w.iter().zip(own).map(|(w, z)| (w * z).re).sum::<f64>();
                self.of.level += (of(modal, &own.modal) + of(gaps, &own.gaps)) * power;
            }
        }
    }
}

/// Adds weights of the change of a row in a motion; that of the level.
fn weigh_row(factor: Complex64, to: &mut ResponseRow, row: &ResponseRow, n: usize, motion: &Motion) -> f64 {
    let at = motion.at;
    to.modes.iter_mut().zip((motion.eta)(n)).for_each(|(to, z)| *to += (factor * z).re);
    to.contacts.iter_mut().zip((motion.forces)(n)).for_each(|(to, z)| *to += (factor * z).re);
    let mut level = 0.0;
    for (t, term) in motion.load.terms().iter().enumerate().filter(|(_, term)| term.harmonic == n) {
        let factor = factor * at.omega.powi(term.omega_power);
        to.loads.get_mut(t).into_iter().for_each(|to| *to += factor * at.level);
        level += (factor * row.loads.get(t).copied().unwrap_or_default()).re;
    }
    level
}

fn add_scaled<T>(factor: f64, from: &[T], to: &mut [T])
where
    T: Copy + std::ops::Mul<f64, Output = T> + std::ops::AddAssign,
{
    to.iter_mut().zip(from).for_each(|(to, from)| *to += *from * factor);
}
