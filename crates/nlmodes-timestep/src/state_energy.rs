use std::fmt;

use nlmodes_contact::{LcpWorkspace, solver_by_name};
use nlmodes_linalg::{DenseLu, bilinear};
use nlmodes_modal::HarmonicCoefficients;
use nlmodes_model::MasslessContactModel;
use num_complex::Complex64;

use crate::TimestepError;
use crate::dynamics::contact_body;
use crate::error::agrees;

/// Energy of single states of a structure whose massless contact coordinates satisfy the contact law, for any number of
/// degrees of freedom.
///
/// ```text
/// E = ½ q̇_Lᵀ M_LL q̇_L + ½ qᵀ K q + ½ λᵀ C λ ,   q_N = b + K_NN⁻¹ W λ
/// 0 ≤ λ ⊥ A λ + Wᵀ b + g₀ ≥ 0 ,   b = −K_NN⁻¹ K_NL q_L
/// ```
///
/// and `−fᵀ q` of a steady force `f`. Energies in J, displacements in m, velocities in m/s. No mode is computed,
/// unlike in [`ContactDynamics`](crate::ContactDynamics).
pub struct StateEnergy<'m> {
    model: &'m MasslessContactModel,
    k_nn: DenseLu,
    workspace: Box<dyn LcpWorkspace>,
}

impl fmt::Debug for StateEnergy<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "StateEnergy({} degrees of freedom)", self.model.dofs().len())
    }
}

impl<'m> StateEnergy<'m> {
    /// For a structure.
    ///
    /// # Errors
    /// [`TimestepError::Contact`] or [`TimestepError::Linalg`] if the stiffness of its contact nodes is unsuitable.
    pub fn new(model: &'m MasslessContactModel) -> Result<Self, TimestepError> {
        let workspace = solver_by_name("active-set")?.workspace(contact_body(model)?.matrix())?;
        let k_nn =
            DenseLu::factor(model.k_nn()).map_err(TimestepError::during("stiffness K_NN of the contact nodes"))?;
        Ok(Self { model, k_nn, workspace })
    }

    /// Energy at the phase `tau = ωt` (rad) of a periodic motion given by its Fourier coefficients, eq. (7); those of
    /// massless degrees of freedom are ignored.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`] if its coordinates are not those of the structure; [`TimestepError::Contact`] if
    /// the contact problem has no solution there.
    pub fn of_harmonics(&mut self, motion: &HarmonicCoefficients, omega: f64, tau: f64) -> Result<f64, TimestepError> {
        agrees("displacements", self.model.dofs().len(), motion.n_coordinates())?;
        let turns: Vec<Complex64> = (0..=motion.n_harmonics()).map(|n| Complex64::cis(n as f64 * tau)).collect();
        let (mut q, mut v) = (Vec::new(), Vec::new());
        for &d in self.model.linear_dofs() {
            let terms = motion.of(d).iter().zip(&turns).map(|(q, turn)| q * turn);
            let at = terms.enumerate().fold([0.0; 2], |[x, dx], (n, z)| [x + z.re, dx - n as f64 * omega * z.im]);
            q.push(at[0]);
            v.push(at[1]);
        }
        self.of_state(&q, &v)
    }

    /// Energy of the displacements and velocities of the degrees of freedom with mass.
    fn of_state(&mut self, q: &[f64], v: &[f64]) -> Result<f64, TimestepError> {
        let (model, w) = (self.model, self.model.w());
        let coupled: Vec<f64> =
            model.k_ln().col_iter().map(|column| column.iter().zip(q).map(|(k, q)| k * q).sum()).collect();
        let mut b: Vec<f64> = coupled.iter().map(|f| -f).collect();
        self.k_nn.solve_in_place(&mut b);
        let free: Vec<f64> = model
            .contacts()
            .iter()
            .zip(w.col_iter())
            .map(|(contact, w)| contact.gap + w.iter().zip(&b).map(|(w, b)| w * b).sum::<f64>())
            .collect();
        let (mut closed, mut lambda) = (vec![false; free.len()], vec![0.0; free.len()]);
        self.workspace.solve(&free, &mut closed, &mut lambda)?;
        let force: Vec<f64> = w.row_iter().map(|w| w.iter().zip(&lambda).map(|(w, λ)| w * λ).sum()).collect();
        let mut q_n = force.clone();
        self.k_nn.solve_in_place(&mut q_n);
        q_n.iter_mut().zip(&b).for_each(|(q, b)| *q += b);
        // K_NN q_N = W λ − K_NL q_L.
        let of_contacts: f64 = q_n.iter().zip(force.iter().zip(&coupled)).map(|(q, (f, c))| q * (f + c)).sum();
        let of_stops: f64 = lambda.iter().zip(model.stop_compliance()).map(|(λ, c)| c * λ * λ).sum();
        let steady = model.steady_force().map_or(0.0, |steady| {
            model.linear_dofs().iter().zip(q).map(|(&dof, q)| steady.force[dof] * q).sum::<f64>()
        });
        Ok(0.5 * (bilinear(v, model.m_ll(), v) + bilinear(q, model.k_ll(), q) + of_contacts + of_stops) - steady)
    }
}
