//! Segments of a branch that miss an accuracy.

use nlmodes_modal::ModalPoint;

/// Points in a row whose estimate is larger than what was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BeyondAccuracy {
    /// Index of the first and of the last one.
    pub points: [usize; 2],
    /// Lowest and highest angular frequency among them, rad/s.
    pub frequency: [f64; 2],
    /// Largest estimate among them.
    pub largest_estimate: f64,
}

/// The segments of a branch beyond an accuracy. Points without an estimate are between two others part of a segment,
/// but do not make one.
pub(super) fn beyond(points: &[ModalPoint], error: f64) -> Vec<BeyondAccuracy> {
    let mut all: Vec<BeyondAccuracy> = Vec::new();
    let mut open = false;
    for (k, point) in points.iter().enumerate() {
        let Some(estimate) = point.error_estimate else { continue };
        if estimate <= error {
            open = false;
            continue;
        }
        let omega = point.omega;
        match all.last_mut().filter(|_| open) {
            Some(last) => {
                last.points[1] = k;
                last.frequency = [last.frequency[0].min(omega), last.frequency[1].max(omega)];
                last.largest_estimate = last.largest_estimate.max(estimate);
            }
            None => all.push(BeyondAccuracy { points: [k, k], frequency: [omega; 2], largest_estimate: estimate }),
        }
        open = true;
    }
    all
}
