use nlmodes_fem::{MassMatrix, Material, Mesh, Rod, Support};

use crate::closed_forms::clamped_free_rod;
use crate::common::{assert_close, frequencies, rod};

const SPEED: f64 = 4830.458915396479; // √(210e9 / 9000)

/// Relative error of frequency `k` with `elements` elements.
fn error(elements: usize, mass_matrix: MassMatrix, k: usize) -> f64 {
    let model = rod(elements, mass_matrix).assemble(&[]).unwrap();
    let omega = frequencies(model.mass(), model.stiffness(), k);
    omega[k - 1] / clamped_free_rod(SPEED, 20.0, k) - 1.0
}

#[test]
fn frequencies_converge_with_the_square_of_the_element_length() {
    for (kind, sign) in [(MassMatrix::Consistent, 1.0), (MassMatrix::Lumped, -1.0)] {
        for k in 1..=4 {
            let errors = [20, 40, 80, 160].map(|n| sign * error(n, kind, k));
            // ω² = 6 (1 − cos κh) / (2 + cos κh), and 2 (1 − cos κh) lumped, give ± (κh)² / 24.
            let kh = (2 * k - 1) as f64 * std::f64::consts::PI / (2.0 * 160.0);
            assert_close(errors[3], kh * kh / 24.0, 0.01);
            for pair in errors.windows(2) {
                let rate = (pair[0] / pair[1]).log2();
                assert!((rate - 2.0).abs() < 0.02, "{kind:?}, mode {k}: rate {rate}");
            }
        }
    }
}

#[test]
fn discrete_frequencies_of_a_uniform_rod_are_met_to_rounding() {
    for n in [1, 3, 50, 700] {
        let model = rod(n, MassMatrix::Consistent).assemble(&[]).unwrap();
        let h = 20.0 / n as f64;
        for (i, omega) in frequencies(model.mass(), model.stiffness(), n.min(12)).iter().enumerate() {
            let half = (2 * i + 1) as f64 * std::f64::consts::PI / (4.0 * n as f64);
            let expected = SPEED / h * (12.0 * half.sin().powi(2) / (2.0 + (2.0 * half).cos())).sqrt();
            assert_close(*omega, expected, 2e-12);
        }
    }
}

#[test]
fn ends_hold_what_their_names_say() {
    let frequency = |start, end, r: usize| {
        let model = Rod { start, end, ..rod(400, MassMatrix::Consistent) }.assemble(&[]).unwrap();
        frequencies(model.mass(), model.stiffness(), r + 1)[r]
    };
    let between = std::f64::consts::PI * SPEED / 20.0;
    for start in [Support::Clamped, Support::Pinned] {
        assert_close(frequency(start, Support::Pinned, 0), between, 1e-5);
        assert_close(frequency(start, Support::Sliding, 0), between / 2.0, 1e-5);
    }
    for start in [Support::Free, Support::Sliding] {
        assert!(frequency(start, Support::Free, 0) < 1e-4 * between);
        assert_close(frequency(start, Support::Free, 1), between, 1e-5);
    }
}

#[test]
fn a_graded_mesh_gives_the_same_frequencies() {
    let mesh = Mesh::graded(20.0, 400, 5.0).unwrap();
    let graded = Rod { mesh, ..rod(1, MassMatrix::Consistent) }.assemble(&[]).unwrap();
    for (i, omega) in frequencies(graded.mass(), graded.stiffness(), 3).iter().enumerate() {
        assert_close(*omega, clamped_free_rod(SPEED, 20.0, i + 1), 1e-4);
    }
}

#[test]
fn impossible_rods_are_refused() {
    for area in [0.0, f64::NAN] {
        assert!(Rod { area, ..rod(3, MassMatrix::Lumped) }.assemble(&[]).is_err());
    }
    let held = Rod { end: Support::Pinned, ..rod(1, MassMatrix::Lumped) };
    assert_eq!(held.assemble(&[]).unwrap_err(), nlmodes_fem::FemError::NothingMoves);
    let stiff = Rod { material: Material::new(1e308, 1.0).unwrap(), area: 1e3, ..rod(2, MassMatrix::Lumped) };
    assert!(matches!(stiff.assemble(&[]), Err(nlmodes_fem::FemError::Overflow { .. })));
}
