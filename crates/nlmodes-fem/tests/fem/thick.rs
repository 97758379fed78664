//! A thick beam, L/h = 5, compared with the exact frequency equation of Timoshenko's theory.

use nlmodes_fem::Support::{self, Clamped, Free, Pinned};
use nlmodes_model::DofKind;

use crate::closed_forms::Timoshenko;
use crate::common::{assert_close, frequencies_of, square_beam};

const HEIGHT: f64 = 0.2;

fn numbers() -> Timoshenko {
    let r2 = HEIGHT * HEIGHT / 12.0;
    // E / κG = 2 (1 + ν) / κ
    Timoshenko { r2, s2: r2 * 2.0 * 1.3 / (5.0 / 6.0) }
}

/// Relative errors of the first five bending frequencies.
fn errors(elements: usize, start: Support, end: Support, exact: &[f64]) -> Vec<f64> {
    let model = square_beam(HEIGHT, elements, start, end).assemble(&[]).unwrap();
    let omega = frequencies_of(&model, DofKind::Deflection, 5);
    let unit = (210e9 / 7800.0 * numbers().r2).sqrt();
    omega.iter().zip(exact).map(|(omega, b)| omega / (b * unit) - 1.0).collect()
}

fn check(start: Support, end: Support, exact: &[f64]) {
    assert!(exact.len() >= 5, "{} zeros below the cut-on frequency", exact.len());
    let [coarse, fine] = [20, 40].map(|n| errors(n, start, end, exact));
    for (k, (coarse, fine)) in coarse.iter().zip(&fine).enumerate() {
        assert!(fine.abs() < 5e-3, "{start}-{end}, mode {}: error {fine:e}", k + 1);
        let rate = (coarse / fine).log2();
        assert!(rate > 1.9, "{start}-{end}, mode {}: rate {rate}", k + 1);
    }
    for error in errors(500, start, end, exact) {
        assert_close(1.0 + error, 1.0, 4e-5);
    }
}

#[test]
fn cantilever() {
    check(Clamped, Free, &numbers().clamped_free());
}

#[test]
fn free_free() {
    check(Free, Free, &numbers().free_free());
}

#[test]
fn clamped_clamped() {
    check(Clamped, Clamped, &numbers().clamped_clamped());
}

#[test]
fn pinned_pinned() {
    check(Pinned, Pinned, &numbers().pinned_pinned());
}
