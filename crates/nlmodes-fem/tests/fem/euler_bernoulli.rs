//! Slender beams between all pairs of ends.

use nlmodes_fem::{Beam, MassMatrix, Support};
use nlmodes_model::DofKind;

use crate::closed_forms::euler_bernoulli as exact;
use crate::common::{assert_close, frequencies_of, rigid_modes, square_beam};

use Support::{Clamped, Free, Pinned, Sliding};

const HEIGHT: f64 = 1e-3;

/// `√(EI/ρA)`, m²/s.
fn stiffness_to_mass() -> f64 {
    (210e9 / 7800.0_f64).sqrt() * HEIGHT / 12.0_f64.sqrt()
}

fn check(start: Support, end: Support, rigid: usize, beta: &[f64]) {
    for (start, end) in [(start, end), (end, start)] {
        let model = square_beam(HEIGHT, 40, start, end).assemble(&[]).unwrap();
        assert_eq!(rigid_modes(&model), rigid, "{start}-{end}");
        let omega = frequencies_of(&model, DofKind::Deflection, 4);
        for (omega, beta) in omega.iter().zip(beta) {
            // Shear and rotary inertia lower the frequency by about 2 (β h / L)² / 12, the mesh raises it by (β/n)⁴
            // / 1440.
            assert_close(*omega, beta * beta * stiffness_to_mass(), 6e-5);
        }
    }
}

#[test]
fn clamped_and_free_ends() {
    check(Clamped, Free, 0, &exact::clamped_free());
    check(Clamped, Clamped, 0, &exact::free_free());
    check(Free, Free, 3, &exact::free_free());
}

#[test]
fn pinned_ends() {
    check(Pinned, Pinned, 0, &exact::pinned_pinned());
    check(Clamped, Pinned, 0, &exact::clamped_pinned());
    check(Pinned, Free, 1, &exact::clamped_pinned());
}

#[test]
fn sliding_ends() {
    check(Clamped, Sliding, 0, &exact::clamped_sliding());
    check(Sliding, Sliding, 1, &exact::pinned_pinned());
    check(Sliding, Free, 1, &exact::clamped_sliding());
    let halves: Vec<f64> = exact::pinned_pinned().iter().map(|b| b - std::f64::consts::FRAC_PI_2).collect();
    check(Pinned, Sliding, 0, &halves);
}

#[test]
fn a_lumped_mass_matrix_converges_to_the_same_frequencies() {
    let beam = Beam { mass_matrix: MassMatrix::Lumped, ..square_beam(HEIGHT, 100, Clamped, Free) };
    let omega = frequencies_of(&beam.assemble(&[]).unwrap(), DofKind::Deflection, 3);
    for (omega, beta) in omega.iter().zip(exact::clamped_free()) {
        assert_close(*omega, beta * beta * stiffness_to_mass(), 2e-3);
    }
}

#[test]
fn a_beam_has_the_axial_modes_of_a_rod() {
    let model = square_beam(0.2, 100, Clamped, Free).assemble(&[]).unwrap();
    let omega = frequencies_of(&model, DofKind::Axial, 3);
    for (i, omega) in omega.iter().enumerate() {
        assert_close(*omega, crate::closed_forms::clamped_free_rod((210e9 / 7800.0_f64).sqrt(), 1.0, i + 1), 3e-4);
    }
}
