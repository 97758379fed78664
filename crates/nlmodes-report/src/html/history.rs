//! Time histories for the script, and thinned ones.

use super::number::rounded;
use nlmodes_modal::TimeHistory;
use serde::Serialize;

/// Most samples of a history on the page.
const MAX_SAMPLES: usize = 501;

#[derive(Serialize)]
pub(super) struct HistoryData {
    name: String,
    time: Vec<f64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    force: Vec<f64>,
    stop: f64,
    /// Time, and whether touching begins.
    instants: Vec<(f64, bool)>,
}

impl HistoryData {
    pub fn new(name: &str, history: &TimeHistory) -> Self {
        let thin = thinned(history);
        let short = |values: Vec<f64>| values.into_iter().map(|value| rounded(value, 6)).collect();
        Self {
            name: name.into(),
            time: short(thin.time),
            displacement: short(thin.displacement),
            velocity: short(thin.velocity),
            acceleration: short(thin.acceleration),
            force: short(thin.force),
            stop: thin.stop,
            instants: thin.instants.iter().map(|instant| (rounded(instant.time, 8), instant.touching)).collect(),
        }
    }
}

/// The history with at most [`MAX_SAMPLES`] samples, both ends among them.
///
/// A series that is shorter than the time stays as it is.
pub(super) fn thinned(history: &TimeHistory) -> TimeHistory {
    let n = history.time.len();
    if n <= MAX_SAMPLES {
        return history.clone();
    }
    let pick = |values: &Vec<f64>| -> Vec<f64> {
        let chosen = (0..MAX_SAMPLES).filter_map(|k| values.get(k * (n - 1) / (MAX_SAMPLES - 1)).copied());
        if values.len() == n { chosen.collect() } else { values.clone() }
    };
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
