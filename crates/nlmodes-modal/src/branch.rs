use std::sync::Arc;

use num_complex::Complex64;

use crate::{BranchEnd, ContactPeriod, Event, Gradient, HarmonicCoefficients, InternalResonance, Stability};

/// A coordinate of a motion: a degree of freedom or a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// Position along the structure, m.
    pub position: f64,
    /// Kind: `axial`, `deflection`, `rotation`.
    pub kind: String,
}

/// A point of a curve of periodic motions with its modal quantities: of a nonlinear mode, conservative or damped, of a
/// response, or of a record; what a kind of motion does not have is none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModalPoint {
    /// Nonlinear modal frequency `ω̃`, rad/s.
    pub omega: f64,
    /// Complex Fourier coefficients of all coordinates, eq. (20).
    pub coefficients: HarmonicCoefficients,
    /// Kinetic energy averaged over a period `E_av`, J.
    pub kinetic_energy: f64,
    /// The contribution of each harmonic to it, J, from harmonic 0 on.
    pub harmonic_energy: Vec<f64>,
    /// The internal resonance of the motion, if any.
    pub resonance: Option<InternalResonance>,
    /// Stability of the motion, if it was computed.
    pub stability: Option<Stability>,
    /// Kinetic and strain energy, J.
    pub total_energy: f64,
    /// Nonlinear modal amplitude `q̃` of eqs. (21), (22), m·√kg.
    pub modal_amplitude: f64,
    /// Real amplitude of the fundamental of the first contact coordinate, signed against its phase anchor, m.
    pub fundamental: f64,
    /// Largest displacement of the first contact coordinate toward its stop, m.
    pub peak: f64,
    /// Share of the period in which the first contact is closed.
    pub contact_fraction: f64,
    /// Closed intervals per period, over all contacts.
    pub contact_intervals: usize,
    /// Largest contact force, N.
    pub peak_contact_force: f64,
    /// Each contact over the period, in the order of the structure; empty if they are not distinguished, as in a
    /// record.
    pub contacts: Vec<ContactPeriod>,
    /// Norm of the scaled residual.
    pub residual: f64,
    /// Estimated relative error of the frequency at the same energy due to truncated harmonics and modes, if estimated.
    pub error_estimate: Option<f64>,
    /// Events at this point.
    pub events: Vec<Event>,
    /// The largest stress over the period, where it was recovered.
    pub stress: Option<PeakStress>,
    /// Load, drive point and powers; none of a conservative motion.
    pub driven: Option<Driven>,
    /// Derivatives by the parameters that were asked for.
    pub gradients: Arc<[Gradient]>,
}

impl ModalPoint {
    /// Angular frequency by which curves are drawn and listed: that of the load, and without one that of the motion,
    /// rad/s.
    pub fn listed_omega(&self) -> f64 {
        self.driven.map_or(self.omega, |driven| driven.omega)
    }
}

/// The largest stress over a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakStress {
    /// Equivalent stress of von Mises, of rods and beams the magnitude of the axial stress, Pa.
    pub stress: f64,
    /// Number of the node where it is, of rods and beams the position along the axis, m.
    pub at: f64,
}

/// What a point of a damped or driven motion has beside what every motion has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    /// Angular frequency of the load, of which several periods may be one of the motion; of a free motion its own,
    /// rad/s.
    pub omega: f64,
    /// Level of the load, in its unit; none of a free motion.
    pub level: Option<f64>,
    /// Amplitude of the first force, or of that which would hold a free motion in one harmonic, N.
    pub force: Option<f64>,
    /// Complex amplitude of the drive point at the frequency of the load, m; none without a drive point.
    pub drive: Option<Complex64>,
    /// Mean power of the load, W; none of a free motion.
    pub input_power: Option<f64>,
    /// Mean power that the damping takes out, W.
    pub dissipated_power: f64,
    /// Damping ratio `ξ/(2ω)` of a damped mode.
    pub damping_ratio: Option<f64>,
    /// Power-based mode indicator, eq. (19).
    pub indicator: Option<f64>,
    /// Of appropriation: distance of the velocities from those of the mode, over the latter.
    pub mode_distance: Option<f64>,
}

impl Driven {
    /// By how much the drive point lags the load, degrees from −180 to 180; none of a free motion.
    pub fn lag_deg(&self) -> Option<f64> {
        self.level.and(self.drive).map(|drive| -drive.arg().to_degrees())
    }
}

/// A nonlinear mode over energy: computed or measured points in their order along the branch.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalBranch {
    /// Name in legends, for instance `MS-HBM, 3 harmonics`.
    pub label: String,
    /// Coordinates of every motion.
    pub coordinates: Vec<Coordinate>,
    /// Index of the first contact coordinate, if there is one.
    pub contact_coordinate: Option<usize>,
    /// Signed position of the first stop along its coordinate, m (`+g₀` for a stop on the positive side).
    pub stop: Option<f64>,
    /// The points.
    pub points: Vec<ModalPoint>,
    /// Why the branch ends.
    pub end: BranchEnd,
}

impl ModalBranch {
    /// Points of whose motions nothing else is known.
    pub fn of_points(label: impl Into<String>, points: Vec<ModalPoint>, end: BranchEnd) -> Self {
        Self { label: label.into(), coordinates: Vec::new(), contact_coordinate: None, stop: None, points, end }
    }
}
