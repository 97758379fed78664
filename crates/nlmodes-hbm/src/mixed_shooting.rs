mod contact;
mod rows;

use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Boundary, Linearization, ParametricSystem, Scaling};

use self::contact::Gaps;
use self::rows::{EnergyTotals, Nu};
use crate::closed_set::NodeResponse;
use crate::contact_operator::{ContactOperator, Switching};
use crate::energy::KineticEnergy;
use crate::series::{RealSeries, Symmetry};
use crate::shrinking_gaps::Opening;
use crate::transfer::Plane;
use crate::{CondensedStructure, HbmError};

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

/// Mixed shooting-harmonic balance with massless contacts, eqs. (6)-(16), as a system for continuation.
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
/// With [`Symmetry::Even`] this is square. With [`Symmetry::None`] the phase is free: an anchor is added, and with it
/// an unknown δ that multiplies `B_n db_n/dτ`; on a solution of a conservative system δ = 0, which
/// [`MixedShooting::unfolding`] lets one check. The anchor `Σ n (c_n s̄_n − s_n c̄_n) = 0` holds the phase of the last
/// accepted point, and before any is accepted that of the point evaluated first; for a motion with a cosine fundamental
/// it is the paper's `Im q_{a,1} = 0`. Both are directions of `db/dτ`, so that the sign of the determinant, which tells
/// crossings, stays what it is when the anchor moves.
///
/// Unknown vector: `b/length` (n_N × width, one degree of freedom after the other, [`RealSeries`]), `ω/omega`, and δ.
pub struct MixedShooting<'s> {
    pub(crate) structure: &'s CondensedStructure,
    settings: MixedShootingSettings,
    pub(crate) scales: Scales,
    pub(crate) sweep: ContactOperator,
    /// By how much each contact stands back from its gap, m.
    pub(crate) standing_back: Vec<f64>,
    /// The contact nodes with each closed set of the sweep that has occurred in a period.
    nodes: Vec<Option<NodeResponse>>,
    pub(crate) b: Vec<f64>,
    pub(crate) q: Vec<f64>,
    /// `b − q_N`: what the contacts keep the nodes from. Small beside both where these are stiff, so that it is not
    /// taken as their difference.
    pub(crate) kept: Vec<f64>,
    /// Its derivative, `1 − dq_N/db`, row-major.
    dkept_db: Vec<f64>,
    /// The Jacobian, row-major, with respect to the coefficients of `b`: made row by row, then put into its columns.
    rows: Vec<f64>,
    pub(crate) plane: Plane,
    energy: KineticEnergy,
    /// Zero until a point is seen.
    anchor: Vec<f64>,
    /// While contacts stand back: the derivative of `q_N` by the share of that.
    pub(crate) opening: Option<Opening>,
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
        if settings.harmonics == 0 || settings.harmonics > MAX_HARMONICS {
            return Err(HbmError::Harmonics { found: settings.harmonics, most: MAX_HARMONICS });
        }
        let series = RealSeries { symmetry: settings.symmetry, n_harmonics: settings.harmonics };
        let n = structure.n_contact_dofs();
        let size = n * series.width();
        Ok(Self {
            structure,
            settings,
            scales,
            sweep: ContactOperator::new(structure.body.matrix(), series, settings.switching, solver)?,
            standing_back: vec![0.0; structure.n_contacts()],
            nodes: Vec::new(),
            b: vec![0.0; size],
            q: vec![0.0; size],
            kept: vec![0.0; size],
            dkept_db: vec![0.0; size * size],
            rows: vec![0.0; (size + 1) * size],
            plane: Plane::new(n),
            energy: KineticEnergy::new(n),
            anchor: vec![0.0; size],
            opening: None,
        })
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
        self.scales
    }

    /// Layout of the coefficients of one degree of freedom.
    pub fn series(&self) -> RealSeries {
        self.sweep.series
    }

    /// Iterations of the contact solver so far, over all contact problems, in the unit of that solver.
    pub fn contact_iterations(&self) -> usize {
        self.sweep.iterations
    }

    /// Index of the frequency in the unknown vector.
    pub fn frequency_index(&self) -> usize {
        self.b.len()
    }

    /// The unfolding parameter δ of the unknown vector `x`, if there is one; zero on a solution.
    pub fn unfolding(&self, x: &[f64]) -> Option<f64> {
        x.get(self.b.len() + 1).copied()
    }

    /// Angular frequency of the unknown vector `x`, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        x[self.b.len()] * self.scales.omega
    }

    /// Averaged kinetic energy at the parameter `p`, J.
    pub fn energy(&self, p: f64) -> f64 {
        self.scales.energy * p.exp()
    }

    /// An unknown vector, or a direction with the parameter at its end, of a problem on the same structure with another
    /// number of harmonics as one of this problem: harmonics that it does not have are zero, those that this problem
    /// does not have are left out.
    ///
    /// # Panics
    /// If `x` is shorter than the coefficients of `from`.
    pub fn resized(&self, x: &[f64], from: RealSeries) -> Vec<f64> {
        let (n, old) = (self.structure.n_contact_dofs(), from.width());
        let coefficients = (0..n).flat_map(|d| from.resized(&x[d * old..(d + 1) * old], self.series()));
        coefficients.chain(x[n * old..].iter().copied()).collect()
    }
}

impl ParametricSystem for MixedShooting<'_> {
    type Error = HbmError;

    fn dim(&self) -> usize {
        self.b.len() + if self.settings.symmetry == Symmetry::None { 2 } else { 1 }
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), HbmError> {
        let omega = self.omega(x);
        if !(omega.is_finite() && omega > 0.0) {
            return Err(HbmError::Motion { omega, energy: self.energy(p) });
        }
        if self.anchor.iter().all(|a| *a == 0.0) {
            self.hold_phase(x);
        }
        self.solve_contact(x)?;
        // The columns behind those of b, of which not every entry is written below.
        (self.b.len()..out.jacobian.ncols()).for_each(|j| out.jacobian.col_mut(j).fill(0.0));
        let width = self.sweep.series.width();
        let unfolding = self.unfolding(x).unwrap_or(0.0);
        let mut totals = EnergyTotals { value: 0.0, d_b: vec![0.0; self.b.len()], d_omega: 0.0 };
        let mut gradient_q = vec![0.0; self.b.len()];
        let n_dofs = self.structure.n_contact_dofs();
        let (mut b, mut q) = (vec![0.0; n_dofs], vec![0.0; n_dofs]);
        for n in 0..=self.settings.harmonics {
            let nu = Nu { squared: (n as f64 * omega).powi(2), d_omega: 2.0 * (n * n) as f64 * omega };
            if n == 0 {
                self.plane.set_static(self.structure)
            } else {
                self.plane.set(self.structure, nu.squared)
            }
            for m in std::iter::once(n).chain(self.sweep.series.sine(n)) {
                self.connectivity_rows(m, nu, unfolding, out);
                if n == 0 {
                    continue;
                }
                self.coefficients(m, &mut b, &mut q);
                self.energy.set(self.structure, &self.plane, nu.squared, &b, &q);
                totals.value += self.energy.value;
                totals.d_omega += self.energy.d_nu2 * nu.d_omega;
                for d in 0..b.len() {
                    totals.d_b[d * width + m] = self.energy.d_b[d];
                    gradient_q[d * width + m] = self.energy.d_q[d];
                }
            }
        }
        // dr/d(b/length) = length · dr/db, and the rows are divided by the same length: nothing to scale.
        self.energy_row(omega, p, &gradient_q, &totals, out)?;
        self.put_rows(&mut out.jacobian);
        if self.settings.symmetry == Symmetry::None {
            self.anchor_row(x, out);
        }
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling::unit(self.dim()))
    }

    fn pattern(&self) -> u64 {
        self.sweep.pattern()
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        self.intervals_at(z)?;
        Some(self.sweep.pattern())
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        self.intervals_at(from)?;
        let intervals = self.sweep.intervals.clone();
        self.intervals_at(to)?;
        let boundary = self.sweep.boundary_from(&intervals)?;
        let gaps = Gaps { series: self.series(), w: self.structure.model.w().clone(), at_rest: self.gaps_at_rest() };
        let length = self.scales.length;
        Some(Boundary::new(move |z| boundary.value(|weights| gaps.sum(weights, z, length)) / length))
    }

    fn accepted(&mut self, x: &[f64], _p: f64) {
        self.hold_phase(x);
    }
}

/// `to −= factor from`.
fn subtract(to: &mut [f64], factor: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
}
