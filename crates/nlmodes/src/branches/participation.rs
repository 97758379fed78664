use nlmodes_hbm::{HbmError, Projection};
use nlmodes_modal::Participation;
use nlmodes_model::{LinearModes, open_modes};

use super::{BranchError, ComputedBranch};

impl ComputedBranch {
    /// Participation of the lowest `modes` linear modes (contacts open, contact mass as in the computation) at each
    /// point, eq. (30), with all harmonics but the mean in the sum; the fundamental of the first contact coordinate is
    /// the phase anchor.
    ///
    /// # Errors
    /// [`BranchError`] if the linear modes cannot be computed.
    pub fn participation(&self, modes: usize) -> Result<Vec<Participation>, BranchError> {
        self.participation_in(&open_modes(self.structure.model(), modes).map_err(HbmError::from)?)
    }

    /// The same of linear modes that are known.
    ///
    /// # Errors
    /// [`BranchError`] if a point cannot be evaluated again.
    pub fn participation_in(&self, linear: &LinearModes) -> Result<Vec<Participation>, BranchError> {
        let onto = Projection::new(&self.structure, linear);
        let anchor = self.branch.contact_coordinate.unwrap_or(0);
        let both = self.branch.points.iter().zip(&self.unknowns).enumerate();
        both.map(|(number, (point, x))| {
            let modal = match onto.of_motion(&point.coefficients) {
                Some(modal) => modal,
                // The point holds some degrees of freedom only: the sum over all of them is done in the reduced
                // coordinates.
                None => self.problem(number)?.modal_coordinates(x, &onto)?,
            };
            let fundamental = point.coefficients.of(anchor)[1];
            Ok(Participation::of_point(point, &modal, fundamental).map_err(HbmError::from)?)
        })
        .collect()
    }
}
