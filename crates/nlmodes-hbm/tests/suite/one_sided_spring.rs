//! One mass before a one-sided spring: a piecewise linear oscillator, whose motion is closed form.
//!
//! Two problems of this crate are that oscillator: harmonic balance of a mass before an elastic stop, eq. (3), and
//! mixed shooting of a mass with a massless node before it, whose spring and that of the stop are in series.

use crate::support;

use std::f64::consts::{PI, TAU};

use nlmodes_hbm::{CondensedStructure, PeriodicSystem, Switching, Symmetry};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, ContactCoordinates, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use support::{condense, condense_tips, fitted_slope, follow, problem, settle};

const GAP: f64 = 1.0;

/// `m ẍ + k x + k_s max(x − g, 0) = 0` with the largest displacement `top`.
struct Oscillator {
    m: f64,
    k: f64,
    k_s: f64,
    top: f64,
}

impl Oscillator {
    /// Equilibrium, amplitude and angular frequency of the harmonic motion in contact and without.
    fn phases(&self) -> [[f64; 3]; 2] {
        let rest = self.k_s * GAP / (self.k + self.k_s);
        let energy = 0.5 * self.k * self.top.powi(2) + 0.5 * self.k_s * (self.top - GAP).powi(2);
        let free = (2.0 * energy / self.k).sqrt();
        [[rest, self.top - rest, ((self.k + self.k_s) / self.m).sqrt()], [0.0, free, (self.k / self.m).sqrt()]]
    }

    /// Half of each phase as an angle: in contact from the largest displacement to the gap, then on to the smallest.
    fn angles(&self) -> [f64; 2] {
        let [contact, free] = self.phases();
        [((GAP - contact[0]) / contact[1]).acos(), PI - (GAP / free[1]).acos()]
    }

    fn period(&self) -> f64 {
        let [contact, free] = self.phases();
        let [in_contact, without] = self.angles();
        2.0 * (in_contact / contact[2] + without / free[2])
    }

    fn omega(&self) -> f64 {
        TAU / self.period()
    }

    /// `⟨½ m ẋ²⟩`, with `∫₀^a sin² = ½ (a − sin a cos a)` over each phase.
    fn kinetic(&self) -> f64 {
        let share = |[_, amplitude, omega]: [f64; 3], angle: f64| {
            amplitude.powi(2) * omega * (angle - angle.sin() * angle.cos())
        };
        let sum: f64 = self.phases().into_iter().zip(self.angles()).map(|(phase, angle)| share(phase, angle)).sum();
        0.5 * self.m * sum / self.period()
    }

    fn total(&self) -> f64 {
        0.5 * self.k * self.phases()[1][1].powi(2)
    }

    fn x(&self, tau: f64) -> f64 {
        let t = if tau > PI { TAU - tau } else { tau } / self.omega();
        let [contact, free] = self.phases();
        if t * contact[2] < self.angles()[0] {
            return contact[0] + contact[1] * (contact[2] * t).cos();
        }
        -free[1] * (free[2] * (0.5 * self.period() - t)).cos()
    }

    /// Scaled unknowns of the motion, to begin Newton's method with: the gap opens by −x, at rest before
    /// the stop by one.
    fn unknowns(&self, model: &MasslessContactModel, problem: &PeriodicSystem) -> (Vec<f64>, f64) {
        let (h, samples) = (problem.series().n_harmonics, 1 << 12);
        // A node without mass that moves in harmonics is where the springs before and behind it share x − g.
        let yields = match model.contact_coordinates() {
            ContactCoordinates::Nodes => 1.0,
            ContactCoordinates::SpringTips => self.k_s * model.contacts()[0].law.compliance(),
        };
        let node = |x: f64| if x > GAP { GAP + yields * (x - GAP) } else { x };
        let cosine = |n: usize| {
            let at = |j: usize| TAU * j as f64 / samples as f64;
            let sum: f64 = (0..samples).map(|j| node(self.x(at(j))) * (n as f64 * at(j)).cos()).sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / samples as f64
        };
        let mut x: Vec<f64> = (0..=h).map(|n| -cosine(n)).collect();
        x.push(self.omega() / (self.k / self.m).sqrt());
        (x, (self.kinetic() / (0.25 * self.k * GAP * GAP)).ln())
    }
}

/// A wall, a spring of 2, a mass of ⅓; with `massless`, a spring of it and a node without mass; then the stop.
fn model(massless: Option<f64>, stiffness: f64) -> StructuralModel {
    let (mut k, n) = (vec![(0, 0, 2.0)], 1 + usize::from(massless.is_some()));
    if let Some(k2) = massless {
        k.extend([(0, 0, k2), (0, 1, -k2), (1, 0, -k2), (1, 1, k2)]);
    }
    let dofs = (0..n).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
    let stop = if stiffness.is_finite() {
        Contact::elastic(n - 1, Side::Positive, GAP, stiffness)
    } else {
        Contact::rigid(n - 1, Side::Positive, GAP)
    };
    let matrix = |entries: &[_]| sparse_from_triplets(n, n, entries).unwrap();
    StructuralModel::new(matrix(&[(0, 0, 1.0 / 3.0)]), matrix(&k), dofs, vec![stop]).unwrap()
}

/// Harmonic balance of the mass before a spring of `k_c`.
fn harmonic_balance(k_c: f64) -> CondensedStructure {
    condense_tips(&model(None, k_c), None)
}

fn oscillator(k_s: f64, top: f64) -> Oscillator {
    Oscillator { m: 1.0 / 3.0, k: 2.0, k_s, top }
}

/// Relative errors of the frequency and of the total energy at the averaged kinetic energy of the closed form.
fn errors(structure: &CondensedStructure, closed: &Oscillator, harmonics: usize, switching: Switching) -> [f64; 2] {
    let (mut problem, start) = problem(structure, 1, harmonics, Symmetry::Even, switching);
    assert!((start.energy - 0.5).abs() < 1e-13 && (start.omega - 6.0_f64.sqrt()).abs() < 1e-13);
    let (guess, p) = closed.unknowns(structure.model(), &problem);
    let (x, residual) = settle(&mut problem, guess, p);
    assert!(residual < 1e-11, "{harmonics} harmonics, {switching:?}: residual {residual:e}");
    let point = structure.modal_point(&mut problem, &x, residual).unwrap();
    assert!((point.kinetic_energy / closed.kinetic() - 1.0).abs() < 1e-10);
    [point.omega / closed.omega() - 1.0, point.total_energy / closed.total() - 1.0]
}

/// Largest error among the harmonics (or samples) of each octave: single ones oscillate with where the corners fall.
fn octaves(from: usize, count: usize, error: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let largest = |low: usize| (0..8).map(|i| low + low * i / 8).fold(0.0_f64, |m, n| m.max(error(n).abs()));
    (0..count).map(|k| (from << k) as f64).map(|low| (low, largest(low as usize))).collect()
}

#[test]
fn the_closed_form_solves_its_own_equation() {
    let closed = oscillator(6.0, 1.6);
    let n = 200_000;
    let step = closed.period() / n as f64;
    let x = |j: usize| closed.x(TAU * j as f64 / n as f64);
    let (mut worst, mut kinetic) = (0.0_f64, 0.0);
    for j in 1..n {
        let (before, here, after) = (x(j - 1), x(j), x(j + 1));
        let force = closed.k * here + closed.k_s * (here - GAP).max(0.0);
        worst = worst.max((closed.m * (after - 2.0 * here + before) / (step * step) + force).abs());
        kinetic += 0.5 * closed.m * ((after - here) / step).powi(2) / n as f64;
    }
    // Where the spring sets in, the third derivative jumps: differences are off by step × jump there, and by
    // rounding/step².
    assert!(worst < 1e-3, "{worst:e}");
    assert!((kinetic / closed.kinetic() - 1.0).abs() < 1e-4);
}

#[test]
fn harmonic_balance_gives_ten_digits_of_frequency_and_energy() {
    for (k_c, top, harmonics) in [(0.5, 2.0, 50), (2.0, 1.2, 50), (6.0, 1.6, 80), (60.0, 1.2, 220)] {
        let closed = oscillator(k_c, top);
        for harmonics in [harmonics, harmonics + 7] {
            let [frequency, energy] = errors(&harmonic_balance(k_c), &closed, harmonics, Switching::Exact);
            assert!(frequency.abs() < 1e-10, "k_c = {k_c}, {harmonics} harmonics: frequency off by {frequency:e}");
            assert!(energy.abs() < 1e-10, "k_c = {k_c}, {harmonics} harmonics: energy off by {energy:e}");
        }
    }
}

#[test]
fn harmonic_balance_converges_with_the_fifth_power_of_the_harmonics() {
    // The third derivative of x jumps, so x_n ~ n⁻⁴; the frequency is stationary, so its error goes like Σ_{n > H} n²
    // x_n² ~ H⁻⁵.
    let (structure, closed) = (harmonic_balance(6.0), oscillator(6.0, 1.6));
    for which in [0, 1] {
        let found = octaves(5, 5, |h| errors(&structure, &closed, h, Switching::Exact)[which]);
        let slope = fitted_slope(&found);
        assert!((-5.5..-4.4).contains(&slope), "order {slope}: {found:?}");
    }
}

#[test]
fn alternating_frequency_time_adds_an_error_that_falls_with_the_square_of_the_samples() {
    let (structure, closed) = (harmonic_balance(6.0), oscillator(6.0, 1.6));
    let exact = errors(&structure, &closed, 15, Switching::Exact)[0];
    let sampled = octaves(64, 6, |n| errors(&structure, &closed, 15, Switching::Sampled { samples: n })[0] - exact);
    let slope = fitted_slope(&sampled);
    // The trapezoidal rule on a force whose slope jumps; which samples lie next to the jump makes the factor.
    assert!((-2.4..-1.7).contains(&slope), "order {slope}: {sampled:?}");
}

#[test]
fn the_branch_of_harmonic_balance_is_the_closed_form_amplitude_by_amplitude() {
    let structure = harmonic_balance(6.0);
    let (mut problem, start) = problem(&structure, 1, 60, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 4.0);
    assert!(branch.points.len() > 10, "{:?}", branch.stop);
    for point in &branch.points[1..] {
        let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
        let top = support::bisect(|top| oscillator(6.0, top).kinetic() - modal.kinetic_energy, GAP, 3.0);
        let closed = oscillator(6.0, top);
        // A contact of length θ is resolved by harmonics beyond 1/θ only; at the second point half of it is 0.1 rad.
        assert!((modal.omega / closed.omega() - 1.0).abs() < 1e-9, "{top}: {:e}", modal.omega / closed.omega() - 1.0);
        assert!((modal.total_energy / closed.total() - 1.0).abs() < 1e-8, "{top}");
        assert!((modal.peak / top - 1.0).abs() < 1e-5, "{top}: {}", modal.peak);
        // λ = k_c (x − g) at the top, whatever the harmonics.
        assert!((modal.peak_contact_force - 6.0 * (modal.peak - GAP)).abs() < 1e-12);
    }
}

#[test]
fn mixed_shooting_before_an_elastic_stop_is_two_springs_in_series() {
    for (k2, k_c) in [(2.0, 3.0), (2.0, 100.0), (50.0, 0.8)] {
        let structure = condense(&model(Some(k2), k_c));
        let closed = oscillator(k2 * k_c / (k2 + k_c), 1.7);
        let [frequency, energy] = errors(&structure, &closed, 60, Switching::Exact);
        assert!(frequency.abs() < 1e-10 && energy.abs() < 1e-10, "{k2}, {k_c}: {frequency:e}, {energy:e}");
        // What the stop yields: its share of x − g, which both springs share by their compliances.
        let (mut problem, _) = problem(&structure, 1, 60, Symmetry::Even, Switching::Exact);
        let (guess, p) = closed.unknowns(structure.model(), &problem);
        let (x, _) = settle(&mut problem, guess, p);
        let point = structure.modal_point(&mut problem, &x, 0.0).unwrap();
        let top = point.coefficients.value(0, 0.0);
        let force = closed.k_s * (top - GAP);
        assert!((point.peak_contact_force / force - 1.0).abs() < 1e-12);
        assert!((point.peak - GAP - force / k_c).abs() < 1e-12);
    }
}

/// Frequency at twice the energy of the largest displacement 1.7 before the rigid stop.
fn frequency(structure: &CondensedStructure, harmonics: usize, guess: &Oscillator) -> f64 {
    let (mut problem, start) = problem(structure, 1, harmonics, Symmetry::Even, Switching::Exact);
    let (_, p) = guess.unknowns(structure.model(), &problem);
    let branch = follow(&mut problem, &start, p.exp());
    let (x, residual) = settle(&mut problem, branch.points.last().unwrap().x.clone(), p);
    assert!(residual < 1e-11, "residual {residual:e}");
    problem.omega(&x)
}

#[test]
fn an_elastic_stop_runs_into_the_rigid_one_like_its_compliance() {
    // To first order the stop's compliance adds to that of the contact, whatever the harmonics: ω(k_c) − ω(∞) ~ 1/k_c.
    let closed = oscillator(2.0, 1.7);
    for harmonics in [1, 5, 40] {
        let rigid = frequency(&condense(&model(Some(2.0), f64::INFINITY)), harmonics, &closed);
        let differences: Vec<(f64, f64)> = [1e2, 1e3, 1e4, 1e5, 1e6]
            .map(|k_c| (k_c, rigid - frequency(&condense(&model(Some(2.0), k_c)), harmonics, &closed)))
            .to_vec();
        assert!(differences.iter().all(|(_, d)| *d > 0.0), "a stop that yields makes no mode stiffer: {differences:?}");
        let slope = fitted_slope(&differences);
        assert!((-1.01..-0.99).contains(&slope), "{harmonics} harmonics, order {slope}: {differences:?}");
    }
    // The first-order coefficient from the closed form, at the same averaged kinetic energy.
    let at = |k_s: f64| {
        let top = support::bisect(|top| oscillator(k_s, top).kinetic() - closed.kinetic(), 1.0, 4.0);
        oscillator(k_s, top).omega()
    };
    let (k_c, exact) = (1e4, at(2.0) - at(2.0 * 1e4 / (2.0 + 1e4)));
    let found = frequency(&condense(&model(Some(2.0), f64::INFINITY)), 60, &closed)
        - frequency(&condense(&model(Some(2.0), k_c)), 60, &closed);
    assert!((found / exact - 1.0).abs() < 1e-5, "{found:e} against {exact:e}");
}

#[test]
fn harmonic_balance_of_a_massless_node_needs_the_harmonics_that_mixed_shooting_spares() {
    // With the node in harmonics as well, its slope jumps: λ_n ~ n⁻², and the frequency misses Σ_{n > H} λ_n² ~ H⁻³;
    // mixed shooting, which keeps the node in time, misses H⁻⁵.
    let k_c = 20.0;
    let elastic = model(Some(2.0), k_c);
    let closed = oscillator(2.0 * k_c / (2.0 + k_c), 1.7);
    let tips = octaves(5, 5, |h| errors(&condense_tips(&elastic, Some(&Drop)), &closed, h, Switching::Exact)[0]);
    let slope = fitted_slope(&tips);
    assert!((-3.4..-2.6).contains(&slope), "order {slope}: {tips:?}");
    let nodes = octaves(5, 5, |h| errors(&condense(&elastic), &closed, h, Switching::Exact)[0]);
    let slope = fitted_slope(&nodes);
    assert!((-5.5..-4.4).contains(&slope), "order {slope}: {nodes:?}");
}

#[test]
fn harmonic_balance_runs_into_mixed_shooting_with_a_rigid_stop_where_its_harmonics_keep_up() {
    // Same masses, k_c → ∞: the difference falls like 1/k_c as long as the harmonics resolve the contact, and no
    // further.
    let closed = oscillator(2.0, 1.7);
    let rigid = frequency(&condense(&model(Some(2.0), f64::INFINITY)), 60, &closed);
    let difference = |k_c: f64, harmonics: usize| {
        let near = oscillator(2.0 * k_c / (2.0 + k_c), 1.7);
        let energy = Oscillator {
            top: support::bisect(|top| oscillator(near.k_s, top).kinetic() - closed.kinetic(), 1.0, 4.0),
            ..near
        };
        rigid - frequency(&condense_tips(&model(Some(2.0), k_c), Some(&Drop)), harmonics, &energy)
    };
    let differences: Vec<(f64, f64)> = [2e1, 2e2, 2e3].map(|k_c| (k_c, difference(k_c, 120))).to_vec();
    let slope = fitted_slope(&differences);
    assert!((-1.03..-0.95).contains(&slope), "order {slope}: {differences:?}");
    // Five harmonics make the stiff stop stiffer than the rigid one: they cannot bend as the massless node does.
    let five = difference(2e2, 5) / rigid;
    assert!(five < -1e-5, "{five:e}");
}
