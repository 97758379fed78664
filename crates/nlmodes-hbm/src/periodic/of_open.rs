use nlmodes_linalg::Mat;
use nlmodes_model::MasslessContactModel;
use nlmodes_model::reduction::OpenModes;

use super::damping::ModalDamping;
use super::structure::ModalStructure;
use crate::HbmError;

impl ModalStructure {
    /// The structure that was reduced to its open modes, with this damping. Rigid-body motions that no contact feels
    /// are never pushed by one.
    ///
    /// # Errors
    /// As [`ModalStructure::new`] and [`with_steady_force`](Self::with_steady_force).
    pub fn of_open(open: &OpenModes, damping: ModalDamping) -> Result<Self, HbmError> {
        let (rigid, unfelt) = (open.n_rigid(), open.unfelt_motions());
        let rows = Mat::from_fn(open.n_contacts(), open.n_modes(), |i, r| {
            if unfelt.contains(&r) { 0.0 } else { open.contact_rows()[(i, r)] }
        });
        let squares = open.omega_squared().iter().enumerate();
        let squares = squares.map(|(r, square)| if r < rigid { 0.0 } else { square.max(0.0) });
        let (gaps, stops) = (open.gaps().to_vec(), open.stop_compliance());
        let structure = Self::new(squares.collect(), rows, open.flexibility(), gaps, stops, damping)?;
        structure.with_steady_force(open.steady_force().to_vec())
    }

    /// The undamped structure of a model without mass at its contacts, with all its modes: those of
    /// [`OpenModes::all_of_massless`], in which eqs. (6) to (16) are solved.
    ///
    /// # Errors
    /// [`HbmError::Reduction`], or as [`of_open`](Self::of_open).
    pub fn of_massless(model: &MasslessContactModel) -> Result<Self, HbmError> {
        let open = OpenModes::all_of_massless(model)?;
        Self::of_open(&open, ModalDamping::none(open.n_modes()))
    }
}
