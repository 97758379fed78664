//! Two masses on springs, in harmonics and in time.

use std::f64::consts::TAU;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{Damping, ResponseModel, ResponsePoint};
use nlmodes_linalg::{Mat, sparse_from_triplets};
use nlmodes_model::{Contact, ContactLaw, Dof, DofKind, Side, StructuralModel};
use nlmodes_timestep::{ForcedMotion, ForcedStructure};
use num_complex::Complex64;

/// Two masses on springs (NLvib's third example), `M = m I`, `K = k [1 −1; −1 2]`, `C = damping K √(m/k)`, a spring of
/// `stop k` (100 in the example) at the distance `gap` from the first one, a force at the second.
#[derive(Clone, Copy)]
pub struct Masses {
    pub mass: f64,
    pub stiffness: f64,
    /// Negative where the stop presses at rest.
    pub gap: f64,
    /// Amplitude of the force over that which would hold the second spring stretched by the size of the gap.
    pub force: f64,
    /// 0.03 in the example.
    pub damping: f64,
    /// Stiffness of the stop over that of the springs.
    pub stop: f64,
}

impl Masses {
    pub fn frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// The size of the gap, m; a millimetre where there is none.
    pub fn size(&self) -> f64 {
        if self.gap == 0.0 { 1e-3 } else { self.gap.abs() }
    }

    pub fn model(&self) -> ResponseModel {
        let k = |i, j, v: f64| (i, j, v * self.stiffness);
        let mass = sparse_from_triplets(2, 2, &[(0, 0, self.mass), (1, 1, self.mass)]).unwrap();
        let stiffness = [k(0, 0, 1.0), k(0, 1, -1.0), k(1, 0, -1.0), k(1, 1, 2.0)];
        let stiffness = sparse_from_triplets(2, 2, &stiffness).unwrap();
        let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
        let law = ContactLaw::Elastic { stiffness: self.stop * self.stiffness };
        let stop = Contact { law, ..Contact::rigid(0, Side::Positive, self.gap) };
        let model = StructuralModel::new(mass, stiffness, vec![dof(0), dof(1)], vec![stop]).unwrap();
        let open = OpenModes::of_model(&model, ModeCount::Lowest(2)).unwrap();
        let damping = Damping::Rayleigh { mass: 0.0, stiffness: self.damping / self.frequency() };
        let mut model = ResponseModel::new(open, &damping).unwrap();
        model.push_force(1, 1.0, 1, 0.0).unwrap();
        model.set_drive(1).unwrap();
        model
    }

    /// The exact motion over `subharmonic` periods of the load near a point, where shooting finds one.
    pub fn exact(&self, model: &ResponseModel, point: &ResponsePoint, subharmonic: usize) -> Option<ForcedMotion> {
        let of = model.structure();
        let m = of.n_modes();
        let damping = Mat::from_fn(m, m, |i, j| of.damping().entry(i, j));
        let (omega_squared, rows, a) = (of.omega_squared(), of.rows(), of.compliance().a());
        let mut exact = ForcedStructure::new(omega_squared, &damping, rows, a, of.gaps()).unwrap();
        let modal: Vec<Complex64> = model.row(1).unwrap().modes.iter().map(|v| Complex64::from(*v)).collect();
        exact.push_load(1, &modal, &[Complex64::default()]).unwrap();
        let value = |k: usize, order: i32| -> f64 {
            let nu = |n: usize| Complex64::new(0.0, n as f64 * point.motion.at.omega);
            point.motion.eta.iter().enumerate().map(|(n, eta)| (nu(n).powi(order) * eta[k]).re).sum()
        };
        let near: Vec<f64> = (0..m).map(|k| value(k, 0)).chain((0..m).map(|k| value(k, 1))).collect();
        exact.periodic(point.level, point.omega, subharmonic, &near).ok()
    }

    pub fn level(&self) -> f64 {
        self.force * self.stiffness * self.size()
    }

    /// Accelerations, in the state `[q₁, q₂, q̇₁, q̇₂]`.
    fn rate(&self, t: f64, omega: f64, s: &[f64; 4]) -> [f64; 4] {
        let (k, c) = (self.stiffness, self.damping * self.stiffness / self.frequency());
        let [q, p] = [[s[0], s[1]], [s[2], s[3]]];
        let along = |v: [f64; 2]| [v[0] - v[1], 2.0 * v[1] - v[0]];
        let (elastic, viscous) = (along(q), along(p));
        let stop = self.stop * k * (q[0] - self.gap).max(0.0);
        let a = (-k * elastic[0] - c * viscous[0] - stop) / self.mass;
        let b = (-k * elastic[1] - c * viscous[1] + self.level() * (omega * t).cos()) / self.mass;
        [p[0], p[1], a, b]
    }

    /// The state at the beginning of a period of a point; `subharmonic` periods of the load are one of the motion.
    pub fn state(&self, model: &ResponseModel, point: &ResponsePoint, subharmonic: usize) -> [f64; 4] {
        let of = |dof: usize, order: i32| -> f64 {
            let q = model.displacement(&model.row(dof).unwrap(), &point.motion, subharmonic);
            let nu = |n: usize| Complex64::new(0.0, n as f64 * point.motion.at.omega);
            q.iter().enumerate().map(|(n, z)| (nu(n).powi(order) * z).re).sum()
        };
        [of(0, 0), of(1, 0), of(0, 1), of(1, 1)]
    }

    /// Largest difference of two states in units of the gap.
    pub fn distance(&self, omega: f64, a: &[f64; 4], b: &[f64; 4]) -> f64 {
        (0..4).map(|i| (a[i] - b[i]).abs() / if i < 2 { 1.0 } else { omega }).fold(0.0, f64::max) / self.size()
    }

    /// The state after `periods` of the load by the classical Runge-Kutta method, and the amplitude of the second mass
    /// whose period this is.
    pub fn integrate(&self, omega: f64, start: [f64; 4], periods: usize) -> ([f64; 4], Complex64) {
        let steps = 4_000 * periods;
        let h = TAU / omega * periods as f64 / steps as f64;
        let add = |s: &[f64; 4], k: &[f64; 4], h: f64| [0, 1, 2, 3].map(|i| s[i] + h * k[i]);
        let (mut s, mut fundamental) = (start, Complex64::default());
        for j in 0..steps {
            let t = h * j as f64;
            fundamental += Complex64::cis(-omega / periods as f64 * t) * (2.0 * s[1] / steps as f64);
            let a = self.rate(t, omega, &s);
            let b = self.rate(t + 0.5 * h, omega, &add(&s, &a, 0.5 * h));
            let c = self.rate(t + 0.5 * h, omega, &add(&s, &b, 0.5 * h));
            let d = self.rate(t + h, omega, &add(&s, &c, h));
            s = [0, 1, 2, 3].map(|i| s[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        (s, fundamental)
    }

    /// The motion of this many periods near a state, by shooting.
    pub fn shoot(&self, omega: f64, start: [f64; 4], periods: usize) -> ([f64; 4], Complex64) {
        let sizes = [1.0, 1.0, omega, omega].map(|v| v * self.size());
        let off = |s: &[f64; 4]| {
            let end = self.integrate(omega, *s, periods).0;
            [0, 1, 2, 3].map(|i| (end[i] - s[i]) / sizes[i])
        };
        let norm = |v: &[f64; 4]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let (mut s, mut at) = (start, off(&start));
        for _ in 0..12 {
            let mut rows = [[0.0; 5]; 4];
            for j in 0..4 {
                let mut beside = s;
                beside[j] += 1e-6 * sizes[j];
                let moved = off(&beside);
                (0..4).for_each(|i| rows[i][j] = (moved[i] - at[i]) / 1e-6);
            }
            (0..4).for_each(|i| rows[i][4] = -at[i]);
            let step = solve(rows);
            // Shorter steps where a contact is lost or won on the way.
            let tried =
                [1.0, 0.5, 0.25, 0.1, 0.03].map(|share| [0, 1, 2, 3].map(|i| s[i] + share * step[i] * sizes[i]));
            let Some((next, left)) = tried.iter().map(|s| (*s, off(s))).find(|(_, left)| norm(left) < norm(&at)) else {
                break;
            };
            (s, at) = (next, left);
            if norm(&at) < 1e-8 {
                break;
            }
        }
        assert!(norm(&at) < 1e-6, "shooting ends with {at:?}");
        (s, self.integrate(omega, s, periods).1)
    }
}

/// Gauss-Jordan elimination of `[A | b]`.
fn solve(mut rows: [[f64; 5]; 4]) -> [f64; 4] {
    for k in 0..4 {
        let pivot = (k..4).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap();
        rows.swap(k, pivot);
        let own = rows[k];
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / own[k];
            row.iter_mut().zip(own).for_each(|(r, o)| *r -= factor * o);
        }
    }
    [0, 1, 2, 3].map(|i| rows[i][4] / rows[i][i])
}
