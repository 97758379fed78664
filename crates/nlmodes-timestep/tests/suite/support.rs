//! Structures and motions with known answers.
#![allow(dead_code)]

use std::f64::consts::PI;

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes_linalg::{DenseLu, Mat};
use nlmodes_model::{Drop, MassRedistribution, MasslessContactModel, Side, StructuralModel};
use nlmodes_timestep::ContactDynamics;

/// Clamped-free rod with `EA = ρA = L = 1` and a rigid stop at a distance of 1 from its tip, consistent mass.
pub fn unit_rod(elements: usize) -> StructuralModel {
    rod_with(elements, &[Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0)])
}

pub fn rod_with(elements: usize, stops: &[Stop]) -> StructuralModel {
    rod_of(1.0, elements, stops)
}

/// The same with another cross-section.
pub fn rod_of(area: f64, elements: usize, stops: &[Stop]) -> StructuralModel {
    let rod = Rod {
        material: Material::new(1.0, 1.0).unwrap(),
        area,
        mesh: Mesh::uniform(1.0, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    rod.assemble(stops).unwrap()
}

/// The beam of Section 4 with `elements` elements.
pub fn beam(elements: usize, stops: &[Stop]) -> StructuralModel {
    let beam = Beam {
        material: Material::new(181.36e9, 7730.0).unwrap().with_poissons_ratio(0.3).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap(),
        mesh: Mesh::graded(0.62975520, elements, 9.1958536).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    beam.assemble(stops).unwrap()
}

pub fn massless(model: &StructuralModel) -> MasslessContactModel {
    with_rule(model, &Drop)
}

pub fn with_rule(model: &StructuralModel, rule: &dyn MassRedistribution) -> MasslessContactModel {
    MasslessContactModel::new(model, rule).unwrap()
}

pub fn dynamics(model: &StructuralModel) -> ContactDynamics {
    ContactDynamics::new(massless(model)).unwrap()
}

/// The motion of the rod of two elements with amplitude `A` while free.
///
/// The massive node x has `m = 1/3`; when free it has a spring of 2 about 0, and with the tip at the stop one of 4
/// about ½. At `x = 1` both have the same strain energy 1 and the speed is continuous: `6 (A² − 1) = 12 (B² − ¼)`.
pub struct ClosedForm {
    pub a: f64,
    pub b: f64,
    /// Half the contact phase and half the free phase, s.
    pub half: [f64; 2],
}

pub const OMEGA_FREE: f64 = 2.449_489_742_783_178;
pub const OMEGA_CONTACT: f64 = 3.464_101_615_137_754_6;

impl ClosedForm {
    pub fn new(a: f64) -> Self {
        let b = (0.25 + 0.5 * (a * a - 1.0)).sqrt();
        Self { a, b, half: [(0.5 / b).acos() / OMEGA_CONTACT, (PI - (1.0 / a).acos()) / OMEGA_FREE] }
    }

    pub fn period(&self) -> f64 {
        2.0 * (self.half[0] + self.half[1])
    }

    pub fn omega(&self) -> f64 {
        2.0 * PI / self.period()
    }

    /// `⟨½ m ẋ²⟩` with `∫ sin² = ½ (θ − sin θ cos θ)` over each phase.
    pub fn kinetic(&self) -> f64 {
        let theta = [OMEGA_CONTACT * self.half[0], OMEGA_FREE * self.half[1]];
        let integral = theta.map(|theta| theta - theta.sin() * theta.cos());
        let contact = 2.0 * self.b * self.b / OMEGA_CONTACT * integral[0];
        let free = self.a * self.a / OMEGA_FREE * integral[1];
        (contact + free) / self.period()
    }

    /// Massive node and tip at the instant `t`, which is in the middle of contact at 0.
    pub fn position(&self, t: f64) -> [f64; 2] {
        let t = t.rem_euclid(self.period());
        let t = t.min(self.period() - t);
        let x = if t < self.half[0] {
            0.5 + self.b * (OMEGA_CONTACT * t).cos()
        } else {
            -self.a * (OMEGA_FREE * (0.5 * self.period() - t)).cos()
        };
        [x, x.min(1.0)]
    }
}

/// Newton's method at the fixed parameter `p`: unknowns and largest residual.
pub fn settle<S: ParametricSystem>(system: &mut S, mut x: Vec<f64>, p: f64) -> (Vec<f64>, f64) {
    let n = system.dim();
    let mut at = Linearization::new(n);
    let mut best = (x.clone(), f64::INFINITY);
    for _ in 0..40 {
        system.linearize(&x, p, &mut at).unwrap();
        if at.residual_norm() < best.1 {
            best = (x.clone(), at.residual_norm());
        } else if best.1 < 1e-11 {
            break;
        }
        let mut step = at.residual.clone();
        let square = Mat::from_fn(n, n, |i, j| at.jacobian[(i, j)]);
        DenseLu::factor(&square).unwrap().solve_in_place(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, s)| *x -= s);
    }
    best
}

/// Newton's method with the unknown `index` fixed at its value in `x`: unknowns followed by the parameter, and
/// residual.
pub fn settle_fixing<S: ParametricSystem>(system: &mut S, x: &[f64], p: f64, index: usize) -> (Vec<f64>, f64) {
    let n = system.dim();
    let mut z: Vec<f64> = x.iter().copied().chain([p]).collect();
    let others: Vec<usize> = (0..=n).filter(|j| *j != index).collect();
    let mut at = Linearization::new(n);
    let mut best = (z.clone(), f64::INFINITY);
    for _ in 0..40 {
        system.linearize(&z[..n], z[n], &mut at).unwrap();
        if at.residual_norm() < best.1 {
            best = (z.clone(), at.residual_norm());
        } else if best.1 < 1e-11 {
            break;
        }
        let mut step = at.residual.clone();
        let square = Mat::from_fn(n, n, |i, j| at.jacobian[(i, others[j])]);
        DenseLu::factor(&square).unwrap().solve_in_place(&mut step);
        others.iter().zip(&step).for_each(|(&j, s)| z[j] -= s);
    }
    best
}

/// Slope of `log(error)` over `log(n)` by least squares: minus the order of convergence.
pub fn fitted_slope(errors: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = errors.iter().map(|(n, e)| (n.ln(), e.ln())).collect();
    let count = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|l| l.0).sum::<f64>() / count, logs.iter().map(|l| l.1).sum::<f64>() / count);
    let top: f64 = logs.iter().map(|l| (l.0 - mx) * (l.1 - my)).sum();
    top / logs.iter().map(|l| (l.0 - mx).powi(2)).sum::<f64>()
}
