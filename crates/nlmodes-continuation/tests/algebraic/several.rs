//! Points at which several directions become free at once, and such points close together.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{
    Branch, Continuation, EventKind, Linearization, ParametricSystem, StepSettings, StopReason,
};

use crate::samples::{events, window};
use crate::units::InUnits;

const CROSSING: fn(&EventKind) -> bool = |e| *e == EventKind::BranchPoint;

/// `(p − c_i) x_i − x_i³ − g x_i Σ x_j² = 0`: the normal form with the symmetry of a cube where all c are zero; modes
/// of a stripe otherwise.
pub struct Modes {
    pub at: Vec<f64>,
    pub g: f64,
}

impl ParametricSystem for Modes {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.at.len()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let n = x.len();
        let sum: f64 = x.iter().map(|x| x * x).sum();
        for i in 0..n {
            let rest = p - self.at[i] - self.g * sum;
            out.residual[i] = x[i] * (rest - x[i] * x[i]);
            (0..n).for_each(|j| out.jacobian[(i, j)] = -2.0 * self.g * x[i] * x[j]);
            out.jacobian[(i, i)] += rest - 3.0 * x[i] * x[i];
            out.jacobian[(i, n)] = x[i];
        }
        Ok(())
    }
}

fn along_zero<S: ParametricSystem<Error = Infallible>>(settings: &Continuation, mut system: S, from: f64) -> Branch {
    let n = system.dim();
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    settings.run(&mut system, &vec![0.0; n], from, &direction, |_| ControlFlow::Continue(())).unwrap()
}

/// Half-branches of the cubic normal form but for the way back: each unknown is zero or one of two, and zero goes on.
fn n_onward(n: u32) -> usize {
    3_usize.pow(n)
}

#[test]
fn a_branch_point_of_one_to_four_free_directions_is_found_from_any_start_in_any_units() {
    for (n, starts) in [(1, 100), (2, 100), (3, 100), (4, 100)] {
        for [x, p, residual] in [[1.0, 1.0, 1.0], [1.0, 1.0, 10.0], [0.01, 1e3, 1e6]] {
            for k in 0..starts {
                let from = -0.2 - 0.00731 * f64::from(k);
                let g = 0.3 + 0.004 * f64::from(k);
                let system = InUnits { inner: Modes { at: vec![0.0; n], g }, x, p, residual };
                let branch = along_zero(&window(n, -p, 0.5 * p), system, from * p);
                let case = format!("n = {n}, from {from}, units {x} {p} {residual}");
                assert_eq!(branch.stop, StopReason::Bound { coordinate: n, value: 0.5 * p }, "{case}");
                assert!(branch.points.iter().all(|q| q.x.iter().all(|v| v.abs() < 1e-7 * x)), "{case}");
                let found = events(&branch, CROSSING);
                assert_eq!(found.len(), 1, "{case}: {:?}", found.iter().map(|q| q.p).collect::<Vec<_>>());
                assert!(found[0].p.abs() < 1e-6 * p, "{case}: {}", found[0].p);
                let crossing = &branch.crossings[0];
                let complete = crossing.arms.len() == n_onward(n as u32);
                assert!(crossing.arms.len() <= n_onward(n as u32), "{case}: {} arms", crossing.arms.len());
                assert_eq!(crossing.kernel, n + 1, "{case}");
                assert!(complete || !crossing.complete, "{case}: {} arms", crossing.arms.len());
            }
        }
    }
}

/// `Δu + p (u − u³) = 0` on a square of m × m inner nodes, in five-point differences times h².
pub struct Square {
    pub m: usize,
}

impl ParametricSystem for Square {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.m * self.m
    }

    fn linearize(&mut self, u: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let (m, n) = (self.m, u.len());
        (0..=n).for_each(|j| out.jacobian.col_mut(j).fill(0.0));
        for (i, &v) in u.iter().enumerate() {
            let (row, column) = (i / m, i % m);
            let neighbours = [
                (row > 0).then(|| i - m),
                (row + 1 < m).then(|| i + m),
                (column > 0).then(|| i - 1),
                (column + 1 < m).then(|| i + 1),
            ];
            out.residual[i] = p * (v - v * v * v) - 4.0 * v;
            out.jacobian[(i, i)] = p * (1.0 - 3.0 * v * v) - 4.0;
            out.jacobian[(i, n)] = v - v * v * v;
            for j in neighbours.into_iter().flatten() {
                out.residual[i] += u[j];
                out.jacobian[(i, j)] = 1.0;
            }
        }
        Ok(())
    }
}

#[test]
fn double_branch_points_of_a_square_are_found_on_all_grids() {
    for m in 2..=8 {
        let angle = |k: usize| (k as f64 * std::f64::consts::PI / (m + 1) as f64).cos();
        let (first, double) = (4.0 - 4.0 * angle(1), 4.0 - 2.0 * angle(1) - 2.0 * angle(2));
        for residual in [1.0, ((m + 1) * (m + 1)) as f64] {
            for share in [0.2, 0.3317, 0.77] {
                let to = double + 0.3 * (double - first);
                let system = InUnits { inner: Square { m }, x: 1.0, p: 1.0, residual };
                let branch = along_zero(&window(m * m, 0.0, to), system, share * first);
                let found: Vec<f64> = events(&branch, CROSSING).iter().map(|q| q.p).collect();
                assert_eq!(found.len(), 2, "m = {m}, from {share}: {found:?} for {first}, {double}");
                assert!(
                    (found[0] - first).abs() < 1e-6 && (found[1] - double).abs() < 1e-6,
                    "m = {m}: {found:?} {double}"
                );
                // Two modes and both their sums and differences, each with two signs, and the branch itself; twice as
                // many half-branches on a ring of eight nodes.
                let expected = if m == 3 { 17 } else { 9 };
                let crossing = &branch.crossings[1];
                assert_eq!((crossing.arms.len(), crossing.kernel), (expected, 3), "m = {m}, from {share}");
                assert!(branch.crossings[0].complete && !crossing.complete, "m = {m}, from {share}");
            }
        }
    }
}

/// Units of unknowns, parameter and residual, and whether all half-branches must be found in them.
const UNITS: [([f64; 3], bool); 4] =
    [([1.0, 1.0, 1.0], true), ([0.5, 0.5, 16.0], true), ([2.0, 4.0, 1e6], false), ([0.01, 1e3, 1e6], false)];

/// The motions of 3 × 3 nodes that are odd about the middle one are those of the ring of the other eight, which are
/// alike: what is symmetric under an eighth of a turn has 16 half-branches, and only terms of seventh order tell them
/// apart.
///
/// Where lengths are in such units that these are below rounding at all distances, it is reported that some are
/// missing.
#[test]
fn all_arms_of_the_double_point_of_nine_nodes_are_found_from_any_start() {
    let half = 0.5_f64.sqrt();
    let (along, across) = ([half, 1.0, half], [1.0, 0.0, -1.0]);
    let (first, double) = (4.0 - 4.0 * half, 4.0 - 2.0 * half);
    for ([x, p, residual], certain) in UNITS {
        for k in 0..10 {
            let from = (0.2 + 0.0713 * f64::from(k)) * first * p;
            let system = InUnits { inner: Square { m: 3 }, x, p, residual };
            let branch = along_zero(&window(9, 0.0, (double + 0.3) * p), system, from);
            let case = format!("from {from}, units {x} {p} {residual}");
            let crossing = &branch.crossings[1];
            let found = (crossing.arms.len(), crossing.complete);
            if !certain && found.0 < 17 {
                continue;
            }
            assert_eq!(found, (17, false), "{case}");
            let shares = |q: &[f64]| {
                let sum = |mode: &dyn Fn(usize, usize) -> f64| (0..9).map(|i| mode(i / 3, i % 3) * q[i]).sum::<f64>();
                (sum(&|i, j| along[i] * across[j]), sum(&|i, j| across[i] * along[j]))
            };
            let mut sixteenths: Vec<i32> = Vec::new();
            for arm in &crossing.arms {
                let (a, b) = shares(&arm.start.z);
                if a.hypot(b) < 1e-6 * x {
                    continue;
                }
                let turns = b.atan2(a) / std::f64::consts::FRAC_PI_8;
                assert!((turns - turns.round()).abs() < 1e-2, "{case}: {a} {b}");
                sixteenths.push((turns.round() as i32).rem_euclid(16));
            }
            sixteenths.sort_unstable();
            assert_eq!(sixteenths, (0..16).collect::<Vec<i32>>(), "{case}");
        }
    }
}

/// Branch points of the equation of Swift and Hohenberg on a stripe of this length: its modes `k`, where
/// `p = (1 − (k π/length)²)²`.
fn check_stripe(length: f64, modes: u32, count: usize, longest_steps: &[f64]) {
    let at: Vec<f64> =
        (1..=modes).map(|k| (1.0 - (f64::from(k) * std::f64::consts::PI / length).powi(2)).powi(2)).collect();
    let mut expected: Vec<f64> = at.iter().copied().filter(|c| *c < 1.2).collect();
    expected.sort_by(f64::total_cmp);
    assert_eq!(expected.len(), count);
    for &max in longest_steps {
        for residual in [1.0, 1e4] {
            let step = StepSettings { max, ..StepSettings::default() };
            let settings = Continuation { step, ..window(at.len(), -2.0, 1.2) };
            let inner = Modes { at: at.clone(), g: 0.5 };
            let branch = along_zero(&settings, InUnits { inner, x: 1.0, p: 1.0, residual }, -1.0);
            assert_eq!(branch.stop, StopReason::Bound { coordinate: at.len(), value: 1.2 });
            let found: Vec<f64> = events(&branch, CROSSING).iter().map(|q| q.p).collect();
            assert_eq!(found.len(), expected.len(), "longest step {max}: {found:?} for {expected:?}");
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        }
    }
}

#[test]
fn branch_points_close_together_are_all_found_whatever_the_longest_step() {
    check_stripe(30.0, 20, 13, &[1.0, 0.3, 0.1, 0.05, 0.02]);
}

/// From −30 to 30.
#[test]
fn all_27_branch_points_of_a_long_stripe_are_found() {
    check_stripe(60.0, 30, 27, &[0.3, 0.05]);
}
