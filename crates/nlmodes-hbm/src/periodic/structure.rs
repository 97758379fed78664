use nlmodes_contact::LcpMatrix;
use nlmodes_linalg::{Mat, max_norm, symmetric_eigen};
use num_complex::Complex64;

use super::damping::ModalDamping;
use super::law::PlacedLaw;
use crate::HbmError;
use crate::error::agrees;

/// A damped structure in open modes, with the static flexibility of what they leave over at the contacts.
///
/// ```text
/// η̈ + Ĉ η̇ + diag(ω_k²) η = Yᵀ λ + p(t) + p_s ,   y = g₀ + Y η + a(t) ,   0 ≤ λ ⊥ (A + C) λ + y ≥ 0
/// ```
///
/// [`DampedStop`](crate::DampedStop)s are coordinates without mass behind the modes: `d_i ṡ_i + k_i s_i = λ_i`, and
/// `s_i` opens gap i.
///
/// `p_s` is a [steady force](Self::with_steady_force) that no level multiplies.
///
/// `Y` (c × m, 1/√kg) are the modes as the gaps see them, `A` (c × c, m/N) the residual flexibility, `C` the compliance
/// of the stops. The contacts themselves have no mass. A structure whose contact nodes are massless is of this form
/// with all its modes, [`ModalStructure::of_massless`].
#[derive(Debug, Clone)]
pub struct ModalStructure {
    pub(super) omega_squared: Vec<f64>,
    /// Mass of each coordinate: one of a mode, none of a stop that dissipates.
    pub(super) inertia: Vec<f64>,
    /// The contact of each stop that dissipates.
    pub(super) damped: Vec<usize>,
    pub(super) rows: Mat<f64>,
    pub(super) compliance: LcpMatrix,
    pub(super) stop_compliance: Vec<f64>,
    pub(super) gaps: Vec<f64>,
    pub(super) damping: ModalDamping,
    pub(super) laws: Vec<PlacedLaw>,
    pub(super) law_samples: usize,
    /// Of each coordinate; empty for none.
    pub(super) steady_force: Vec<f64>,
}

/// A displacement as a row of open modes and contact forces, `q = φᵀ η + sᵀ λ + Σ_t a_t`, with what each term of the
/// load moves statically.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseRow {
    /// `φ`, m, 1/√kg.
    pub modes: Vec<f64>,
    /// `s`, m/N: residual flexibility between the contacts, and the places of laws behind them, and this place.
    pub contacts: Vec<f64>,
    /// Complex amplitude by a unit level of each term of the load, m; empty for none.
    pub loads: Vec<Complex64>,
}

impl ModalStructure {
    /// From squared open frequencies (m, rad²/s²), `Y` (c × m), `A` (c × c), gaps `g₀` (c, m), compliances of the stops
    /// (c, m/N, zero for rigid ones) and damping.
    ///
    /// # Errors
    /// [`HbmError::Size`], [`HbmError::NotFinite`], or [`HbmError::Compliance`] where a rigid stop meets a contact
    /// without flexibility.
    pub fn new(
        omega_squared: Vec<f64>,
        rows: Mat<f64>,
        flexibility: &Mat<f64>,
        gaps: Vec<f64>,
        stop_compliance: &[f64],
        damping: ModalDamping,
    ) -> Result<Self, HbmError> {
        let (m, c) = (omega_squared.len(), gaps.len());
        agrees("modes of the contact rows", m, rows.ncols())?;
        agrees("contacts of the contact rows", c, rows.nrows())?;
        agrees("rows of the residual flexibility", c, flexibility.nrows())?;
        agrees("columns of the residual flexibility", c, flexibility.ncols())?;
        agrees("compliances of the stops", c, stop_compliance.len())?;
        agrees("modes of the damping", m, damping.n_modes())?;
        let damped = (0..m).all(|i| (0..m).all(|j| damping.entry(i, j).is_finite()));
        let numbers = [
            ("squared frequencies", omega_squared.iter().all(|v| v.is_finite())),
            ("contact rows", rows.is_all_finite()),
            ("gaps", gaps.iter().all(|v| v.is_finite())),
            ("damping", damped),
        ];
        if let Some((what, _)) = numbers.iter().find(|(_, fine)| !fine) {
            return Err(HbmError::NotFinite { what });
        }
        let own = |i: usize, j: usize| if i == j { stop_compliance[i] } else { 0.0 };
        let compliance = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| flexibility[(i, j)] + own(i, j)));
        let mut structure = Self {
            inertia: vec![1.0; m],
            damped: Vec::new(),
            omega_squared,
            rows,
            compliance: compliance.map_err(HbmError::Compliance)?,
            stop_compliance: stop_compliance.to_vec(),
            gaps,
            damping,
            laws: Vec::new(),
            law_samples: 0,
            steady_force: Vec::new(),
        };
        structure.silence_modes_at_rest();
        Ok(structure)
    }

    /// The same undamped structure whose flexibility beyond the modes answers in harmonics, as its modes do, not at
    /// each instant: with `A = Σ_r v_r v_rᵀ`, coordinates `s_r = v_rᵀ λ` without mass follow the modes, and open the
    /// gaps by `v_r`. A displacement that goes with `A` is in harmonics either way.
    ///
    /// # Errors
    /// [`HbmError::Linalg`], or [`HbmError::Compliance`] where a stop has no compliance of its own.
    pub(crate) fn with_flexibility_in_harmonics(mut self) -> Result<Self, HbmError> {
        let (c, m, a) = (self.n_contacts(), self.n_modes(), self.compliance.a());
        let beyond = Mat::from_fn(c, c, |i, j| a[(i, j)] - if i == j { self.stop_compliance[i] } else { 0.0 });
        let failed = |source| HbmError::Linalg { what: "flexibility beyond the modes", source };
        let (values, vectors) = symmetric_eigen(&beyond).map_err(failed)?;
        let largest = max_norm(values.iter().copied());
        let kept: Vec<usize> = (0..c).filter(|&r| values[r] > f64::EPSILON * largest).collect();
        self.rows = Mat::from_fn(c, m + kept.len(), |i, k| match k.checked_sub(m) {
            None => self.rows[(i, k)],
            Some(r) => vectors[(i, kept[r])] * values[kept[r]].sqrt(),
        });
        self.omega_squared.resize(m + kept.len(), 1.0);
        self.inertia.resize(m + kept.len(), 0.0);
        self.damping = ModalDamping::none(m + kept.len());
        if !self.steady_force.is_empty() {
            self.steady_force.resize(m + kept.len(), 0.0);
        }
        let own = &self.stop_compliance;
        let compliance = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| if i == j { own[i] } else { 0.0 }));
        self.compliance = compliance.map_err(HbmError::Compliance)?;
        Ok(self)
    }

    /// The same structure of whose compliance `A + C` at the contacts this much is that of the stops, c, m/N.
    pub(crate) fn with_stop_compliance(self, stop_compliance: Vec<f64>) -> Self {
        Self { stop_compliance, ..self }
    }

    /// The same structure with other gaps, m, c.
    ///
    /// # Errors
    /// [`HbmError::Size`] or [`HbmError::NotFinite`].
    pub fn with_gaps(&self, gaps: Vec<f64>) -> Result<Self, HbmError> {
        agrees("gaps", self.n_contacts(), gaps.len())?;
        if !gaps.iter().all(|gap| gap.is_finite()) {
            return Err(HbmError::NotFinite { what: "gaps" });
        }
        Ok(Self { gaps, ..self.clone() })
    }

    /// The same structure under a constant force, `p = Φᵀ f` (m, N/√kg), that no level multiplies: what acts on the
    /// rigid-body motions of a structure that floats, `ω_k = 0`, and is balanced by its contacts alone. Empty for none.
    ///
    /// # Errors
    /// [`HbmError::Size`] or [`HbmError::NotFinite`].
    pub fn with_steady_force(&self, mut force: Vec<f64>) -> Result<Self, HbmError> {
        if !force.iter().all(|p| p.is_finite()) {
            return Err(HbmError::NotFinite { what: "steady force" });
        }
        if !force.is_empty() {
            agrees("modes of the steady force", self.n_moving(), force.len())?;
            force.resize(self.n_modes(), 0.0);
        }
        Ok(Self { steady_force: force, ..self.clone() })
    }

    /// The constant force on each coordinate, N/√kg; empty for none.
    pub fn steady_force(&self) -> &[f64] {
        &self.steady_force
    }

    /// Whether something presses it onto its stops where no load acts: a steady force, or a gap below zero.
    pub fn is_pressed(&self) -> bool {
        self.gaps.iter().any(|gap| *gap < 0.0) || self.steady_force.iter().any(|p| *p != 0.0)
    }

    /// The same structure with other damping.
    ///
    /// # Errors
    /// [`HbmError::Size`] or [`HbmError::NotFinite`].
    pub fn with_damping(&self, damping: ModalDamping) -> Result<Self, HbmError> {
        agrees("modes of the damping", self.n_modes(), damping.n_modes())?;
        let m = self.n_modes();
        if !(0..m).all(|i| (0..m).all(|j| damping.entry(i, j).is_finite())) {
            return Err(HbmError::NotFinite { what: "damping" });
        }
        Ok(Self { damping, ..self.clone() })
    }

    /// Rounding in the rows of modes that leave the contacts at rest would be a pole of its own: it becomes zero.
    fn silence_modes_at_rest(&mut self) {
        let strength = |k: usize| self.coupling(k);
        let strongest = max_norm((0..self.n_modes()).map(strength));
        let at_rest: Vec<usize> = (0..self.n_modes()).filter(|&k| strength(k) <= 1e-20 * strongest).collect();
        at_rest.iter().for_each(|&k| self.rows.col_mut(k).fill(0.0));
    }

    /// Number of modes m, with the coordinates of stops that dissipate behind them.
    pub fn n_modes(&self) -> usize {
        self.omega_squared.len()
    }

    /// Number of modes that have mass, which come first.
    pub fn n_moving(&self) -> usize {
        self.inertia.iter().filter(|mass| **mass > 0.0).count()
    }

    /// Mass of each coordinate, m: one of a mode, none of a stop that dissipates.
    pub(crate) fn inertia(&self) -> &[f64] {
        &self.inertia
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.gaps.len()
    }

    /// Squared open frequencies, rad²/s², m; of stops that dissipate their stiffness, N/m.
    pub fn omega_squared(&self) -> &[f64] {
        &self.omega_squared
    }

    /// The modes as the gaps see them, `Y`, c × m, 1/√kg.
    pub fn rows(&self) -> &Mat<f64> {
        &self.rows
    }

    /// `A + C`, c × c, m/N.
    pub fn compliance(&self) -> &LcpMatrix {
        &self.compliance
    }

    /// Compliances of the stops alone, m/N, c.
    pub fn stop_compliance(&self) -> &[f64] {
        &self.stop_compliance
    }

    /// Gaps `g₀`, m, c.
    pub fn gaps(&self) -> &[f64] {
        &self.gaps
    }

    /// Damping with open contacts.
    pub fn damping(&self) -> &ModalDamping {
        &self.damping
    }

    /// How strongly a mode takes part in the motion of the contacts and laws, rad²/s²: `s_k = max_i y_ik²/A_ii` of
    /// contacts, and of laws the same with the whole flexibility at their place.
    pub(crate) fn coupling(&self, k: usize) -> f64 {
        let a = self.compliance.a();
        let contacts = (0..self.n_contacts()).map(|i| self.rows[(i, k)].powi(2) / a[(i, i)]);
        let laws = self.laws.iter().enumerate().map(|(l, law)| {
            let elastic = (0..self.n_modes()).filter(|&j| self.omega_squared[j] > 0.0);
            let modal: f64 = elastic.map(|j| law.modes[j].powi(2) / self.omega_squared[j]).sum();
            let whole = law.laws[l] + modal;
            if whole > 0.0 { law.modes[k].powi(2) / whole } else { 0.0 }
        });
        max_norm(contacts.chain(laws))
    }

    /// Whether mode k moves a contact or the place of a law.
    pub(crate) fn moves_a_contact(&self, k: usize) -> bool {
        self.rows.col(k).iter().chain(self.laws.iter().map(|law| &law.modes[k])).any(|y| *y != 0.0)
    }
}
