use nalgebra::SMatrix;

/// Mass matrix of an element.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum MassMatrix {
    /// From the shape functions of the stiffness: `∫ ρA Nᵀ N dx`.
    #[default]
    Consistent,
    /// Half of the mass at either node: a diagonal matrix.
    Lumped,
}

impl MassMatrix {
    /// Lower-case name, as used in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Lumped => "lumped",
        }
    }
}

/// Stiffness and mass of one element, N × N, symmetric, with the degrees of freedom of its first node before those of
/// its second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementMatrices<const N: usize> {
    /// Stiffness, N/m (N and N·m in rows and columns of rotations).
    pub stiffness: SMatrix<f64, N, N>,
    /// Mass, kg (kg·m and kg·m²).
    pub mass: SMatrix<f64, N, N>,
}
