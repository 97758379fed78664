use std::fmt;

use nlmodes_linalg::{SparseMatrix, bilinear, max_norm, multiply, triplets};

use crate::{Dof, DofKind};

mod spatial;

/// A motion of a structure without strain.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum RigidMotion {
    /// Translation along the axis.
    Axial,
    /// Translation across the axis.
    Transverse,
    /// Rotation about a point of the axis.
    Rotation {
        /// Position of the point, m.
        about: f64,
    },
    /// Motion of a structure in space: `u(x) = t + r × x`; the larger of both, over the size of the structure, is one.
    Spatial {
        /// Displacement `t` of the origin.
        translation: [f64; 3],
        /// Rotation `r`, 1/m.
        rotation: [f64; 3],
    },
}

impl fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axial => write!(f, "translation along the axis"),
            Self::Transverse => write!(f, "translation across the axis"),
            Self::Rotation { about } => write!(f, "rotation about x = {about} m"),
            Self::Spatial { translation: [x, y, z], rotation: [rx, ry, rz] } => {
                write!(f, "translation ({x:.3}, {y:.3}, {z:.3}) with rotation ({rx:.3}, {ry:.3}, {rz:.3})/m")
            }
        }
    }
}

impl RigidMotion {
    /// A rigid motion that neither `stiffness` nor fixing the degrees of freedom `held` prevents.
    ///
    /// This checks `K r = 0` row by row instead of pivots: fine beams have such small pivots that a factorisation
    /// cannot distinguish a supported structure from a floating one.
    ///
    /// `places` are the coordinates of the nodes of a structure in space.
    pub(crate) fn of_held(
        stiffness: &SparseMatrix,
        dofs: &[Dof],
        places: Option<&[[f64; 3]]>,
        held: &[usize],
    ) -> Option<Self> {
        if let Some(places) = places {
            let (translation, rotation) = spatial::motion(stiffness, dofs, places, held)?;
            return Some(Self::Spatial { translation, rotation });
        }
        let holds = |kind: DofKind| held.iter().any(|&i| dofs[i].kind == kind);
        let axial = translation(dofs, DofKind::Axial);
        if !holds(DofKind::Axial) && strains_nothing(stiffness, &axial) {
            return Some(Self::Axial);
        }
        let across = translation(dofs, DofKind::Deflection);
        let about_origin = rotation(dofs);
        if strains_nothing(stiffness, &across) {
            if !holds(DofKind::Deflection) {
                return Some(Self::Transverse);
            }
            let pivot = held.iter().find(|&&i| dofs[i].kind == DofKind::Deflection).map(|&i| dofs[i].position);
            return pivot.and_then(|about| rotation_about(about, stiffness, dofs, held));
        }
        // A support fixes the deflection: a rotation about it may remain, `K (ρ − a r) = 0`.
        let (k_across, k_about) = (multiply(stiffness, &across), multiply(stiffness, &about_origin));
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let about = product(&k_across, &k_about) / product(&k_across, &k_across);
        about.is_finite().then(|| rotation_about(about, stiffness, dofs, held)).flatten()
    }
}

/// The rotation about `about`, if it causes no strain and moves no fixed degree of freedom.
fn rotation_about(about: f64, stiffness: &SparseMatrix, dofs: &[Dof], held: &[usize]) -> Option<RigidMotion> {
    let across = translation(dofs, DofKind::Deflection);
    let motion: Vec<f64> = rotation(dofs).iter().zip(&across).map(|(rotation, r)| rotation - about * r).collect();
    let size = max_norm(motion.iter().copied());
    let held_still = held.iter().all(|&i| motion[i].abs() <= 1e-9 * size);
    (held_still && strains_nothing(stiffness, &motion)).then_some(RigidMotion::Rotation { about })
}

/// Displacements of the unit translation that `kind` measures.
pub(crate) fn translation(dofs: &[Dof], kind: DofKind) -> Vec<f64> {
    dofs.iter().map(|d| f64::from(u8::from(d.kind == kind))).collect()
}

/// Displacements of the unit rotation about `x = 0`.
fn rotation(dofs: &[Dof]) -> Vec<f64> {
    let component = |d: &Dof| match d.kind {
        DofKind::Deflection => d.position,
        DofKind::Rotation => 1.0,
        _ => 0.0,
    };
    dofs.iter().map(component).collect()
}

/// Whether `K r` is rounding compared with `|K| |r|`, row by row, for a nonzero motion.
fn strains_nothing(stiffness: &SparseMatrix, r: &[f64]) -> bool {
    let mut scale = vec![0.0; r.len()];
    triplets(stiffness).for_each(|(i, j, k)| scale[i] += (k * r[j]).abs());
    r.iter().any(|v| *v != 0.0) && multiply(stiffness, r).iter().zip(&scale).all(|(f, s)| f.abs() <= 1e-12 * s)
}

/// Mass and its moments in rigid motions, of the free degrees of freedom.
///
/// `m = rᵀ M r`, `s = rᵀ M ρ` and `J = ρᵀ M ρ`, where `r` translates the structure in the direction of the kind and `ρ`
/// displaces each point by its position `x`: a rotation about `x = 0` for deflections (with the rotations of the cross
/// sections), a uniform extension for axial displacements. Mass at supported degrees of freedom is not in `M` and
/// therefore not included.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MassProperties {
    /// Total mass `m`, kg (rotary inertia in kg·m² for rotations).
    pub total: f64,
    /// First moment `s`, kg·m.
    pub first_moment: f64,
    /// Moment of inertia `J = ρᵀ M ρ` about `x = 0`, kg·m².
    pub moment_of_inertia: f64,
}

impl MassProperties {
    /// Mass and first moment of the motion in the direction of `kind`.
    ///
    /// # Panics
    /// If the size of `mass` is not the number of degrees of freedom.
    pub fn of(mass: &SparseMatrix, dofs: &[Dof], kind: DofKind) -> Self {
        let (r, rho) = (translation(dofs, kind), positions(dofs, kind));
        Self {
            total: bilinear(&r, mass, &r),
            first_moment: bilinear(&r, mass, &rho),
            moment_of_inertia: bilinear(&rho, mass, &rho),
        }
    }

    /// Centre of mass `s/m`, m.
    pub fn centre(&self) -> f64 {
        self.first_moment / self.total
    }
}

/// The vector `ρ` of [`MassProperties`].
pub(crate) fn positions(dofs: &[Dof], kind: DofKind) -> Vec<f64> {
    match kind {
        DofKind::Deflection => rotation(dofs),
        kind => dofs.iter().map(|d| if d.kind == kind { d.position } else { 0.0 }).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Contact, Drop, MasslessContactModel, Side, StructuralModel};
    use nlmodes_linalg::{Triplet, sparse_from_triplets};

    /// Four nodes across an axis from `from` on, `length` apart, whose bending `q_{i−1} − 2 q_i + q_{i+1}` is strained;
    /// a spring to the ground at some nodes, a stop at the third. The first node is fixed along the axis.
    fn beam(from: f64, length: f64, stiffness: f64, grounds: &[usize]) -> MasslessContactModel {
        let mut k: Vec<Triplet> = vec![(4, 4, stiffness)];
        let bending = [1.0, -2.0, 1.0];
        for first in 0..2 {
            let pairs = (0..9).map(|p| (p / 3, p % 3));
            k.extend(pairs.map(|(i, j)| (first + i, first + j, stiffness * bending[i] * bending[j])));
        }
        k.extend(grounds.iter().map(|&i| (i, i, stiffness)));
        let m: Vec<Triplet> = (0..5).map(|i| (i, i, 1.0)).collect();
        let [m, k] = [m, k].map(|entries| sparse_from_triplets(5, 5, &entries).unwrap());
        let dof = |node: usize| Dof { node, position: from + length * node as f64, kind: DofKind::Deflection };
        let along = Dof { kind: DofKind::Axial, ..dof(0) };
        let contact = Contact::rigid(2, Side::Positive, 0.1);
        let model = StructuralModel::new(m, k, (0..4).map(dof).chain([along]).collect(), vec![contact]).unwrap();
        MasslessContactModel::new(&model, &Drop).unwrap()
    }

    /// For motions in one direction only: masses across it, next to it and coupled with it are not included; rotary
    /// inertias are.
    #[test]
    fn each_direction_has_its_own_mass() {
        let of = |position, kind| Dof { node: 0, position, kind };
        use DofKind::{Axial, Deflection, Rotation};
        let dofs = [of(1.0, Axial), of(3.0, Axial), of(2.0, Deflection), of(5.0, Deflection), of(5.0, Rotation)];
        let masses = [2.0, 0.5, 4.0, 8.0, 16.0];
        let entries: Vec<Triplet> = (0..5).map(|i| (i, i, masses[i])).chain([(0, 2, 0.25), (2, 0, 0.25)]).collect();
        let mass = sparse_from_triplets(5, 5, &entries).unwrap();
        for (kind, total, first_moment, moment_of_inertia) in
            [(Axial, 2.5, 3.5, 6.5), (Deflection, 12.0, 48.0, 16.0 + 200.0 + 16.0), (Rotation, 16.0, 80.0, 400.0)]
        {
            assert_eq!(
                MassProperties::of(&mass, &dofs, kind),
                MassProperties { total, first_moment, moment_of_inertia }
            );
        }
    }

    #[test]
    fn a_beam_floats_turns_about_what_holds_it_or_stands_in_any_unit() {
        for (from, length, stiffness) in [(0.0, 1.0, 1.0), (-0.7, 1e-3, 1e-6), (20.0, 5.0, 1e9), (0.3, 1.0, 1e-15)] {
            let free = beam(from, length, stiffness, &[]);
            assert_eq!(free.rigid_motion(), Some(RigidMotion::Transverse));
            let about = |found: Option<RigidMotion>| match found {
                Some(RigidMotion::Rotation { about }) => (about - from) / length,
                other => panic!("{other:?}"),
            };
            // The contact fixes the free one; a spring restrains it elsewhere; both together leave no motion.
            assert_eq!(about(free.held_rigid_motion()), (from + 2.0 * length - from) / length);
            for node in [0, 1, 3] {
                let hinged = beam(from, length, stiffness, &[node]);
                assert!((about(hinged.rigid_motion()) - node as f64).abs() < 1e-9);
                assert_eq!(hinged.held_rigid_motion(), None);
            }
            assert!((about(beam(from, length, stiffness, &[2]).held_rigid_motion()) - 2.0).abs() < 1e-9);
            assert_eq!(beam(from, length, stiffness, &[0, 3]).rigid_motion(), None);
        }
    }
}
