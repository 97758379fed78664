//! Points between nodes.

use nlmodes_fem::{Beam, FemError, MassMatrix, Material, Mesh, Rod, Section, Support};
use nlmodes_linalg::SparseCholesky;

fn beam(mesh: Mesh) -> Beam {
    Beam {
        material: Material::new(187.6e9, 7730.0).unwrap(),
        section: Section::rectangle(0.012, 0.02).unwrap(),
        mesh,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    }
}

/// Deflection of the tip-loaded cantilever per newton: `x² (3L − x) / 6EI + x / κGA`, which one element has exactly.
fn tip_loaded(x: f64, length: f64) -> f64 {
    let (ei, ga) = (187.6e9 * 0.012 * 0.02f64.powi(3) / 12.0, 5.0 / 6.0 * 187.6e9 / 2.6 * 0.012 * 0.02);
    x * x * (3.0 * length - x) / (6.0 * ei) + x / ga
}

#[test]
fn a_tip_loaded_beam_is_exact_between_its_nodes() {
    let length = 0.3;
    for elements in [1, 3] {
        let beam = beam(Mesh::graded(length, elements, 2.0).unwrap());
        let model = beam.assemble(&[]).unwrap();
        let statics = SparseCholesky::factor(model.stiffness(), "stiffness").unwrap();
        let at = |x: f64| beam.deflection_at(model.dofs(), x).unwrap();
        let mut q = vec![0.0; model.dofs().len()];
        at(length).iter().for_each(|&(dof, weight)| q[dof] = weight);
        statics.solve_in_place(&mut q);
        for share in [0.0, 0.01, 0.2, 0.55, 0.9, 1.0] {
            let w: f64 = at(share * length).iter().map(|&(dof, weight)| weight * q[dof]).sum();
            assert!((w - tip_loaded(share * length, length)).abs() < 1e-11 * tip_loaded(length, length), "{share}");
        }
    }
}

#[test]
fn nodes_have_their_own_degree_of_freedom_and_held_ones_none() {
    let beam = beam(Mesh::uniform(1.0, 4).unwrap());
    let model = beam.assemble(&[]).unwrap();
    let at = beam.deflection_at(model.dofs(), 0.5).unwrap();
    assert_eq!(at.len(), 1);
    assert!((at[0].1 - 1.0).abs() < 1e-14 && model.dofs()[at[0].0].node == 2);
    assert_eq!(beam.deflection_at(model.dofs(), 0.0).unwrap(), vec![]);
    assert!(beam.deflection_at(model.dofs(), 1.0 + 1e-12).is_ok());
    for asked in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(beam.deflection_at(model.dofs(), asked), Err(FemError::OutsideMesh { length: 1.0, .. })));
    }
}

#[test]
fn rods_are_linear_between_their_nodes() {
    let rod = Rod {
        material: Material::new(210e9, 9000.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(2.0, 2).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = rod.assemble(&[]).unwrap();
    assert_eq!(rod.displacement_at(model.dofs(), 1.25).unwrap(), vec![(0, 0.75), (1, 0.25)]);
    assert_eq!(rod.displacement_at(model.dofs(), 0.5).unwrap(), vec![(0, 0.5)]);
}
