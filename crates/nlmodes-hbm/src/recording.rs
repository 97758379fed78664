use nlmodes_linalg::Mat;
use nlmodes_model::{ContactCoordinates, MasslessContactModel};

use nlmodes_reduction::HeldMode;

/// Most degrees of freedom of which modal points hold all coefficients.
///
/// A structure with more is recorded at evenly spaced nodes, half of that number, and at its contacts: a hundred
/// thousand degrees of freedom with five harmonics would else need 10 MB a point.
pub const MAX_RECORDED: usize = 4000;

/// The degrees of freedom that modal points show, and what makes their coefficients from the reduced ones:
/// `q_L,n = Ψ q_N,n + ν² X q_N,n + Σ_k (ν²/λ_k) φ_k η_k,n`.
#[derive(Debug, Clone)]
pub(crate) struct Recording {
    dofs: Vec<usize>,
    /// Of each recorded degree of freedom with mass, its place among the recorded ones.
    pub linear: Vec<usize>,
    /// Of each contact coordinate that is a node, its place among the recorded ones.
    pub contacts: Vec<usize>,
    /// Rows of `[φ … , Ψ, X]` for `linear`.
    pub basis: Mat<f64>,
    /// What a steady force adds to the mean of `linear`; empty for none.
    pub sag: Vec<f64>,
}

impl Recording {
    pub fn new(
        model: &MasslessContactModel,
        modes: &[HeldMode],
        shapes: &Mat<f64>,
        [psi, residual]: [&Mat<f64>; 2],
        sag: &[f64],
    ) -> Self {
        let dofs = recorded(model);
        let place = |dof: usize| dofs.binary_search(&dof).ok();
        let rows: Vec<(usize, usize)> =
            model.linear_dofs().iter().enumerate().filter_map(|(row, &dof)| Some((row, place(dof)?))).collect();
        let (k, n) = (modes.len(), psi.ncols());
        let basis = Mat::from_fn(rows.len(), k + 2 * n, |i, j| {
            let row = rows[i].0;
            match j {
                j if j < k => shapes[(row, modes[j].column)],
                j if j < k + n => psi[(row, j - k)],
                j => residual[(row, j - k - n)],
            }
        });
        let contacts = match model.contact_coordinates() {
            ContactCoordinates::Nodes => model.contact_dofs().iter().filter_map(|&dof| place(dof)).collect(),
            ContactCoordinates::SpringTips => Vec::new(),
        };
        let sag = rows.iter().filter_map(|(row, _)| sag.get(*row).copied()).collect();
        Self { linear: rows.into_iter().map(|(_, place)| place).collect(), contacts, basis, sag, dofs }
    }

    pub fn dofs(&self) -> &[usize] {
        &self.dofs
    }
}

/// All degrees of freedom, or those of every m-th node, of the last one and of the contacts.
fn recorded(model: &MasslessContactModel) -> Vec<usize> {
    let all = model.dofs();
    if all.len() <= MAX_RECORDED {
        return (0..all.len()).collect();
    }
    let stride = all.len().div_ceil(MAX_RECORDED / 2);
    let last = all.iter().map(|d| d.node).max().unwrap_or(0);
    let is_contact = |i: usize| model.contacts().iter().any(|c| c.dof == i);
    (0..all.len()).filter(|&i| all[i].node.is_multiple_of(stride) || all[i].node == last || is_contact(i)).collect()
}
