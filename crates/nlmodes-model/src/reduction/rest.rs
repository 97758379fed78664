use nlmodes_contact::{LcpError, LcpMatrix, LcpSolver, balance};
use nlmodes_linalg::{DenseLu, Mat, SparseMatrix, max_norm, multiply_transposed, symmetric_eigen};

use crate::reduction::{ModalLoad, OpenModes, ReductionError};

/// Modes that move the closed contacts by less than this share of the others leave them at rest.
const PRESSES: f64 = 1e-6;

/// Scalar product of two unit vectors above which there is no other of an orthonormal set that is more alike.
const ALIKE: f64 = 0.8;

/// Eigenvalues up to this share of the first elastic one are those of rigid-body motions.
const RIGID: f64 = 1e-6;

/// A motion that moves the contacts by less than this, squared and beside the strongest one, does not move them: modes
/// have eight digits at least.
const UNFELT: f64 = 1e-12;

/// Motion of the contacts over the largest one up to which a mode is not felt: its effect on them is the square of
/// that.
const AT_REST: f64 = 1e-6;

/// `Wᵀ Φ`, zero for modes that no contact feels: in symmetric structures rounding couples these, and a branch would
/// follow an internal resonance with a motion that contacts cannot excite.
pub(super) fn felt_rows(directions: &SparseMatrix, shapes: &Mat<f64>) -> Mat<f64> {
    let mut rows = multiply_transposed(directions, shapes);
    let largest: Vec<f64> = (0..rows.ncols()).map(|r| max_norm(rows.col(r).iter().copied())).collect();
    let most = max_norm(largest.iter().copied());
    (0..rows.ncols()).filter(|r| largest[*r] <= AT_REST * most).for_each(|r| rows.col_mut(r).fill(0.0));
    rows
}

/// A structure at rest against its stops, pressed by interference or by static loads.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct RestState {
    /// Modal coordinates, m.
    pub eta: Vec<f64>,
    /// Contact forces `λ ≥ 0`, c, N.
    pub forces: Vec<f64>,
    /// Gaps `g + C λ ≥ 0`, c, m: zero where a contact is closed.
    pub gaps: Vec<f64>,
    /// The closed contacts; of redundant ones those that carry the force.
    pub closed: Vec<bool>,
}

impl RestState {
    /// Of a structure with so many modes and these gaps that nothing moves.
    pub fn still(modes: usize, gaps: &[f64]) -> Self {
        let c = gaps.len();
        Self { eta: vec![0.0; modes], forces: vec![0.0; c], gaps: gaps.to_vec(), closed: vec![false; c] }
    }
}

/// Linear modes of the structure with some of its contacts closed, in the coordinates of the open modes.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ClosedModes {
    /// Squared angular frequencies, ascending, rad²/s².
    pub omega_squared: Vec<f64>,
    /// Orthonormal columns `η`, m × m.
    pub eta: Mat<f64>,
}

impl ClosedModes {
    /// The mode of these, in fewer of the same coordinates, that is mode `mode` of `other`; none where it is made of
    /// several.
    fn most_alike(&self, other: &Self, mode: usize) -> Option<usize> {
        let overlap =
            |r: usize| (0..self.eta.nrows()).map(|s| self.eta[(s, r)] * other.eta[(s, mode)]).sum::<f64>().abs();
        let overlaps = (0..self.omega_squared.len()).map(|r| (r, overlap(r)));
        overlaps.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, overlap)| *overlap > ALIKE).map(|(r, _)| r)
    }
}

impl OpenModes {
    /// Whether the structure floats: rigid-body motions are among its modes.
    pub fn floats(&self) -> bool {
        self.residual.shift() > 0.0
    }

    /// Number of rigid-body motions, which come first among the modes.
    pub fn n_rigid(&self) -> usize {
        let elastic = RIGID * self.residual.shift();
        let rigid = self.omega_squared.iter().take_while(|square| self.floats() && **square <= elastic).count();
        rigid.max(self.openness.strainless.min(self.n_modes()))
    }

    /// The rigid-body motions that no contact feels; among those that are felt, none is a combination of them.
    pub fn unfelt_motions(&self) -> Vec<usize> {
        (0..self.n_rigid()).filter(|&r| self.contact_rows.col(r).iter().all(|y| *y == 0.0)).collect()
    }

    /// Rigid-body motions among the modes, and how many of them holding all contacts leaves: motions that no contact
    /// feels, `Yᵀ Y` of those modes having no rank for them.
    ///
    /// # Errors
    /// [`ReductionError::Linalg`] if the eigenvalues of that matrix are not found.
    pub fn rigid_motions(&self) -> Result<(usize, usize), ReductionError> {
        let rigid = self.n_rigid();
        if rigid == 0 {
            return Ok((0, 0));
        }
        let rows = self.contact_rows.subcols(0, rigid);
        let felt = rows.transpose() * rows;
        let symmetric = Mat::from_fn(rigid, rigid, |i, j| 0.5 * (felt[(i, j)] + felt[(j, i)]));
        let (strengths, _) = symmetric_eigen(&symmetric).map_err(ReductionError::during("rigid-body motions"))?;
        // Beside all modes: where no contact feels any of these motions, rounding is what is left of the strongest.
        let of = |r: usize| (0..self.n_contacts()).map(|i| self.contact_rows[(i, r)].powi(2)).sum::<f64>();
        let largest = (0..self.n_modes()).map(of).fold(0.0, f64::max);
        Ok((rigid, strengths.iter().filter(|strength| **strength <= UNFELT * largest).count()))
    }

    /// Where the structure rests under the static loads `preload`: one contact problem with the whole flexibility,
    ///
    /// ```text
    /// F = A + Y Ω⁻² Yᵀ ,   0 ≤ λ ⊥ (F + C) λ + g₀ + Σ (a + Y Ω⁻² p) ≥ 0
    /// ```
    ///
    /// A structure that floats rests where it is, if no contact interferes and nothing loads it; otherwise where its
    /// contacts balance what acts on its rigid-body motions `r`, `Y_rᵀ λ + p_r = 0`.
    ///
    /// # Errors
    /// [`ReductionError::FloatingRest`] for one that floats and that closed contacts do not hold,
    /// [`ReductionError::FallsAway`] where no contact forces balance its load; [`ReductionError::Rest`] if the contact
    /// problem cannot be solved.
    pub fn rest(&self, preload: &[&ModalLoad], solver: &dyn LcpSolver) -> Result<RestState, ReductionError> {
        let (c, m) = (self.n_contacts(), self.n_modes());
        let is_loaded = preload.iter().any(|load| load.modal.iter().chain(&load.gaps).any(|v| *v != 0.0))
            || self.steady_force.iter().any(|p| *p != 0.0);
        if !is_loaded && self.gaps().iter().all(|g| *g > 0.0) {
            return Ok(RestState::still(m, self.gaps()));
        }
        let y = self.contact_rows();
        let mut eta: Vec<f64> = (0..m).map(|r| preload.iter().map(|l| l.modal[r]).sum::<f64>()).collect();
        let unfelt = self.unfelt_motions();
        let free: Vec<usize> = (0..self.n_rigid()).filter(|r| !unfelt.contains(r)).collect();
        let pull = |r: &usize| eta[*r] + self.steady_force.get(*r).copied().unwrap_or(0.0);
        let pull: Vec<f64> = free.iter().map(pull).collect();
        eta[..self.n_rigid()].fill(0.0);
        eta.iter_mut().zip(self.omega_squared()).skip(self.n_rigid()).for_each(|(eta, w)| *eta /= w);
        let modal = |i: usize, eta: &[f64]| eta.iter().enumerate().map(|(r, e)| y[(i, r)] * e).sum::<f64>();
        let opened: Vec<f64> =
            (0..c).map(|i| self.gaps()[i] + preload.iter().map(|l| l.gaps[i]).sum::<f64>() + modal(i, &eta)).collect();
        let (mut closed, mut forces, mut gaps) = (vec![false; c], vec![0.0; c], vec![0.0; c]);
        if free.is_empty() {
            let matrix = LcpMatrix::new(&self.static_flexibility()).map_err(ReductionError::Rest)?;
            let mut workspace = solver.workspace(&matrix).map_err(ReductionError::Rest)?;
            workspace.solve(&opened, &mut closed, &mut forces).map_err(ReductionError::Rest)?;
            workspace.gaps(&mut gaps).map_err(ReductionError::Rest)?;
        } else {
            let rows = Mat::from_fn(c, free.len(), |i, r| y[(i, free[r])]);
            let found = balance(&self.static_flexibility(), &rows, &opened, &pull, solver);
            let found = found.map_err(|error| self.of_balance(error, &free))?;
            (closed, forces, gaps) = (found.closed, found.forces, found.gaps);
            free.iter().zip(found.motion).for_each(|(&r, motion)| eta[r] = motion);
        }
        for (r, eta) in eta.iter_mut().enumerate().skip(self.n_rigid()) {
            let pressed: f64 = forces.iter().enumerate().map(|(i, l)| y[(i, r)] * l).sum();
            *eta += pressed / self.omega_squared()[r];
        }
        Ok(RestState { eta, forces, gaps, closed })
    }

    /// Linear modes with the contacts of `closed` (c) kept closed, on their springs where the stops have some:
    ///
    /// ```text
    /// [Ω² + Y_Sᵀ (A + C)_SS⁻¹ Y_S] η = ω² η
    /// ```
    ///
    /// The structure with its open modes truncated answers stiffly beyond them: the frequencies are too high, and fall
    /// with m.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`]; [`ReductionError::Linalg`] if the flexibility of the closed contacts is singular:
    /// they share a direction, or nothing without mass is left that could be pressed.
    pub fn closed_modes(&self, closed: &[bool]) -> Result<ClosedModes, ReductionError> {
        let (expected, found) = (self.n_contacts(), closed.len());
        if expected != found {
            return Err(ReductionError::Dimension { what: "list of closed contacts", expected, found });
        }
        let set: Vec<usize> = (0..expected).filter(|&i| closed[i]).collect();
        let (y, m) = (self.contact_rows(), self.n_modes());
        let compliance = |i: usize| self.flexibility()[(i, i)] + self.stop_compliance()[i];
        let block = Mat::from_fn(set.len(), set.len(), |a, b| {
            let (i, j) = (set[a], set[b]);
            if i == j { compliance(i) } else { self.flexibility()[(i, j)] }
        });
        let failed = ReductionError::during("flexibility of the closed contacts");
        let lu = DenseLu::factor(&block).map_err(failed)?;
        let mut stiffness = Mat::from_fn(m, m, |r, s| if r == s { self.omega_squared()[r] } else { 0.0 });
        let mut force = vec![0.0; set.len()];
        for s in 0..m {
            (0..set.len()).for_each(|a| force[a] = y[(set[a], s)]);
            lu.solve_in_place(&mut force);
            for r in 0..m {
                stiffness[(r, s)] += set.iter().zip(&force).map(|(&i, f)| y[(i, r)] * f).sum::<f64>();
            }
        }
        let symmetric = Mat::from_fn(m, m, |r, s| 0.5 * (stiffness[(r, s)] + stiffness[(s, r)]));
        let (values, eta) =
            symmetric_eigen(&symmetric).map_err(ReductionError::during("modes with closed contacts"))?;
        Ok(ClosedModes { omega_squared: values.iter().map(|v| v.max(0.0)).collect(), eta })
    }

    /// Estimate of what the truncation does to the frequency of mode `mode` (from 0) with the contacts of `closed`
    /// closed, or of the next one that presses these: the relative change from m/2 to m modes; zero where there are no
    /// other modes. The error of a truncation falls with the first to third power of m, so that what is left is at most
    /// about as large as this.
    ///
    /// # Errors
    /// As [`OpenModes::closed_modes`] and [`OpenModes::truncated`]; [`ReductionError::NoMode`] if half of the modes do
    /// not reach `mode`.
    pub fn truncation_error(&self, closed: &[bool], mode: usize) -> Result<f64, ReductionError> {
        if self.has_all_modes() {
            return Ok(0.0);
        }
        let modes = self.closed_modes(closed)?;
        let pressing = self.pressing(&modes, closed);
        // Modes that leave the contacts at rest, as two equal bodies have, know nothing of what is left out.
        let largest = pressing.iter().copied().fold(0.0, f64::max);
        let missing = ReductionError::NoMode { wanted: mode + 1 };
        let found = (mode..pressing.len()).find(|r| pressing[*r] > PRESSES * largest).ok_or(missing.clone())?;
        let half = self.truncated(self.n_modes() / 2)?.closed_modes(closed)?;
        let alike = half.most_alike(&modes, found).ok_or(missing)?;
        Ok((half.omega_squared[alike].sqrt() / modes.omega_squared[found].sqrt() - 1.0).abs())
    }

    /// How far each of the modes with closed contacts would move these if they were open, `|Y_S η_r|`.
    fn pressing(&self, modes: &ClosedModes, closed: &[bool]) -> Vec<f64> {
        let moved = |i: usize, r: usize| -> f64 {
            (0..self.n_modes()).map(|s| self.contact_rows()[(i, s)] * modes.eta[(s, r)]).sum()
        };
        let of = |r: usize| (0..closed.len()).filter(|i| closed[*i]).map(|i| moved(i, r).abs()).fold(0.0, f64::max);
        (0..modes.omega_squared.len()).map(of).collect()
    }

    /// Why a structure that floats does not rest.
    fn of_balance(&self, error: LcpError, free: &[usize]) -> ReductionError {
        match error {
            LcpError::Loose => ReductionError::FloatingRest,
            LcpError::Unbalanced { motion } => {
                let mut driven = vec![0.0; self.n_modes()];
                free.iter().zip(motion).for_each(|(&r, motion)| driven[r] = motion);
                ReductionError::FallsAway { motion: self.combined(free, &driven) }
            }
            error => ReductionError::Rest(error),
        }
    }

    /// `F + C = A + Y Ω⁻² Yᵀ + C` with the elastic modes.
    fn static_flexibility(&self) -> Mat<f64> {
        let (c, y) = (self.n_contacts(), self.contact_rows());
        Mat::from_fn(c, c, |i, j| {
            let modes = self.omega_squared().iter().enumerate().skip(self.n_rigid());
            let modal: f64 = modes.map(|(r, w)| y[(i, r)] * y[(j, r)] / w).sum();
            self.flexibility()[(i, j)] + modal + if i == j { self.stop_compliance()[i] } else { 0.0 }
        })
    }
}
