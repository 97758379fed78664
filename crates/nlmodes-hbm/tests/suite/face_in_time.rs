//! A face of three nodes that touch one after the other, in open modes, against an integration in time of the structure
//! itself.
//!
//! The reference owes nothing to the reduction or to harmonics: it steps the masses of the structure, finds the contact
//! forces of each instant among all eight sets of closed contacts, and closes the period by Newton's method with
//! differences. What is left between the two is the truncation of the harmonics, and that must vanish as their number
//! grows.

use crate::support;

use nlmodes_hbm::{CondensedStructure, Switching, Symmetry};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_modal::ModalPoint;
use nlmodes_model::reduction::{ModeCount, OpenModes, ReducedStructure};
use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use support::{fitted_slope, follow, problem, solve_dense};

type Matrix = [[f64; 3]; 3];

/// Three masses that are coupled by their mass matrix, and three nodes of a face without mass, coupled among themselves
/// and each to a mass.
const MASS: Matrix = [[2.0, 0.3, 0.1], [0.3, 1.5, 0.4], [0.1, 0.4, 1.0]];
const INNER: Matrix = [[5.0, -2.0, 0.0], [-2.0, 6.0, -1.5], [0.0, -1.5, 4.5]];
const FACE: Matrix = [[8.0, -1.0, 0.5], [-1.0, 9.0, -1.2], [0.5, -1.2, 7.0]];
const COUPLING: Matrix = [[-3.0, -0.4, 0.0], [-0.2, -3.5, -0.5], [0.0, -0.6, -2.5]];
const GAPS: [f64; 3] = [0.90, 1.30, 0.92];

/// Units: a length in m, a stiffness in N/m, a mass in kg.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    stiffness: f64,
    mass: f64,
}

impl Units {
    fn structure(self) -> StructuralModel {
        let (mut m, mut k) = (Vec::new(), Vec::new());
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            m.push((i, j, self.mass * MASS[i][j]));
            k.push((i, j, self.stiffness * INNER[i][j]));
            k.push((3 + i, 3 + j, self.stiffness * FACE[i][j]));
            k.extend([(i, 3 + j, self.stiffness * COUPLING[i][j]), (3 + j, i, self.stiffness * COUPLING[i][j])]);
        }
        let dofs = (0..6).map(|node| Dof { node, position: 0.0, kind: DofKind::X }).collect();
        let contacts = (0..3).map(|i| Contact::rigid(3 + i, Side::Positive, self.length * GAPS[i])).collect();
        let [m, k] = [m, k].map(|entries| sparse_from_triplets(6, 6, &entries).unwrap());
        StructuralModel::new(m, k, dofs, contacts).unwrap()
    }
}

/// `x` with `a x = b`.
fn solve(a: &Matrix, b: [f64; 3]) -> [f64; 3] {
    let x = solve_dense(a.iter().map(|row| row.to_vec()).collect(), b.to_vec());
    [x[0], x[1], x[2]]
}

fn times(a: &Matrix, x: &[f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|j| a[i][j] * x[j]).sum())
}

fn transposed(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

fn inverse(a: &Matrix) -> Matrix {
    transposed(&[0, 1, 2].map(|j| solve(a, [0, 1, 2].map(|i| f64::from(u8::from(i == j))))))
}

/// The structure in units of one, with what each step needs.
struct InTime {
    /// `M⁻¹`
    inverse_mass: Matrix,
    /// Flexibility of the face with the masses held: `g = g₀ − u + A λ`.
    flexibility: Matrix,
    /// Those of the sets of closed contacts that are not empty, each with the inverse of its rows of `A`.
    sets: Vec<Matrix>,
}

/// A motion after half a period.
struct Half {
    velocity: [f64; 3],
    kinetic_energy: f64,
    mean_forces: [f64; 3],
}

impl InTime {
    fn new() -> Self {
        let flexibility = inverse(&FACE);
        let of_set = |set: u8| {
            let is_in = |i: usize| set & (1 << i) != 0;
            // Ones on the diagonal represent the contacts that are open.
            let rows = [0, 1, 2].map(|i| {
                [0, 1, 2].map(|j| match (is_in(i) && is_in(j), i == j) {
                    (true, _) => flexibility[i][j],
                    (false, same) => f64::from(u8::from(same)),
                })
            });
            let mut all = inverse(&rows);
            (0..3).for_each(|i| (0..3).for_each(|j| all[i][j] *= f64::from(u8::from(is_in(i) && is_in(j)))));
            all
        };
        Self { inverse_mass: inverse(&MASS), flexibility, sets: (0..8).map(of_set).collect() }
    }

    /// Displacement of the face without contact, and the contact forces.
    fn contact(&self, q: &[f64; 3]) -> ([f64; 3], [f64; 3]) {
        let pull = times(&transposed(&COUPLING), q);
        let free = times(&self.flexibility, &pull.map(|f| -f));
        let over = [0, 1, 2].map(|i| free[i] - GAPS[i]);
        let forces = self.sets.iter().map(|set| times(set, &over));
        let fits = |forces: &[f64; 3]| {
            let gap = times(&self.flexibility, forces);
            (0..3).all(|i| forces[i] >= -1e-12 && gap[i] - over[i] >= -1e-12)
        };
        (free, forces.into_iter().find(fits).expect("a complementarity problem with a positive definite matrix"))
    }

    fn acceleration(&self, q: &[f64; 3]) -> ([f64; 3], [f64; 3]) {
        let (free, forces) = self.contact(q);
        let back = times(&self.flexibility, &forces);
        let face = [0, 1, 2].map(|i| free[i] - back[i]);
        let (inner, coupled) = (times(&INNER, q), times(&COUPLING, &face));
        (times(&self.inverse_mass, &[0, 1, 2].map(|i| -inner[i] - coupled[i])), forces)
    }

    /// Half a period from rest, by the Runge-Kutta method of fourth order; sums by Simpson's rule.
    fn half(&self, start: [f64; 3], period: f64) -> Half {
        const STEPS: usize = 3000;
        let h = 0.5 * period / STEPS as f64;
        let (mut q, mut v) = (start, [0.0; 3]);
        let mut half = Half { velocity: v, kinetic_energy: 0.0, mean_forces: [0.0; 3] };
        let ahead = |x: &[f64; 3], dx: &[f64; 3], by: f64| [0, 1, 2].map(|i| x[i] + by * dx[i]);
        let kinetic = |v: &[f64; 3]| 0.5 * v.iter().zip(times(&MASS, v)).map(|(v, p)| v * p).sum::<f64>();
        for _ in 0..STEPS {
            let (a1, f1) = self.acceleration(&q);
            let v2 = ahead(&v, &a1, 0.5 * h);
            let (a2, f2) = self.acceleration(&ahead(&q, &v, 0.5 * h));
            let v3 = ahead(&v, &a2, 0.5 * h);
            let (a3, f3) = self.acceleration(&ahead(&q, &v2, 0.5 * h));
            let v4 = ahead(&v, &a3, h);
            let (a4, f4) = self.acceleration(&ahead(&q, &v3, h));
            let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * b + 2.0 * c + d) / 6.0;
            let middle = kinetic(&[0, 1, 2].map(|i| 0.5 * (v2[i] + v3[i])));
            half.kinetic_energy += kinetic(&v) / 6.0 + 4.0 / 6.0 * middle;
            q = [0, 1, 2].map(|i| q[i] + h * mean(v[i], v2[i], v3[i], v4[i]));
            v = [0, 1, 2].map(|i| v[i] + h * mean(a1[i], a2[i], a3[i], a4[i]));
            half.kinetic_energy += kinetic(&v) / 6.0;
            (0..3).for_each(|i| half.mean_forces[i] += mean(f1[i], f2[i], f3[i], f4[i]) / STEPS as f64);
        }
        half.kinetic_energy /= STEPS as f64;
        half.velocity = v;
        half
    }

    /// The periodic motion of this mean kinetic energy near a start and a period: period and mean forces.
    fn periodic(&self, start: [f64; 3], period: f64, energy: f64) -> (f64, [f64; 3]) {
        let residual = |x: &[f64; 4]| {
            let half = self.half([x[0], x[1], x[2]], x[3]);
            [half.velocity[0], half.velocity[1], half.velocity[2], half.kinetic_energy / energy - 1.0]
        };
        let mut x = [start[0], start[1], start[2], period];
        for _ in 0..12 {
            let r = residual(&x);
            if r.iter().all(|r| r.abs() < 1e-10) {
                return (x[3], self.half([x[0], x[1], x[2]], x[3]).mean_forces);
            }
            let column = |j: usize| {
                let mut beside = x;
                beside[j] += 1e-6;
                residual(&beside).iter().zip(&r).map(|(b, r)| (b - r) * 1e6).collect::<Vec<_>>()
            };
            let columns: Vec<_> = (0..4).map(column).collect();
            let jacobian = (0..4).map(|i| (0..4).map(|j| columns[j][i]).collect()).collect();
            let step = solve_dense(jacobian, r.to_vec());
            x.iter_mut().zip(&step).for_each(|(x, s)| *x -= s);
        }
        panic!("no periodic motion near {start:?}");
    }
}

/// The point at twice the energy of grazing, with so many harmonics, and where its masses are half a period from the
/// contact.
fn harmonic(units: Units, harmonics: usize) -> (ModalPoint, [f64; 3]) {
    let model = units.structure();
    let open = OpenModes::of_model(&model, ModeCount::Lowest(3)).unwrap();
    let reduced = ReducedStructure::new(&open, &[(3, 0.0), (4, 0.0), (5, 0.0)]).unwrap();
    let massless = MasslessContactModel::new(reduced.model(), &Drop).unwrap();
    let structure = CondensedStructure::new(massless, 3).unwrap();
    let (mut problem, start) = problem(&structure, 1, harmonics, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 2.0);
    let last = branch.points.last().unwrap();
    assert!((last.p - 2.0_f64.ln()).abs() < 1e-12, "{:?}", branch.stop);
    let point = structure.modal_point(&mut problem, &last.x, last.residual).unwrap();
    let eta = [0, 1, 2].map(|r| point.coefficients.value(r, std::f64::consts::PI));
    let at_rest = [0, 1, 2].map(|i| (0..3).map(|r| open.shapes()[(i, r)] * eta[r]).sum::<f64>() / units.length);
    (point, at_rest)
}

#[test]
fn forces_of_a_face_in_open_modes_converge_to_those_in_time() {
    let in_time = InTime::new();
    for units in [Units { length: 1.0, stiffness: 1.0, mass: 1.0 }, Units { length: 1e-3, stiffness: 2e8, mass: 0.4 }] {
        let (force, second) = (units.stiffness * units.length, (units.mass / units.stiffness).sqrt());
        let (mut of_forces, mut of_frequency) = (Vec::new(), Vec::new());
        for harmonics in [6, 12, 24, 48] {
            let (point, start) = harmonic(units, harmonics);
            let energy = point.kinetic_energy / (force * units.length);
            let (period, expected) = in_time.periodic(start, std::f64::consts::TAU / (point.omega * second), energy);
            let found = point.contacts.iter().map(|contact| contact.mean_force / force);
            let whole: f64 = expected.iter().sum();
            let error = found.zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
            assert!(expected.iter().all(|force| *force > 0.01 * whole), "all three touch: {expected:?}");
            of_forces.push((harmonics as f64, error / whole));
            of_frequency.push((harmonics as f64, (point.omega * second * period / std::f64::consts::TAU - 1.0).abs()));
        }
        // Forces have corners where contacts close and open: their harmonics fall as n⁻², and what is cut off of means
        // and frequencies faster.
        assert!(fitted_slope(&of_forces) < -2.0, "{of_forces:?}");
        assert!(fitted_slope(&of_frequency) < -2.0, "{of_frequency:?}");
        assert!(of_forces[3].1 < 1e-6 && of_frequency[3].1 < 1e-7, "{of_forces:?}, {of_frequency:?}");
    }
}
