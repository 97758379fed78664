//! Mathematics that several cases need, and that owes nothing to the libraries.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use nlmodes::continuation::ParametricSystem;
use nlmodes::continuation::{Bound, Branch, Continuation};
use nlmodes::hbm::{CondensedStructure, Grazing, PeriodicSettings, PeriodicSystem, Symmetry, grazing};
use nlmodes::linalg::{Triplet, sparse_from_triplets};
use nlmodes::model::{Contact, Dof, DofKind, Drop, MasslessContactModel, StructuralModel};
use nlmodes_contact::solver_by_name;

use crate::Failure;

/// The root of `f` between `low` and `high`, to rounding.
pub fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low).signum();
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle).signum() == sign { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The slope of a straight line through logarithms.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<[f64; 2]> = points.iter().map(|(x, y)| [x.ln(), y.abs().ln()]).collect();
    let mean = |k: usize| logs.iter().map(|l| l[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let across: f64 = logs.iter().map(|l| (l[0] - x) * (l[1] - y)).sum();
    across / logs.iter().map(|l| (l[0] - x).powi(2)).sum::<f64>()
}

/// Gaussian elimination with partial pivoting; `None` for a singular matrix.
pub fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        a.swap(k, pivot);
        b.swap(k, pivot);
        if a[k][k] == 0.0 {
            return None;
        }
        let (above, below) = a.split_at_mut(k + 1);
        for (i, row) in below.iter_mut().enumerate() {
            let factor = row[k] / above[k][k];
            row.iter_mut().zip(&above[k]).skip(k).for_each(|(entry, pivot)| *entry -= factor * pivot);
            b[k + 1 + i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    Some(b)
}

/// Newton's method with central differences.
pub fn newton(f: impl Fn(&[f64]) -> Vec<f64>, start: &[f64]) -> Result<Vec<f64>, Failure> {
    let (n, mut x) = (start.len(), start.to_vec());
    for _ in 0..40 {
        let column = |j: usize| {
            let h = 1e-6 * x[j].abs().max(1e-3);
            let moved = |s: f64| f(&(0..n).map(|i| if i == j { x[i] + s * h } else { x[i] }).collect::<Vec<_>>());
            let (up, down) = (moved(1.0), moved(-1.0));
            (0..n).map(|i| (up[i] - down[i]) / (2.0 * h)).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..n).map(column).collect();
        let jacobian = (0..n).map(|i| (0..n).map(|j| columns[j][i]).collect()).collect();
        let step = solve(jacobian, f(&x)).ok_or("a reference has a singular Jacobian")?;
        x.iter_mut().zip(&step).for_each(|(x, s)| *x -= s);
        if step.iter().zip(&x).all(|(s, x)| s.abs() < 1e-14 * x.abs().max(1e-3)) {
            return Ok(x);
        }
    }
    // Differences leave the last digit open.
    if f(&x).iter().all(|r| r.abs() < 1e-11) { Ok(x) } else { Err("a reference did not converge".into()) }
}

/// Simpson's rule on `n` (even) intervals.
pub fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64, n: usize) -> f64 {
    let h = (to - from) / n as f64;
    let weight = |j: usize| if j == 0 || j == n { 1.0 } else { [2.0, 4.0][j % 2] };
    (0..=n).map(|j| weight(j) * f(from + h * j as f64)).sum::<f64>() * h / 3.0
}

/// Masses on a line (kg) with springs between two of them or, with one index twice, to the ground (N/m).
pub fn springs(
    masses: &[f64],
    springs: &[(usize, usize, f64)],
    contacts: Vec<Contact>,
) -> Result<StructuralModel, Failure> {
    let n = masses.len();
    let mass: Vec<Triplet> = masses.iter().enumerate().filter(|m| *m.1 > 0.0).map(|(i, m)| (i, i, *m)).collect();
    let mut stiffness: Vec<Triplet> = Vec::new();
    for &(i, j, k) in springs {
        stiffness.push((i, i, k));
        if i != j {
            stiffness.extend([(j, j, k), (i, j, -k), (j, i, -k)]);
        }
    }
    let dofs = (0..n).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
    let [mass, stiffness] = [mass, stiffness].map(|entries| sparse_from_triplets(n, n, &entries));
    Ok(StructuralModel::new(mass?, stiffness?, dofs, contacts)?)
}

/// The structure with massless contact nodes.
pub fn condensed(model: &StructuralModel) -> Result<CondensedStructure, Failure> {
    Ok(CondensedStructure::new(MasslessContactModel::new(model, &Drop)?, usize::MAX)?)
}

/// The structure with its mass at the contacts, behind the massless tips of elastic stops: conventional harmonic
/// balance.
pub fn with_tips(model: &StructuralModel) -> Result<CondensedStructure, Failure> {
    Ok(CondensedStructure::new(MasslessContactModel::with_spring_tips(model, None)?, usize::MAX)?)
}

/// A periodic problem about the linear mode that just touches.
pub fn mode(
    structure: &CondensedStructure,
    mode: usize,
    harmonics: usize,
    symmetry: Symmetry,
) -> Result<(PeriodicSystem, Grazing), Failure> {
    let start = grazing(structure, mode)?;
    let settings = (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, symmetry);
    let solver = solver_by_name("active-set")?;
    Ok((structure.conservative_mode(settings, start.scales(), solver.as_ref())?, start))
}

/// The branch from grazing to this averaged kinetic energy, J.
pub fn follow(problem: &mut PeriodicSystem, start: &Grazing, energy: f64) -> Result<Branch, Failure> {
    let (n, to) = (problem.dim(), (energy / start.energy).ln());
    let (x, direction) = problem.start(start);
    let bounds = vec![Bound { coordinate: n, min: -1.0, max: to }];
    let branch = Continuation { bounds, ..Continuation::default() }
        .run(problem, &x, 0.0, &direction, |_| ControlFlow::Continue(()))?;
    let last = branch.points.last().ok_or("no points")?;
    if (last.p - to).abs() > 1e-9 {
        Err(format!("the branch ended early: {:?}", branch.stop).into())
    } else {
        Ok(branch)
    }
}

/// Angular frequency (rad/s) and total energy (J) of the branch at this averaged kinetic energy.
pub fn at_energy(
    structure: &CondensedStructure,
    number: usize,
    harmonics: usize,
    energy: f64,
) -> Result<nlmodes::modal::ModalPoint, Failure> {
    let (mut problem, start) = mode(structure, number, harmonics, Symmetry::Even)?;
    let branch = follow(&mut problem, &start, energy)?;
    let last = branch.points.last().ok_or("no points")?;
    Ok(structure.modal_point(&mut problem, &last.x, last.residual)?)
}

/// `m ẍ + k x + k_s max(x − g, 0) = 0` with the largest displacement `top`, or with the same stop on the other side as
/// well.
#[derive(Debug, Clone, Copy)]
pub struct Bilinear {
    pub m: f64,
    pub k: f64,
    pub k_s: f64,
    pub gap: f64,
    pub top: f64,
    pub two_sided: bool,
}

impl Bilinear {
    /// Amplitude, angular frequency and angle of the arc with and without the stop.
    fn arcs(&self) -> [[f64; 3]; 2] {
        let rest = self.k_s * self.gap / (self.k + self.k_s);
        let (pressed, free) = (self.top - rest, (2.0 * self.total() / self.k).sqrt());
        let touching = (self.gap / free).acos();
        let half = if self.two_sided { PI / 2.0 } else { PI };
        [
            [pressed, ((self.k + self.k_s) / self.m).sqrt(), ((self.gap - rest) / pressed).acos()],
            [free, (self.k / self.m).sqrt(), half - touching],
        ]
    }

    /// How often each arc is passed in a period.
    fn times(&self) -> f64 {
        if self.two_sided { 4.0 } else { 2.0 }
    }

    pub fn period(&self) -> f64 {
        self.times() * self.arcs().iter().map(|[_, omega, angle]| angle / omega).sum::<f64>()
    }

    pub fn omega(&self) -> f64 {
        TAU / self.period()
    }

    pub fn total(&self) -> f64 {
        0.5 * self.k * self.top.powi(2) + 0.5 * self.k_s * (self.top - self.gap).powi(2)
    }

    /// Share of the period in contact.
    pub fn share(&self) -> f64 {
        let [[_, omega, angle], _] = self.arcs();
        self.times() * angle / omega / self.period()
    }

    /// Displacement and velocity at the time `t` from the largest displacement, of the one-sided oscillator.
    pub fn state(&self, t: f64) -> [f64; 2] {
        let [[pressed, fast, angle], [free, slow, _]] = self.arcs();
        let (t, period) = (t.rem_euclid(self.period()), self.period());
        let (from_top, sign) = if t > 0.5 * period { (period - t, -1.0) } else { (t, 1.0) };
        if from_top * fast < angle {
            let (s, c) = (fast * from_top).sin_cos();
            return [self.top - pressed + pressed * c, -sign * pressed * fast * s];
        }
        let (s, c) = (slow * (0.5 * period - from_top)).sin_cos();
        [-free * c, -sign * free * slow * s]
    }

    /// `⟨½ m ẋ²⟩`: `∫ sin²` from where the mass stands still, or for the free arc between two stops, `∫ cos²` from the
    /// middle.
    pub fn kinetic(&self) -> f64 {
        let share = |[a, omega, angle]: [f64; 3], sign: f64| {
            0.25 * self.m * a * a * omega * (angle - sign * angle.sin() * angle.cos())
        };
        let [pressed, free] = self.arcs();
        let of_free = if self.two_sided { -1.0 } else { 1.0 };
        self.times() * (share(pressed, 1.0) + share(free, of_free)) / self.period()
    }
}

/// Free motion of two unit masses with the stiffness `[a, b; b, c]` about a rest.
struct Pair {
    turn: [f64; 2],
    omega: [f64; 2],
    rest: [f64; 2],
}

impl Pair {
    fn new([a, b, c]: [f64; 3], rest: [f64; 2]) -> Self {
        let angle = 0.5 * (2.0 * b).atan2(a - c);
        let (s, t) = angle.sin_cos();
        let omega = [a * t * t + 2.0 * b * s * t + c * s * s, a * s * s - 2.0 * b * s * t + c * t * t].map(f64::sqrt);
        Self { turn: [t, s], omega, rest }
    }

    fn turned(&self, [x, y]: [f64; 2], back: f64) -> [f64; 2] {
        let [t, s] = self.turn;
        [t * x + back * s * y, -back * s * x + t * y]
    }

    /// Displacements and velocities after `t`.
    fn after(&self, [x, v]: [[f64; 2]; 2], t: f64) -> [[f64; 2]; 2] {
        let (u, w) = (self.turned([x[0] - self.rest[0], x[1] - self.rest[1]], 1.0), self.turned(v, 1.0));
        let moved = |k: usize| {
            let (s, c) = (self.omega[k] * t).sin_cos();
            [u[k] * c + w[k] * s / self.omega[k], w[k] * c - u[k] * self.omega[k] * s]
        };
        let [a, b] = [moved(0), moved(1)];
        let x = self.turned([a[0], b[0]], -1.0);
        [[x[0] + self.rest[0], x[1] + self.rest[1]], self.turned([a[1], b[1]], -1.0)]
    }
}

/// Two unit masses between walls on unit springs, a stop of 30 at 1 before the first one, or on both sides.
pub struct TwoMasses {
    pub omega: f64,
    /// Averaged kinetic energy.
    pub kinetic: f64,
    /// Displacement of the second mass where both stand still.
    pub second: f64,
}

impl TwoMasses {
    /// The motion in phase in which the first mass goes as far as `top`.
    pub fn of_amplitude(top: f64, two_sided: bool) -> Result<Self, Failure> {
        let det = 32.0 * 2.0 - 1.0;
        let pressed = Pair::new([32.0, -1.0, 2.0], [2.0 * 30.0 / det, 30.0 / det]);
        let free = Pair::new([2.0, -1.0, 2.0], [0.0; 2]);
        let parts = |z: &[f64]| {
            let start = [[top, z[0]], [0.0; 2]];
            let touched = pressed.after(start, z[1]);
            (start, touched, free.after(touched, z[2]))
        };
        let defects = |z: &[f64]| {
            let (_, touched, end) = parts(z);
            // At rest after half a period, or at zero after a quarter of it.
            let rest = if two_sided { end[0] } else { end[1] };
            vec![touched[0][0] - 1.0, rest[0], rest[1]]
        };
        let guess = if two_sided { [top, 0.2, 0.9] } else { [top, 0.2, 2.4] };
        let z = newton(defects, &guess)?;
        let (start, touched, _) = parts(&z);
        let kinetic = |pair: &Pair, from: [[f64; 2]; 2], length: f64| {
            integral(|t| 0.5 * pair.after(from, t)[1].iter().map(|v| v * v).sum::<f64>(), 0.0, length, 2000)
        };
        let part = z[1] + z[2];
        let mean = (kinetic(&pressed, start, z[1]) + kinetic(&free, touched, z[2])) / part;
        let parts_of_a_period = if two_sided { 4.0 } else { 2.0 };
        if !(z[1] > 0.0 && z[2] > 0.0) {
            return Err("the reference has a negative duration".into());
        }
        Ok(Self { omega: TAU / (parts_of_a_period * part), kinetic: mean, second: z[0] })
    }
}
