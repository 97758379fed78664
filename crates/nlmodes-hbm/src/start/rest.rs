//! Where a structure rests against stops that press.

use nlmodes_contact::{LcpMatrix, balance, solver_by_name};
use nlmodes_linalg::{DenseLu, Mat, max_norm};
use nlmodes_model::SteadyForce;

use crate::{CondensedStructure, HbmError};

/// Guard at rest, over the largest gap, below which a contact touches without force.
const ROUNDING: f64 = 1e-12;

/// The structure at rest, pressed against the stops whose gaps are negative, or by a steady force.
pub(super) struct Rest {
    pub closed: Vec<bool>,
    pub b: Vec<f64>,
    /// Largest static compliance of the structure at a pressed contact, m/N; zero where none is pressed.
    pub compliance: f64,
    /// Guards up to this, m, are zero.
    pub noise: f64,
    /// Energy of a structure under a steady force, J; zero of others.
    pub energy: f64,
}

impl Rest {
    pub fn of(structure: &CondensedStructure) -> Result<Self, HbmError> {
        let (c, n) = (structure.n_contacts(), structure.n_contact_dofs());
        if let Some(steady) = structure.model.steady_force() {
            return Self::under(structure, steady);
        }
        if structure.body.gaps().iter().all(|g| *g >= 0.0) {
            return Ok(Self { closed: vec![false; c], b: vec![0.0; n], compliance: 0.0, noise: 0.0, energy: 0.0 });
        }
        // q_0 = (K_NN (I − T_0))⁻¹ W λ: the whole structure yields, not only the contact node.
        let system = Mat::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 } - structure.t0[(i, j)]);
        let lu = DenseLu::factor(&system).map_err(|source| HbmError::Linalg {
            what: "a structure that is pressed at rest but not supported",
            source,
        })?;
        let mut q = structure.body.compliance_w().clone();
        for i in 0..c {
            let mut column: Vec<f64> = q.col(i).iter().copied().collect();
            lu.solve_in_place(&mut column);
            q.col_mut(i).iter_mut().zip(&column).for_each(|(q, v)| *q = *v);
        }
        let compliance = LcpMatrix::new(&with_stops(structure, &q)).map_err(HbmError::Compliance)?;
        let (mut closed, mut lambda) = (vec![false; c], vec![0.0; c]);
        solver_by_name("active-set")
            .and_then(|solver| solver.workspace(&compliance))
            .and_then(|mut workspace| workspace.solve(structure.body.gaps(), &mut closed, &mut lambda))
            .map_err(HbmError::Compliance)?;
        let noise = ROUNDING * max_norm(structure.body.gaps().iter().copied());
        let q: Vec<f64> = (0..n).map(|d| (0..c).map(|i| q[(d, i)] * lambda[i]).sum()).collect();
        let b = free_places(structure, &q);
        Ok(Self { closed, b, compliance: 0.0, noise, energy: 0.0 }.held_by(compliance.a(), &lambda))
    }

    /// A force that is nothing but rounding does not hold a contact.
    fn held_by(mut self, a: &Mat<f64>, lambda: &[f64]) -> Self {
        (0..lambda.len()).for_each(|i| self.closed[i] &= a[(i, i)] * lambda[i] > self.noise);
        self.compliance = max_norm((0..lambda.len()).filter(|i| self.closed[*i]).map(|i| a[(i, i)]));
        self
    }

    /// A structure that floats, pressed by a force `f` on its motions without strain `R`: with `S = K_NN (I − T_0)`,
    /// which is singular along these, and any springs `U` that hold them, loads in balance move the contact nodes by
    ///
    /// ```text
    /// q_N = (S + U)⁻¹ (W λ + Ψᵀ f_L) + R_N η ,   Rᵀ (W λ + f) = 0
    /// ```
    fn under(structure: &CondensedStructure, steady: &SteadyForce) -> Result<Self, HbmError> {
        let (c, n, model) = (structure.n_contacts(), structure.n_contact_dofs(), &structure.model);
        let (motions, k_nn) = (steady.at(model.contact_dofs()).motions, model.k_nn());
        let stretched = k_nn * &motions;
        let own = |r: usize| (0..n).map(|d| motions[(d, r)] * stretched[(d, r)]).sum::<f64>();
        let own: Vec<f64> = (0..motions.ncols()).map(own).collect();
        let carried = k_nn * &structure.t0;
        let held = Mat::from_fn(n, n, |i, j| {
            let springs = (0..own.len()).map(|r| stretched[(i, r)] * stretched[(j, r)] / own[r]).sum::<f64>();
            k_nn[(i, j)] - 0.5 * (carried[(i, j)] + carried[(j, i)]) + springs
        });
        let lu = DenseLu::factor(&held).map_err(|source| HbmError::Linalg {
            what: "a structure that floats and is pressed onto its contacts",
            source,
        })?;
        let pressed = lu.solve_columns(model.w());
        let mut pulled = structure.statics.pull.clone();
        lu.solve_in_place(&mut pulled);
        let w = model.w();
        let toward = |q: &[f64], i: usize| (0..n).map(|d| w[(d, i)] * q[d]).sum::<f64>();
        let gaps: Vec<f64> = (0..c).map(|i| structure.body.gaps()[i] + toward(&pulled, i)).collect();
        let (a, rows) = (with_stops(structure, &pressed), w.transpose() * &motions);
        let solver = solver_by_name("active-set").map_err(HbmError::Compliance)?;
        let found = balance(&a, &rows, &gaps, &steady.on_motions(), solver.as_ref()).map_err(HbmError::Compliance)?;
        let of = |d: usize, by: &Mat<f64>, amounts: &[f64]| {
            amounts.iter().enumerate().map(|(j, amount)| by[(d, j)] * amount).sum::<f64>()
        };
        let place = |d: usize| pulled[d] + of(d, &pressed, &found.forces) + of(d, &motions, &found.motion);
        let q: Vec<f64> = (0..n).map(place).collect();
        let b: Vec<f64> = free_places(structure, &q).iter().zip(&structure.held.lift).map(|(b, l)| b + l).collect();
        let noise = ROUNDING * max_norm(b.iter().chain(&gaps).copied());
        // ½ qᵀ S q − fᵀ u + ½ λᵀ C λ, where S q = W λ + Ψᵀ f_L and gaps of closed contacts vanish.
        let work = |forces: &[f64], along: &[f64]| forces.iter().zip(along).map(|(f, q)| f * q).sum::<f64>();
        let energy = -0.5 * (work(&found.forces, structure.body.gaps()) + work(&structure.statics.pull, &q))
            + structure.statics.energy;
        Ok(Self { closed: found.closed, b, compliance: 0.0, noise, energy }.held_by(&a, &found.forces))
    }
}

/// `T_0 q_N`: where the contact nodes would be without their stops.
fn free_places(structure: &CondensedStructure, q: &[f64]) -> Vec<f64> {
    (0..q.len()).map(|d| (0..q.len()).map(|e| structure.t0[(d, e)] * q[e]).sum()).collect()
}

/// `Wᵀ Q + C` of the displacements `Q` (n_N × c) under unit contact forces, symmetric.
fn with_stops(structure: &CondensedStructure, q: &Mat<f64>) -> Mat<f64> {
    let (c, compliance) = (q.ncols(), structure.model.w().transpose() * q);
    let mut compliance = Mat::from_fn(c, c, |i, j| 0.5 * (compliance[(i, j)] + compliance[(j, i)]));
    structure.model.stop_compliance().iter().enumerate().for_each(|(i, own)| compliance[(i, i)] += own);
    compliance
}
