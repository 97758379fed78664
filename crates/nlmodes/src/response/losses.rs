//! Where responses lose their stability.

use nlmodes_continuation::{Branch, BranchPoint};
use nlmodes_modal::Event;

use crate::response::follow::{CONVERGED, Curve};
use crate::response::{ResponseError, ResponsePoint, Stability};

/// Most steps, and the distance from the unit circle, with which a loss of stability is located.
const LOCATING: usize = 25;
const LOCATED: f64 = 1e-9;

/// A point at which a multiplier passes the unit circle, with the name of that.
fn named(mut point: ResponsePoint) -> ResponsePoint {
    let event = point.stability.and_then(|s| s.loss());
    point.events.extend(event);
    point
}

fn is_oscillating(point: &ResponsePoint) -> bool {
    point.stability.is_some_and(|s| s.magnitude() > 1.0 && s.loss().is_some())
}

impl Curve<'_> {
    /// Puts a point where stability is lost or won by anything but a fold, so that it can be named there.
    pub fn locate_losses(
        &mut self,
        branch: &Branch,
        points: Vec<ResponsePoint>,
    ) -> Result<Vec<ResponsePoint>, ResponseError> {
        let beyond = |p: &ResponsePoint| p.stability.map(|s| s.magnitude() - 1.0);
        let mut located: Vec<ResponsePoint> = Vec::with_capacity(points.len());
        for (i, point) in points.into_iter().enumerate() {
            let pair = i.checked_sub(1).map(|before| (&branch.points[before], &branch.points[i]));
            let values = located.last().and_then(beyond).zip(beyond(&point));
            if let (Some((a, b)), Some((from, to))) = (pair, values)
                && from * to < 0.0
                && [located.last(), Some(&point)].into_iter().flatten().any(is_oscillating)
            {
                located.extend(self.loss_between(a, b, [from, to])?.map(named));
            }
            located.push(point);
        }
        Ok(located)
    }

    /// The point between two neighbours at which the largest multiplier passes the unit circle.
    fn loss_between(
        &mut self,
        a: &BranchPoint,
        b: &BranchPoint,
        values: [f64; 2],
    ) -> Result<Option<ResponsePoint>, ResponseError> {
        let (from, to) = (a.z(), b.z());
        let step: Vec<f64> = from.iter().zip(&to).map(|(a, b)| b - a).collect();
        let length = step.iter().map(|s| s * s).sum::<f64>().sqrt();
        let (mut low, mut high) = ((0.0, values[0]), (1.0, values[1]));
        let mut found: Option<ResponsePoint> = None;
        for _ in 0..LOCATING {
            // Halves and secants in turn: multipliers have slopes like square roots where a contact grazes.
            let secant = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let half = 0.5 * (low.0 + high.0);
            let share = if found.is_some() && secant.is_finite() { secant.clamp(low.0, high.0) } else { half };
            let x = from.iter().zip(&step).take(a.x.len()).map(|(z, s)| z + share * s).collect();
            let p = from[a.x.len()] + share * step[a.x.len()];
            let along = step.iter().map(|s| s / length).collect();
            let point = self.point(&BranchPoint::guess(x, p, along))?;
            let Some(value) = point.stability.map(|s| s.magnitude() - 1.0) else { break };
            if point.residual > CONVERGED {
                break;
            }
            if value * low.1 < 0.0 {
                high = (share, value)
            } else {
                low = (share, value)
            }
            found = Some(point);
            if value.abs() < LOCATED {
                break;
            }
        }
        Ok(found.filter(|point| point.stability.is_some_and(|s| (s.magnitude() - 1.0).abs() < 1e-3)))
    }
}

/// Names the losses of stability that no fold explains and that were not located, as where multipliers jump at a
/// corner: at the first or last unstable point.
pub(crate) fn name_lost_stability(points: &mut [ResponsePoint]) {
    let mut last: Option<(usize, Stability)> = None;
    for i in 0..points.len() {
        let Some(now) = points[i].stability.filter(|s| s.stable.is_some()) else { continue };
        if let Some((before, was)) = last.filter(|(_, was)| was.stable != now.stable) {
            let (place, unstable) = if now.stable == Some(false) { (i, now) } else { (before, was) };
            let is_named = points[before..=i].iter().any(|point| point.events.iter().any(is_loss));
            points[place].events.extend(unstable.loss().filter(|_| !is_named));
        }
        last = Some((i, now));
    }
}

/// Whether an event is a loss of stability without a fold.
pub(crate) fn is_loss(event: &Event) -> bool {
    matches!(event, Event::PeriodDoubling | Event::NeimarkSacker)
}
