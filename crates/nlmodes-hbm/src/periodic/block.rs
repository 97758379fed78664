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
    /// The coordinates and the contact forces at which it was evaluated, d.
    pub x: Vec<Complex64>,
    pub force: Vec<Complex64>,
    pub l: Vec<Complex64>,
    pub g: Vec<Complex64>,
    pub residual: Vec<Complex64>,
    pub d_residual: [Vec<Complex64>; 3],
    /// What is large for a derivative of each row, d.
    pub sizes: Vec<f64>,
    /// The mode that is kept apart, with `ρ²`, in contact coordinates.
    pub pole: Option<(usize, f64)>,
    pub kinetic: KineticEnergy,
}

/// Averaged kinetic energy of one harmonic, `¼ ν² Σ_k m_k |η_k|²`, with its derivatives; of products with complex
/// weights the real part counts.
#[derive(Debug, Clone, Default)]
pub(crate) struct KineticEnergy {
    pub value: f64,
    /// Weights (d) of the coordinates and of the contact forces `λ̂`.
    pub by_x: Vec<Complex64>,
    pub by_force: Vec<Complex64>,
    /// With respect to ω, ξ and the level where `x` and `λ̂` are fixed.
    pub by: [f64; 3],
}

impl KineticEnergy {
    /// Adds a modal coordinate to `Σ_k m_k |η_k|²`, of which [`times_speed`](Self::times_speed) makes the energy, with
    /// half the derivatives with respect to ω, ξ and the level.
    pub fn add(&mut self, mass: f64, eta: Complex64, d_eta: [Complex64; 3]) {
        self.value += mass * eta.norm_sqr();
        (0..3).for_each(|t| self.by[t] += mass * (eta.conj() * d_eta[t]).re);
    }

    /// Multiplies the sums by `¼ ν²`, `ν = nω`.
    pub fn times_speed(&mut self, n: usize, omega: f64) {
        let (n, nu) = (n as f64, n as f64 * omega);
        let half = 0.5 * nu * nu;
        self.by = self.by.map(|by| half * by);
        self.by[0] += 0.5 * n * nu * self.value;
        self.value *= 0.5 * half;
        self.by_x.iter_mut().chain(&mut self.by_force).for_each(|w| *w *= half);
    }
}

/// Modal coordinates of one harmonic, m, with their derivatives or zeros in place of these.
#[derive(Debug, Clone)]
pub(crate) struct ModalMotion {
    pub eta: Vec<Complex64>,
    pub d_eta: [Vec<Complex64>; 3],
}

impl ModalMotion {
    pub fn at_rest(modes: usize) -> Self {
        let zero = vec![Complex64::default(); modes];
        Self { d_eta: [0, 1, 2].map(|_| zero.clone()), eta: zero }
    }
}

impl HarmonicBlock {
    /// Makes room for as many coordinates as `x` has, all else zero.
    pub fn reset(&mut self) {
        let (d, zero) = (self.x.len(), Complex64::default());
        let fill = |v: &mut Vec<Complex64>, n: usize| {
            v.clear();
            v.resize(n, zero);
        };
        fill(&mut self.l, d * d);
        fill(&mut self.g, d * d);
        fill(&mut self.residual, d);
        self.d_residual.iter_mut().for_each(|v| fill(v, d));
        [&mut self.kinetic.by_x, &mut self.kinetic.by_force].into_iter().for_each(|v| fill(v, d));
        self.sizes.clear();
        self.sizes.resize(d, 1.0);
        (self.kinetic.value, self.kinetic.by, self.pole) = (0.0, [0.0; 3], None);
    }
}

/// What an evaluation of a block is for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked {
    /// The kinetic energy.
    pub energy: bool,
    /// Derivatives with respect to ω, ξ and the level; those that are not asked for are zero.
    pub by: [bool; 3],
}

/// A linear structure in coordinates of its choice.
pub(crate) trait LinearResponse {
    /// Number of coordinates d.
    fn n_coordinates(&self) -> usize;

    /// The first coordinate that is the displacement of a law; those of the others follow.
    fn first_law(&self) -> usize;

    /// `P_ij`: how coordinate j moves gap i.
    fn gap_row(&self, i: usize, j: usize) -> f64;

    /// Coordinates of open mode k with the modal coordinate one.
    fn of_mode(&self, k: usize) -> Vec<f64>;

    /// Unit of the coordinates for lengths near `length`.
    fn scale(&self, length: f64) -> f64;

    /// From now on the equations are those of motions of any phase: where motions are even in time and nothing loads
    /// them they may have other signs.
    fn take_any_phase(&mut self) {}

    /// Writes the block of harmonic `n` for the coordinates and forces in it.
    fn evaluate(&mut self, n: usize, at: OperatingPoint, load: &Load, asked: Asked, block: &mut HarmonicBlock);

    /// Modal coordinates of an evaluated block, with their derivatives where these are asked for.
    fn modal_motion(
        &self,
        n: usize,
        at: OperatingPoint,
        load: &Load,
        block: &HarmonicBlock,
        derivatives: bool,
    ) -> ModalMotion;

    /// `wᵀ ∂η/∂x` and `wᵀ ∂η/∂λ̂` for weights `w` (m) of the modal coordinates of an evaluated block.
    fn pull(
        &self,
        n: usize,
        at: OperatingPoint,
        block: &HarmonicBlock,
        weights: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>);

    /// The weights of a load of the modes (m), and of what moves the places of laws, that go with weights of the
    /// residual (d) and of the modal coordinates (m) of an evaluated block, where coordinates and forces stay: both
    /// answer to any load.
    fn pull_load(
        &self,
        n: usize,
        at: OperatingPoint,
        block: &HarmonicBlock,
        residual: &[Complex64],
        eta: &[Complex64],
    ) -> (Vec<Complex64>, Vec<Complex64>);
}

/// Stiffness that holds the mean of a rigid-body motion, over that of the contacts that it moves.
const GAUGE: f64 = 1e-14;

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
    let stiffness = match structure.omega_squared()[k] {
        // Before anything touches nothing else says where the mean of a rigid-body motion is.
        0.0 if n == 0.0 && mass > 0.0 => GAUGE * structure.coupling(k),
        square => square,
    };
    let value = Complex64::new(stiffness - mass * nu * nu, nu * c);
    (value, [Complex64::new(-2.0 * n * nu * mass, n * c), Complex64::new(0.0, -nu * mass)])
}
