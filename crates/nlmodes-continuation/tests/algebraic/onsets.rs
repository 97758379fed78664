//! Points at which several stiff pieces set in at once.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Boundary, Continuation, EventKind, Linearization, ParametricSystem, Scaling};

use crate::samples::{events, window};

/// `−v_j + K (v_j)₊^{3/2} = q_j π` for `v = B x/a`, `π = p/b`, as sums of these equations.
///
/// For each π > 0 each `v_j` is either open, `v_j = −q_j π`, or closed, `v_j ≈ (q_j π/K)^{2/3}`: 2ᵏ half-branches leave
/// the origin, to none of which a step as short as those that are permitted leads from another one.
pub struct Stops {
    count: usize,
    stiffness: f64,
    units: [f64; 2],
    /// The piece at the point evaluated last.
    piece: u64,
}

fn q(j: usize) -> f64 {
    0.8 + 0.3 * j as f64
}

/// B, and what the equations are sums with.
fn b(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { 0.3 / (1.0 + i as f64 + 2.0 * j as f64) }
}

fn sums(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { 0.2 * (i as f64 - 0.5 * j as f64) }
}

impl Stops {
    pub fn new(count: usize, stiffness: f64, units: [f64; 2]) -> Self {
        Self { count, stiffness, units, piece: 0 }
    }

    fn v(&self, x: &[f64]) -> Vec<f64> {
        let entry = |i: usize| (0..self.count).map(|j| b(i, j) * x[j] / self.units[0]).sum();
        (0..self.count).map(entry).collect()
    }

    fn piece_of(v: &[f64]) -> u64 {
        v.iter().rev().fold(0, |bits, v| 2 * bits + u64::from(*v > 0.0))
    }
}

impl ParametricSystem for Stops {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.count
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let (n, [a, unit], v) = (self.count, self.units, self.v(x));
        self.piece = Self::piece_of(&v);
        let set_in = |v: f64| self.stiffness * v.max(0.0).powf(1.5);
        let own: Vec<f64> = (0..n).map(|j| -v[j] + set_in(v[j]) - q(j) * p / unit).collect();
        let slope = |j: usize| -1.0 + 1.5 * self.stiffness * v[j].max(0.0).sqrt();
        for i in 0..n {
            out.residual[i] = (0..n).map(|j| sums(i, j) * own[j]).sum();
            for k in 0..n {
                out.jacobian[(i, k)] = (0..n).map(|j| sums(i, j) * slope(j) * b(j, k) / a).sum();
            }
            out.jacobian[(i, n)] = -(0..n).map(|j| sums(i, j) * q(j) / unit).sum::<f64>();
        }
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        let [a, unit] = self.units;
        let unknowns = (0..self.count).map(|_| a).chain([unit]).collect();
        Some(Scaling { unknowns, equations: vec![1.0; self.count] })
    }

    fn pattern(&self) -> u64 {
        self.piece
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        Some(Self::piece_of(&self.v(z)))
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let (from, to) = (Self::piece_of(&self.v(from)), Self::piece_of(&self.v(to)));
        if (from ^ to).count_ones() != 1 {
            return None;
        }
        let (i, sign) = ((from ^ to).trailing_zeros() as usize, if to > from { -1.0 } else { 1.0 });
        let (n, a) = (self.count, self.units[0]);
        Some(Boundary::new(move |z| sign * (0..n).map(|j| b(i, j) * z[j] / a).sum::<f64>()))
    }
}

#[test]
fn all_arms_of_a_point_at_which_stops_are_reached_at_once_are_found_without_curves_around_it() {
    for (count, units) in [(2, [1.0, 1.0]), (2, [1e-3, 50.0]), (3, [1.0, 1.0]), (3, [64.0, 1e-4])] {
        for (start, stiffness) in (0..10).flat_map(|start| [(start, 1e5), (start, 3e6)]) {
            let case = format!("{count} stops, units {units:?}, stiffness {stiffness:e}, start {start}");
            let mut system = Stops::new(count, stiffness, units);
            let [a, unit] = units;
            let from = 0.31 + 0.0123 * f64::from(start);
            // All are open: v = −q π.
            let x = open(count).iter().map(|x| x * from * a).collect::<Vec<f64>>();
            let direction: Vec<f64> = x.iter().map(|x| -x).chain([-from * unit]).collect();
            let settings = Continuation { max_points: 400, ..window(count, -0.5 * unit, 0.6 * unit) };
            let branch = settings.run(&mut system, &x, from * unit, &direction, |_| ControlFlow::Continue(())).unwrap();
            assert_eq!(events(&branch, |e| *e == EventKind::BranchPoint).len(), 1, "{case}: {:?}", branch.stop);
            let crossing = &branch.crossings[0];
            let sizes = (0..count).map(|_| a).chain([unit]);
            assert!(crossing.z.iter().zip(sizes).all(|(z, size)| (z / size).abs() < 1e-7), "{case}");
            assert_eq!((crossing.arms.len() + 1, crossing.complete), (1 << count, true), "{case}");
            // Each is another one, that has all but these stops open.
            let mut sets: Vec<u64> = crossing
                .arms
                .iter()
                .map(|arm| {
                    let (v, pi) = (system.v(&arm.start.z), arm.start.z[count] / unit);
                    for (j, v) in v.iter().enumerate() {
                        let force = -v.min(0.0) / q(j) + stiffness * v.max(0.0).powf(1.5) / q(j) - v.max(0.0) / q(j);
                        assert!((force / pi - 1.0).abs() < 1e-3, "{case}: {v:e} at {pi:e}");
                    }
                    Stops::piece_of(&v)
                })
                .collect();
            sets.sort_unstable();
            assert_eq!(sets, (1..1 << count).collect::<Vec<u64>>(), "{case}");
            assert!(branch.evaluations < 2500, "{case}: {} evaluations", branch.evaluations);
        }
    }
}

/// `−B⁻¹ q`, by Gauss-Seidel.
pub fn open(n: usize) -> Vec<f64> {
    let mut x = vec![0.0; n];
    for _ in 0..200 {
        for i in 0..n {
            let others: f64 = (0..n).filter(|j| *j != i).map(|j| b(i, j) * x[j]).sum();
            x[i] = -q(i) - others;
        }
    }
    x
}
