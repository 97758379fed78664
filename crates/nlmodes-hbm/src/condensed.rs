use nlmodes_contact::{ContactBody, LcpMatrix};
use nlmodes_linalg::{DenseLu, Mat, symmetric_eigen};
use nlmodes_model::{ContactCoordinates, LinearModes, MasslessContactModel, held_modes};

use crate::HbmError;
use crate::held_sums::HeldSums;
use crate::recording::Recording;

/// A mode of the structure with its contacts held, as the contact degrees of freedom see it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct HeldMode {
    /// Squared angular frequency `λ_k`, rad²/s².
    pub lambda: f64,
    /// Column of the mode in [`CondensedStructure::shapes`].
    pub column: usize,
    /// `g_k = φ_kᵀ K_LN`, n_N.
    pub g: Vec<f64>,
    /// `h_k = K_NN⁻¹ g_kᵀ`, n_N.
    pub h: Vec<f64>,
    /// `s_k = g_k h_k`, rad²/s²: how strongly the mode takes part in the motion of the contacts.
    pub s: f64,
}

/// Relative difference below which two held frequencies count as one.
pub(crate) const REPEATED: f64 = 1e-10;

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
/// Modes beyond the computed ones answer as springs with the mass of their static shape: of their share of `T`, `K_NN⁻¹ R ν²` is
/// kept, `R = Ψᵀ M_LL Ψ − Σ_k g_kᵀ g_k/λ_k²`, and of `q_L,n` likewise. What is left out falls with `ν⁴/λ³`. `b(t)` is where the massless
/// contact nodes would be without stops. A stop's own compliance is in series with `K_NN⁻¹` and stands on the diagonal of `A` alone.
///
/// Where the massless coordinates are the tips of contact springs ([`ContactCoordinates::SpringTips`](nlmodes_model::ContactCoordinates)),
/// the same formulas are conventional harmonic balance: `b` is the displacement of the contact node, which moves in harmonics with its
/// mass, `A = diag(1/k_c)`, and `T = (K_c + D)⁻¹ K_c` with the dynamic stiffness `D(ν²)` of the structure at the contact.
#[derive(Debug, Clone)]
pub struct CondensedStructure {
    pub(crate) model: MasslessContactModel,
    pub(crate) modes: Vec<HeldMode>,
    pub(crate) shapes: Mat<f64>,
    pub(crate) psi: Mat<f64>,
    pub(crate) t0: Mat<f64>,
    /// What the held modes that were not computed still contribute.
    pub(crate) residual: ResidualMass,
    /// The contact degrees of freedom with `C = K_NN⁻¹`.
    pub(crate) body: ContactBody,
    /// The held modes once more, laid out for sums over all of them.
    pub(crate) sums: HeldSums,
    pub(crate) recording: Recording,
    n_held: usize,
}

impl CondensedStructure {
    /// Reduces `model` with its lowest `n_modes` held modes, all of them where there are fewer.
    ///
    /// # Errors
    /// [`HbmError::ContactTooStiff`]; [`HbmError`] if the held structure still has a rigid-body mode or the contact compliance is not usable.
    pub fn new(model: MasslessContactModel, n_modes: usize) -> Result<Self, HbmError> {
        let psi = static_shapes(&model)?;
        let mut held = held_modes(&model, n_modes)?;
        let k_nn = DenseLu::factor(model.k_nn())
            .map_err(|source| HbmError::Linalg { what: "stiffness K_NN of the contact degrees of freedom", source })?;
        let coupling = model.k_ln().transpose() * &psi;
        let t0 = solve_columns(&k_nn, &(-coupling));
        refuse_stiff_springs(&model, &t0)?;
        let gaps: Vec<f64> = model.contacts().iter().map(|c| c.gap).collect();
        let body = ContactBody::new(model.w().clone(), solve_columns(&k_nn, model.w()), gaps)
            .and_then(|body| body.with_stop_compliance(&model.stop_compliance()))
            .map_err(HbmError::Compliance)?;
        separate_repeated(&mut held, &model, &k_nn)?;
        let g = held.shapes.transpose() * model.k_ln();
        let scale = (0..t0.nrows()).map(|i| t0[(i, i)].abs()).fold(f64::MIN_POSITIVE, f64::max);
        let modes = (0..held.omega.len()).filter_map(|k| {
            let row: Vec<f64> = (0..g.ncols()).map(|d| g[(k, d)]).collect();
            let mut h = row.clone();
            k_nn.solve_in_place(&mut h);
            let s: f64 = row.iter().zip(&h).map(|(g, h)| g * h).sum();
            let lambda = held.omega[k] * held.omega[k];
            // Modes that leave the contacts at rest (the axial family of a beam under a transverse stop) do not take part.
            (s > 1e-20 * scale * lambda).then_some(HeldMode { lambda, column: k, g: row, h, s })
        });
        let modes: Vec<HeldMode> = modes.collect();
        let residual = if held.omega.len() < psi.nrows() {
            ResidualMass::new(&model, &psi, &modes, &held.shapes, &k_nn)?
        } else {
            ResidualMass::none(&psi)
        };
        let n_held = held.omega.len();
        let inverse = solve_columns(&k_nn, &Mat::identity(psi.ncols(), psi.ncols()));
        let sums = HeldSums::new(&modes, &inverse, &t0, &residual);
        let recording = Recording::new(&model, &modes, &held.shapes, &psi, &residual.shapes);
        Ok(Self { model, modes, shapes: held.shapes, psi, t0, residual, body, sums, recording, n_held })
    }

    /// The structure that was reduced.
    pub fn model(&self) -> &MasslessContactModel {
        &self.model
    }

    /// Held modes that move the contacts, ascending.
    pub fn modes(&self) -> &[HeldMode] {
        &self.modes
    }

    /// Held modes computed, with those that leave the contacts at rest.
    pub fn n_held_modes(&self) -> usize {
        self.n_held
    }

    /// Shapes of the held modes, n_L × modes.
    pub fn shapes(&self) -> &Mat<f64> {
        &self.shapes
    }

    /// Degrees of freedom whose coefficients modal points hold, ascending: all of them up to [`MAX_RECORDED`](crate::MAX_RECORDED), else
    /// some evenly spaced ones and those of the contacts.
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

/// Largest stiffness of a contact spring over the static stiffness of the structure behind it. The force is `k_c` times a small difference of
/// displacements, which has lost as many digits as this ratio has: with 1e9 Newton's method does not settle to seven any more.
const STIFFEST: f64 = 5e8;

/// Contact springs beside which the stiffness of the structure is lost in rounding: equations of harmonic balance in which any motion
/// would pass for a solution.
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

/// Among modes with the same frequency (equal spans between contacts), chooses those with `g_i K_NN⁻¹ g_jᵀ = 0`, so that each
/// pole of `T` can be taken apart by itself.
fn separate_repeated(held: &mut LinearModes, model: &MasslessContactModel, k_nn: &DenseLu) -> Result<(), HbmError> {
    let mut first = 0;
    while first < held.omega.len() {
        let same =
            held.omega[first..].iter().take_while(|omega| **omega <= held.omega[first] * (1.0 + REPEATED)).count();
        if same > 1 {
            let shapes = held.shapes.subcols(first, same).to_owned();
            let g = shapes.transpose() * model.k_ln();
            let strength = symmetric(&(&g * solve_columns(k_nn, &g.transpose().to_owned())));
            let (_, turn) = symmetric_eigen(&strength)
                .map_err(|source| HbmError::Linalg { what: "modes with the same frequency", source })?;
            held.shapes.subcols_mut(first, same).copy_from(&shapes * turn);
        }
        first += same;
    }
    Ok(())
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
    /// The next term, which is left out and serves to estimate the error: `S = Σ_k g_kᵀ g_k/λ_k³` over the modes that were not
    /// computed, which is `Ψᵀ M_LL` times `shapes`; n_N × n_N.
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

    fn new(
        model: &MasslessContactModel,
        psi: &Mat<f64>,
        modes: &[HeldMode],
        held: &Mat<f64>,
        k_nn: &DenseLu,
    ) -> Result<Self, HbmError> {
        let inertia = model.m_ll().as_ref() * psi;
        let mut mass = symmetric(&(psi.transpose() * &inertia));
        let mut shapes = solve_held(model, inertia.clone())?;
        for mode in modes {
            let weight = 1.0 / (mode.lambda * mode.lambda);
            for j in 0..mode.g.len() {
                (0..mode.g.len()).for_each(|i| mass[(i, j)] -= weight * mode.g[i] * mode.g[j]);
                (0..shapes.nrows()).for_each(|i| shapes[(i, j)] += weight * held[(i, mode.column)] * mode.g[j]);
            }
        }
        let transfer = solve_columns(k_nn, &mass);
        let next = symmetric(&(inertia.transpose() * &shapes));
        let next_transfer = solve_columns(k_nn, &next);
        Ok(Self { mass, transfer, shapes, next, next_transfer })
    }
}

/// `Ψ = −K_LL⁻¹ K_LN`.
fn static_shapes(model: &MasslessContactModel) -> Result<Mat<f64>, HbmError> {
    solve_held(model, -model.k_ln())
}

/// `K_LL⁻¹` times the columns of `rhs`.
fn solve_held(model: &MasslessContactModel, mut rhs: Mat<f64>) -> Result<Mat<f64>, HbmError> {
    let k_ll = model.factor_k_ll()?;
    for d in 0..rhs.ncols() {
        let mut column: Vec<f64> = rhs.col(d).iter().copied().collect();
        k_ll.solve_in_place(&mut column);
        rhs.col_mut(d).iter_mut().zip(&column).for_each(|(p, c)| *p = *c);
    }
    Ok(rhs)
}

fn solve_columns(lu: &DenseLu, rhs: &Mat<f64>) -> Mat<f64> {
    let mut x = rhs.clone();
    for d in 0..x.ncols() {
        let mut column: Vec<f64> = x.col(d).iter().copied().collect();
        lu.solve_in_place(&mut column);
        x.col_mut(d).iter_mut().zip(&column).for_each(|(p, c)| *p = *c);
    }
    x
}

fn symmetric(a: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| 0.5 * (a[(i, j)] + a[(j, i)]))
}
