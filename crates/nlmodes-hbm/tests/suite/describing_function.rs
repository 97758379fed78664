//! One harmonic: a clamped cosine has Fourier coefficients in closed form, and with them the whole branch.

use crate::support;

use std::f64::consts::PI;

use nlmodes_hbm::{Switching, Symmetry};
use nlmodes_model::Side;
use support::{FullMatrices, bisect, follow, paper_rod, problem, rod, rod_mode, solve_dense};

const GAP: f64 = 0.5;

/// Mean and first cosine coefficient of `min(b0 + b1 cos τ, g)`, `b1 > 0`.
fn clamped(b0: f64, b1: f64) -> [f64; 2] {
    let theta = ((GAP - b0) / b1).min(1.0).acos();
    let mean = (GAP * theta + b0 * (PI - theta) - b1 * theta.sin()) / PI;
    [mean, (2.0 * (GAP - b0) * theta.sin() + b1 * (PI - theta - theta.sin() * theta.cos())) / PI]
}

/// The structure behind the tip at one frequency: `q_L` for a unit tip displacement by a dense solution of eq. (8), and
/// where the tip would be without a stop.
struct Response {
    transfer: f64,
    q_l: Vec<f64>,
}

fn response(full: &FullMatrices, nu: f64) -> Response {
    let n = full.size() - 1;
    let h = (0..n).map(|i| (0..n).map(|j| full.k[i][j] - nu * nu * full.m[i][j]).collect()).collect();
    let q_l = solve_dense(h, (0..n).map(|i| -full.k[i][n]).collect());
    let transfer = -(0..n).map(|j| full.k[n][j] * q_l[j]).sum::<f64>() / full.k[n][n];
    Response { transfer, q_l }
}

fn paper_matrices() -> FullMatrices {
    FullMatrices::of(&rod(100, 210e9, 9000.0, 20.0, &[(100, Side::Positive, GAP)]))
}

#[test]
fn one_harmonic_branch_satisfies_the_describing_function_and_a_dense_solution_of_the_linear_part() {
    let (structure, full) = (paper_rod(), paper_matrices());
    let (mut problem, start) = problem(&structure, 1, 1, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 3.0);
    assert!(branch.points.len() > 10);
    let at_rest = response(&full, 0.0);
    for point in &branch.points {
        assert!(point.residual < 1e-10, "residual {:e}", point.residual);
        let omega = problem.omega(&point.x);
        // The gap opens by −b.
        let b = [0, 1].map(|n| -point.x[n] * problem.scales().length);
        let q = clamped(b[0], b[1]);
        let moving = response(&full, omega);
        // The dense matrix has a condition number of about 1e4, so its own rounding is near 1e-12.
        for (b, free) in [(b[0], at_rest.transfer * q[0]), (b[1], moving.transfer * q[1])] {
            assert!((b - free).abs() < 1e-10 * GAP, "{b} against {free}");
        }
        let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
        assert!((modal.coefficients.of(99)[0].re - q[0]).abs() < 1e-12 * GAP);
        assert!((modal.coefficients.of(99)[1].re - q[1]).abs() < 1e-12 * GAP);
        for (j, unit) in moving.q_l.iter().enumerate() {
            assert!((modal.coefficients.of(j)[1].re - unit * q[1]).abs() < 1e-9 * GAP, "coordinate {j}");
        }
    }
}

#[test]
fn one_harmonic_backbone_is_the_closed_form_energy_of_its_frequency() {
    let (structure, full) = (paper_rod(), paper_matrices());
    let (mut problem, start) = problem(&structure, 1, 1, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 3.0);
    let t0 = response(&full, 0.0).transfer;
    for point in &branch.points[1..] {
        let omega = problem.omega(&point.x);
        let moving = response(&full, omega);
        // q_1/b_1 = 1/T depends on the contact angle alone; then mean and amplitude follow from two linear equations.
        let share = |theta: f64| (PI - theta + theta.sin() * theta.cos()) / PI;
        let theta = bisect(|theta| share(theta) - 1.0 / moving.transfer, 0.0, PI);
        // b0 = T0 q0(b0, b1) and b0 + b1 cos θ = g
        let row = vec![1.0 - t0 * (PI - theta) / PI, t0 * theta.sin() / PI];
        let b = solve_dense(vec![row, vec![1.0, theta.cos()]], vec![t0 * GAP * theta / PI, GAP]);
        let q1 = b[1] / moving.transfer;
        let n = moving.q_l.len();
        let square: f64 =
            (0..n).map(|i| (0..n).map(|j| full.m[i][j] * moving.q_l[i] * moving.q_l[j]).sum::<f64>()).sum();
        let energy = 0.25 * (omega * q1).powi(2) * square;
        let found = problem.scales().energy * point.p.exp();
        // T − 1 is near 0.01, so that the angle loses two digits, and near grazing half of what is left: θ ~ √(1 −
        // 1/T).
        assert!((energy / found - 1.0).abs() < 1e-7, "{:.6} Hz: {energy:e} J against {found:e} J", omega / 2.0 / PI);
    }
    // Own computation in Python (dense matrices, Gauss quadrature, Newton's method): 70.336945574391 Hz.
    let last = branch.points.last().unwrap();
    let hz = problem.omega(&last.x) / (2.0 * PI);
    assert!((last.p - 3.0_f64.ln()).abs() < 1e-12 && (hz - 70.336_945_574_391).abs() < 1e-8, "{hz}");
}

#[test]
fn grazing_is_the_closed_form_of_the_discrete_rod() {
    let structure = paper_rod();
    for mode in 1..=5 {
        let expected = rod_mode(100, 210e9, 9000.0, 20.0, mode);
        let found = nlmodes_hbm::grazing(&structure, mode).unwrap();
        assert!((found.omega / expected.omega - 1.0).abs() < 1e-11, "mode {mode}: {}", found.omega);
        assert!((found.energy / expected.grazing_energy(GAP) - 1.0).abs() < 1e-9, "mode {mode}: {}", found.energy);
        assert!((found.contact_amplitudes(&structure)[0].abs() / GAP - 1.0).abs() < 1e-12);
    }
    let first = nlmodes_hbm::grazing(&structure, 1).unwrap();
    assert!((first.energy / 8.150_553_44e8 - 1.0).abs() < 1e-8, "{:e}", first.energy);
}
