//! Time histories for the script, and thinned ones.

use super::knots::knots;
use super::number::rounded;
use super::packed::Column;
use crate::figure::HistoryLook;
use nlmodes_modal::TimeHistory;
use serde::Serialize;

/// Tolerance of a curve relative to its largest value: a tenth of a pixel.
const TOLERANCE: f64 = 5e-4;

#[derive(Serialize)]
pub(super) struct HistoryData {
    name: String,
    time: Column,
    displacement: Column,
    velocity: Column,
    acceleration: Column,
    force: Column,
    stop: f64,
    /// Colour of the stop.
    wall: &'static str,
    /// Time, and whether contact begins.
    instants: Vec<(f64, bool)>,
    label: String,
    color: &'static str,
    dash: Option<&'static str>,
    /// Overlaid histories.
    others: Vec<HistoryData>,
}

impl HistoryData {
    /// The first of these histories, with the others overlaid; none if empty.
    pub fn of_all(name: &str, all: &[&TimeHistory], look: &HistoryLook) -> Option<Self> {
        let colors = |index: usize| {
            let dash = look.is_dashed(index, all.len()).then_some("6 3");
            (look.curve(index, all.len()), look.wall(index), dash)
        };
        let mut curves = all.iter().enumerate().map(|(index, history)| Self::new(name, history, colors(index)));
        let first = curves.next()?;
        Some(Self { others: curves.collect(), ..first })
    }

    fn new(
        name: &str,
        history: &TimeHistory,
        (color, wall, dash): (&'static str, &'static str, Option<&'static str>),
    ) -> Self {
        let thin = thinned(history);
        Self {
            name: name.into(),
            time: Column::new(thin.time),
            displacement: Column::new(thin.displacement),
            velocity: Column::new(thin.velocity),
            acceleration: Column::new(thin.acceleration),
            force: Column::new(thin.force),
            stop: thin.stop,
            wall,
            instants: thin.instants.iter().map(|instant| (rounded(instant.time, 8), instant.touching)).collect(),
            label: history.label.clone(),
            color,
            dash,
            others: Vec::new(),
        }
    }
}

/// The history with the minimum number of samples for its curves; unchanged if a series does not match the time.
pub(super) fn thinned(history: &TimeHistory) -> TimeHistory {
    let all = [&history.displacement, &history.velocity, &history.acceleration, &history.force];
    if all.iter().any(|values| values.len() != history.time.len()) {
        return history.clone();
    }
    let chosen = knots(&history.time, &all.map(Vec::as_slice), TOLERANCE);
    let pick = |values: &[f64]| chosen.iter().map(|k| values[*k]).collect();
    TimeHistory {
        label: history.label.clone(),
        time: pick(&history.time),
        displacement: pick(&history.displacement),
        velocity: pick(&history.velocity),
        acceleration: pick(&history.acceleration),
        force: pick(&history.force),
        stop: history.stop,
        instants: history.instants.clone(),
    }
}
