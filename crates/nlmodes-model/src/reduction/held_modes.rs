use nlmodes_linalg::{DenseLu, Mat, SparseCholesky, symmetric_eigen};

use crate::reduction::ReductionError;
use crate::{LinearModes, MasslessContactModel, held_modes};

/// A fixed-interface mode, as seen at the contact degrees of freedom.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct HeldMode {
    /// Squared angular frequency `λ_k`, rad²/s².
    pub lambda: f64,
    /// Column of the mode in [`HeldModes::shapes`].
    pub column: usize,
    /// `g_k = φ_kᵀ K_LN`, n_N.
    pub g: Vec<f64>,
}

/// A structure with massless contact coordinates, represented by its fixed-interface modes and its statics.
///
/// ```text
/// K_LL φ_k = λ_k M_LL φ_k ,   Ψ = −K_LL⁻¹ K_LN
/// ```
///
/// Among modes with the same frequency (equal spans between contacts) those with `g_i K_NN⁻¹ g_jᵀ = 0` are chosen, of
/// which at most as many as contact coordinates are coupled to these. Modes that are not coupled to the contacts (axial
/// modes of a beam with a transverse stop) are only counted.
#[derive(Debug, Clone)]
pub struct HeldModes {
    /// Those that move a contact, ascending.
    pub modes: Vec<HeldMode>,
    /// Squared angular frequencies of all that were computed, ascending, rad²/s².
    pub lambda: Vec<f64>,
    /// Shapes of all that were computed, mass-normalised, n_L × [`count`](Self::count).
    pub shapes: Mat<f64>,
    /// Static shapes `Ψ`, n_L × n_N.
    pub statics: Mat<f64>,
    /// `K_LL`, factored.
    pub stiffness: SparseCholesky,
}

impl HeldModes {
    /// Relative difference below which two frequencies count as one.
    pub const REPEATED: f64 = 1e-10;

    /// The lowest `count` modes of `model`, all of them where there are fewer.
    ///
    /// # Errors
    /// [`ReductionError::Model`] if the structure can move as a rigid body with its contacts fixed, or its modes cannot
    /// be computed; [`ReductionError::Linalg`].
    pub fn new(model: &MasslessContactModel, count: usize) -> Result<Self, ReductionError> {
        let stiffness = model.factor_k_ll()?;
        let mut statics = -model.k_ln();
        stiffness.solve_many(&mut statics);
        let k_nn = DenseLu::factor(model.k_nn())
            .map_err(ReductionError::during("stiffness K_NN of the contact degrees of freedom"))?;
        let mut held = held_modes(model, count)?;
        separate_repeated(&mut held, model, &k_nn)?;
        let g = held.shapes.transpose() * model.k_ln();
        // T_0, where the contact coordinates would be statically, without stops, by the place at which they are.
        let transfer = k_nn.solve_columns(&-(model.k_ln().transpose() * &statics));
        let scale = (0..transfer.nrows()).map(|i| transfer[(i, i)].abs()).fold(f64::MIN_POSITIVE, f64::max);
        let modes = held.omega.iter().enumerate().filter_map(|(k, omega)| {
            let row: Vec<f64> = (0..g.ncols()).map(|d| g[(k, d)]).collect();
            let mut h = row.clone();
            k_nn.solve_in_place(&mut h);
            // How strongly the mode takes part in the motion of the contacts, rad²/s².
            let s: f64 = row.iter().zip(&h).map(|(g, h)| g * h).sum();
            let lambda = omega * omega;
            (s > 1e-20 * scale * lambda).then_some(HeldMode { lambda, column: k, g: row })
        });
        let (modes, lambda) = (modes.collect(), held.omega.iter().map(|omega| omega * omega).collect());
        Ok(Self { modes, lambda, shapes: held.shapes, statics, stiffness })
    }

    /// Modes computed, with those that leave the contacts at rest.
    pub fn count(&self) -> usize {
        self.shapes.ncols()
    }

    /// Whether there are no others.
    pub fn is_all(&self) -> bool {
        self.count() >= self.shapes.nrows()
    }
}

fn separate_repeated(
    held: &mut LinearModes,
    model: &MasslessContactModel,
    k_nn: &DenseLu,
) -> Result<(), ReductionError> {
    let mut first = 0;
    while first < held.omega.len() {
        let limit = held.omega[first] * (1.0 + HeldModes::REPEATED);
        let same = held.omega[first..].iter().take_while(|omega| **omega <= limit).count();
        if same > 1 {
            let shapes = held.shapes.subcols(first, same).to_owned();
            let g = shapes.transpose() * model.k_ln();
            let strength = &g * k_nn.solve_columns(&g.transpose().to_owned());
            let strength = Mat::from_fn(same, same, |i, j| 0.5 * (strength[(i, j)] + strength[(j, i)]));
            let (_, turn) =
                symmetric_eigen(&strength).map_err(ReductionError::during("modes with the same frequency"))?;
            held.shapes.subcols_mut(first, same).copy_from(&shapes * turn);
        }
        first += same;
    }
    Ok(())
}
