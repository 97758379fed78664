//! No locking of a beam whose length is ten thousand times its height.

use nlmodes_fem::{Beam, Mesh, Support};
use nlmodes_linalg::SparseCholesky;
use nlmodes_model::DofKind;

use crate::closed_forms::euler_bernoulli;
use crate::common::{assert_close, frequencies_of, square_beam};

const HEIGHT: f64 = 1e-4;

/// Tip deflection due to a unit tip force.
fn tip_compliance(beam: &Beam) -> f64 {
    let model = beam.assemble(&[]).unwrap();
    let tip = model.dofs().iter().rposition(|d| d.kind == DofKind::Deflection).unwrap();
    let mut x = vec![0.0; model.dofs().len()];
    x[tip] = 1.0;
    SparseCholesky::factor(model.stiffness(), "stiffness").unwrap().solve_in_place(&mut x);
    x[tip]
}

/// `L³ / 3EI + L / κGA`.
fn expected(height: f64) -> f64 {
    let (e, kg) = (210e9, 5.0 / 6.0 * 210e9 / 2.6);
    4.0 / (e * height.powi(4)) + 1.0 / (kg * height * height)
}

#[test]
fn static_deflection_does_not_depend_on_the_mesh() {
    // One element is exact; with n elements rounding errors grow with the condition number of the stiffness, about n⁴.
    for (elements, tolerance) in [(1, 1e-13), (10, 1e-11), (100, 1e-7)] {
        let beam = square_beam(HEIGHT, elements, Support::Clamped, Support::Free);
        assert_close(tip_compliance(&beam), expected(HEIGHT), tolerance);
    }
    let graded =
        Beam { mesh: Mesh::graded(1.0, 20, 9.0).unwrap(), ..square_beam(HEIGHT, 1, Support::Clamped, Support::Free) };
    assert_close(tip_compliance(&graded), expected(HEIGHT), 1e-8);
}

#[test]
fn static_deflection_of_a_thick_beam_includes_shear() {
    for elements in [1, 3] {
        let beam = square_beam(0.5, elements, Support::Clamped, Support::Free);
        assert_close(tip_compliance(&beam), expected(0.5), 1e-12);
    }
}

#[test]
fn first_frequency_is_that_of_an_euler_bernoulli_beam() {
    let beta = euler_bernoulli::clamped_free();
    let unit = (210e9 / 7800.0_f64).sqrt() * HEIGHT / 12.0_f64.sqrt();
    // Error of the mesh (β/n)⁴ / 1440, rounding 1e-16 n⁴.
    for (elements, tolerance) in [(10, 2e-6), (30, 2e-8), (60, 1e-8)] {
        let model = square_beam(HEIGHT, elements, Support::Clamped, Support::Free).assemble(&[]).unwrap();
        assert_close(frequencies_of(&model, DofKind::Deflection, 1)[0], beta[0] * beta[0] * unit, tolerance);
    }
}
