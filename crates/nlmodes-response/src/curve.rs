use std::f64::consts::TAU;

use nlmodes_continuation::StopReason;
use nlmodes_hbm::{PeriodicMotion, PeriodicSystem};
use nlmodes_modal::{BranchEnd, EndReason, Event, ModalPoint, Stability};
use num_complex::Complex64;

/// A point of a curve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResponsePoint {
    /// Frequency of the load, or of the damped mode, rad/s.
    pub omega: f64,
    /// Level of the load; zero for a damped mode.
    pub level: f64,
    /// The motion, over its own period.
    pub motion: PeriodicMotion,
    /// Complex amplitude of the drive point at the frequency of the load, m; zero without a drive point.
    pub drive: Complex64,
    /// Stability, where it was asked for.
    pub stability: Option<Stability>,
    /// Largest scaled residual.
    pub residual: f64,
    /// What happens here.
    pub events: Vec<Event>,
    /// Scaled coefficients of the motion and their unit, from which another curve can start.
    pub(crate) coefficients: (Vec<f64>, f64),
}

impl ResponsePoint {
    /// By how much the drive point lags the load, rad, from −π to π.
    pub fn lag(&self) -> f64 {
        -self.drive.arg()
    }

    /// As a point of a curve, without load and displacements: its fundamental is NaN.
    pub fn modal_point(&self) -> ModalPoint {
        ModalPoint {
            stability: self.stability,
            residual: self.residual,
            events: self.events.clone(),
            ..self.motion.point()
        }
    }

    /// Its coefficients as the first unknowns of another problem on the same structure with as many harmonics.
    pub(crate) fn coefficients_for(&self, system: &PeriodicSystem) -> Vec<f64> {
        let (series, (own, unit)) = (system.series(), &self.coefficients);
        let coordinates = (system.n_coefficients() / series.width()).max(1);
        let width = own.len() / coordinates;
        let factor = unit / system.unit();
        // Motions that are even in time have no sines, which stand last.
        let padded = |one: &[f64]| {
            let mut one: Vec<f64> = one.iter().map(|x| x * factor).collect();
            one.resize(series.width(), 0.0);
            one
        };
        own.chunks(width.max(1)).flat_map(padded).collect()
    }
}

/// Why the continuation has no further points; `omega` is the coordinate of the frequency, whose unit is `unit`, rad/s.
pub(crate) fn end_of(stop: &StopReason, omega: usize, unit: f64) -> BranchEnd {
    let (reason, message) = match stop {
        StopReason::Bound { coordinate, value } if *coordinate == omega => {
            let hertz = value * unit / TAU;
            (EndReason::FrequencyWindow, format!("the frequency window ends at {hertz:.6} Hz"))
        }
        StopReason::Bound { .. } => (EndReason::Limit, "the largest level or energy is reached".to_owned()),
        StopReason::Closed => (EndReason::Closed, "the curve is closed".to_owned()),
        StopReason::Joined => return joined(),
        StopReason::MaxPoints => (EndReason::MaxPoints, "it has as many points as were asked for".to_owned()),
        StopReason::StepTooSmall { step, refusal } => {
            return lost(format!("no step longer than {step:.0e} stays on the curve: {refusal}"));
        }
        _ => (EndReason::Stopped, "it was asked to end".to_owned()),
    };
    let is_complete = !matches!(reason, EndReason::MaxPoints | EndReason::Stopped);
    BranchEnd::new(reason, message, is_complete)
}

/// That a curve came to where another curve of the same problem goes on.
pub(crate) fn joined() -> BranchEnd {
    BranchEnd::new(EndReason::Joined, "it meets another curve", true)
}

/// That a curve was lost, for this reason.
pub(crate) fn lost(why: String) -> BranchEnd {
    BranchEnd::new(EndReason::NoConvergence, why, false)
}

/// A curve of motions.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResponseCurve {
    /// The points, in order.
    pub points: Vec<ResponsePoint>,
    /// Why there are no more.
    pub end: BranchEnd,
    /// Of a curve of phase resonances: each one at the levels that were asked for, in the order of the curve.
    pub at_levels: Vec<ResponsePoint>,
}
