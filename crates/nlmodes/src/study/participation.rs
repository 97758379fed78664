use nlmodes_hbm::{HbmError, Projection};
use nlmodes_linalg::multiply;
use nlmodes_modal::{HarmonicCoefficients, ModalPoint, NonlinearModeShape, Participation, PhaseAnchor};
use nlmodes_model::linear_modes;
use num_complex::Complex64;

use super::{ComputedBranch, StudyError};

impl ComputedBranch {
    /// Participation of the lowest `modes` linear modes (contacts open, contact mass as in the computation) at each point, eq. (30), with
    /// all harmonics but the mean in the sum; the fundamental of the first contact coordinate is the phase anchor.
    /// NaN where a motion has no fundamental to be normalised by, as the pure second mode on the tip of a tongue.
    ///
    /// # Errors
    /// [`StudyError`] if the linear modes cannot be computed.
    pub fn participation(&self, modes: usize) -> Result<Vec<Participation>, StudyError> {
        let model = self.structure.model();
        let linear = linear_modes(model.mass(), model.stiffness(), modes).map_err(HbmError::from)?;
        // Rows of Φᵀ M: modal coordinates of displacements.
        let inertia: Vec<Vec<f64>> = (0..linear.omega.len())
            .map(|k| {
                let shape: Vec<f64> = linear.shapes.col(k).iter().copied().collect();
                let mut row = vec![0.0; shape.len()];
                multiply(model.mass(), &shape, &mut row);
                row
            })
            .collect();
        let anchor = self.branch.contact_coordinate.unwrap_or(0);
        let of = |point: &ModalPoint, modal: &HarmonicCoefficients| {
            let amplitude = point.modal_amplitude;
            if amplitude == 0.0 {
                let none = vec![f64::NAN; linear.omega.len()];
                return Ok(Participation {
                    factors: none.clone(),
                    quadrature: none,
                    harmonics: 1..=modal.n_harmonics(),
                });
            }
            // Where the anchor's fundamental vanishes, as on the tip of a tongue, there is no phase to take out.
            let fundamental = point.coefficients.of(anchor)[1];
            let phase =
                if fundamental.norm() > 0.0 { PhaseAnchor::Phase(fundamental.arg()) } else { PhaseAnchor::None };
            let shape = NonlinearModeShape::new(modal, |_| amplitude * amplitude, phase).map_err(HbmError::from)?;
            Ok(Participation::new(&shape.harmonics, 1..=modal.n_harmonics()))
        };
        if self.structure.recorded_dofs().len() == model.dofs().len() {
            let all = &self.branch.points;
            return all.iter().map(|point| of(point, &modal_coordinates(&inertia, &point.coefficients))).collect();
        }
        // The points hold some degrees of freedom only: the sum over all of them is done in the reduced coordinates.
        let (mut problem, onto) = (self.problem()?, Projection::new(&self.structure, &linear));
        let all = self.branch.points.iter().zip(&self.unknowns);
        all.map(|(point, x)| of(point, &problem.modal_coordinates(x, &onto)?)).collect()
    }
}

/// `Φᵀ M q_n`, modes × (H + 1).
fn modal_coordinates(inertia: &[Vec<f64>], motion: &HarmonicCoefficients) -> HarmonicCoefficients {
    let mut modal = HarmonicCoefficients::zeros(inertia.len(), motion.n_harmonics());
    for (k, row) in inertia.iter().enumerate() {
        for (n, eta) in modal.of_mut(k).iter_mut().enumerate() {
            *eta = row.iter().enumerate().map(|(d, m)| motion.of(d)[n] * *m).sum::<Complex64>();
        }
    }
    modal
}
