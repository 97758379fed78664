//! Structures in open modes, made by hand: dense statics and the modes of the pencil.
#![allow(dead_code)]

use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{
    Coordinates, ForceLaw, Load, LoadTerm, ModalDamping, ModalStructure, PeriodicSettings, PeriodicSystem, PlacedLaw,
    ResponseRow, Switching,
};
use nlmodes_linalg::{Mat, SparseMatrix, lowest_modes};
use nlmodes_model::{DofContact, Drop, MasslessContactModel, StructuralModel};
use num_complex::Complex64;
use std::sync::Arc;

use super::{dense, solve_dense, stops};

/// Open modes of a structure with everything that loads and recovery need.
pub struct Open {
    pub omega_squared: Vec<f64>,
    /// Degrees of freedom × modes.
    pub shapes: Mat<f64>,
    pub contacts: Vec<DofContact>,
    k: Vec<Vec<f64>>,
    m: Vec<Vec<f64>>,
}

impl Open {
    /// With the mass of the contact nodes dropped.
    pub fn massless(model: &StructuralModel) -> Self {
        let massless = MasslessContactModel::new(model, &Drop).unwrap();
        Self::of(massless.mass(), massless.stiffness(), massless.contacts(), massless.m_ll().nrows())
    }

    /// With the mass as it is and the lowest modes.
    pub fn lowest(model: &StructuralModel, modes: usize) -> Self {
        Self::of(model.mass(), model.stiffness(), &stops(model), modes)
    }

    fn of(mass: &SparseMatrix, stiffness: &SparseMatrix, contacts: &[DofContact], modes: usize) -> Self {
        let modes = lowest_modes(stiffness, mass, modes).unwrap();
        Self {
            omega_squared: modes.eigenvalues,
            shapes: modes.vectors,
            contacts: contacts.to_vec(),
            k: dense(stiffness),
            m: dense(mass),
        }
    }

    pub fn n_modes(&self) -> usize {
        self.omega_squared.len()
    }

    fn static_answer(&self, force: &[f64]) -> Vec<f64> {
        let mut q = solve_dense(self.k.clone(), force.to_vec());
        for (r, w) in self.omega_squared.iter().enumerate() {
            let p: f64 = (0..q.len()).map(|d| self.shapes[(d, r)] * force[d]).sum();
            (0..q.len()).for_each(|d| q[d] -= self.shapes[(d, r)] * p / w);
        }
        q
    }

    fn push(&self, contact: &DofContact) -> Vec<f64> {
        let mut force = vec![0.0; self.k.len()];
        force[contact.dof] = contact.direction();
        force
    }

    pub fn structure(&self, damping: ModalDamping) -> ModalStructure {
        let (c, m) = (self.contacts.len(), self.n_modes());
        let rows = Mat::from_fn(c, m, |i, k| self.contacts[i].direction() * self.shapes[(self.contacts[i].dof, k)]);
        let pushed: Vec<Vec<f64>> = self.contacts.iter().map(|c| self.static_answer(&self.push(c))).collect();
        // What is rounding where all modes of a structure with mass are there is zero.
        let size = pushed.iter().flatten().fold(0.0_f64, |m, q| m.max(q.abs()));
        let clean = |v: f64| if v.abs() < 1e-12 * size.max(1e-3) { 0.0 } else { v };
        let flexibility =
            Mat::from_fn(c, c, |i, j| clean(self.contacts[i].direction() * pushed[j][self.contacts[i].dof]));
        let gaps = self.contacts.iter().map(|c| c.gap).collect();
        let own: Vec<f64> = self.contacts.iter().map(|c| c.law.compliance()).collect();
        ModalStructure::new(self.omega_squared.clone(), rows, &flexibility, gaps, &own, damping).unwrap()
    }

    /// A force with this complex amplitude at a degree of freedom in a harmonic.
    pub fn force(&self, dof: usize, harmonic: usize, amplitude: Complex64) -> LoadTerm {
        let mut force = vec![0.0; self.k.len()];
        force[dof] = 1.0;
        let still = self.static_answer(&force);
        LoadTerm {
            harmonic,
            omega_power: 0,
            modal: (0..self.n_modes()).map(|k| amplitude * self.shapes[(dof, k)]).collect(),
            gaps: self.contacts.iter().map(|c| amplitude * (c.direction() * still[c.dof])).collect(),
        }
    }

    /// Laws at degrees of freedom.
    pub fn placed(&self, laws: &[(usize, Arc<dyn ForceLaw>)]) -> Vec<PlacedLaw> {
        let still = |dof: usize| {
            let mut force = vec![0.0; self.k.len()];
            force[dof] = 1.0;
            self.static_answer(&force)
        };
        let placed = |(dof, law): &(usize, Arc<dyn ForceLaw>)| {
            let still = still(*dof);
            PlacedLaw {
                law: law.clone(),
                modes: (0..self.n_modes()).map(|k| self.shapes[(*dof, k)]).collect(),
                contacts: self.contacts.iter().map(|c| c.direction() * still[c.dof]).collect(),
                laws: laws.iter().map(|(other, _)| still[*other]).collect(),
            }
        };
        laws.iter().map(placed).collect()
    }

    /// Displacement of a degree of freedom; its load is a unit force there in one term, if `driven`.
    pub fn row(&self, dof: usize, driven: bool) -> ResponseRow {
        let mut force = vec![0.0; self.k.len()];
        force[dof] = 1.0;
        let still = self.static_answer(&force);
        ResponseRow {
            modes: (0..self.n_modes()).map(|k| self.shapes[(dof, k)]).collect(),
            contacts: self.contacts.iter().map(|c| c.direction() * still[c.dof]).collect(),
            loads: if driven { vec![Complex64::new(still[dof], 0.0)] } else { Vec::new() },
        }
    }

    pub fn load(&self, structure: &ModalStructure, terms: Vec<LoadTerm>) -> Load {
        Load::new(structure, terms).unwrap()
    }

    /// `Φᵀ C Φ`.
    pub fn viscous(&self, c: &[Vec<f64>]) -> ModalDamping {
        let n = self.k.len();
        let entry = |i: usize, j: usize| -> f64 {
            (0..n).map(|a| (0..n).map(|b| self.shapes[(a, i)] * c[a][b] * self.shapes[(b, j)]).sum::<f64>()).sum()
        };
        ModalDamping::Full(Mat::from_fn(self.n_modes(), self.n_modes(), entry))
    }

    pub fn stiffness(&self) -> &[Vec<f64>] {
        &self.k
    }

    pub fn mass(&self) -> &[Vec<f64>] {
        &self.m
    }
}

pub fn solver() -> Box<dyn LcpSolver> {
    solver_by_name("active-set").unwrap()
}

pub fn settings(harmonics: usize, coordinates: Coordinates) -> PeriodicSettings {
    PeriodicSettings { harmonics, switching: Switching::Exact, coordinates }
}

/// Newton's method at a fixed parameter; unknowns and largest residual.
pub fn newton(system: &mut PeriodicSystem, mut x: Vec<f64>, p: f64) -> (Vec<f64>, f64) {
    let n = system.dim();
    let mut at = Linearization::new(n);
    let mut lu = nlmodes_linalg::DenseLu::default();
    for _ in 0..60 {
        system.linearize(&x, p, &mut at).unwrap();
        if at.residual_norm() < 3e-15 {
            break;
        }
        lu.refactor(&at.jacobian.subcols(0, n).to_owned()).unwrap();
        let mut step = at.residual.clone();
        lu.solve_in_place(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, s)| *x -= s);
    }
    system.linearize(&x, p, &mut at).unwrap();
    (x, at.residual_norm())
}

/// Largest difference in a column, over the largest entry of that column.
pub fn worst_column(system: &mut PeriodicSystem, x: &[f64], p: f64, step: f64) -> f64 {
    let n = system.dim();
    let (mut at, mut plus, mut minus) = (Linearization::new(n), Linearization::new(n), Linearization::new(n));
    system.linearize(x, p, &mut at).unwrap();
    let mut worst = 0.0_f64;
    for j in 0..=n {
        let shifted = |s: f64| {
            let mut z: Vec<f64> = x.iter().copied().chain([p]).collect();
            z[j] += s;
            z
        };
        let (high, low) = (shifted(step), shifted(-step));
        system.linearize(&high[..n], high[n], &mut plus).unwrap();
        system.linearize(&low[..n], low[n], &mut minus).unwrap();
        let difference = |i: usize| (plus.residual[i] - minus.residual[i]) / (2.0 * step);
        let size = (0..n).fold(f64::MIN_POSITIVE, |m, i| m.max(at.jacobian[(i, j)].abs()));
        if size == f64::MIN_POSITIVE {
            continue;
        }
        worst = (0..n).fold(worst, |w, i| w.max((difference(i) - at.jacobian[(i, j)]).abs() / size));
    }
    worst
}
