//! Where a correction looks for its point.

use crate::vectors::{distance, dot};

/// The plane `normal · z = offset` on which a correction looks for its point.
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperplane {
    /// Normal, n + 1.
    pub normal: Vec<f64>,
    /// Offset.
    pub offset: f64,
}

impl Hyperplane {
    /// Through `point`, across `normal`.
    pub fn through(point: &[f64], normal: &[f64]) -> Self {
        Self { normal: normal.to_vec(), offset: dot(point, normal) }
    }

    /// Where coordinate `index` of `dim` has this value.
    pub fn fixing(index: usize, value: f64, dim: usize) -> Self {
        let mut normal = vec![0.0; dim];
        normal[index] = 1.0;
        Self { normal, offset: value }
    }
}

/// Where a correction looks for its point: the equation that makes n equations for n + 1 unknowns square.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Surface {
    Plane(Hyperplane),
    Sphere { center: Vec<f64>, radius: f64 },
}

impl Surface {
    pub(super) fn is_plane(&self) -> bool {
        matches!(self, Self::Plane(_))
    }

    /// That of a sphere.
    pub(super) fn radius(&self) -> Option<f64> {
        match self {
            Self::Plane(_) => None,
            Self::Sphere { radius, .. } => Some(*radius),
        }
    }

    /// Signed distance of `z` from the surface, for a sphere to first order.
    pub(super) fn defect(&self, z: &[f64]) -> f64 {
        match self {
            Self::Plane(plane) => dot(&plane.normal, z) - plane.offset,
            Self::Sphere { center, radius } => {
                let d = distance(z, center);
                0.5 * (d * d / radius - radius)
            }
        }
    }

    pub(super) fn normal(&self, z: &[f64], into: &mut [f64]) {
        match self {
            Self::Plane(plane) => into.copy_from_slice(&plane.normal),
            Self::Sphere { center, radius } => {
                into.iter_mut().zip(z).zip(center).for_each(|((n, z), c)| *n = (z - c) / radius);
            }
        }
    }
}
