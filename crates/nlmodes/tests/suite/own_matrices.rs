//! A branch of matrices of another program: what `docs/python.md` leads to.

use std::error::Error;

#[test]
fn matrices_of_another_program() -> Result<(), Box<dyn Error>> {
    use nlmodes::branches::{BranchSettings, compute_branch};
    use nlmodes::linalg::sparse_from_triplets;
    use nlmodes::model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

    // (row, column, value), both triangles; here two masses on springs and the node at the stop, k in N/m and m in kg.
    let mut k = vec![(0, 0, 3e4), (0, 1, -2e4), (1, 0, -2e4), (1, 1, 4e4)];
    k.extend([(1, 2, -2e4), (2, 1, -2e4), (2, 2, 2e4)]);
    let k = sparse_from_triplets(3, 3, &k)?;
    let m = sparse_from_triplets(3, 3, &[(0, 0, 0.2), (1, 1, 0.1), (2, 2, 0.01)])?;
    let dofs = [1, 2, 3].map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).to_vec();
    let stop = Contact::rigid(2, Side::Positive, 1e-3);
    let model = MasslessContactModel::new(&StructuralModel::new(m, k, dofs, vec![stop])?, &Drop)?;
    let settings = BranchSettings { max_energy_ratio: Some(10.0), ..BranchSettings::default() };
    let computed = compute_branch(model, &settings, |_| std::ops::ControlFlow::Continue(()))?;
    for point in &computed.branch.points {
        println!("{:.4} Hz at {:.3e} J", point.omega / std::f64::consts::TAU, point.total_energy);
    }

    // By hand, the massless node following the second mass: 0.02 λ² − 7e3 λ + 2e8 = 0 with λ = ω².
    let lowest = (7e3 - (49e6_f64 - 16e6).sqrt()) / 0.04;
    assert!((computed.branch.points[0].omega.powi(2) / lowest - 1.0).abs() < 1e-9);
    Ok(())
}
