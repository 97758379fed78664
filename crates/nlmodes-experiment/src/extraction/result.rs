use nlmodes_modal::{
    ContactStiffness, HarmonicCoefficients, LinearDissipation, ModalPoint, NonlinearModeShape, Participation,
    Restitution, TimeHistory,
};

use crate::extraction::{BalanceFigures, ExcitationPower, Finding, Measured};

/// What a record says about a nonlinear mode.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RecordExtraction {
    /// Name of the record.
    pub record: String,
    /// Frequency, rad/s.
    pub omega: Measured,
    /// Number of periods.
    pub periods: usize,
    /// Harmonics of the mode shape and of the participation.
    pub harmonics: usize,
    /// Positions of the sensors, m.
    pub positions: Vec<f64>,
    /// Displacement at these positions, m; phases count from the middle of the periods. The mean is zero where no
    /// sensor gives it.
    pub motion: HarmonicCoefficients,
    /// Modal quantities, where linear modes are given.
    pub modal: Option<ModalFigures>,
    /// Quantities of the excitation, where there are a force and a drive point.
    pub excitation: Option<ExcitationFigures>,
    /// Quantities of the contact, where its force was measured.
    pub contact: Option<ContactFigures>,
    /// The same from the balance of the linear modes, without the force that was measured.
    pub balance: Option<BalanceFigures>,
    /// What a careful experimenter wants to know.
    pub findings: Vec<Finding>,
}

/// Modal quantities, eqs. (20)-(28), (30).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModalFigures {
    /// Nonlinear modal amplitude `q̃`, m·√kg.
    pub amplitude: Measured,
    /// Mode shape per harmonic.
    pub shape: NonlinearModeShape,
    /// Participation of the linear modes; says which harmonics are in the sum.
    pub participation: Participation,
    /// Standard errors of the participation factors.
    pub participation_uncertainty: Vec<f64>,
    /// Damping coefficient `δ̃`, eq. (28), where the excitation was measured.
    pub damping: Option<Measured>,
    /// Power that the damping ratios of the linear modes dissipate, eqs. (25), (26).
    pub dissipation: LinearDissipation,
    /// Damping coefficients `δ̃_n` of the harmonics 1, 2 …, eq. (26).
    pub harmonic_damping: Vec<Measured>,
    /// Power that they do not dissipate of what the force supplies in as many harmonics, eq. (17), W: lost at the
    /// contact, or in modes that are not in the table.
    pub contact_dissipation: Option<Measured>,
    /// Kinetic energy averaged over a period, J.
    pub kinetic_energy: Measured,
    /// The share of each harmonic in it, J, from harmonic 0 on.
    pub harmonic_energy: Vec<f64>,
}

/// Quantities of the excitation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ExcitationFigures {
    /// Powers, eqs. (17), (18).
    pub power: ExcitationPower,
    /// Active power of the fundamental, W.
    pub fundamental_power: Measured,
    /// Active power of all harmonics, eq. (17), W.
    pub total_power: Measured,
    /// Power-based mode indicator, eq. (19), from as many harmonics as `power` says.
    pub pbmif: Measured,
    /// Amplitude of the force's fundamental, N.
    pub force: Measured,
    /// Amplitude of the fundamental of the drive-point displacement, m.
    pub drive: Measured,
    /// Lag of the drive-point displacement behind the force, rad; π/2 at phase resonance.
    pub lag: Measured,
    /// Lag of the coordinate of the excited mode behind the force, rad, where linear modes are given: without what
    /// other modes add to the motion of the drive point.
    pub modal_lag: Option<Measured>,
    /// Indicator of phase resonance from all sensors, `1 − Σ |Re x_i||x_i| / Σ |x_i|²` of their fundamentals by the
    /// phase of the force; one in phase resonance.
    pub phase_indicator: Option<Measured>,
}

/// Quantities of the contact.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ContactFigures {
    /// Largest force of each period, N, mean over the periods.
    pub peak_force: Measured,
    /// Share of time in contact.
    pub closed_fraction: f64,
    /// Contact intervals a period.
    pub intervals_per_period: f64,
    /// Coefficients of restitution, eq. (29); `None` without contact.
    pub restitution: Option<Restitution>,
    /// Contact stiffness; `None` without contact, or where force and displacement do not rise together.
    pub stiffness: Option<ContactStiffness>,
    /// Motion at the stop and contact force; `None` without a description of the stop.
    pub history: Option<TimeHistory>,
}

impl RecordExtraction {
    /// Names of the findings, each once, separated by spaces.
    pub fn finding_names(&self) -> String {
        Finding::names(&self.findings)
    }

    /// As a point of a branch, for tables and figures beside computed ones; `None` without modal quantities.
    ///
    /// Signal-based figures that a record does not give are NaN: the strain energy, and so the total one.
    pub fn modal_point(&self) -> Option<ModalPoint> {
        let modal = self.modal.as_ref()?;
        let last = self.motion.n_coordinates().checked_sub(1)?;
        let contact = self.contact.as_ref();
        let history = contact.and_then(|contact| contact.history.as_ref());
        let peak = history.map_or(f64::NAN, |history| {
            let side = if history.stop < 0.0 { -1.0 } else { 1.0 };
            history.displacement.iter().map(|x| side * x).fold(f64::NEG_INFINITY, f64::max)
        });
        Some(ModalPoint {
            omega: self.omega.value,
            coefficients: self.motion.clone(),
            kinetic_energy: modal.kinetic_energy.value,
            harmonic_energy: modal.harmonic_energy.clone(),
            total_energy: f64::NAN,
            modal_amplitude: modal.amplitude.value,
            fundamental: self.motion.of(last)[1].norm(),
            peak,
            contact_fraction: contact.map_or(f64::NAN, |contact| contact.closed_fraction),
            contact_intervals: contact.map_or(0, |contact| contact.intervals_per_period.round() as usize),
            peak_contact_force: contact.map_or(f64::NAN, |contact| contact.peak_force.value),
            residual: f64::NAN,
            ..ModalPoint::default()
        })
    }
}
