//! What the motion of a response's point becomes once it is disturbed: integrated exactly, from the point along the
//! vector of its largest multiplier.

mod lines;
mod near;
mod search;
mod text;
mod verified;

use std::path::Path;

use serde::Serialize;

pub(crate) use near::Row;
pub(crate) use search::Forced;
use search::Search;
pub use verified::{FoundResponse, verify_response};

use crate::model::Model;
use crate::motion::Motion;
use crate::verify::VerifyError;

/// How a point is disturbed, and how long it is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettleSettings {
    /// Size of the disturbance over that of the motion.
    pub disturbance: f64,
    /// Most periods of the load that are followed; none for as many as the slowest mode takes to decay.
    pub periods: Option<usize>,
}

impl Default for SettleSettings {
    fn default() -> Self {
        Self { disturbance: 1e-3, periods: None }
    }
}

/// What the motion of a point becomes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settled {
    /// Number of the point.
    pub point: usize,
    /// Frequency of the load, Hz.
    pub frequency_hz: f64,
    /// Level of the load, and its unit.
    pub level: f64,
    /// Unit of the level.
    pub level_unit: &'static str,
    /// What it becomes.
    #[serde(flatten)]
    pub becomes: Becomes,
    /// Size of the disturbance over that of the motion.
    pub disturbance: f64,
    /// Periods of the load that were integrated.
    pub integrated_periods: usize,
    /// Distance of the first state of the point to the exact motion next to it, over its size: what harmonics leave
    /// out. None where there is no such motion: the state of the point itself is then followed, not disturbed.
    pub distance_to_exact: Option<f64>,
    /// Largest multiplier of that exact motion: real part, imaginary part.
    pub multiplier: Option<[f64; 2]>,
    /// Displacement of the first contact toward its stop, or of the drive point, in the motion of the point.
    pub before: Size,
}

/// A displacement over a period or several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Size {
    /// Its largest value, m.
    pub largest_m: f64,
    /// Its smallest value, m.
    pub smallest_m: f64,
    /// Its amplitude at the frequency of the load, m.
    pub fundamental_m: f64,
}

/// What a disturbed motion becomes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Becomes {
    /// The motion of the point again, or one of more periods of the load.
    Periodic {
        /// Periods of the load in one of the motion.
        periods: usize,
        /// Whether it is the motion of the point.
        returns: bool,
        /// Magnitude of its largest multiplier.
        largest_multiplier: f64,
        /// Its displacement.
        after: Size,
    },
    /// A motion with two frequencies.
    TwoLines {
        /// That of the load, and of the strongest line that is no multiple of it, Hz.
        frequencies_hz: [f64; 2],
        /// Frequency of the beat: the lowest difference of lines, Hz.
        beat_hz: f64,
        /// Mean of the largest displacements of the periods of the load, m, and their standard deviation.
        largest_m: f64,
        /// Their standard deviation, m.
        spread_m: f64,
    },
    /// Neither periodic nor of two frequencies within the time that was integrated.
    Irregular {
        /// Mean of the largest displacements of the periods of the load, m.
        largest_m: f64,
        /// Their standard deviation, m.
        spread_m: f64,
        /// The largest of them, m.
        most_m: f64,
    },
    /// Another motion of the same period.
    Other {
        /// Periods of the load in one of that motion.
        periods: usize,
        /// Magnitude of its largest multiplier.
        largest_multiplier: f64,
        /// Its displacement.
        after: Size,
        /// The nearest point of the results at this level and frequency, by the amplitude; none where there is none.
        nearest_point: Option<usize>,
    },
}

/// What the motion of a point becomes, disturbed along the vector of its largest multiplier.
///
/// # Errors
/// [`VerifyError`] if there is no such point, or it is none of a forced response.
pub fn settle(directory: &Path, point: usize, settings: SettleSettings) -> Result<Settled, VerifyError> {
    let periods = settings.periods.map_or(1.0, |periods| periods as f64);
    for (what, value) in [("disturbance", settings.disturbance), ("periods", periods)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(VerifyError::NotPositive { what, value });
        }
    }
    settled(&Search::read(directory, point)?, settings)
}

/// The same of a point of curves in memory; `rows` has all of them.
///
/// # Errors
/// [`VerifyError`].
pub(crate) fn settle_in_memory(
    model: &Model,
    at: Forced,
    motion: &Motion,
    rows: &[Row],
) -> Result<Settled, VerifyError> {
    settled(&Search::new(model, at, motion, rows.to_vec())?, SettleSettings::default())
}

fn settled(search: &Search, settings: SettleSettings) -> Result<Settled, VerifyError> {
    let (becomes, integrated_periods) = search.follow(settings)?;
    let multiplier = search.start.as_ref().and_then(|start| start.multipliers.first());
    Ok(Settled {
        point: search.at.point,
        frequency_hz: search.at.omega / std::f64::consts::TAU,
        level: search.at.level,
        level_unit: search.unit,
        becomes,
        disturbance: settings.disturbance,
        integrated_periods,
        distance_to_exact: search.off(),
        multiplier: multiplier.map(|most| [most.re, most.im]),
        before: search.start.as_ref().map_or(search.before, Search::size),
    })
}
