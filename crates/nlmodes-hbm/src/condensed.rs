use std::sync::Arc;

use nlmodes_contact::{ContactBody, LcpMatrix};
use nlmodes_linalg::Mat;
use nlmodes_model::{ContactCoordinates, MasslessContactModel};
use nlmodes_reduction::{HeldMode, HeldModes};

use crate::HbmError;
use crate::energy::inner;
use crate::held_sums::HeldSums;
use crate::recording::Recording;

/// A structure with massless contacts, reduced once to what the periodic problem needs.
///
/// With the modes of the held structure, `K_LL φ_k = λ_k M_LL φ_k`, eq. (8) reads
///
/// ```text
/// q_L,n = Ψ q_N,n + Σ_k (ν²/λ_k) φ_k η_k,n ,   η_k,n = −g_k q_N,n / (λ_k − ν²) ,   ν = nω ,   Ψ = −K_LL⁻¹ K_LN
/// b_n   = −K_NN⁻¹ K_NL q_L,n = T(ν²) q_N,n
/// T(ν²) = T_0 + Σ_k ν²/(λ_k (λ_k − ν²)) h_k g_k ,   T_0 = K_NN⁻¹ K_NL K_LL⁻¹ K_LN
/// ```
///
/// Modes beyond the computed ones answer as springs with the mass of their static shape: of their share of `T`,
/// `K_NN⁻¹ R ν²` is kept, `R = Ψᵀ M_LL Ψ − Σ_k g_kᵀ g_k/λ_k²`, and of `q_L,n` likewise. What is left out falls with
/// `ν⁴/λ³`. `b(t)` is where the massless contact nodes would be without stops. A stop's own compliance is in series
/// with `K_NN⁻¹` and stands on the diagonal of `A` alone.
///
/// Where the massless coordinates are the tips of contact springs
/// ([`ContactCoordinates::SpringTips`](nlmodes_model::ContactCoordinates)), the same formulas are conventional harmonic
/// balance: `b` is the displacement of the contact node, which moves in harmonics with its mass, `A = diag(1/k_c)`, and
/// `T = (K_c + D)⁻¹ K_c` with the dynamic stiffness `D(ν²)` of the structure at the contact.
#[derive(Debug, Clone)]
pub struct CondensedStructure {
    pub(crate) model: MasslessContactModel,
    /// What the equations of one harmonic need.
    pub(crate) held: Arc<Held>,
    pub(crate) shapes: Mat<f64>,
    pub(crate) psi: Mat<f64>,
    pub(crate) t0: Mat<f64>,
    /// The contact degrees of freedom with `C = K_NN⁻¹`.
    pub(crate) body: ContactBody,
    /// What a steady force does with the contacts held.
    pub(crate) statics: HeldStatics,
    pub(crate) recording: Recording,
    n_held: usize,
}

impl CondensedStructure {
    /// Reduces `model` with its lowest `n_modes` held modes, all of them where there are fewer.
    ///
    /// # Errors
    /// [`HbmError::ContactTooStiff`]; [`HbmError`] if the held structure still has a rigid-body mode or the contact
    /// compliance is not usable.
    pub fn new(model: MasslessContactModel, n_modes: usize) -> Result<Self, HbmError> {
        let held = HeldModes::new(&model, n_modes)?;
        refuse_stiff_springs(&model, &held.transfer)?;
        let statics = HeldStatics::new(&model, &held);
        let residual = if held.is_all() { ResidualMass::none(&held.statics) } else { ResidualMass::new(&model, &held) };
        let (k_nn, n_held) = (&held.contact_stiffness, held.count());
        let gaps: Vec<f64> = model.contacts().iter().map(|c| c.gap).collect();
        let body = ContactBody::new(model.w().clone(), k_nn.solve_columns(model.w()), gaps)
            .and_then(|body| body.with_stop_compliance(&model.stop_compliance()))
            .map_err(HbmError::Compliance)?;
        let n_n = held.statics.ncols();
        let inverse = k_nn.solve_columns(&Mat::identity(n_n, n_n));
        let mut lift = statics.pull.clone();
        if !lift.is_empty() {
            k_nn.solve_in_place(&mut lift);
        }
        let HeldModes { modes, shapes, statics: psi, transfer: t0, .. } = held;
        let sums = HeldSums::new(&modes, &inverse, &t0, &residual);
        let recording = Recording::new(&model, &modes, &shapes, [&psi, &residual.shapes], &statics.sag);
        let held = Arc::new(Held { modes, residual, sums, lift });
        Ok(Self { model, held, shapes, psi, t0, body, statics, recording, n_held })
    }

    /// The structure that was reduced.
    pub fn model(&self) -> &MasslessContactModel {
        &self.model
    }

    /// Held modes that move the contacts, ascending.
    pub fn modes(&self) -> &[HeldMode] {
        &self.held.modes
    }

    /// Held modes computed, with those that leave the contacts at rest.
    pub fn n_held_modes(&self) -> usize {
        self.n_held
    }

    /// Shapes of the held modes, n_L × modes.
    pub fn shapes(&self) -> &Mat<f64> {
        &self.shapes
    }

    /// Degrees of freedom whose coefficients modal points hold, ascending: all of them up to
    /// [`MAX_RECORDED`](crate::MAX_RECORDED), else some evenly spaced ones and those of the contacts.
    pub fn recorded_dofs(&self) -> &[usize] {
        self.recording.dofs()
    }

    /// Place of degree of freedom `dof` among the recorded ones, if it is one of them.
    pub fn recorded_index(&self, dof: usize) -> Option<usize> {
        self.recording.dofs().binary_search(&dof).ok()
    }

    /// Contact compliance `A = Wᵀ K_NN⁻¹ W + C`, eqs. (11), (13), with that of the stops in series; c × c, m/N.
    pub fn compliance(&self) -> &LcpMatrix {
        self.body.matrix()
    }

    /// Number of contact degrees of freedom n_N.
    pub fn n_contact_dofs(&self) -> usize {
        self.t0.nrows()
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.body.gaps().len()
    }
}

/// The held structure as the contact nodes see it in one harmonic.
#[derive(Debug)]
pub(crate) struct Held {
    /// The held modes that move the contacts, ascending.
    pub modes: Vec<HeldMode>,
    /// What the held modes that were not computed still contribute.
    pub residual: ResidualMass,
    /// The held modes once more, laid out for sums over all of them.
    pub sums: HeldSums,
    /// Where a steady force brings the contact nodes, `K_NN⁻¹ Ψᵀ f_L`, n_N, m; empty where there is none.
    pub lift: Vec<f64>,
}

impl Held {
    /// Number of contact degrees of freedom n_N.
    pub fn n_contact_dofs(&self) -> usize {
        self.sums.size()
    }
}

/// Static answer of the structure to a steady force `f` with its contacts held; all empty where there is none.
#[derive(Debug, Clone, Default)]
pub(crate) struct HeldStatics {
    /// `K_LL⁻¹ f_L`, n_L, m.
    pub sag: Vec<f64>,
    /// `Ψᵀ f_L`, n_N, N: what the contact nodes feel of it.
    pub pull: Vec<f64>,
    /// `−½ f_Lᵀ K_LL⁻¹ f_L`, J: energy of the structure and of the force, contacts held where they are drawn.
    pub energy: f64,
}

impl HeldStatics {
    fn new(model: &MasslessContactModel, held: &HeldModes) -> Self {
        let Some(steady) = model.steady_force() else { return Self::default() };
        let force: Vec<f64> = model.linear_dofs().iter().map(|&dof| steady.force[dof]).collect();
        let along = |d: usize| (0..force.len()).map(|i| held.statics[(i, d)] * force[i]).sum::<f64>();
        let pull: Vec<f64> = (0..held.statics.ncols()).map(along).collect();
        let mut sag = force.clone();
        held.stiffness.solve_in_place(&mut sag);
        let energy = -0.5 * inner(&force, &sag);
        Self { sag, pull, energy }
    }
}

/// Largest stiffness of a contact spring over the static stiffness of the structure behind it. The force is `k_c` times
/// a small difference of displacements, which has lost as many digits as this ratio has: with 1e9 Newton's method does
/// not settle to seven any more.
const STIFFEST: f64 = 5e8;

/// Contact springs beside which the stiffness of the structure is lost in rounding: equations of harmonic balance in
/// which any motion would pass for a solution.
fn refuse_stiff_springs(model: &MasslessContactModel, t0: &Mat<f64>) -> Result<(), HbmError> {
    if model.contact_coordinates() == ContactCoordinates::Nodes || model.rigid_motion().is_some() {
        return Ok(());
    }
    // The spring in series with the structure: T_0 = 1 − 1/(1 + k_c/k).
    let ratio = |d: usize| 1.0 / (1.0 - t0[(d, d)]).max(f64::EPSILON);
    match (0..t0.nrows()).find(|&d| ratio(d) > STIFFEST) {
        Some(contact) => Err(HbmError::ContactTooStiff { contact, ratio: ratio(contact), most: STIFFEST }),
        None => Ok(()),
    }
}

/// Share of the held modes that were not computed, to first order in `ν²`.
#[derive(Debug, Clone)]
pub(crate) struct ResidualMass {
    /// `R = Ψᵀ M_LL Ψ − Σ_k g_kᵀ g_k/λ_k²`, n_N × n_N.
    pub mass: Mat<f64>,
    /// `K_NN⁻¹ R`: its share of `T` is `ν²` times that.
    pub transfer: Mat<f64>,
    /// `K_LL⁻¹ M_LL Ψ + Σ_k φ_k g_k/λ_k²`, n_L × n_N: its share of `q_L,n` is `ν²` times that and `q_N,n`.
    pub shapes: Mat<f64>,
    /// The next term, which is left out and serves to estimate the error: `S = Σ_k g_kᵀ g_k/λ_k³` over the modes that
    /// were not computed, which is `Ψᵀ M_LL` times `shapes`; n_N × n_N.
    pub next: Mat<f64>,
    /// `K_NN⁻¹ S`: of the share of `T`, at least `ν⁴` times that is left out.
    pub next_transfer: Mat<f64>,
}

impl ResidualMass {
    fn none(psi: &Mat<f64>) -> Self {
        let zero = Mat::zeros(psi.ncols(), psi.ncols());
        let shapes = Mat::zeros(psi.nrows(), psi.ncols());
        Self { mass: zero.clone(), transfer: zero.clone(), shapes, next: zero.clone(), next_transfer: zero }
    }

    fn new(model: &MasslessContactModel, held: &HeldModes) -> Self {
        let (psi, k_nn) = (&held.statics, &held.contact_stiffness);
        let inertia = model.m_ll().as_ref() * psi;
        let mut mass = symmetric(&(psi.transpose() * &inertia));
        let mut shapes = inertia.clone();
        held.stiffness.solve_many(&mut shapes);
        for mode in &held.modes {
            let weight = 1.0 / (mode.lambda * mode.lambda);
            for j in 0..mode.g.len() {
                (0..mode.g.len()).for_each(|i| mass[(i, j)] -= weight * mode.g[i] * mode.g[j]);
                (0..shapes.nrows()).for_each(|i| shapes[(i, j)] += weight * held.shapes[(i, mode.column)] * mode.g[j]);
            }
        }
        let transfer = k_nn.solve_columns(&mass);
        let next = symmetric(&(inertia.transpose() * &shapes));
        let next_transfer = k_nn.solve_columns(&next);
        Self { mass, transfer, shapes, next, next_transfer }
    }
}

fn symmetric(a: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| 0.5 * (a[(i, j)] + a[(j, i)]))
}
