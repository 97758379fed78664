use std::f64::consts::TAU;

use nlmodes_continuation::StopReason;
use nlmodes_hbm::{MotionChange, PeriodicMotion, PeriodicSystem};
use nlmodes_modal::{BranchEnd, EndReason, Event, ModalPoint, Stability};
use num_complex::Complex64;

use crate::response::FinerPoint;

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
    /// Amplitude of the displacement that gradients watch, m; zero without one.
    pub(crate) watched: f64,
    /// Stability, where it was asked for.
    pub stability: Option<Stability>,
    /// Largest scaled residual.
    pub residual: f64,
    /// What happens here.
    pub events: Vec<Event>,
    /// Its derivatives by the parameters that were asked for, in their order.
    pub gradients: Vec<MotionChange>,
    /// Where it lies in the unknowns of its problem, from which another curve can start.
    pub(crate) solved: Solved,
}

/// A solution in the unknowns of its problem.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solved {
    /// The unknowns; the coefficients of the motion are the first of them.
    pub x: Vec<f64>,
    /// The parameter.
    pub p: f64,
    /// Number of coefficients, and their unit.
    pub coefficients: (usize, f64),
}

impl Solved {
    /// The scaled coefficients of the motion, and their unit.
    pub fn coefficients(&self) -> (&[f64], f64) {
        let (count, unit) = self.coefficients;
        (&self.x[..count], unit)
    }
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
        let (series, (own, unit)) = (system.series(), self.solved.coefficients());
        let coordinates = (system.n_coefficients() / series.width()).max(1);
        let width = own.len() / coordinates;
        let factor = unit / system.unit();
        // Motions that are even in time have no sines, which are last.
        let padded = |one: &[f64]| {
            let mut one: Vec<f64> = one.iter().map(|x| x * factor).collect();
            one.resize(series.width(), 0.0);
            one
        };
        own.chunks(width.max(1)).flat_map(padded).collect()
    }
}

/// Why the continuation has no further points, of at most `max_points`; `bound` says what a bound that was reached is
/// to the curve, by its coordinate and the value there.
pub fn curve_end(
    stop: &StopReason,
    max_points: usize,
    bound: impl FnOnce(usize, f64) -> (EndReason, String),
) -> BranchEnd {
    let (reason, message) = match stop {
        StopReason::Bound { coordinate, value } => bound(*coordinate, *value),
        StopReason::Closed => (EndReason::Closed, "the branch came back to where it began".to_owned()),
        StopReason::Joined => return joined(),
        StopReason::Stopped => (EndReason::Stopped, "it was asked to stop".to_owned()),
        StopReason::MaxPoints => (EndReason::MaxPoints, format!("the limit of {max_points} points was reached")),
        StopReason::StepTooSmall { step, refusal } => {
            let why = format!("no step, down to {step:.1e}, could be shown to stay on the branch: {refusal}");
            (EndReason::NoStep, why)
        }
        _ => (EndReason::Unknown, format!("{stop:?}")),
    };
    let is_complete = matches!(stop, StopReason::Bound { .. } | StopReason::Closed);
    BranchEnd::new(reason, message, is_complete)
}

/// What the largest and the smallest energy are to a curve whose parameter is the logarithm of the energy over that at
/// its beginning, named so: `grazing`.
pub fn energy_bound(value: f64, beginning: &str) -> (EndReason, String) {
    if value > 0.0 {
        (EndReason::MaxEnergy, format!("the energy reached {:.6} times that at {beginning}", value.exp()))
    } else {
        (EndReason::MinEnergy, format!("the energy fell to {:.1e} of that at {beginning}", value.exp()))
    }
}

/// What an end of the window of frequencies, rad/s, is to a curve.
pub fn frequency_bound(omega: f64) -> (EndReason, String) {
    (EndReason::FrequencyWindow, format!("the frequency reached {:.6} Hz", omega / TAU))
}

/// That a curve came to where another curve of the same problem goes on.
pub(crate) fn joined() -> BranchEnd {
    let message = "it came to a branch point from which its way on had been followed already";
    BranchEnd::new(EndReason::Joined, message, true)
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
    /// Points solved again with more harmonics, where that was asked for.
    pub finer: Vec<FinerPoint>,
}

impl ResponseCurve {
    /// Largest relative change that more harmonics make at the points that were solved again: of the frequency, and of
    /// the amplitude `√E_av/ω` over the largest of the curve. Infinite where no motion was found next to a point, and
    /// none where no point was solved again.
    pub fn truncation(&self) -> Option<f64> {
        let amplitude = |point: &ResponsePoint| point.motion.kinetic_energy.sqrt() / point.motion.at.omega;
        let largest = self.points.iter().map(amplitude).fold(f64::MIN_POSITIVE, f64::max);
        let changes = self.finer.iter().map(|finer| {
            let (own, Some(found)) = (&self.points[finer.point], &finer.found) else { return f64::INFINITY };
            let frequency = (found.omega / own.omega - 1.0).abs();
            frequency.max((amplitude(found) - amplitude(own)).abs() / largest)
        });
        changes.reduce(f64::max)
    }
}
