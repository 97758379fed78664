//! Structures made by hand, so that these tests owe nothing to the finite-element crate.
#![allow(dead_code)]

pub mod modal;

use std::ops::ControlFlow;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, Branch, Continuation, Linearization, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, Grazing, PeriodicSettings, PeriodicSystem, Switching, Symmetry, grazing};
use nlmodes_linalg::{SparseMatrix, sparse_from_triplets};
use nlmodes_modal::ModalPoint;
use nlmodes_model::{
    Contact, ContactLaw, Dof, DofContact, DofKind, Drop, MassRedistribution, MasslessContactModel, Side,
    StructuralModel,
};

/// Clamped-free rod of `elements` linear elements with consistent mass, a stop at each `(node, side, gap)`.
pub fn rod(elements: usize, ea: f64, rho_a: f64, length: f64, stops: &[(usize, Side, f64)]) -> StructuralModel {
    let l = length / elements as f64;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for e in 0..elements {
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if e + a == 0 || e + b == 0 {
                continue;
            }
            let (i, j) = (e + a - 1, e + b - 1);
            k.push((i, j, ea / l * if a == b { 1.0 } else { -1.0 }));
            m.push((i, j, rho_a * l / 6.0 * if a == b { 2.0 } else { 1.0 }));
        }
    }
    let dofs = (1..=elements).map(|node| Dof { node, position: l * node as f64, kind: DofKind::Axial }).collect();
    let contacts = stops.iter().map(|&(node, side, gap)| Contact::rigid(node - 1, side, gap)).collect();
    StructuralModel::new(
        sparse_from_triplets(elements, elements, &m).unwrap(),
        sparse_from_triplets(elements, elements, &k).unwrap(),
        dofs,
        contacts,
    )
    .unwrap()
}

/// The rod of Section 3 with a stop at its tip, the mass of the tip dropped.
pub fn paper_rod() -> CondensedStructure {
    condense(&rod(100, 210e9, 9000.0, 20.0, &[(100, Side::Positive, 0.5)]))
}

/// Two elements, `EA = ρA = L = g₀ = 1`: one massive degree of freedom.
pub fn two_element_rod() -> CondensedStructure {
    condense(&rod(2, 1.0, 1.0, 1.0, &[(2, Side::Positive, 1.0)]))
}

pub fn condense(model: &StructuralModel) -> CondensedStructure {
    let n = model.dofs().len();
    CondensedStructure::new(MasslessContactModel::new(model, &Drop).unwrap(), n).unwrap()
}

/// The contacts of a structure whose contacts are stops at single degrees of freedom.
pub fn stops(model: &StructuralModel) -> Vec<DofContact> {
    model.contacts().iter().map(|c| c.single_dof().unwrap()).collect()
}

/// The same structure with its stops on springs of the given stiffness; one that is not finite stays rigid.
pub fn on_springs(model: &StructuralModel, stiffness: &[f64]) -> StructuralModel {
    let contacts = model.contacts().iter().zip(stiffness).map(|(c, &stiffness)| Contact {
        law: if stiffness.is_finite() { ContactLaw::Elastic { stiffness } } else { ContactLaw::Rigid },
        ..c.clone()
    });
    StructuralModel::new(model.mass().clone(), model.stiffness().clone(), model.dofs().to_vec(), contacts.collect())
        .unwrap()
}

/// Conventional harmonic balance: the contact nodes move in harmonics, with their mass or without.
pub fn condense_tips(model: &StructuralModel, rule: Option<&dyn MassRedistribution>) -> CondensedStructure {
    let n = model.dofs().len();
    CondensedStructure::new(MasslessContactModel::with_spring_tips(model, rule).unwrap(), n).unwrap()
}

pub fn problem(
    structure: &CondensedStructure,
    mode: usize,
    harmonics: usize,
    symmetry: Symmetry,
    switching: Switching,
) -> (PeriodicSystem, Grazing) {
    let start = grazing(structure, mode).unwrap();
    let settings = (PeriodicSettings { harmonics, switching, ..PeriodicSettings::default() }, symmetry);
    let solver = solver_by_name("active-set").unwrap();
    (structure.conservative_mode(settings, start.scales(), solver.as_ref()).unwrap(), start)
}

/// Follows the branch from grazing to `ratio` times the energy there.
pub fn follow(problem: &mut PeriodicSystem, start: &Grazing, ratio: f64) -> Branch {
    let dim = problem.dim();
    let (x, direction) = problem.start(start);
    let bounds = vec![Bound { coordinate: dim, min: -8.0, max: ratio.ln() }];
    let continuation = Continuation { bounds, max_points: 2000, ..Default::default() };
    continuation.run(problem, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap()
}

/// Frequency over that at grazing at `ratio` times the energy of grazing.
pub fn frequency_ratio(structure: &CondensedStructure, harmonics: usize, switching: Switching, ratio: f64) -> f64 {
    let (mut problem, start) = problem(structure, 1, harmonics, Symmetry::Even, switching);
    let branch = follow(&mut problem, &start, ratio);
    let last = branch.points.last().unwrap();
    assert!((last.p - ratio.ln()).abs() < 1e-12, "ended at {} of {ratio}: {:?}", last.p.exp(), branch.stop);
    last.x[problem.n_coefficients()]
}

/// Newton's method at the fixed parameter `p`: unknowns and largest residual.
pub fn settle(problem: &mut PeriodicSystem, mut x: Vec<f64>, p: f64) -> (Vec<f64>, f64) {
    let n = problem.dim();
    let mut at = Linearization::new(n);
    for _ in 0..40 {
        problem.linearize(&x, p, &mut at).unwrap();
        if at.residual_norm() < 2e-14 {
            break;
        }
        let jacobian = (0..n).map(|i| (0..n).map(|j| at.jacobian[(i, j)]).collect()).collect();
        let step = solve_dense(jacobian, at.residual.clone());
        x.iter_mut().zip(&step).for_each(|(x, s)| *x -= s);
    }
    problem.linearize(&x, p, &mut at).unwrap();
    (x, at.residual_norm())
}

/// Gaussian elimination with partial pivoting.
pub fn solve_dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        let (above, below) = a.split_at_mut(k + 1);
        let row = &above[k];
        for (i, lower) in below.iter_mut().enumerate() {
            let factor = lower[k] / row[k];
            if factor != 0.0 {
                lower[k..].iter_mut().zip(&row[k..]).for_each(|(l, r)| *l -= factor * r);
                b[k + 1 + i] -= factor * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}

pub fn dense(matrix: &SparseMatrix) -> Vec<Vec<f64>> {
    let full = matrix.to_dense();
    (0..full.nrows()).map(|i| (0..full.ncols()).map(|j| full[(i, j)]).collect()).collect()
}

/// Full matrices of a structure, the rows and columns of the contact degrees of freedom taken out of the mass by hand.
pub struct FullMatrices {
    pub k: Vec<Vec<f64>>,
    pub m: Vec<Vec<f64>>,
    pub contact: Vec<usize>,
}

impl FullMatrices {
    pub fn of(model: &StructuralModel) -> Self {
        let (k, mut m) = (dense(model.stiffness()), dense(model.mass()));
        let mut contact: Vec<usize> = stops(model).iter().map(|c| c.dof).collect();
        contact.sort_unstable();
        contact.dedup();
        for &c in &contact {
            m[c].fill(0.0);
            m.iter_mut().for_each(|row| row[c] = 0.0);
        }
        Self { k, m, contact }
    }

    pub fn size(&self) -> usize {
        self.k.len()
    }

    /// Largest defect of eq. (8) over all harmonics and rows without contact, over the largest `Σ_j |K_ij q_j|`.
    pub fn equation_8_defect(&self, point: &ModalPoint) -> f64 {
        let (mut defect, mut scale) = (0.0_f64, f64::MIN_POSITIVE);
        for n in 0..=point.coefficients.n_harmonics() {
            let nu2 = (n as f64 * point.omega).powi(2);
            for i in (0..self.size()).filter(|i| !self.contact.contains(i)) {
                let q = |j: usize| point.coefficients.of(j)[n];
                let row: num_complex::Complex64 =
                    (0..self.size()).map(|j| q(j) * (self.k[i][j] - nu2 * self.m[i][j])).sum();
                defect = defect.max(row.norm());
                scale = scale.max((0..self.size()).map(|j| (q(j) * self.k[i][j]).norm()).sum());
            }
        }
        defect / scale
    }

    /// Averaged kinetic energy `¼ Σ ν² q_nᴴ M q_n`.
    pub fn kinetic_energy(&self, point: &ModalPoint) -> f64 {
        (1..=point.coefficients.n_harmonics())
            .map(|n| 0.25 * (n as f64 * point.omega).powi(2) * self.square(&self.m, point, n))
            .sum()
    }

    fn square(&self, matrix: &[Vec<f64>], point: &ModalPoint, n: usize) -> f64 {
        let q: Vec<_> = (0..self.size()).map(|j| point.coefficients.of(j)[n]).collect();
        (0..q.len()).map(|i| (0..q.len()).map(|j| matrix[i][j] * (q[i].conj() * q[j]).re).sum::<f64>()).sum()
    }

    /// Static problem of the contact nodes, eq. (13): position without stops `b(τ)` of each contact degree of freedom.
    pub fn free_position(&self, point: &ModalPoint, tau: f64) -> Vec<f64> {
        let q: Vec<f64> = (0..self.size()).map(|j| point.coefficients.value(j, tau)).collect();
        let k_nn = self.contact.iter().map(|&i| self.contact.iter().map(|&j| self.k[i][j]).collect()).collect();
        let rhs = self
            .contact
            .iter()
            .map(|&i| -(0..q.len()).filter(|j| !self.contact.contains(j)).map(|j| self.k[i][j] * q[j]).sum::<f64>());
        solve_dense(k_nn, rhs.collect())
    }
}

/// Linear modes of the rod of [`rod`] with its tip massless, in closed form: between the ends `q_j = sin κj`, and
/// the tip, which has no mass and follows its neighbour, asks for `(1 + μ) sin κN = sin κ(N − 1)`,
/// `μ = ω² ρA l²/(6 EA) = (2 − 2 cos κ)/(4 + 2 cos κ)`.
pub struct RodMode {
    pub omega: f64,
    /// `q_1 … q_N`, not normalised.
    pub shape: Vec<f64>,
    /// `½ Σ qᵀ M q`.
    pub half_mass: f64,
}

pub fn rod_mode(elements: usize, ea: f64, rho_a: f64, length: f64, mode: usize) -> RodMode {
    let (n, l) = (elements as f64, length / elements as f64);
    let mu = |kappa: f64| (2.0 - 2.0 * kappa.cos()) / (4.0 + 2.0 * kappa.cos());
    let f = |kappa: f64| (1.0 + mu(kappa)) * (kappa * n).sin() - (kappa * (n - 1.0)).sin();
    // Between the frequencies of the held rod, κN = kπ, there is one root each.
    let held = |k: usize| std::f64::consts::PI * k as f64 / n;
    let kappa = bisect(f, held(mode - 1) + 1e-9, held(mode) - 1e-9);
    let mut shape: Vec<f64> = (1..elements).map(|j| (kappa * j as f64).sin()).collect();
    let mut square = 0.0;
    for j in 0..shape.len() {
        let next = shape.get(j + 1).copied().unwrap_or(0.0);
        square += rho_a * l / 6.0 * (4.0 * shape[j] * shape[j] + 2.0 * shape[j] * next);
    }
    shape.push(shape[elements - 2]);
    RodMode { omega: (6.0 * mu(kappa) * ea / (rho_a * l * l)).sqrt(), shape, half_mass: 0.5 * square }
}

impl RodMode {
    /// Averaged kinetic energy with the tip just reaching `gap`.
    pub fn grazing_energy(&self, gap: f64) -> f64 {
        let amplitude = gap / self.shape.last().unwrap();
        0.5 * self.half_mass * (self.omega * amplitude).powi(2)
    }
}

pub fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low).signum();
    assert!(f(high).signum() != sign, "no change of sign: f({low}) = {}, f({high}) = {}", f(low), f(high));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle).signum() == sign {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Slope of `log(error)` over `log(n)` by least squares: minus the order of convergence.
pub fn fitted_slope(errors: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = errors.iter().map(|(n, e)| (n.ln(), e.ln())).collect();
    let count = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|l| l.0).sum::<f64>() / count, logs.iter().map(|l| l.1).sum::<f64>() / count);
    let top: f64 = logs.iter().map(|l| (l.0 - mx) * (l.1 - my)).sum();
    top / logs.iter().map(|l| (l.0 - mx).powi(2)).sum::<f64>()
}
