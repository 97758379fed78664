use nlmodes_hbm::{HbmError, Projection};
use nlmodes_modal::{HarmonicCoefficients, ModalPoint, NonlinearModeShape, Participation, PhaseAnchor};
use nlmodes_model::{LinearModes, open_modes};

use super::{BranchError, ComputedBranch};

impl ComputedBranch {
    /// Participation of the lowest `modes` linear modes (contacts open, contact mass as in the computation) at each
    /// point, eq. (30), with all harmonics but the mean in the sum; the fundamental of the first contact coordinate is
    /// the phase anchor. NaN where a motion has no fundamental to be normalised by, as the pure second mode on the tip
    /// of a tongue.
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
        let of = |point: &ModalPoint, modal: &HarmonicCoefficients| {
            let amplitude = point.modal_amplitude;
            if amplitude == 0.0 {
                let none = vec![f64::NAN; linear.omega.len()];
                return Ok(Participation {
                    factors: none.clone(),
                    quadrature: none,
                    harmonics: 1..=modal.n_harmonics(),
                    energy_shares: Vec::new(),
                }
                .with_energy_shares(modal, point.omega, point.kinetic_energy));
            }
            // Where the anchor's fundamental vanishes, as on the tip of a tongue, there is no phase to take out.
            let fundamental = point.coefficients.of(anchor)[1];
            let phase =
                if fundamental.norm() > 0.0 { PhaseAnchor::Phase(fundamental.arg()) } else { PhaseAnchor::None };
            let shape = NonlinearModeShape::new(modal, |_| amplitude * amplitude, phase).map_err(HbmError::from)?;
            let participation = Participation::new(&shape.harmonics, 1..=modal.n_harmonics());
            Ok(participation.with_energy_shares(modal, point.omega, point.kinetic_energy))
        };
        let both = self.branch.points.iter().zip(&self.unknowns).enumerate();
        both.map(|(number, (point, x))| {
            let modal = match onto.of_motion(&point.coefficients) {
                Some(modal) => modal,
                // The point holds some degrees of freedom only: the sum over all of them is done in the reduced
                // coordinates.
                None => self.problem(number)?.modal_coordinates(x, &onto)?,
            };
            of(point, &modal)
        })
        .collect()
    }
}
