//! Mass redistribution on assembled structures.

use nlmodes_fem::{Beam, Direction, MassMatrix, Mesh, Rod, Support};
use nlmodes_model::{Conserve, DofKind, Drop, MassProperties, MasslessContactModel, ModelError, Move, StructuralModel};

use crate::common::{assert_close, cantilever, frequencies, rod, stop};

fn assert_kept(model: &StructuralModel, kind: DofKind) {
    let moved = MasslessContactModel::new(model, &Move).unwrap();
    let before = MassProperties::of(model.mass(), model.dofs(), kind);
    let after = MassProperties::of(moved.mass(), moved.dofs(), kind);
    assert_close(after.total, before.total, 1e-14);
    assert_close(after.centre(), before.centre(), 1e-14);
    let conserved = MasslessContactModel::new(model, &Conserve).unwrap();
    let after = MassProperties::of(conserved.mass(), conserved.dofs(), kind);
    assert_close(after.total, before.total, 1e-14);
    assert_close(after.centre(), before.centre(), 1e-14);
    assert_close(after.moment_of_inertia, before.moment_of_inertia, 1e-14);
}

#[test]
fn mass_properties_are_those_of_the_body() {
    let free = Rod { start: Support::Free, ..rod(7, MassMatrix::Consistent) }.assemble(&[]).unwrap();
    let body = MassProperties::of(free.mass(), free.dofs(), DofKind::Axial);
    assert_close(body.total, 180e3, 1e-14);
    assert_close(body.centre(), 10.0, 1e-14);
    for mass_matrix in [MassMatrix::Consistent, MassMatrix::Lumped] {
        let free = Beam { start: Support::Free, mass_matrix, ..cantilever(200e9) }.assemble(&[]).unwrap();
        for kind in [DofKind::Axial, DofKind::Deflection] {
            let body = MassProperties::of(free.mass(), free.dofs(), kind);
            assert_close(body.total, 7730.0 * 0.012 * 0.020 * 0.62975520, 1e-13);
            assert_close(body.centre(), 0.62975520 / 2.0, 1e-13);
            let rotary = if kind == DofKind::Deflection && mass_matrix == MassMatrix::Consistent {
                0.020_f64.powi(2) / 12.0
            } else {
                0.0
            };
            let slender = body.total * (0.62975520_f64.powi(2) / 3.0 + rotary);
            // Half of the mass of an element at each of its nodes has a larger moment of inertia, by m l²/6 per
            // element.
            let tolerance = if mass_matrix == MassMatrix::Consistent { 1e-13 } else { 3e-2 };
            assert_close(body.moment_of_inertia, slender, tolerance);
        }
    }
}

#[test]
fn moving_keeps_mass_and_centre_of_rods() {
    for mass_matrix in [MassMatrix::Consistent, MassMatrix::Lumped] {
        for grading in [1.0, 9.0] {
            let mesh = Mesh::graded(20.0, 20, grading).unwrap();
            let rod = Rod { mesh, ..rod(1, mass_matrix) };
            let at = |i: usize| stop(rod.mesh.nodes()[i], Direction::Axial);
            for stops in [vec![at(20)], vec![at(9)], vec![at(9), at(10)], vec![at(5), at(12), at(20)]] {
                assert_kept(&rod.assemble(&stops).unwrap(), DofKind::Axial);
            }
        }
    }
}

#[test]
fn a_mesh_that_coarsens_towards_the_contact_has_too_little_mass_behind_it() {
    let rod = Rod { mesh: Mesh::graded(20.0, 20, 0.1).unwrap(), ..rod(1, MassMatrix::Consistent) };
    let model = rod.assemble(&[stop(20.0, Direction::Axial)]).unwrap();
    let error = MasslessContactModel::new(&model, &Move).unwrap_err();
    assert!(matches!(error, ModelError::IndefiniteMass { kind: DofKind::Axial, .. }), "{error}");
}

#[test]
fn moving_keeps_mass_and_centre_of_beams() {
    for mass_matrix in [MassMatrix::Consistent, MassMatrix::Lumped] {
        let beam = Beam { mass_matrix, ..cantilever(187.6e9) };
        let at = |i: usize, direction| stop(beam.mesh.nodes()[i], direction);
        let (along, across) = (Direction::Axial, Direction::Transverse);
        for stops in [vec![at(21, across)], vec![at(8, across)], vec![at(21, along), at(21, across), at(13, across)]] {
            let model = beam.assemble(&stops).unwrap();
            assert_kept(&model, DofKind::Axial);
            assert_kept(&model, DofKind::Deflection);
        }
    }
}

#[test]
fn moving_changes_the_first_frequency_less_than_dropping() {
    let beam = cantilever(187.6e9).assemble(&[stop(0.62975520, Direction::Transverse)]).unwrap();
    let rod = rod(100, MassMatrix::Consistent).assemble(&[stop(20.0, Direction::Axial)]).unwrap();
    for model in [beam, rod] {
        let kept = frequencies(model.mass(), model.stiffness(), 1)[0];
        let change = |massless: MasslessContactModel| {
            (frequencies(massless.mass(), massless.stiffness(), 1)[0] / kept - 1.0).abs()
        };
        let moved = change(MasslessContactModel::new(&model, &Move).unwrap());
        let dropped = change(MasslessContactModel::new(&model, &Drop).unwrap());
        assert!(moved < 0.01 * dropped, "moved {moved:e}, dropped {dropped:e}");
        let conserved = change(MasslessContactModel::new(&model, &Conserve).unwrap());
        assert!(conserved < 0.6 * moved, "moved {moved:e}, conserved {conserved:e}");
    }
}

#[test]
fn conserving_takes_more_nodes_where_the_mesh_coarsens_towards_the_contact() {
    let rod = Rod { mesh: Mesh::graded(20.0, 20, 0.1).unwrap(), ..rod(1, MassMatrix::Consistent) };
    let model = rod.assemble(&[stop(20.0, Direction::Axial)]).unwrap();
    let conserved = MasslessContactModel::new(&model, &Conserve).unwrap();
    let (before, after) =
        [model.mass(), conserved.mass()].map(|m| MassProperties::of(m, model.dofs(), DofKind::Axial)).into();
    assert_close(after.moment_of_inertia, before.moment_of_inertia, 1e-14);
    // No inertia decreases by more than 70 %.
    let d = model.dofs().len();
    assert!((0..d - 1).all(|i| conserved.mass()[(i, i)] >= 0.3 * model.mass()[(i, i)]));
}

#[test]
fn a_rod_too_short_to_conserve_its_inertia_says_so() {
    let model = rod(3, MassMatrix::Consistent).assemble(&[stop(20.0, Direction::Axial)]).unwrap();
    let error = MasslessContactModel::new(&model, &Conserve).unwrap_err();
    assert!(matches!(error, ModelError::TooFewNeighbours { found: 2, .. }), "{error}");
}
