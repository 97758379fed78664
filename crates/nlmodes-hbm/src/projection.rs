use nlmodes_linalg::{Mat, multiply_many};
use nlmodes_modal::HarmonicCoefficients;
use nlmodes_model::LinearModes;

use crate::{CondensedStructure, HbmError, MixedShooting};

/// Modal coordinates `Φᵀ M q_n` of linear modes, of motions of all degrees of freedom or of the reduced coordinates,
/// for which the sum over the degrees of freedom is done once.
#[derive(Debug, Clone)]
pub struct Projection {
    /// `M Φ`, degrees of freedom × modes.
    inertia: Mat<f64>,
    /// `Φᵀ M [φ … , Ψ, X]`, modes × (held modes + 2 n_N).
    reduced: Mat<f64>,
    /// `Φᵀ M` of what a steady force adds to the mean, modes; empty for none.
    sag: Vec<f64>,
}

impl Projection {
    /// Onto the modes `linear`, shapes over all degrees of freedom.
    ///
    /// # Panics
    /// If the shapes have another number of rows than the structure has degrees of freedom.
    pub fn new(structure: &CondensedStructure, linear: &LinearModes) -> Self {
        let model = structure.model();
        let (r, k, n) = (linear.omega.len(), structure.modes().len(), structure.n_contact_dofs());
        let inertia = multiply_many(model.mass(), &linear.shapes);
        // Contact nodes that are not among the linear degrees of freedom have no mass, and take no part in the sum.
        let linear_dofs = model.linear_dofs();
        let heavy = Mat::from_fn(r, linear_dofs.len(), |j, i| inertia[(linear_dofs[i], j)]);
        let (shapes, psi) = (&heavy * structure.shapes(), &heavy * &structure.psi);
        let residual = &heavy * &structure.held.residual.shapes;
        let reduced = Mat::from_fn(r, k + 2 * n, |i, j| match j {
            j if j < k => shapes[(i, structure.modes()[j].column)],
            j if j < k + n => psi[(i, j - k)],
            j => residual[(i, j - k - n)],
        });
        let of = |j: usize| structure.statics.sag.iter().enumerate().map(|(i, sag)| heavy[(j, i)] * sag).sum::<f64>();
        let sag = if structure.statics.sag.is_empty() { Vec::new() } else { (0..r).map(of).collect() };
        Self { inertia, reduced, sag }
    }

    /// Of a motion of all degrees of freedom, modes × (H + 1), m·√kg; `None` for a motion of some of them only.
    pub fn of_motion(&self, motion: &HarmonicCoefficients) -> Option<HarmonicCoefficients> {
        if motion.n_coordinates() != self.inertia.nrows() {
            return None;
        }
        let mut modal = HarmonicCoefficients::zeros(self.inertia.ncols(), motion.n_harmonics());
        for k in 0..self.inertia.ncols() {
            let modal = modal.of_mut(k);
            for (d, mass) in self.inertia.col(k).iter().enumerate().filter(|(_, mass)| **mass != 0.0) {
                modal.iter_mut().zip(motion.of(d)).for_each(|(eta, q)| *eta += q * *mass);
            }
        }
        Some(modal)
    }
}

impl MixedShooting<'_> {
    /// Modal coordinates of the motion with the unknowns `x`, modes × (H + 1), m·√kg.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_coordinates(&mut self, x: &[f64], onto: &Projection) -> Result<HarmonicCoefficients, HbmError> {
        if self.is_in_open_modes() {
            // Its modal points have all its coordinates.
            let motion = self.modal_point(x, 0.0)?.coefficients;
            return Ok(onto.of_motion(&motion).unwrap_or_else(|| HarmonicCoefficients::zeros(0, 0)));
        }
        self.solve(x)?;
        let omega = self.omega(x);
        let held = self.held_motion(omega);
        let mut modal = HarmonicCoefficients::zeros(onto.reduced.nrows(), self.series().n_harmonics);
        for part in &held.parts {
            let values = &onto.reduced * self.amplitudes(part, omega);
            for k in 0..values.nrows() {
                modal.of_mut(k).iter_mut().enumerate().for_each(|(n, eta)| *eta += part.unit * values[(k, n)]);
            }
        }
        onto.sag.iter().enumerate().for_each(|(k, sag)| modal.of_mut(k)[0] += sag);
        Ok(modal)
    }
}
