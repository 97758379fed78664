//! The conservative nonlinear mode in open modes: m (N_h + 1) unknowns, whatever the number of contacts.

use nlmodes_contact::solver_by_name;
use nlmodes_hbm::{
    CondensedStructure, Coordinates, Grazing, ModalGrazing, ModalStructure, PeriodicSettings, PeriodicSystem,
    modal_grazing,
};
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
        let open = ModalStructure::of_massless(model)?;
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
        && model.contacts().iter().all(|contact| contact.gap > 0.0)
        && model.steady_force().is_none()
        && settings.method == BranchMethod::HarmonicBalance
        && settings.accuracy.is_none()
        && settings.held_modes.is_none()
        && settings.internal_resonance == ResonanceRule::Follow
}
