use nlmodes_linalg::{Mat, multiply};
use nlmodes_modal::HarmonicCoefficients;
use nlmodes_model::{ContactCoordinates, LinearModes};
use num_complex::Complex64;

use crate::held_motion::Part;
use crate::{CondensedStructure, HbmError, MixedShooting, Symmetry};

/// Modal coordinates `Φᵀ M q_n` of linear modes, from the reduced coordinates of a motion: the sum over the degrees of freedom is done once.
#[derive(Debug, Clone)]
pub struct Projection {
    /// `Φᵀ M [φ … , Ψ, X]`, modes × (held modes + 2 n_N).
    rows: Mat<f64>,
}

impl Projection {
    /// Onto the modes `linear`, shapes over all degrees of freedom, of the structure without the mass of its contacts.
    ///
    /// # Panics
    /// If the shapes have another number of rows than the structure has degrees of freedom.
    pub fn new(structure: &CondensedStructure, linear: &LinearModes) -> Self {
        let model = structure.model();
        let mass = model.mass();
        let (r, k, n) = (linear.omega.len(), structure.modes().len(), structure.n_contact_dofs());
        let mut inertia = Mat::zeros(model.linear_dofs().len(), r);
        let mut row = vec![0.0; mass.nrows()];
        for j in 0..r {
            let shape: Vec<f64> = linear.shapes.col(j).iter().copied().collect();
            multiply(mass, &shape, &mut row);
            let heavy = model.linear_dofs().iter().map(|&dof| row[dof]);
            inertia.col_mut(j).iter_mut().zip(heavy).for_each(|(to, from)| *to = from);
        }
        // The contact nodes have no mass, so that they take no part in the sum.
        debug_assert!(
            model.contact_coordinates() == ContactCoordinates::SpringTips
                || model.contact_dofs().iter().all(|&dof| row[dof] == 0.0)
        );
        let shapes = inertia.transpose() * structure.shapes();
        let (psi, residual) = (inertia.transpose() * &structure.psi, inertia.transpose() * &structure.residual.shapes);
        let rows = Mat::from_fn(r, k + 2 * n, |i, j| match j {
            j if j < k => shapes[(i, structure.modes()[j].column)],
            j if j < k + n => psi[(i, j - k)],
            j => residual[(i, j - k - n)],
        });
        Self { rows }
    }
}

impl MixedShooting<'_> {
    /// Modal coordinates of the motion with the unknowns `x`, modes × (H + 1), m·√kg.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_coordinates(&mut self, x: &[f64], onto: &Projection) -> Result<HarmonicCoefficients, HbmError> {
        self.solve_contact(x)?;
        let omega = self.omega(x);
        let held = self.held_motion(omega);
        let mut modal = HarmonicCoefficients::zeros(onto.rows.nrows(), self.series().n_harmonics);
        for (part, unit) in [(Part::Real, Complex64::ONE), (Part::Imaginary, Complex64::I)] {
            if part == Part::Imaginary && self.series().symmetry == Symmetry::Even {
                continue;
            }
            let values = &onto.rows * self.amplitudes(&held, omega, part);
            for k in 0..values.nrows() {
                modal.of_mut(k).iter_mut().enumerate().for_each(|(n, eta)| *eta += unit * values[(k, n)]);
            }
        }
        Ok(modal)
    }
}
