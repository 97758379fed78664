//! Rigid-body motions of a structure in space.

use nlmodes_linalg::{Mat, SparseMatrix, max_norm, symmetric_eigen, triplets};

use crate::Dof;

/// Forces of a rigid motion below this fraction of the sum of their terms are rounding, even for matrices written with
/// ten digits.
const STRAINLESS: f64 = 1e-8;

/// Combinations of the six motions with less than this fraction (squared) of the displacement of the others are zero.
const STILL: f64 = 1e-12;

/// The motion `u(x) = t + r × x` with the least strain that also leaves `held` at rest, as `(t, r)`; none if it causes
/// strain.
///
/// With the six unit motions as columns of `R`, about the centre and with rotations over the size of the structure, the
/// rows of `K R` over `|K| max|R|` are dimensionless, for any mixture of displacements and rotations. The required
/// motion is the eigenvector of their Gram matrix with eigenvalue zero. Combinations of the six that move no degree of
/// freedom, as across a structure that can move in one direction only, are excluded first.
pub(super) fn motion(
    stiffness: &SparseMatrix,
    dofs: &[Dof],
    places: &[[f64; 3]],
    held: &[usize],
) -> Option<([f64; 3], [f64; 3])> {
    let (centre, size) = extent(places);
    let motions: Vec<[f64; 6]> = dofs.iter().zip(places).map(|(dof, x)| unit_motions(dof, x, centre, size)).collect();
    let mut force = vec![[0.0; 6]; dofs.len()];
    let mut scale = vec![0.0; dofs.len()];
    for (i, j, k) in triplets(stiffness) {
        let largest = max_norm(motions[j]);
        scale[i] += k.abs() * largest;
        (0..6).for_each(|c| force[i][c] += k * motions[j][c]);
    }
    for &i in held {
        (force[i], scale[i]) = (motions[i], max_norm(motions[i]));
    }
    let rows: Vec<[f64; 6]> =
        force.iter().zip(&scale).filter(|(_, s)| **s > 0.0).map(|(row, s)| row.map(|f| f / s)).collect();
    // The rotation of a node is multiplied by the size of the structure, so that the unit does not matter.
    let reach = |dof: &Dof| if dof.kind.rotation_axis().is_some() { size } else { 1.0 };
    let displaced: Vec<[f64; 6]> = dofs.iter().zip(&motions).map(|(dof, row)| row.map(|r| reach(dof) * r)).collect();
    let moving = moving(&displaced)?;
    let strains: Vec<Vec<f64>> = rows.iter().map(|row| moving.iter().map(|axis| inner(row, axis)).collect()).collect();
    let gram = Mat::from_fn(moving.len(), moving.len(), |a, b| strains.iter().map(|row| row[a] * row[b]).sum());
    let (_, vectors) = symmetric_eigen(&gram).ok()?;
    let c: [f64; 6] =
        std::array::from_fn(|k| moving.iter().enumerate().map(|(a, axis)| vectors[(a, 0)] * axis[k]).sum());
    let largest = max_norm(displaced.iter().map(|row| inner(row, &c)));
    let c = c.map(|c| c / largest);
    if rows.iter().any(|row| inner(row, &c).abs() > STRAINLESS) {
        return None;
    }
    let r = [c[3] / size, c[4] / size, c[5] / size];
    let at_centre = cross(r, centre);
    let t = std::array::from_fn(|a| c[a] - at_centre[a]);
    Some((t, r))
}

/// Combinations of the six motions that span all nonzero ones, with a mean square displacement of one; none if nothing
/// moves.
fn moving(motions: &[[f64; 6]]) -> Option<Vec<[f64; 6]>> {
    let count = motions.len().max(1) as f64;
    let squares = Mat::from_fn(6, 6, |a, b| motions.iter().map(|row| row[a] * row[b]).sum::<f64>() / count);
    let (values, axes) = symmetric_eigen(&squares).ok()?;
    let largest = max_norm(values.iter().copied());
    let moves = |k: &usize| values[*k] > STILL * largest;
    let axis = |k: usize| std::array::from_fn(|a| axes[(a, k)] / values[k].sqrt());
    let found: Vec<[f64; 6]> = (0..6).filter(moves).map(axis).collect();
    (!found.is_empty()).then_some(found)
}

fn inner(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Mean of the positions, and the largest distance from it; one for a structure at a single point.
fn extent(places: &[[f64; 3]]) -> ([f64; 3], f64) {
    let count = places.len().max(1) as f64;
    let centre = std::array::from_fn(|a| places.iter().map(|x| x[a]).sum::<f64>() / count);
    let distance = |x: &[f64; 3]| (0..3).map(|a| (x[a] - centre[a]).powi(2)).sum::<f64>().sqrt();
    let size = max_norm(places.iter().map(distance));
    (centre, if size > 0.0 { size } else { 1.0 })
}

/// The component of a degree of freedom in three translations and three rotations about `centre`, by one over `size`.
fn unit_motions(dof: &Dof, x: &[f64; 3], centre: [f64; 3], size: f64) -> [f64; 6] {
    let mut components = [0.0; 6];
    if let Some(axis) = dof.kind.translation_axis() {
        components[axis] = 1.0;
        let from_centre = std::array::from_fn(|a| x[a] - centre[a]);
        for about in 0..3 {
            let mut rotation = [0.0; 3];
            rotation[about] = 1.0 / size;
            components[3 + about] = cross(rotation, from_centre)[axis];
        }
    }
    if let Some(axis) = dof.kind.rotation_axis() {
        components[3 + axis] = 1.0 / size;
    }
    components
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use crate::{
        Contact, Dof, DofIndex, DofKind, Drop, MasslessContactModel, ModelError, RigidMotion, StructuralModel,
    };
    use nlmodes_linalg::{Triplet, sparse_from_triplets};

    /// Bars of stiffness 7 between all of five points of which no four lie in a plane, and springs to the ground.
    fn truss(ground: &[(usize, DofKind)], contact: Option<[f64; 3]>, length: f64) -> StructuralModel {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.1, 0.3], [0.1, 0.3, 1.2], [1.0, 1.2, 1.5]]
            .map(|p| p.map(|x| length * x));
        let mut k: Vec<Triplet> = Vec::new();
        for (a, b) in (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b))) {
            let d: [f64; 3] = std::array::from_fn(|i| points[b][i] - points[a][i]);
            let squared: f64 = d.iter().map(|d| d * d).sum();
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let v = 7.0 * d[i] * d[j] / squared;
                k.extend([(3 * a + i, 3 * a + j, v), (3 * b + i, 3 * b + j, v)]);
                k.extend([(3 * a + i, 3 * b + j, -v), (3 * b + i, 3 * a + j, -v)]);
            }
        }
        let kinds = [DofKind::X, DofKind::Y, DofKind::Z];
        for (node, kind) in ground {
            let i = 3 * node + kinds.iter().position(|k| k == kind).unwrap();
            k.push((i, i, 7.0));
        }
        let dofs: Vec<Dof> =
            (0..15).map(|i| Dof { node: i / 3, position: points[i / 3][0], kind: kinds[i % 3] }).collect();
        let contacts = contact.map(|n| Contact::point(&DofIndex::new(&dofs), 4, n, 0.1).unwrap()).into_iter().collect();
        let m: Vec<Triplet> = (0..15).map(|i| (i, i, 1.0)).collect();
        let [m, k] = [m, k].map(|entries| sparse_from_triplets(15, 15, &entries).unwrap());
        StructuralModel::new(m, k, dofs, contacts)
            .unwrap()
            .with_places((0..15).map(|i| points[i / 3]).collect())
            .unwrap()
    }

    fn held(model: &StructuralModel) -> Option<RigidMotion> {
        MasslessContactModel::new(model, &Drop).unwrap().held_rigid_motion()
    }

    #[test]
    fn a_free_body_moves_and_a_statically_held_one_does_not() {
        use DofKind::{X, Y, Z};
        for length in [1.0, 1e3, 1e-3] {
            assert!(held(&truss(&[], Some([0.0, 0.0, 1.0]), length)).is_some());
            // Six supports in total, including the contact: fixed.
            let five = [(0, X), (0, Y), (0, Z), (1, Y), (2, Z)];
            assert_eq!(held(&truss(&five, Some([0.0, 0.0, 1.0]), length)), None);
            // The rotation about the axis through nodes 0 and 1 remains if the contact does not prevent it.
            let model = truss(&[(0, X), (0, Y), (0, Z), (1, Y), (1, Z)], None, length);
            let model = model
                .clone()
                .with_contacts(vec![Contact::point(&DofIndex::new(model.dofs()), 0, [1.0, 0.0, 0.0], 0.1).unwrap()])
                .unwrap();
            match held(&model) {
                Some(RigidMotion::Spatial { translation, rotation }) => {
                    let size = rotation.iter().map(|r| r * r).sum::<f64>().sqrt();
                    // Node 0 is the origin; the axis passes through node 1 at (1, 0.1, 0).
                    assert!(translation.iter().all(|t| t.abs() < 1e-9 * size * length));
                    assert!((rotation[1] / rotation[0] - 0.1).abs() < 1e-9 && rotation[2].abs() < 1e-9 * size);
                }
                other => panic!("{other:?}"),
            }
        }
    }

    /// Masses in a row that can move along x only, with a spring to ground at the first or none, and a stop at the
    /// last.
    fn chain(ground: f64, stiffness: f64, length: f64) -> StructuralModel {
        let n = 4;
        let mut k: Vec<Triplet> = vec![(0, 0, ground)];
        for i in 1..n {
            let s = stiffness;
            k.extend([(i - 1, i - 1, s), (i, i, s), (i - 1, i, -s), (i, i - 1, -s)]);
        }
        let m: Vec<Triplet> = (0..n).map(|i| (i, i, 1.0)).collect();
        let [m, k] = [m, k].map(|entries| sparse_from_triplets(n, n, &entries).unwrap());
        let dofs: Vec<Dof> = (0..n).map(|i| Dof { node: i, position: length * i as f64, kind: DofKind::X }).collect();
        let contact = Contact::point(&DofIndex::new(&dofs), n - 1, [1.0, 0.0, 0.0], 0.1).unwrap();
        let places = (0..n).map(|i| [length * i as f64, 0.0, 0.0]).collect();
        StructuralModel::new(m, k, dofs, vec![contact]).unwrap().with_places(places).unwrap()
    }

    #[test]
    fn motions_that_a_structure_in_one_direction_does_not_have_are_none() {
        for (length, stiffness) in [(1.0, 7.0), (1e3, 7e9), (1e-3, 7e-12)] {
            // The stop prevents the only rigid motion; nothing moves transversely.
            assert_eq!([stiffness, 0.0].map(|ground| held(&chain(ground, stiffness, length))), [None, None]);
            let free = |ground: f64| {
                MasslessContactModel::new(&chain(ground, stiffness, length), &Drop).unwrap().rigid_motion()
            };
            assert_eq!(free(stiffness), None);
            match free(0.0) {
                Some(RigidMotion::Spatial { translation: [x, y, z], .. }) => {
                    assert!((x.abs() - 1.0).abs() < 1e-9 && y.abs() < 1e-9 && z.abs() < 1e-9, "{x} {y} {z}");
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn what_the_partition_cannot_do_is_refused() {
        let slanted = truss(&[], Some([0.0, 1.0, 1.0]), 1.0);
        let error = MasslessContactModel::new(&slanted, &Drop).unwrap_err();
        assert_eq!(error, ModelError::NotASingleDof { contact: 0, dofs: 2 });
        assert!(error.to_string().contains("use open modes"), "{error}");
        let straight = truss(&[], Some([0.0, 1.0, 0.0]), 1.0);
        let moved = MasslessContactModel::new(&straight, &crate::Move).unwrap_err();
        assert_eq!(moved, ModelError::StraightOnly { rule: "move", dof: 13 });
        let (m, k) = (straight.shared_mass(), straight.shared_stiffness());
        let nowhere = StructuralModel::new(m, k, straight.dofs().to_vec(), straight.contacts().to_vec()).unwrap();
        assert_eq!(MasslessContactModel::new(&nowhere, &Drop).unwrap_err(), ModelError::PlacesUnknown);
    }
}
