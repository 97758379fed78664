//! Damped structures under periodic loads in the time domain: exact between contact instants, with periodic motions by
//! shooting over the whole period.

mod flow;
mod input;
mod laws;
mod linear;
mod motion;
mod series;
mod shooting;
mod stroboscope;
mod trajectory;
mod transient;

pub use input::{DEGREE, Signal, SignalPiece};
pub use laws::{LawSettings, TimeLaw};
pub use linear::{LinearFlow, TURN};
pub use motion::ForcedMotion;
pub use series::FlowSeries;
pub use stroboscope::Flash;
pub use transient::{Along, Blow, Stretch, Touch, TransientSettings};

use input::{Input, Observed};
use laws::LawAt;

use nlmodes_contact::LcpMatrix;
use nlmodes_linalg::Mat;
use num_complex::Complex64;

use crate::TimestepError;
use crate::error::{agrees, positive};

/// A damped structure with stops under a periodic load, as a linear complementarity system in time.
///
/// ```text
/// z̈ + Ĉ ż + diag(ω_k²) z = Yᵀ λ + F Σ Re(p_n e^{inΩt})
/// 0 ≤ λ ⊥ A λ + y ≥ 0 ,   y = g₀ + Y z + s + F Σ Re(a_n e^{inΩt})
/// d_i ṡ_i + k_i s_i = λ_i                the stops that dissipate, without mass; s_i = 0 for the others
/// ```
///
/// `Y` (c × m, 1/√kg) are the modes at the gaps, `A` (c × c, m/N) the flexibility at the contacts including that of
/// elastic stops, `F` the level. No harmonics are used: these motions are the reference for harmonic balance.
#[derive(Debug, Clone)]
pub struct ForcedStructure {
    omega_squared: Vec<f64>,
    damping: Mat<f64>,
    rows: Mat<f64>,
    compliance: LcpMatrix,
    gaps: Vec<f64>,
    /// Contact, stiffness and damper of each dissipative stop.
    dampers: Vec<(usize, f64, f64)>,
    loads: Vec<ForcedLoad>,
    /// Modal forces that do not change in time, m, √kg m/s²; empty for none.
    steady: Vec<f64>,
    inputs: Vec<Input>,
    observed: Vec<Observed>,
    laws: Vec<LawAt>,
    law_settings: LawSettings,
}

/// One harmonic of the load.
#[derive(Debug, Clone)]
struct ForcedLoad {
    harmonic: usize,
    modal: Vec<Complex64>,
    gaps: Vec<Complex64>,
}

impl ForcedStructure {
    /// From squared open frequencies (m, rad²/s²), `Ĉ` (m × m, 1/s), `Y` (c × m), `A` with the compliance of elastic
    /// stops (c × c) and gaps (c, m).
    ///
    /// # Errors
    /// [`TimestepError::Dimension`], [`TimestepError::NotFinite`], or [`TimestepError::Contact`] if there is no
    /// flexibility at a stop.
    pub fn new(
        omega_squared: &[f64],
        damping: &Mat<f64>,
        rows: &Mat<f64>,
        compliance: &Mat<f64>,
        gaps: &[f64],
    ) -> Result<Self, TimestepError> {
        let (m, c) = (omega_squared.len(), gaps.len());
        agrees("rows of the modal damping", m, damping.nrows())?;
        agrees("columns of the modal damping", m, damping.ncols())?;
        agrees("rows of the contact rows", c, rows.nrows())?;
        agrees("columns of the contact rows", m, rows.ncols())?;
        agrees("rows of the compliance", c, compliance.nrows())?;
        let numbers = [
            ("squared frequencies", omega_squared.iter().all(|v| v.is_finite())),
            ("modal damping", damping.is_all_finite()),
            ("contact rows", rows.is_all_finite()),
            ("gaps", gaps.iter().all(|v| v.is_finite())),
        ];
        if let Some((what, _)) = numbers.iter().find(|(_, fine)| !fine) {
            return Err(TimestepError::NotFinite { what });
        }
        Ok(Self {
            omega_squared: omega_squared.to_vec(),
            damping: damping.clone(),
            rows: rows.clone(),
            compliance: LcpMatrix::new(compliance)?,
            gaps: gaps.to_vec(),
            dampers: Vec::new(),
            loads: Vec::new(),
            steady: Vec::new(),
            inputs: Vec::new(),
            observed: Vec::new(),
            laws: Vec::new(),
            law_settings: LawSettings::default(),
        })
    }

    /// Adds a harmonic of the load: modal forces `p` (m, √kg m/s² per unit of level) and its contribution to the gaps,
    /// `a` (c, m per unit of level).
    ///
    /// # Errors
    /// [`TimestepError::Dimension`].
    pub fn push_load(&mut self, harmonic: usize, modal: &[Complex64], gaps: &[Complex64]) -> Result<(), TimestepError> {
        agrees("modal forces of the load", self.n_modes(), modal.len())?;
        agrees("gaps of the load", self.n_contacts(), gaps.len())?;
        self.loads.push(ForcedLoad { harmonic, modal: modal.to_vec(), gaps: gaps.to_vec() });
        Ok(())
    }

    /// Mounts the stop of a contact on a spring (N/m) and a damper (N s/m) in parallel. It returns to its rest position
    /// while the contact is open.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`] or [`TimestepError::NotPositive`].
    pub fn push_damped_stop(&mut self, contact: usize, stiffness: f64, damper: f64) -> Result<(), TimestepError> {
        if contact >= self.n_contacts() {
            let (expected, found) = (self.n_contacts(), contact);
            return Err(TimestepError::Dimension { what: "contacts", expected, found });
        }
        positive("stiffness of a stop (N/m)", stiffness)?;
        positive("damper of a stop (N s/m)", damper)?;
        self.dampers.push((contact, stiffness, damper));
        Ok(())
    }

    /// Number of modes m.
    pub fn n_modes(&self) -> usize {
        self.omega_squared.len()
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.gaps.len()
    }

    /// Length of a state: modal coordinates (m √kg), their rates (m √kg/s), displacements of the dissipative stops (m).
    pub fn n_states(&self) -> usize {
        2 * self.n_modes() + self.dampers.len()
    }

    /// The slowest rate at which a free motion decays with all contacts open, by the damping of each mode alone, 1/s:
    /// zero where one is not damped.
    pub fn slowest_decay(&self) -> f64 {
        let of = |k: usize| {
            let half = 0.5 * self.damping[(k, k)];
            let square = self.omega_squared[k].max(0.0);
            // An overdamped mode creeps back.
            if half * half <= square { half } else { square / (half + (half * half - square).sqrt()) }
        };
        (0..self.n_modes()).map(of).fold(f64::INFINITY, f64::min)
    }

    /// A rate that scales velocities to displacements, 1/s.
    fn rate(&self) -> f64 {
        let highest = self.omega_squared.iter().fold(0.0_f64, |most, w| most.max(w.abs())).sqrt();
        if highest > 0.0 { highest } else { 1.0 }
    }
}
