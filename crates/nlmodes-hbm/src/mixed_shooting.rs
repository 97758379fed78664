use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Boundary, Linearization, ParametricSystem, Scaling};
use num_complex::Complex64;

use crate::contact_operator::Switching;
use crate::periodic::{Coordinates, ModalGrazing, ModalStructure, PeriodicSettings, PeriodicSystem, modal_grazing};
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
/// in the coordinates of a structure with its contacts held.
///
/// Unknowns are the coefficients of `b(t)`, the position that the massless contact nodes would have without stops, and
/// the frequency; the parameter is `p = ln(E_av/E_ref)`. For given `b` the static contact problem (11), (13) gives
/// `q_N(t)` at each instant, and the equations are
///
/// ```text
/// A_n b_n − B_n 𝓕_n(q_N(t)) = 0 ,  n = 0 … N_h        connectivity (14) through eq. (8), in a form without poles
/// ln(E_av(ω, b)/E_ref) − p = 0                          energy condition of (16)
/// ```
///
/// A steady force `f` that the contacts alone can balance, such as the weight of a structure that floats, stands in the
/// mean: `b_0 − T_0 q_N,0 = K_NN⁻¹ Ψᵀ f_L`.
///
/// The paper iterates on `q_N,n` instead, eq. (15); the solutions are the same, with `q_N,n = 𝓕_n(q_N(t))`. But `q_N,n`
/// vanishes where `nω` meets an eigenfrequency of the held structure, and cannot tell solutions apart there; `b_n`
/// does, for `q_N(t)` is a function of `b(t)`, not the other way round.
///
/// With [`Symmetry::Even`] this is square. With [`Symmetry::None`] the phase is free: the phase of the last accepted
/// point is held, [`PhaseCondition`](crate::PhaseCondition), and with it comes an unknown δ that multiplies
/// `B_n db_n/dτ`; on a solution of a conservative system δ = 0, which [`MixedShooting::unfolding`] lets one check.
///
/// Unknown vector: `b/length` (n_N × width, one degree of freedom after the other, [`RealSeries`]), `ω/omega`, and δ.
pub struct MixedShooting<'s> {
    pub(crate) structure: &'s CondensedStructure,
    settings: MixedShootingSettings,
    pub(crate) system: PeriodicSystem,
    /// Where the branch begins, of a problem in open modes.
    open: Option<ModalGrazing>,
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
        let system = PeriodicSystem::held_mode(structure, settings, scales, solver)?;
        Ok(Self { structure, settings, system, open: None })
    }

    /// The same problem of a structure that was reduced to its free-interface modes, with their coordinates as unknowns,
    /// m × (2 N_h + 1) whatever the number of contacts; it begins at the grazing of linear mode `mode` (from 1).
    ///
    /// # Errors
    /// As [`new`](Self::new), as [`ModalStructure::of_massless`] and as [`modal_grazing`].
    pub fn in_open_modes(
        structure: &'s CondensedStructure,
        mode: usize,
        settings: MixedShootingSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let MixedShootingSettings { harmonics, symmetry, switching } = settings;
        let periodic = PeriodicSettings { harmonics, switching, coordinates: Coordinates::Modal };
        let modal = ModalStructure::of_massless(structure.model())?;
        let system = PeriodicSystem::conservative_mode(&modal, symmetry, periodic, scales, solver)?;
        Ok(Self { structure, settings, system, open: Some(modal_grazing(&modal, mode)?) })
    }

    /// Whether the unknowns are coordinates of open modes.
    pub fn is_in_open_modes(&self) -> bool {
        self.open.is_some()
    }

    /// Unknowns at the begin of the branch, where `p = 0`, and the direction of growing amplitude.
    pub fn start(&self, grazing: &Grazing) -> (Vec<f64>, Vec<f64>) {
        let (series, dim) = (self.series(), self.dim());
        match &self.open {
            Some(open) => (open.unknowns(&self.system), open.direction(&self.system)),
            None => (grazing.unknowns(series, dim), grazing.direction(series, dim)),
        }
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

    /// The unfolding parameter δ of the unknown vector `x`, if there is one; zero on a solution.
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

    /// From now on, or not any more, held modes that were not computed answer with the term in `ν⁴` too.
    pub(crate) fn take_next_term(&mut self, with: bool) {
        self.system.response.take_next_term(with);
    }

    /// Contacts and linear structure at the unknowns `x`.
    pub(crate) fn solve(&mut self, x: &[f64]) -> Result<(), HbmError> {
        self.system.solve(x, 0.0).map(|_| ())
    }

    /// Writes the coefficients of `b` and `q_N` of the cosine, or of the sine, of harmonic `n`, for the point evaluated
    /// last.
    pub(crate) fn coefficients(&self, n: usize, is_sine: bool, b: &mut [f64], q: &mut [f64]) {
        let (block, inverse) = (&self.system.blocks[n], &self.structure.held.sums.k_nn_inverse);
        let part = |z: &Complex64| if is_sine { -z.im } else { z.re };
        b.iter_mut().zip(&block.x).for_each(|(b, x)| *b = part(x));
        for ((q, b), inverse) in q.iter_mut().zip(b).zip(inverse.chunks(block.x.len())) {
            let pressed: Complex64 = inverse.iter().zip(&block.force).map(|(k, force)| force * *k).sum();
            *q = *b + part(&pressed);
        }
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
