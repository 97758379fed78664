//! Necessary conditions on the entries of a mass matrix for nonnegative kinetic energy.

use nlmodes_linalg::{SparseMatrix, triplets};

use crate::{Dof, ModelError};

/// Entries below this fraction of the largest one of their kind may be rounding.
const ROUNDING: f64 = 1e-9;

/// Entries below this fraction of the largest masses are rounding wherever they are: some hundred times that of a sum.
const LEAST: f64 = 1e-14;

/// Rejects negative principal minors of one and two rows: `m_ii ≥ 0` and `m_ij² ≤ m_ii m_jj` hold wherever `½ vᵀ M v ≥
/// 0` does.
///
/// # Errors
/// [`ModelError::NegativeMass`], [`ModelError::CoupledMass`].
pub fn check_mass(mass: &SparseMatrix, dofs: &[Dof]) -> Result<(), ModelError> {
    let mut diagonal = vec![0.0; dofs.len()];
    triplets(mass).filter(|(i, j, _)| i == j).for_each(|(i, _, value)| diagonal[i] += value);
    // Masses and moments of inertia are not compared with each other.
    let largest = |kind| {
        let alike = dofs.iter().zip(&diagonal).filter(|(other, _)| other.kind == kind);
        alike.fold(0.0_f64, |largest, (_, m)| largest.max(*m))
    };
    for (dof, &value) in diagonal.iter().enumerate().filter(|(_, value)| value.is_sign_negative()) {
        let Dof { node, position, kind } = dofs[dof];
        if -value > ROUNDING * largest(kind) {
            return Err(ModelError::NegativeMass { dof, node, position, kind, value });
        }
    }
    for (row, column, value) in triplets(mass).filter(|(i, j, _)| i < j) {
        let [a, b] = [row, column].map(|i| diagonal[i].max(0.0));
        let most = a.sqrt() * b.sqrt();
        if value.abs() > (1.0 + ROUNDING) * most && value.abs() > ROUNDING * a.max(b) {
            // Between rows without mass, too, what is far below all masses is rounding.
            let [a, b] = [row, column].map(|i| largest(dofs[i].kind));
            if value.abs() > LEAST * a.sqrt() * b.sqrt() {
                return Err(ModelError::CoupledMass { row, column, value, most });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DofKind;
    use nlmodes_linalg::{Triplet, sparse_from_triplets};

    fn check(entries: &[Triplet], unit: f64) -> Result<(), ModelError> {
        let scaled: Vec<Triplet> = entries.iter().map(|&(i, j, m)| (i, j, unit * m)).collect();
        let kinds = [DofKind::Deflection, DofKind::Rotation, DofKind::Deflection];
        let dofs: Vec<Dof> = (0..3).map(|node| Dof { node, position: node as f64, kind: kinds[node] }).collect();
        check_mass(&sparse_from_triplets(3, 3, &scaled).unwrap(), &dofs)
    }

    #[test]
    fn a_negative_mass_is_refused_with_its_place_in_any_unit() {
        for unit in [1.0, 1e-9, 1e6] {
            let error = check(&[(0, 0, 1.0), (1, 1, 1e-6), (2, 2, -2.0)], unit).unwrap_err();
            let kind = DofKind::Deflection;
            assert_eq!(error, ModelError::NegativeMass { dof: 2, node: 2, position: 2.0, kind, value: -2.0 * unit });
            // A moment of inertia may be much smaller than the masses.
            let error = check(&[(0, 0, 1.0), (1, 1, -1e-12), (2, 2, 1.0)], unit).unwrap_err();
            assert!(matches!(error, ModelError::NegativeMass { dof: 1, .. }), "{error}");
        }
    }

    #[test]
    fn two_masses_are_not_coupled_by_more_than_they_have() {
        let coupled = |m: f64| vec![(0, 0, 4.0), (1, 1, 1.0), (0, 1, m), (1, 0, m), (2, 2, 1.0)];
        for unit in [1.0, 1e-9, 1e6] {
            check(&coupled(2.0), unit).unwrap();
            for m in [2.1, -2.1] {
                let error = check(&coupled(m), unit).unwrap_err();
                let expected = ModelError::CoupledMass { row: 0, column: 1, value: m * unit, most: 2.0 * unit };
                assert!(error.to_string() == expected.to_string(), "{error}");
            }
        }
    }

    /// CalculiX writes such entries for B31R: -3.3e-24 t between two rows without mass, beside 1e-7 t.
    #[test]
    fn rounding_between_rows_without_mass_is_no_mass() {
        let dofs: Vec<Dof> =
            (0..3).map(|node| Dof { node, position: node as f64, kind: DofKind::Deflection }).collect();
        let check = |between: f64| {
            let entries = [(0, 0, 1e-7), (1, 1, -3.3e-24), (1, 2, between), (2, 1, between)];
            check_mass(&sparse_from_triplets(3, 3, &entries).unwrap(), &dofs)
        };
        check(-3.3e-24).unwrap();
        assert!(matches!(check(1e-17), Err(ModelError::CoupledMass { row: 1, column: 2, .. })));
    }

    #[test]
    fn massless_rows_and_rounding_are_no_negative_masses() {
        check(&[(0, 0, 1.0), (2, 2, -1e-17)], 1.0).unwrap();
        check(&[(0, 0, 1.0), (2, 2, 0.0), (0, 2, 1e-18), (2, 0, 1e-18)], 1.0).unwrap();
        // The consistent mass of a beam element, whose minors are positive.
        let (a, b, c, d) = (156.0, 22.0, 4.0, -13.0);
        check(
            &[
                (0, 0, a),
                (0, 1, b),
                (1, 0, b),
                (1, 1, c),
                (0, 2, 54.0),
                (2, 0, 54.0),
                (2, 2, a),
                (1, 2, -d),
                (2, 1, -d),
            ],
            1.0,
        )
        .unwrap();
    }
}
