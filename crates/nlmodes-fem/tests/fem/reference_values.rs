//! Values of an independent computation for the rod and the beam of the examples.

use std::f64::consts::TAU;

use nlmodes_fem::{Direction, MassMatrix};
use nlmodes_model::{Drop, MasslessContactModel, Move, StructuralModel, held_modes};

use crate::common::{assert_close, cantilever, frequencies, rod, stop};

fn rod_with_stop(mass_matrix: MassMatrix) -> StructuralModel {
    rod(100, mass_matrix).assemble(&[stop(20.0, Direction::Axial)]).unwrap()
}

#[test]
fn rod_with_the_mass_of_its_tip_dropped() {
    let model = MasslessContactModel::new(&rod_with_stop(MassMatrix::Consistent), &Drop).unwrap();
    let omega = frequencies(model.mass(), model.stiffness(), 2);
    assert_close(omega[0] / TAU, 60.78660727, 1e-9 / 6.0);
    assert_close(omega[1] / TAU, 182.37496593, 1e-9 / 6.0);
    assert_close(held_modes(&model, 1).unwrap().omega[0] / TAU, 120.76643906, 1e-9 / 6.0);
}

#[test]
fn rod_with_the_mass_of_its_tip_kept() {
    let model = rod_with_stop(MassMatrix::Consistent);
    let omega = frequencies(model.mass(), model.stiffness(), 2);
    assert_close(omega[0] / TAU, 60.38135721, 1e-9 / 6.0);
    assert_close(omega[1] / TAU, 181.15897044, 1e-9 / 6.0);
}

#[test]
fn lumped_rod_with_the_mass_of_its_tip_dropped() {
    let model = MasslessContactModel::new(&rod_with_stop(MassMatrix::Lumped), &Drop).unwrap();
    let omega = frequencies(model.mass(), model.stiffness(), 2);
    assert_close(omega[0] / TAU, 60.684, 1e-5);
    assert_close(omega[1] / TAU, 182.035, 1e-5);
}

#[test]
fn rod_with_the_mass_of_its_tip_moved() {
    for kind in [MassMatrix::Consistent, MassMatrix::Lumped] {
        let model = MasslessContactModel::new(&rod_with_stop(kind), &Move).unwrap();
        let omega = frequencies(model.mass(), model.stiffness(), 2);
        assert!((omega[0] / TAU - 60.38).abs() < 0.005, "{kind:?}: {}", omega[0] / TAU);
        assert!((omega[1] / TAU - 181.16).abs() < 0.05, "{kind:?}: {}", omega[1] / TAU);
    }
}

#[test]
fn beam_with_and_without_the_mass_of_its_tip() {
    let dropped = cantilever(181.36e9).assemble(&[stop(0.62975520, Direction::Transverse)]).unwrap();
    let dropped = MasslessContactModel::new(&dropped, &Drop).unwrap();
    assert!((frequencies(dropped.mass(), dropped.stiffness(), 1)[0] / TAU - 40.10).abs() < 0.005);
    let kept = cantilever(187.60e9).assemble(&[]).unwrap();
    assert!((frequencies(kept.mass(), kept.stiffness(), 1)[0] / TAU - 40.10).abs() < 0.005);
    let h = cantilever(1.0).mesh.element_lengths().to_vec();
    assert!((h[20] - 7.97e-3).abs() < 5e-6, "last element {} m", h[20]);
}
