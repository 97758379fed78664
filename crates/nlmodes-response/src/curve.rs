use nlmodes_continuation::StopReason;
use nlmodes_hbm::{Instability, PeriodicMotion};
use num_complex::Complex64;

/// What a curve passes at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ResponseEvent {
    /// The parameter turns: frequency, level, or energy.
    Fold,
    /// More than two arms meet.
    BranchPoint,
    /// The curve has a corner.
    Kink,
    /// Another sequence of contacts.
    PatternChange,
    /// Between here and the point before, a multiplier passes −1.
    PeriodDoubling,
    /// Between here and the point before, a pair of multipliers passes the unit circle.
    NeimarkSacker,
}

impl ResponseEvent {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::BranchPoint => "branch-point",
            Self::Kink => "kink",
            Self::PatternChange => "pattern-change",
            Self::PeriodDoubling => "period-doubling",
            Self::NeimarkSacker => "neimark-sacker",
        }
    }
}

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
    pub events: Vec<ResponseEvent>,
}

impl ResponsePoint {
    /// By how much the drive point lags the load, rad, from −π to π.
    pub fn lag(&self) -> f64 {
        -self.drive.arg()
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
    /// It has as many points as were asked for.
    MaxPoints,
    /// No step could be shown to stay on the curve, for this reason.
    Lost(String),
}

impl CurveEnd {
    /// Whether it ended at a limit that was asked for.
    pub fn is_complete(&self) -> bool {
        matches!(self, Self::Window(_) | Self::Limit | Self::Closed)
    }

    /// From the reason of the continuation; `omega` and `limit` are the coordinates of frequency and of level or energy.
    pub(crate) fn of(stop: &StopReason, omega: usize, unit: f64) -> Self {
        match stop {
            StopReason::Bound { coordinate, value } if *coordinate == omega => Self::Window(value * unit),
            StopReason::Bound { .. } => Self::Limit,
            StopReason::Closed => Self::Closed,
            StopReason::MaxPoints => Self::MaxPoints,
            StopReason::StepTooSmall { step, refusal } => {
                Self::Lost(format!("no step longer than {step:.0e} stays on the curve: {refusal}"))
            }
            _ => Self::Lost("the computation was stopped".to_owned()),
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
}
