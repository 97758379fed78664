use nlmodes_linalg::{
    Mat, SparseCholesky, SparseMatrix, multiply, multiply_many, sparse_from_triplets, symmetric_eigen,
};

use crate::reduction::{HeldModes, OpenModes, ReductionError, ResponseRows};
use crate::{
    Contact, ContactCoordinates, ContactLaw, Dof, DofContact, DofKind, Drop, MasslessContactModel, SteadyForce,
    StructuralModel,
};

/// Relative mass of the residual static shapes below which there is no residual.
const NOTHING: f64 = 1e-13;

/// A structure with massless contacts, reduced to its lowest fixed-interface modes with static correction.
///
/// ```text
/// q_L = B y ,   B = [φ_1 … φ_m, χ] ,   ÿ + Bᵀ K_LL B y + Bᵀ K_LN q_N = 0 ,   Bᵀ M_LL B = I
/// K_NN q_N + K_NL B y = W λ                                                                     massless contacts (13)
/// ```
///
/// `χ`, one column per contact coordinate, is the residual of the static shapes `Ψ = −K_LL⁻¹ K_LN` beyond the kept
/// modes, orthogonal to them. Thus the static stiffness is that of the full structure, and the mass is correct up to
/// `ν²`, as in mixed shooting-harmonic balance, while the contacts remain massless: the result is itself a structure
/// with massless contacts. If all modes are kept it is the full structure. Modes that are not excited by the contacts
/// (axial modes of a beam with a transverse stop) remain at rest and are omitted.
#[derive(Debug, Clone)]
pub struct GalerkinReduction {
    full: MasslessContactModel,
    model: MasslessContactModel,
    /// `B`, n_L × m; `None` if all modes are kept.
    basis: Option<Mat<f64>>,
    kept: usize,
    coupled: usize,
    available: usize,
    /// Largest `λ` of the fixed-interface modes that move a contact, rad²/s².
    highest: f64,
    left_out: Mat<f64>,
}

impl GalerkinReduction {
    /// Keeps, of the lowest `count` fixed-interface modes, those that are coupled to a contact, and the static
    /// correction.
    ///
    /// # Errors
    /// [`ReductionError::Model`] if the structure can move as a rigid body with its contacts fixed, or its modes cannot
    /// be computed; [`ReductionError::Linalg`].
    pub fn new(full: MasslessContactModel, count: usize) -> Result<Self, ReductionError> {
        Self::of(full, count, false)
    }

    /// As [`new`](Self::new), with all of these modes: also those that leave the contacts at rest, so that the modes of
    /// the reduced structure have the numbers of those of the full one.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_modes_at_rest(full: MasslessContactModel, count: usize) -> Result<Self, ReductionError> {
        Self::of(full, count, true)
    }

    fn of(full: MasslessContactModel, count: usize, with_all: bool) -> Result<Self, ReductionError> {
        let (n_l, n_n) = (full.linear_dofs().len(), full.k_nn().nrows());
        let held = HeldModes::new(&full, count.min(n_l))?;
        let (coupled, available, is_all) = (held.modes.len(), held.count(), held.is_all());
        let highest = held.modes.last().map_or(0.0, |mode| mode.lambda);
        let kept: Vec<(usize, f64)> = match with_all {
            true => held.lambda.iter().copied().enumerate().collect(),
            false => held.modes.iter().map(|mode| (mode.column, mode.lambda)).collect(),
        };
        let n_kept = kept.len();
        let left_out = Mat::zeros(n_n, n_n);
        if n_kept == n_l {
            let model = full.clone();
            return Ok(Self { model, full, basis: None, kept: n_l, coupled, available, highest, left_out });
        }
        let shapes = Mat::from_fn(n_l, n_kept, |i, k| held.shapes[(i, kept[k].0)]);
        let StaticCorrection { shapes: correction, lambda: own, left_out } = match is_all {
            true => StaticCorrection { shapes: Mat::zeros(n_l, 0), lambda: Vec::new(), left_out },
            false => static_correction(&full, &shapes, held.statics, &held.stiffness)?,
        };
        let lambda: Vec<f64> = kept.iter().map(|(_, lambda)| *lambda).chain(own).collect();
        let basis = Mat::from_fn(n_l, lambda.len(), |i, k| match k.checked_sub(n_kept) {
            Some(r) => correction[(i, r)],
            None => shapes[(i, k)],
        });
        let steady = full.steady_force().map(|steady| on_basis(&full, steady, &basis));
        let model = reduced_model(&full, &lambda, &(basis.transpose() * full.k_ln()), steady)?;
        Ok(Self { full, model, basis: Some(basis), kept: n_kept, coupled, available, highest, left_out })
    }

    /// The original structure.
    pub fn full(&self) -> &MasslessContactModel {
        &self.full
    }

    /// The reduced structure: its degrees of freedom are `y`, then `q_N`.
    pub fn model(&self) -> &MasslessContactModel {
        &self.model
    }

    /// Number of modes kept, including those of the static correction.
    pub fn n_modes(&self) -> usize {
        self.model.linear_dofs().len()
    }

    /// Number of fixed-interface modes kept.
    pub fn n_kept_modes(&self) -> usize {
        self.kept
    }

    /// Number of fixed-interface modes computed, including those that are not coupled to the contacts.
    pub fn n_held_modes(&self) -> usize {
        self.available
    }

    /// Number of them that move a contact.
    pub fn n_coupled_modes(&self) -> usize {
        self.coupled
    }

    /// Largest squared angular frequency of those that move a contact, rad²/s².
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// What the reduction leaves out of the answer of the structure at its contacts, n_N × n_N: with
    /// `S = Σ g_kᵀ g_k/λ_k³` over the modes that were not computed, and `S_χ` what the static correction has of it,
    /// `S − S_χ`. Forces that hold the contacts at `q_N e^{iνt}` are wrong by `ν⁴` times that, and by higher powers.
    pub fn left_out(&self) -> &Mat<f64> {
        &self.left_out
    }

    /// Rows of displacements of the full structure, at the degrees of freedom `dofs`, in the modes `open` of the
    /// reduced one and in the contact forces.
    ///
    /// # Errors
    /// [`ReductionError::Linalg`] for modes of another structure.
    pub fn rows_of_dofs(&self, open: &OpenModes, dofs: &[usize]) -> Result<ResponseRows, ReductionError> {
        let Some(basis) = &self.basis else { return open.rows_of_dofs(dofs) };
        let all: Vec<usize> = (0..self.model.dofs().len()).collect();
        let (own, m) = (open.rows_of_dofs(&all)?, self.n_modes());
        let share = |dof: usize, j: usize| match self.full.linear_dofs().binary_search(&dof) {
            Ok(row) => {
                if j < m {
                    basis[(row, j)]
                } else {
                    0.0
                }
            }
            Err(_) => f64::from(u8::from(self.full.contact_dofs().binary_search(&dof).is_ok_and(|node| j == m + node))),
        };
        let shares = Mat::from_fn(dofs.len(), all.len(), |i, j| share(dofs[i], j));
        Ok(ResponseRows { modes: &shares * own.modes, forces: &shares * own.forces })
    }

    /// Displacements or velocities of all degrees of freedom of the full structure, from those of the reduced one.
    pub fn expand(&self, reduced: &[f64]) -> Vec<f64> {
        let Some(basis) = &self.basis else { return reduced.to_vec() };
        let (y, q_n) = reduced.split_at(self.n_modes());
        let mut all = vec![0.0; self.full.dofs().len()];
        if self.full.contact_coordinates() == ContactCoordinates::Nodes {
            self.full.contact_dofs().iter().zip(q_n).for_each(|(&dof, q)| all[dof] = *q);
        }
        self.full.linear_dofs().iter().zip(times(basis, y)).for_each(|(&dof, q)| all[dof] = q);
        all
    }

    /// Displacements or velocities of the reduced structure, from those of all degrees of freedom of the full one;
    /// those of its contact coordinates follow statically and are set to zero.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`].
    pub fn project(&self, full: &[f64]) -> Result<Vec<f64>, ReductionError> {
        let expected = self.full.dofs().len();
        if full.len() != expected {
            return Err(ReductionError::Dimension { what: "displacements", expected, found: full.len() });
        }
        let Some(basis) = &self.basis else { return Ok(full.to_vec()) };
        let q_l: Vec<f64> = self.full.linear_dofs().iter().map(|&dof| full[dof]).collect();
        let inertia = multiply(self.full.m_ll(), &q_l);
        let contacts = std::iter::repeat_n(0.0, self.full.k_nn().nrows());
        Ok(transposed(basis, &inertia).into_iter().chain(contacts).collect())
    }
}

/// The residual of the static shapes beyond certain modes.
struct StaticCorrection {
    /// `χ`, n_L × r.
    shapes: Mat<f64>,
    /// `χᵀ K χ`, r.
    lambda: Vec<f64>,
    /// `S − S_χ`, n_N × n_N.
    left_out: Mat<f64>,
}

/// Columns `χ` with `χᵀ M χ = I`, `φᵀ M χ = 0`, that span the residual of the static shapes beyond the modes `φ`, and
/// what they leave out.
fn static_correction(
    full: &MasslessContactModel,
    modes: &Mat<f64>,
    psi: Mat<f64>,
    stiffness: &SparseCholesky,
) -> Result<StaticCorrection, ReductionError> {
    let failed = |source| ReductionError::Linalg { what: "static correction of the held modes", source };
    let n_n = psi.ncols();
    let whole = gram(full.m_ll(), &psi);
    let whole = (0..n_n).map(|d| whole[(d, d)]).fold(0.0, f64::max);
    let mut rest = psi;
    // Twice: rounding errors of the modes are as large as the residual.
    for _ in 0..2 {
        rest = &rest - modes * (modes.transpose() * multiply_many(full.m_ll(), &rest));
    }
    let (mass, turn) = symmetric_eigen(&gram(full.m_ll(), &rest)).map_err(failed)?;
    let left: Vec<usize> = (0..n_n).filter(|&r| mass[r] > NOTHING * whole).collect();
    let turn = Mat::from_fn(n_n, left.len(), |i, r| turn[(i, left[r])] / mass[left[r]].sqrt());
    let unit = &rest * &turn;
    let (lambda, turn) = symmetric_eigen(&gram(full.k_ll(), &unit)).map_err(failed)?;
    let correction = &unit * &turn;
    // S = restᵀ M K⁻¹ M rest, and S_χ = restᵀ M χ Λ⁻¹ χᵀ M rest.
    let inertia = multiply_many(full.m_ll(), &rest);
    let mut answer = inertia.clone();
    stiffness.solve_many(&mut answer);
    let (s, seen) = (inertia.transpose() * answer, correction.transpose() * inertia);
    let of_correction =
        |i: usize, j: usize| (0..lambda.len()).map(|r| seen[(r, i)] * seen[(r, j)] / lambda[r]).sum::<f64>();
    let left_out = Mat::from_fn(n_n, n_n, |i, j| 0.5 * (s[(i, j)] + s[(j, i)]) - of_correction(i, j));
    Ok(StaticCorrection { shapes: correction, lambda, left_out })
}

/// `B y`.
fn times(b: &Mat<f64>, y: &[f64]) -> Vec<f64> {
    (0..b.nrows()).map(|i| y.iter().enumerate().map(|(k, y)| b[(i, k)] * y).sum()).collect()
}

/// `Bᵀ q`.
fn transposed(b: &Mat<f64>, q: &[f64]) -> Vec<f64> {
    (0..b.ncols()).map(|k| b.col(k).iter().zip(q).map(|(b, q)| b * q).sum()).collect()
}

/// `Xᵀ A X`, symmetric.
fn gram(a: &SparseMatrix, x: &Mat<f64>) -> Mat<f64> {
    let product = x.transpose() * multiply_many(a, x);
    Mat::from_fn(x.ncols(), x.ncols(), |i, j| 0.5 * (product[(i, j)] + product[(j, i)]))
}

/// `M = diag(I, 0)` and the arrow `K` of kept modes and contact coordinates, with `g = Bᵀ K_LN`.
fn reduced_model(
    full: &MasslessContactModel,
    lambda: &[f64],
    g: &Mat<f64>,
    steady: Option<SteadyForce>,
) -> Result<MasslessContactModel, ReductionError> {
    let statics = full.k_nn();
    let (m, n_n) = (lambda.len(), statics.nrows());
    let failed = |source| ReductionError::Linalg { what: "matrices of the reduced structure", source };
    let unit: Vec<_> = (0..m).map(|k| (k, k, 1.0)).collect();
    let mut entries: Vec<_> = lambda.iter().enumerate().map(|(k, λ)| (k, k, *λ)).collect();
    for d in 0..n_n {
        (0..m).for_each(|k| entries.extend([(k, m + d, g[(k, d)]), (m + d, k, g[(k, d)])]));
        entries.extend((0..n_n).map(|e| (m + d, m + e, 0.5 * (statics[(d, e)] + statics[(e, d)]))));
    }
    let mass = sparse_from_triplets(m + n_n, m + n_n, &unit).map_err(failed)?;
    let stiffness = sparse_from_triplets(m + n_n, m + n_n, &entries).map_err(failed)?;
    // A kept mode has no node; this label is never visible.
    let mode = |k: usize| Dof { node: k, position: 0.0, kind: DofKind::Deflection };
    let nodes = full.contact_dofs().iter().map(|&dof| full.dofs()[dof]);
    let dofs = (0..m).map(mode).chain(nodes).collect();
    let mut model = StructuralModel::new(mass, stiffness, dofs, contacts(full, m))?;
    if let Some(steady) = steady {
        model = model.with_steady_force(steady)?;
    }
    Ok(MasslessContactModel::new(&model, &Drop)?)
}

/// A steady force in the coordinates of the reduced structure: `Bᵀ f`, and `Bᵀ M R` of its motions.
fn on_basis(full: &MasslessContactModel, steady: &SteadyForce, basis: &Mat<f64>) -> SteadyForce {
    let linear = steady.at(full.linear_dofs());
    let inertia = basis.transpose() * multiply_many(full.m_ll(), &linear.motions);
    let (m, nodes) = (basis.ncols(), steady.at(full.contact_dofs()).motions);
    let mut force = transposed(basis, &linear.force);
    force.resize(m + nodes.nrows(), 0.0);
    let motions = Mat::from_fn(m + nodes.nrows(), nodes.ncols(), |i, r| match i.checked_sub(m) {
        None => inertia[(i, r)],
        Some(node) => nodes[(node, r)],
    });
    SteadyForce { force, motions }
}

/// The contacts at the coordinates of the reduced structure; the tip of a contact spring meets a rigid wall.
fn contacts(full: &MasslessContactModel, m: usize) -> Vec<Contact> {
    let place = |(i, contact): (usize, &DofContact)| match full.contact_coordinates() {
        ContactCoordinates::Nodes => {
            let d = full.contact_dofs().binary_search(&contact.dof).unwrap_or_else(|place| place);
            DofContact { dof: m + d, ..*contact }
        }
        ContactCoordinates::SpringTips => DofContact { dof: m + i, law: ContactLaw::Rigid, ..*contact },
    };
    full.contacts().iter().enumerate().map(place).map(Contact::from).collect()
}
