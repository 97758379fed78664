use nlmodes_linalg::{Mat, SparseMatrix, bilinear, multiply, multiply_many, sparse_from_triplets, symmetric_eigen};
use nlmodes_model::{
    Contact, ContactCoordinates, ContactLaw, Dof, DofContact, DofKind, Drop, MasslessContactModel, SteadyForce,
    StructuralModel,
};
use nlmodes_reduction::HeldModes;

use crate::phase::{column, product, transposed_product};
use crate::{ContactDynamics, TimestepError};

/// Relative mass of the residual static shapes below which there is no residual.
const NOTHING: f64 = 1e-13;

/// A structure with massless contacts, reduced to its lowest fixed-interface modes with static correction.
///
/// ```text
/// q_L = B y ,   B = [φ_1 … φ_m, χ] ,   ÿ + Bᵀ K_LL B y + Bᵀ K_LN q_N = 0 ,   Bᵀ M_LL B = I
/// K_NN q_N + K_NL B y = W λ                                                                       massless contacts (13)
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
    available: usize,
}

impl GalerkinReduction {
    /// Keeps, of the lowest `count` fixed-interface modes, those that are coupled to a contact, and the static
    /// correction.
    ///
    /// # Errors
    /// [`TimestepError::Model`] if the structure can move as a rigid body with its contacts fixed, or its modes cannot
    /// be computed; [`TimestepError::Linalg`].
    pub fn new(full: MasslessContactModel, count: usize) -> Result<Self, TimestepError> {
        let n_l = full.linear_dofs().len();
        let held = HeldModes::new(&full, count.min(n_l))?;
        let (n_kept, available, is_all) = (held.modes.len(), held.count(), held.is_all());
        if n_kept == n_l {
            return Ok(Self { model: full.clone(), full, basis: None, kept: n_l, available });
        }
        let shapes = Mat::from_fn(n_l, n_kept, |i, k| held.shapes[(i, held.modes[k].column)]);
        let (correction, own) = match is_all {
            true => (Mat::zeros(n_l, 0), Vec::new()),
            false => static_correction(&full, &shapes, held.statics)?,
        };
        let lambda: Vec<f64> = held.modes.iter().map(|mode| mode.lambda).chain(own).collect();
        let basis = Mat::from_fn(n_l, lambda.len(), |i, k| match k.checked_sub(n_kept) {
            Some(r) => correction[(i, r)],
            None => shapes[(i, k)],
        });
        let steady = full.steady_force().map(|steady| on_basis(&full, steady, &basis));
        let model = reduced_model(&full, &lambda, &(basis.transpose() * full.k_ln()), steady)?;
        Ok(Self { full, model, basis: Some(basis), kept: n_kept, available })
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

    /// The reduced structure for exact integration.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::new`].
    pub fn dynamics(&self) -> Result<ContactDynamics, TimestepError> {
        ContactDynamics::new(self.model.clone())
    }

    /// Displacements or velocities of all degrees of freedom of the full structure, from those of the reduced one.
    pub fn expand(&self, reduced: &[f64]) -> Vec<f64> {
        let Some(basis) = &self.basis else { return reduced.to_vec() };
        let (y, q_n) = reduced.split_at(self.n_modes());
        let mut all = vec![0.0; self.full.dofs().len()];
        if self.full.contact_coordinates() == ContactCoordinates::Nodes {
            self.full.contact_dofs().iter().zip(q_n).for_each(|(&dof, q)| all[dof] = *q);
        }
        self.full.linear_dofs().iter().zip(product(basis, y)).for_each(|(&dof, q)| all[dof] = q);
        all
    }

    /// Displacements or velocities of the reduced structure, from those of all degrees of freedom of the full one;
    /// those of its contact coordinates follow statically and are set to zero.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`].
    pub fn project(&self, full: &[f64]) -> Result<Vec<f64>, TimestepError> {
        let expected = self.full.dofs().len();
        if full.len() != expected {
            return Err(TimestepError::Dimension { what: "displacements", expected, found: full.len() });
        }
        let Some(basis) = &self.basis else { return Ok(full.to_vec()) };
        let q_l: Vec<f64> = self.full.linear_dofs().iter().map(|&dof| full[dof]).collect();
        let inertia = multiply(self.full.m_ll(), &q_l);
        let contacts = std::iter::repeat_n(0.0, self.full.k_nn().nrows());
        Ok(transposed_product(basis, &inertia).into_iter().chain(contacts).collect())
    }

    /// `yᵀ y`: twice the kinetic energy of velocities of the reduced structure.
    pub(crate) fn inertia(&self, reduced: &[f64]) -> f64 {
        bilinear(reduced, self.model.mass(), reduced)
    }
}

/// Columns `χ` with `χᵀ M χ = I`, `φᵀ M χ = 0`, that span the residual of the static shapes beyond the modes `φ`, and
/// their `χᵀ K χ`.
fn static_correction(
    full: &MasslessContactModel,
    modes: &Mat<f64>,
    psi: Mat<f64>,
) -> Result<(Mat<f64>, Vec<f64>), TimestepError> {
    let failed = TimestepError::during("static correction of the held modes");
    let n_n = psi.ncols();
    let whole = (0..n_n).map(|d| bilinear(column(&psi, d), full.m_ll(), column(&psi, d))).fold(0.0, f64::max);
    let mut rest = psi;
    // Twice: rounding errors of the modes are as large as the residual.
    for _ in 0..2 {
        rest = &rest - modes * (modes.transpose() * multiply_many(full.m_ll(), &rest));
    }
    let (mass, turn) = symmetric_eigen(&gram(full.m_ll(), &rest)).map_err(&failed)?;
    let left: Vec<usize> = (0..n_n).filter(|&r| mass[r] > NOTHING * whole).collect();
    let turn = Mat::from_fn(n_n, left.len(), |i, r| turn[(i, left[r])] / mass[left[r]].sqrt());
    let unit = &rest * &turn;
    let (lambda, turn) = symmetric_eigen(&gram(full.k_ll(), &unit)).map_err(&failed)?;
    Ok((&unit * &turn, lambda))
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
) -> Result<MasslessContactModel, TimestepError> {
    let statics = full.k_nn();
    let (m, n_n) = (lambda.len(), statics.nrows());
    let failed = TimestepError::during("matrices of the reduced structure");
    let unit: Vec<_> = (0..m).map(|k| (k, k, 1.0)).collect();
    let mut entries: Vec<_> = lambda.iter().enumerate().map(|(k, λ)| (k, k, *λ)).collect();
    for d in 0..n_n {
        (0..m).for_each(|k| entries.extend([(k, m + d, g[(k, d)]), (m + d, k, g[(k, d)])]));
        entries.extend((0..n_n).map(|e| (m + d, m + e, 0.5 * (statics[(d, e)] + statics[(e, d)]))));
    }
    let mass = sparse_from_triplets(m + n_n, m + n_n, &unit).map_err(&failed)?;
    let stiffness = sparse_from_triplets(m + n_n, m + n_n, &entries).map_err(&failed)?;
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
    let mut force = transposed_product(basis, &linear.force);
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
