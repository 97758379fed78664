use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Boundary, Linearization, ParametricSystem, Scaling};
use nlmodes_linalg::Mat;
use nlmodes_modal::{HarmonicCoefficients, ModalPoint};
use num_complex::Complex64;

use crate::contact_operator::Switching;
use crate::periodic::{OperatingPoint, PeriodicSystem};
use crate::series::{RealSeries, Symmetry};
use crate::{CondensedStructure, Grazing, HbmError};

/// Most harmonics that are accepted.
pub const MAX_HARMONICS: usize = 4096;

/// What distinguishes one mixed shooting-harmonic balance problem from another on the same structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MixedShootingSettings {
    /// Highest harmonic `N_h` of the linear degrees of freedom, eq. (7).
    pub harmonics: usize,
    /// Which motions are admitted.
    pub symmetry: Symmetry,
    /// How the instants of contact are treated.
    pub switching: Switching,
}

/// What numbers near one mean: lengths, frequencies and energies of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Scales {
    /// Length, m: amplitude of the contact at grazing.
    pub length: f64,
    /// Angular frequency, rad/s: that of the linear mode.
    pub omega: f64,
    /// Averaged kinetic energy, J: that at grazing.
    pub energy: f64,
}

impl Scales {
    /// From a length (m), an angular frequency (rad/s) and an energy (J).
    pub fn new(length: f64, omega: f64, energy: f64) -> Self {
        Self { length, omega, energy }
    }
}

/// Mixed shooting-harmonic balance with massless contacts, eqs. (6)-(16): the [`PeriodicSystem`] of a conservative mode
/// of a [`CondensedStructure`].
///
/// Unknowns are the coefficients of `b(t)`, the position that the massless contact nodes would have without stops, seen
/// along the contacts, or of the modal coordinates where these are fewer, and the frequency; the parameter is
/// `p = ln(E_av/E_ref)`. For given `b` the static contact problem (11), (13) gives `λ(t)` at each instant, and the
/// equations are
///
/// ```text
/// b_n = Y (Ω² − n²ω²)⁻¹ Yᵀ 𝓕_n(λ(t)) ,  n = 0 … N_h      connectivity (14) through eq. (8), in a form without poles
/// ln(E_av(ω, b)/E_ref) − p = 0                          energy condition of (16)
/// ```
///
/// The paper iterates on `q_N,n` instead, eq. (15); the solutions are the same, with `q_N = b + K_NN⁻¹ W λ`. But
/// `q_N,n` vanishes where `nω` meets an eigenfrequency of the structure with its contacts held, and cannot tell
/// solutions apart there; `b_n` does, for `q_N(t)` is a function of `b(t)`, not the other way round.
///
/// With [`Symmetry::Even`] this is square. With [`Symmetry::None`] the phase is free: the phase of the last accepted
/// point is held, [`PhaseCondition`](crate::PhaseCondition), and with it comes a negative damping `ξ` as an unknown; on
/// a solution of a conservative system it vanishes, which [`MixedShooting::unfolding`] lets one check.
///
/// Unknown vector: `b/length` (one direction of the contacts after the other, [`RealSeries`]), `ω/omega`, and
/// `ξ/omega`.
pub struct MixedShooting<'s> {
    pub(crate) structure: &'s CondensedStructure,
    settings: MixedShootingSettings,
    pub(crate) system: PeriodicSystem,
}

impl<'s> MixedShooting<'s> {
    /// Sets up the problem; the contact problems are solved by `solver`.
    ///
    /// # Errors
    /// [`HbmError::Harmonics`], [`HbmError::Samples`], or what the contact solver has against the compliance.
    pub fn new(
        structure: &'s CondensedStructure,
        settings: MixedShootingSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let system = structure.conservative_mode(settings, scales, solver)?;
        Ok(Self { structure, settings, system })
    }

    /// Unknowns at the begin of the branch, where `p = 0`, and the direction of growing amplitude.
    pub fn start(&self, grazing: &Grazing) -> (Vec<f64>, Vec<f64>) {
        (grazing.unknowns(&self.system), grazing.direction(&self.system))
    }

    /// The equations.
    pub fn system(&self) -> &PeriodicSystem {
        &self.system
    }

    /// The equations alone.
    pub fn into_system(self) -> PeriodicSystem {
        self.system
    }

    /// The structure.
    pub fn structure(&self) -> &'s CondensedStructure {
        self.structure
    }

    /// The settings.
    pub fn settings(&self) -> MixedShootingSettings {
        self.settings
    }

    /// The scales of the unknowns.
    pub fn scales(&self) -> Scales {
        self.system.scales
    }

    /// Layout of the coefficients of one degree of freedom.
    pub fn series(&self) -> RealSeries {
        self.system.series()
    }

    /// Iterations of the contact solver so far, over all contact problems, in the unit of that solver.
    pub fn contact_iterations(&self) -> usize {
        self.system.contact_iterations()
    }

    /// Index of the frequency in the unknown vector.
    pub fn frequency_index(&self) -> usize {
        self.system.n_coefficients()
    }

    /// The unfolding parameter `ξ/omega` of the unknown vector `x`, if there is one; zero on a solution.
    pub fn unfolding(&self, x: &[f64]) -> Option<f64> {
        x.get(self.frequency_index() + 1).copied()
    }

    /// Angular frequency of the unknown vector `x`, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        x[self.frequency_index()] * self.scales().omega
    }

    /// Averaged kinetic energy at the parameter `p`, J.
    pub fn energy(&self, p: f64) -> f64 {
        self.scales().energy * p.exp()
    }

    /// An unknown vector, or a direction with the parameter at its end, of a problem on the same structure with another
    /// number of harmonics as one of this problem: harmonics that it does not have are zero, those that this problem
    /// does not have are left out.
    ///
    /// # Panics
    /// If `x` is shorter than the coefficients of `from`.
    pub fn resized(&self, x: &[f64], from: RealSeries) -> Vec<f64> {
        self.system.resized(x, from)
    }

    /// Contacts and linear structure at the unknowns `x`.
    pub(crate) fn solve(&mut self, x: &[f64]) -> Result<(), HbmError> {
        self.system.solve(x, 0.0).map(|_| ())
    }

    /// Displacements `q_N,n = b_n + K_NN⁻¹ W λ_n` of the contact coordinates in harmonic `n` of the motion solved last.
    pub(crate) fn contact_coordinates(&self, n: usize, at: OperatingPoint) -> Vec<Complex64> {
        let (structure, eta) = (self.structure, self.system.modal_coordinates(n, at));
        let forces = self.system.forces_of_harmonic(n);
        let along = |row: &Mat<f64>, d: usize, z: &[Complex64]| {
            z.iter().enumerate().map(|(k, z)| z * row[(d, k)]).sum::<Complex64>()
        };
        let of = |d: usize| along(&structure.follow, d, &eta) + along(&structure.pressed, d, &forces);
        (0..structure.n_contact_dofs()).map(of).collect()
    }

    /// The point with the unknowns `x`, as a nonlinear mode with its modal quantities.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_point(&mut self, x: &[f64], residual: f64) -> Result<ModalPoint, HbmError> {
        let structure = self.structure;
        let first = structure.model().contacts().first().and_then(|first| structure.recorded_index(first.dof));
        self.system.modal_point(x, &structure.rows, first.unwrap_or(0), residual)
    }

    /// Modal coordinates of the motion with the unknowns `x` in the [modes](CondensedStructure::open_modes) of the
    /// structure, modes × (H + 1), m·√kg.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_coordinates(&mut self, x: &[f64]) -> Result<HarmonicCoefficients, HbmError> {
        let motion = self.system.motion(x, 0.0)?;
        let mut modal = HarmonicCoefficients::zeros(self.structure.open.n_modes(), self.series().n_harmonics);
        for (n, eta) in motion.eta.iter().enumerate() {
            eta.iter().enumerate().for_each(|(k, eta)| modal.of_mut(k)[n] = *eta);
        }
        Ok(modal)
    }

    /// Mean contact forces over a period, N.
    pub fn mean_forces(&self) -> Vec<f64> {
        self.system.operator.mean_forces()
    }
}

impl ParametricSystem for MixedShooting<'_> {
    type Error = HbmError;

    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), HbmError> {
        let omega = self.omega(x);
        if !(omega.is_finite() && omega > 0.0) {
            return Err(HbmError::Motion { omega, energy: self.energy(p) });
        }
        self.system.linearize(x, p, out)
    }

    fn scaling(&self) -> Option<Scaling> {
        self.system.scaling()
    }

    fn pattern(&self) -> u64 {
        self.system.pattern()
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        self.system.pattern_at(z)
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        self.system.boundary(from, to)
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        self.system.accepted(x, p);
    }
}
