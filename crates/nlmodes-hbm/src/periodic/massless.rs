use nlmodes_linalg::{DenseLu, Mat};
use nlmodes_model::{DofKind, MasslessContactModel, open_modes};

use super::damping::ModalDamping;
use super::structure::ModalStructure;
use crate::HbmError;

impl ModalStructure {
    /// The undamped structure of a model without mass at its contacts, with all its modes.
    ///
    /// Contact nodes without mass follow the other degrees of freedom and their own contact forces, eq. (13), as
    /// `q_N = b + K_NN⁻¹ W λ`, `b = −K_NN⁻¹ K_NL q_L`. So eqs. (6) to (16) are those of free-interface modes with
    ///
    /// ```text
    /// (K_LL − K_LN K_NN⁻¹ K_NL) φ_k = ω_k² M_LL φ_k ,   Y = −Wᵀ K_NN⁻¹ K_NL Φ ,   A = Wᵀ K_NN⁻¹ W
    /// ```
    ///
    /// # Errors
    /// [`HbmError`] if `K_NN` is singular or the modes cannot be computed, or as [`ModalStructure::new`].
    pub fn of_massless(model: &MasslessContactModel) -> Result<Self, HbmError> {
        let failed = |source| HbmError::Linalg { what: "stiffness K_NN of the contact degrees of freedom", source };
        let pressed = DenseLu::factor(model.k_nn()).map_err(failed)?.solve_columns(model.w());
        let follow = -(pressed.transpose() * model.k_ln().transpose());
        let (linear, dofs) = (model.linear_dofs(), model.dofs());
        let is_modal = linear.iter().all(|&i| dofs[i].kind == DofKind::Modal)
            && model.contact_dofs().iter().all(|&i| dofs[i].kind == DofKind::Contact);
        let steady: Vec<f64> =
            model.steady_force().map_or_else(Vec::new, |steady| linear.iter().map(|&i| steady.force[i]).collect());
        let (omega_squared, rows, steady) = if is_modal {
            // Free-interface modes once more, as which the stiffness without the contact nodes is diagonal.
            let (k_ll, k_ln) = (model.k_ll(), model.k_ln());
            let nodes = DenseLu::factor(model.k_nn()).map_err(failed)?.solve_columns(&k_ln.transpose().to_owned());
            let of_nodes = |k: usize| (0..nodes.nrows()).map(|d| k_ln[(k, d)] * nodes[(d, k)]).sum::<f64>();
            let square = |k: usize| k_ll.get(k, k).copied().unwrap_or(0.0) - of_nodes(k);
            ((0..linear.len()).map(square).collect::<Vec<f64>>(), follow, steady)
        } else {
            let modes = open_modes(model, linear.len())?;
            let shapes = Mat::from_fn(linear.len(), modes.omega.len(), |i, k| modes.shapes[(linear[i], k)]);
            let on = |k: usize| steady.iter().enumerate().map(|(i, force)| shapes[(i, k)] * force).sum();
            let steady = if steady.is_empty() { steady } else { (0..modes.omega.len()).map(on).collect() };
            (modes.omega.iter().map(|omega| omega * omega).collect(), &follow * &shapes, steady)
        };
        let a = model.w().transpose() * &pressed;
        let flexibility = Mat::from_fn(a.nrows(), a.ncols(), |i, j| 0.5 * (a[(i, j)] + a[(j, i)]));
        let gaps = model.contacts().iter().map(|contact| contact.gap).collect();
        let damping = ModalDamping::none(omega_squared.len());
        let structure = Self::new(omega_squared, rows, &flexibility, gaps, &model.stop_compliance(), damping)?;
        structure.with_steady_force(steady)
    }
}
