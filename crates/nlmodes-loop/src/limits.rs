use core::f64::consts::FRAC_PI_2;

use crate::PhaseLoopError;
use crate::error::not_negative;

/// What a test must not exceed. An infinite limit is none.
///
/// The drive is kept below its limit. Any other excess is an emergency: the drive goes to zero within
/// [`stop_duration`](Self::stop_duration), and stays there.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest peak of the drive, N or V.
    pub drive: f64,
    /// Largest displacement to either side, m.
    pub stroke: f64,
    /// Largest contact force, N.
    pub contact_force: f64,
    /// Largest force of the exciter, N.
    pub force: f64,
    /// Longest time without a finite sample of force and response, s.
    pub silence: f64,
    /// Time in which the drive goes to zero in an emergency, s; zero: at the next sample.
    pub stop_duration: f64,
}

/// Why a test was ended.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum EmergencyReason {
    /// It was not.
    #[default]
    None,
    /// The operator wanted it.
    Operator,
    /// The displacement exceeded its limit.
    Stroke,
    /// The contact force exceeded its limit.
    ContactForce,
    /// The force of the exciter exceeded its limit.
    Force,
    /// No finite samples for too long.
    Silence,
}

impl Default for Limits {
    /// None but for 10 ms of silence, with a stop in 50 ms.
    fn default() -> Self {
        let none = f64::INFINITY;
        Self { drive: none, stroke: none, contact_force: none, force: none, silence: 0.01, stop_duration: 0.05 }
    }
}

impl Limits {
    pub(crate) fn check(&self) -> Result<(), PhaseLoopError> {
        let limits = [
            ("largest drive (N or V)", self.drive),
            ("largest stroke (m)", self.stroke),
            ("largest contact force (N)", self.contact_force),
            ("largest force (N)", self.force),
            ("longest time without samples (s)", self.silence),
        ];
        for (what, value) in limits {
            // Formulated such that NaN is refused, and infinity is not.
            let above = value > 0.0;
            if !above {
                return Err(PhaseLoopError::NotPositive { what, value });
            }
        }
        not_negative("duration of an emergency stop (s)", self.stop_duration).map(drop)
    }

    /// What these samples exceed. A sample of a limited channel that is not a number counts as missing, not as excess.
    pub(crate) fn judge(&self, stroke: f64, contact_force: f64, force: f64, silent: f64) -> EmergencyReason {
        if stroke.abs() > self.stroke {
            EmergencyReason::Stroke
        } else if contact_force.abs() > self.contact_force {
            EmergencyReason::ContactForce
        } else if force.abs() > self.force {
            EmergencyReason::Force
        } else if silent > self.silence {
            EmergencyReason::Silence
        } else {
            EmergencyReason::None
        }
    }

    /// Whether the samples of the channels with a limit are numbers.
    pub(crate) fn are_read(&self, stroke: f64, contact_force: f64) -> bool {
        let read = |value: f64, limit: f64| !value.is_nan() || limit == f64::INFINITY;
        read(stroke, self.stroke) && read(contact_force, self.contact_force)
    }
}

/// Share of the drive that is left at the share `x` of a stop: a quarter of a cosine's square, without a corner.
pub(crate) fn fade(x: f64) -> f64 {
    if x >= 1.0 {
        return 0.0;
    }
    let cos = libm::cos(FRAC_PI_2 * x);
    cos * cos
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_excess_has_its_reason_and_what_is_not_limited_has_none() {
        let limits = Limits { stroke: 1e-3, contact_force: 50.0, force: 8.0, ..Limits::default() };
        limits.check().unwrap();
        let cases = [
            ([-1.1e-3, 0.0, 0.0, 0.0], EmergencyReason::Stroke),
            ([0.0, 51.0, 0.0, 0.0], EmergencyReason::ContactForce),
            ([0.0, 0.0, -8.1, 0.0], EmergencyReason::Force),
            ([0.0, 0.0, 0.0, 0.02], EmergencyReason::Silence),
            ([1e-3, -50.0, 8.0, 0.01], EmergencyReason::None),
        ];
        for ([stroke, contact, force, silent], reason) in cases {
            assert_eq!(limits.judge(stroke, contact, force, silent), reason);
            assert_eq!(
                Limits { silence: 1.0, ..Limits::default() }.judge(stroke, contact, force, silent),
                EmergencyReason::None
            );
        }
        assert!(!limits.are_read(f64::NAN, 0.0) && Limits::default().are_read(f64::NAN, f64::NAN));
        assert!(matches!(Limits { drive: f64::NAN, ..limits }.check(), Err(PhaseLoopError::NotPositive { .. })));
        assert!(matches!(Limits { stroke: 0.0, ..limits }.check(), Err(PhaseLoopError::NotPositive { .. })));
    }

    #[test]
    fn a_stop_begins_and_ends_without_a_corner() {
        assert_eq!((fade(0.0), fade(1.0), fade(3.0)), (1.0, 0.0, 0.0));
        assert!((fade(0.5) - 0.5).abs() < 1e-15 && 1.0 - fade(1e-4) < 1e-7 && fade(1.0 - 1e-4) < 1e-7);
    }
}
