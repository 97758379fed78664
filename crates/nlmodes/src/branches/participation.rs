use nlmodes_hbm::HbmError;
use nlmodes_modal::{HarmonicCoefficients, Participation};

use super::{BranchError, ComputedBranch};

impl ComputedBranch {
    /// Participation of the lowest `modes` linear modes (contacts open, contact mass as in the computation) at each
    /// point, eq. (30), with all harmonics but the mean in the sum; the fundamental of the first contact coordinate is
    /// the phase anchor.
    ///
    /// # Errors
    /// [`BranchError`] if a point cannot be evaluated again.
    pub fn participation(&self, modes: usize) -> Result<Vec<Participation>, BranchError> {
        let anchor = self.branch.contact_coordinate.unwrap_or(0);
        let both = self.branch.points.iter().zip(&self.unknowns).enumerate();
        both.map(|(number, (point, x))| {
            let is_whole = point.coefficients.n_coordinates() == self.structure.model().dofs().len();
            let modal = match is_whole {
                true => self.structure.modal_coordinates(&point.coefficients, modes)?,
                false => lowest(&self.problem(number)?.motion(x, 0.0)?.modal_coefficients(), modes),
            };
            let fundamental = point.coefficients.of(anchor)[1];
            Ok(Participation::of_point(point, &modal, fundamental).map_err(HbmError::from)?)
        })
        .collect()
    }
}

/// The first coordinates of a motion.
fn lowest(all: &HarmonicCoefficients, count: usize) -> HarmonicCoefficients {
    let mut some = HarmonicCoefficients::zeros(count.min(all.n_coordinates()), all.n_harmonics());
    (0..some.n_coordinates()).for_each(|k| some.of_mut(k).copy_from_slice(all.of(k)));
    some
}
