use num_complex::Complex64;

use super::load::Load;
use super::operating_point::OperatingPoint;
use super::structure::ModalStructure;

/// The linear structure at one harmonic, evaluated at given coordinates and contact forces.
///
/// ```text
/// r_n = L_n x_n − G_n λ̂_n − load_n ,   λ̂ = Pᵀ λ ,   y = g₀ + P x + a
/// ```
///
/// Matrices are row-major, d × d. Derivatives are with respect to ω, ξ and the level, at fixed `x` and `λ̂`.
#[derive(Debug, Clone, Default)]
pub(crate) struct HarmonicBlock {
    pub l: Vec<Complex64>,
    pub g: Vec<Complex64>,
    pub residual: Vec<Complex64>,
    pub d_residual: [Vec<Complex64>; 3],
    /// Modal coordinates, m.
    pub eta: Vec<Complex64>,
    pub d_eta: [Vec<Complex64>; 3],
    /// `D_k` of each mode (its diagonal where damping couples modes).
    pub d: Vec<Complex64>,
    /// The mode that is kept apart, with `ρ²`, in contact coordinates.
    pub pole: Option<(usize, f64)>,
}

impl HarmonicBlock {
    /// Room for d coordinates and m modes, all zero.
    pub fn reset(&mut self, coordinates: usize, modes: usize) {
        let zero = Complex64::default();
        let fill = |v: &mut Vec<Complex64>, n: usize| {
            v.clear();
            v.resize(n, zero);
        };
        fill(&mut self.l, coordinates * coordinates);
        fill(&mut self.g, coordinates * coordinates);
        fill(&mut self.residual, coordinates);
        fill(&mut self.eta, modes);
        fill(&mut self.d, modes);
        self.d_residual.iter_mut().for_each(|v| fill(v, coordinates));
        self.d_eta.iter_mut().for_each(|v| fill(v, modes));
        self.pole = None;
    }
}

/// A linear structure in coordinates of its choice.
pub(crate) trait LinearResponse {
    /// Number of coordinates d.
    fn n_coordinates(&self) -> usize;

    /// `P_ij`: how coordinate j moves gap i.
    fn gap_row(&self, i: usize, j: usize) -> f64;

    /// Coordinates of open mode k with the modal coordinate one.
    fn of_mode(&self, k: usize) -> Vec<f64>;

    /// Unit of the coordinates for lengths near `length`.
    fn scale(&self, length: f64) -> f64;

    /// Writes the block of harmonic `n`.
    fn evaluate(
        &self,
        n: usize,
        at: OperatingPoint,
        load: &Load,
        x: &[Complex64],
        force: &[Complex64],
        out: &mut HarmonicBlock,
    );

    /// `wᵀ ∂η/∂x` and `wᵀ ∂η/∂λ̂` for weights `w` (m) of the modal coordinates of an evaluated block.
    fn pull(&self, block: &HarmonicBlock, weights: &[Complex64]) -> (Vec<Complex64>, Vec<Complex64>);
}

/// `D_kk` with its derivatives with respect to ω and ξ.
pub(crate) fn dynamic_stiffness(
    structure: &ModalStructure,
    n: usize,
    k: usize,
    at: OperatingPoint,
) -> (Complex64, [Complex64; 2]) {
    let (n, mass) = (n as f64, structure.inertia()[k]);
    let c = structure.damping().entry(k, k) - mass * at.xi;
    let nu = n * at.omega;
    let value = Complex64::new(structure.omega_squared()[k] - mass * nu * nu, nu * c);
    (value, [Complex64::new(-2.0 * n * nu * mass, n * c), Complex64::new(0.0, -nu * mass)])
}
