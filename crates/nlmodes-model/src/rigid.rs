use std::fmt;

use nlmodes_linalg::{SparseMatrix, bilinear, triplets};

use crate::{Dof, DofKind};

mod spatial;

/// A motion of a structure that strains nothing.
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
    /// A rigid motion that neither `stiffness` nor holding the degrees of freedom `held` prevents.
    ///
    /// This looks at `K r = 0` row by row instead of at pivots: fine beams have such small pivots that a factorisation cannot
    /// tell a supported structure from a floating one.
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
        // Some support holds the deflection: a rotation about it may be left, `K (ρ − a r) = 0`.
        let (k_across, k_about) = (image(stiffness, &across).0, image(stiffness, &about_origin).0);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let about = product(&k_across, &k_about) / product(&k_across, &k_across);
        about.is_finite().then(|| rotation_about(about, stiffness, dofs, held)).flatten()
    }
}

/// The rotation about `about`, if it strains nothing and moves no held degree of freedom.
fn rotation_about(about: f64, stiffness: &SparseMatrix, dofs: &[Dof], held: &[usize]) -> Option<RigidMotion> {
    let across = translation(dofs, DofKind::Deflection);
    let motion: Vec<f64> = rotation(dofs).iter().zip(&across).map(|(rotation, r)| rotation - about * r).collect();
    let size = motion.iter().fold(0.0_f64, |l, v| l.max(v.abs()));
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

/// `K r` and `|K| |r|`.
pub(super) fn image(stiffness: &SparseMatrix, r: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut force, mut scale) = (vec![0.0; r.len()], vec![0.0; r.len()]);
    for (i, j, k) in triplets(stiffness) {
        force[i] += k * r[j];
        scale[i] += (k * r[j]).abs();
    }
    (force, scale)
}

fn strains_nothing(stiffness: &SparseMatrix, r: &[f64]) -> bool {
    let (force, scale) = image(stiffness, r);
    r.iter().any(|v| *v != 0.0) && force.iter().zip(&scale).all(|(f, s)| f.abs() <= 1e-12 * s)
}

/// Mass and its moments in rigid motions, of the free degrees of freedom.
///
/// `m = rᵀ M r`, `s = rᵀ M ρ` and `J = ρᵀ M ρ`, where `r` translates the structure in the direction of the kind and `ρ` displaces each point by
/// its position `x`: a rotation about `x = 0` for deflections (with the rotations of the cross sections), a stretch for axial
/// displacements. Mass at supported degrees of freedom is not in `M` and so not counted.
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
    /// Mass and first moment of what moves in the direction of `kind`.
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
