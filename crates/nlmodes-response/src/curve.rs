use std::f64::consts::TAU;
use std::fmt;

use nlmodes_continuation::StopReason;
use nlmodes_hbm::{Floquet, Instability, PeriodicMotion, PeriodicSystem};
use nlmodes_modal::{EndReason, Event};
use num_complex::Complex64;

/// Stability of a response by its multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// Whether disturbances die out; `None` within the error band.
    pub stable: Option<bool>,
    /// The multiplier of largest magnitude, imaginary part not negative.
    pub largest: Complex64,
    /// Estimated error of its magnitude.
    pub error: f64,
    /// How stability is lost by it.
    pub instability: Instability,
}

impl Stability {
    /// By the multipliers of a motion.
    pub(crate) fn of(floquet: &Floquet) -> Self {
        Self {
            stable: floquet.is_stable(),
            largest: floquet.largest(),
            error: floquet.error,
            instability: floquet.instability(),
        }
    }
}

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

/// Why a curve has no further points.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum CurveEnd {
    /// It left the window of frequencies; the last point lies on its end, rad/s.
    Window(f64),
    /// The largest level or energy asked for is reached.
    Limit,
    /// It came back to where it began.
    Closed,
    /// It came to where another curve of the same problem goes on.
    Joined,
    /// It has as many points as were asked for.
    MaxPoints,
    /// It was asked to end.
    Stopped,
    /// No step could be shown to stay on the curve, for this reason.
    Lost(String),
}

impl CurveEnd {
    /// Whether it ended at a limit that was asked for.
    pub fn is_complete(&self) -> bool {
        matches!(self, Self::Window(_) | Self::Limit | Self::Closed | Self::Joined)
    }

    /// Why, without the values.
    pub fn reason(&self) -> EndReason {
        match self {
            Self::Window(_) => EndReason::FrequencyWindow,
            Self::Limit => EndReason::Limit,
            Self::Closed => EndReason::Closed,
            Self::Joined => EndReason::Joined,
            Self::MaxPoints => EndReason::MaxPoints,
            Self::Stopped => EndReason::Stopped,
            Self::Lost(_) => EndReason::NoConvergence,
        }
    }

    /// From the reason of the continuation; `omega` and `limit` are the coordinates of frequency and of level or
    /// energy.
    pub(crate) fn of(stop: &StopReason, omega: usize, unit: f64) -> Self {
        match stop {
            StopReason::Bound { coordinate, value } if *coordinate == omega => Self::Window(value * unit),
            StopReason::Bound { .. } => Self::Limit,
            StopReason::Closed => Self::Closed,
            StopReason::MaxPoints => Self::MaxPoints,
            StopReason::StepTooSmall { step, refusal } => {
                Self::Lost(format!("no step longer than {step:.0e} stays on the curve: {refusal}"))
            }
            StopReason::Joined => Self::Joined,
            _ => Self::Stopped,
        }
    }
}

impl fmt::Display for CurveEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Window(omega) => write!(f, "the frequency window ends at {:.6} Hz", omega / TAU),
            Self::Limit => write!(f, "the largest level or energy is reached"),
            Self::Closed => write!(f, "the curve is closed"),
            Self::Joined => write!(f, "it meets another curve"),
            Self::MaxPoints => write!(f, "it has as many points as were asked for"),
            Self::Stopped => write!(f, "it was asked to end"),
            Self::Lost(why) => write!(f, "{why}"),
        }
    }
}

/// A curve of motions.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResponseCurve {
    /// The points, in order.
    pub points: Vec<ResponsePoint>,
    /// Why there are no more.
    pub end: CurveEnd,
    /// Of a curve of phase resonances: each one at the levels that were asked for, in the order of the curve.
    pub at_levels: Vec<ResponsePoint>,
}
