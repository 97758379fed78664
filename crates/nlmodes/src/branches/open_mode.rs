//! The conservative nonlinear mode in open modes: m (N_h + 1) unknowns, whatever the number of contacts.

use nlmodes_contact::solver_by_name;
use nlmodes_hbm::{
    CondensedStructure, Coordinates, Grazing, ModalDamping, ModalGrazing, ModalStructure, PeriodicSettings,
    PeriodicSystem, modal_grazing,
};
use nlmodes_linalg::{DenseLu, Mat};
use nlmodes_model::{ContactCoordinates, DofContact, DofKind, MasslessContactModel};

use super::{BranchError, BranchMethod, BranchSettings, ResonanceRule};

/// Up to so many directions the motions of the contacts are the unknowns.
const FEW: usize = 8;

/// A periodic system of a structure in open modes.
pub(super) struct OpenMode {
    pub system: PeriodicSystem,
    /// The contacts at the coordinates of the reduced structure.
    pub contacts: Vec<DofContact>,
    grazing: ModalGrazing,
}

impl OpenMode {
    /// The problem, if the structure is one in open modes with many contacts, all of them open at rest, and nothing is
    /// asked for that only motions of the contacts as unknowns have.
    pub fn of(
        structure: &CondensedStructure,
        settings: &BranchSettings,
        start: &Grazing,
    ) -> Result<Option<Self>, BranchError> {
        let model = structure.model();
        if !is_suited(model, settings) {
            return Ok(None);
        }
        let open = open_structure(model)?;
        let solver = solver_by_name(&settings.contact_solver)?;
        let periodic = PeriodicSettings {
            harmonics: settings.harmonics,
            switching: settings.switching,
            coordinates: Coordinates::Modal,
        };
        let system =
            PeriodicSystem::conservative_mode(&open, settings.symmetry, periodic, start.scales(), solver.as_ref())?;
        let grazing = modal_grazing(&open, settings.mode)?;
        Ok(Some(Self { system, contacts: model.contacts().to_vec(), grazing }))
    }

    /// Unknowns at grazing and the direction of growing amplitude.
    pub fn start(&self) -> (Vec<f64>, Vec<f64>) {
        (self.grazing.unknowns(&self.system), self.grazing.direction(&self.system))
    }

    /// Index of the frequency among the unknowns.
    pub fn frequency_index(&self) -> usize {
        self.system.n_coefficients()
    }

    /// Angular frequency of the unknowns `x`, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        self.system.operating_point(x, 0.0).omega
    }
}

fn is_suited(model: &MasslessContactModel, settings: &BranchSettings) -> bool {
    let dofs = model.dofs();
    model.contact_coordinates() == ContactCoordinates::Nodes
        && model.contact_dofs().len() > FEW
        && model.linear_dofs().iter().all(|&i| dofs[i].kind == DofKind::Modal)
        && model.contact_dofs().iter().all(|&i| dofs[i].kind == DofKind::Contact)
        && model.contacts().iter().all(|contact| contact.gap > 0.0)
        && settings.method == BranchMethod::HarmonicBalance
        && settings.accuracy.is_none()
        && settings.held_modes.is_none()
        && settings.internal_resonance == ResonanceRule::Follow
}

/// `Ω²`, `Y` and `A` from the stiffness of the reduced structure: `A = K_NN⁻¹`, `Y = A K_NL`,
/// `Ω² = diag(K_LL − K_LN A K_NL)`.
fn open_structure(model: &MasslessContactModel) -> Result<ModalStructure, BranchError> {
    let (m, d) = (model.linear_dofs().len(), model.contact_dofs().len());
    let failed = |source| nlmodes_hbm::HbmError::Linalg { what: "residual flexibility of the contacts", source };
    let lu = DenseLu::factor(model.k_nn()).map_err(failed)?;
    let solved = |rhs: Mat<f64>| {
        let mut x = rhs;
        for j in 0..x.ncols() {
            let mut column: Vec<f64> = x.col(j).iter().copied().collect();
            lu.solve_in_place(&mut column);
            x.col_mut(j).iter_mut().zip(&column).for_each(|(to, from)| *to = *from);
        }
        x
    };
    let rows = solved(model.k_ln().transpose().to_owned());
    let a = solved(Mat::identity(d, d));
    let coupled = model.k_ln() * &rows;
    let stiffness = |r: usize| model.k_ll().get(r, r).copied().unwrap_or(0.0) - coupled[(r, r)];
    let omega_squared: Vec<f64> = (0..m).map(stiffness).collect();
    let of = |i: usize| model.contacts()[i];
    let place = |i: usize| model.contact_dofs().binary_search(&of(i).dof).unwrap_or(0);
    let c = model.contacts().len();
    // g = g₀ − side u and u = −(Y η + A f): the row of a contact is that of its direction, seen from its side.
    let y = Mat::from_fn(c, m, |i, r| of(i).side.sign() * rows[(place(i), r)]);
    let flexibility = Mat::from_fn(c, c, |i, j| {
        let both = 0.5 * (a[(place(i), place(j))] + a[(place(j), place(i))]);
        of(i).side.sign() * of(j).side.sign() * both
    });
    let gaps = model.contacts().iter().map(|contact| contact.gap).collect();
    let compliance = model.stop_compliance();
    Ok(ModalStructure::new(omega_squared, y, &flexibility, gaps, &compliance, ModalDamping::none(m))?)
}
