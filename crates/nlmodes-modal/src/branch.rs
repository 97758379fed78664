use crate::{BranchEnd, ContactPeriod, Event, HarmonicCoefficients, InternalResonance};

/// A coordinate of a motion: a degree of freedom or a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// Position along the structure, m.
    pub position: f64,
    /// Kind: `axial`, `deflection`, `rotation`.
    pub kind: String,
}

/// Stability of a periodic motion by its Floquet multipliers `μ`: a disturbance is `μ` times as large after each
/// period.
///
/// For a conservative system they occur in pairs `μ`, `1/μ`, so a motion is stable if and only if all are on the unit
/// circle; the double multiplier +1, along the motion and toward the neighbouring motion of different energy, is
/// excluded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// Whether all multipliers are on the unit circle, to rounding.
    pub stable: bool,
    /// The multiplier of largest magnitude: real and imaginary part, the latter not negative.
    pub largest_multiplier: [f64; 2],
}

impl Stability {
    /// Magnitude of the largest multiplier.
    pub fn magnitude(&self) -> f64 {
        self.largest_multiplier[0].hypot(self.largest_multiplier[1])
    }

    /// Its angle in the complex plane, degrees from 0 to 180: stability is lost at 0 at a fold or a branch point, at
    /// 180 by period doubling, and in between by a collision of two pairs.
    pub fn angle_deg(&self) -> f64 {
        self.largest_multiplier[1].abs().atan2(self.largest_multiplier[0]).to_degrees()
    }
}

/// One point of a nonlinear mode: a periodic motion with its modal quantities.
#[derive(Debug, Clone, PartialEq)]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multiplier_has_magnitude_and_angle_whatever_the_sign_of_its_imaginary_part() {
        for (multiplier, magnitude, angle) in [
            ([1.5, 0.0], 1.5, 0.0),
            ([0.0, 2.0], 2.0, 90.0),
            ([-3.0, 0.0], 3.0, 180.0),
            ([1.0, -1.0], 2f64.sqrt(), 45.0),
        ] {
            let stability = Stability { stable: false, largest_multiplier: multiplier };
            assert!((stability.magnitude() - magnitude).abs() < 1e-15);
            assert!((stability.angle_deg() - angle).abs() < 1e-13, "{multiplier:?}: {}", stability.angle_deg());
        }
    }
}
