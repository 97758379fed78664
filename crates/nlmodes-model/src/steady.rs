use nlmodes_linalg::Mat;

/// A constant force on a structure that floats, such as its weight, which its contacts alone can balance:
///
/// ```text
/// M q̈ + K q = W λ + f ,   K R = 0 ,   Rᵀ (W λ_0 + f) = 0
/// ```
///
/// with the mean contact forces `λ_0` of a periodic motion. What such a load strains can be part of the gaps; what it
/// does on the motions without strain cannot.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyForce {
    /// `f`, n, N or N m.
    pub force: Vec<f64>,
    /// `R`, n × k: motions without strain that the contacts feel.
    pub motions: Mat<f64>,
}

impl SteadyForce {
    /// That of these degrees of freedom alone.
    #[must_use]
    pub fn at(&self, dofs: &[usize]) -> Self {
        let motions = Mat::from_fn(dofs.len(), self.motions.ncols(), |i, r| self.motions[(dofs[i], r)]);
        Self { force: dofs.iter().map(|&dof| self.force[dof]).collect(), motions }
    }
}
