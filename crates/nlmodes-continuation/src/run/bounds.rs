//! Where a branch ends within a step: on a bound, or where it began.

use std::ops::ControlFlow;

use super::Run;
use crate::corrector::{Correction, Hyperplane, Surface};
use crate::events::{Root, Search};
use crate::step::reach;
use crate::vectors::{distance, dot};
use crate::{Bound, Refusal, StopReason};

/// Share of a step by which the point on a bound may lie off the branch that was followed to the bound.
const OFF_BRANCH: f64 = 0.3;

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// The first bound that the step to `end` crosses, and the point of the branch on it.
    ///
    /// # Errors
    /// If that point is not found: the step must not be taken.
    pub(super) fn bound_crossed(
        &mut self,
        end: &Correction,
        h: f64,
    ) -> Result<Option<(StopReason, Correction)>, Refusal> {
        let mut first = match self.bound_ahead(&end.z) {
            Some((coordinate, value)) => Some(self.on_bound(coordinate, value, end, h)?),
            None => None,
        };
        for bound in &self.settings.bounds {
            let end = first.as_ref().map_or(end, |(_, last)| last);
            let length = dot(&end.z, &self.base.tangent) - dot(&self.base.z, &self.base.tangent);
            if !may_peak_beyond(bound, &self.base.z, &self.base.tangent, end) {
                continue;
            }
            let sense = -end.tangent[bound.coordinate].signum();
            let base = &self.base;
            let mut search = Search { system: self.system, corrector: &mut self.corrector, base, end, h: length };
            let Root { s, point, .. } = search.root(|c| sense * c.tangent[bound.coordinate]);
            if let Some(value) = bound.passed_by(point.z[bound.coordinate]) {
                first = Some(self.on_bound(bound.coordinate, value, &point, s)?);
            }
        }
        Ok(first)
    }

    /// The bound that a chord from the base point passes first.
    fn bound_ahead(&self, to: &[f64]) -> Option<(usize, f64)> {
        let crossed = self.settings.bounds.iter().filter_map(|b| {
            let (from, to) = (self.base.z[b.coordinate], to[b.coordinate]);
            let value = b.passed_by(to)?;
            Some((((value - from) / (to - from)).clamp(0.0, 1.0), b.coordinate, value))
        });
        crossed.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, coordinate, value)| (coordinate, value))
    }

    /// The point on a bound beyond which `end` lies, at the distance `h` along the tangent of the base point.
    fn on_bound(
        &mut self,
        coordinate: usize,
        value: f64,
        end: &Correction,
        h: f64,
    ) -> Result<(StopReason, Correction), Refusal> {
        let before = (value - self.base.z[coordinate]).signum();
        // From a guess off the branch, Newton's method could find another half-branch on the bound.
        let mut search = Search { system: self.system, corrector: &mut self.corrector, base: &self.base, end, h };
        let guess = search.root(|c| before * (value - c.z[coordinate])).point.z;
        let last = self.on_plane(&guess, Hyperplane::fixing(coordinate, value, guess.len()), end);
        let last = last.filter(|last| distance(&last.z, &guess) <= OFF_BRANCH * distance(&end.z, &self.base.z));
        let mut last = last.ok_or(Refusal::BoundNotLocated { coordinate, value })?;
        // But for rounding it is there.
        last.z[coordinate] = value;
        Ok((StopReason::Bound { coordinate, value }, last))
    }

    /// Keeps the point on a bound between the base point and the first point beyond a kink or a branch point, and says
    /// why the branch ends; `None` if there is no bound in between.
    pub(super) fn bound_before(&mut self, next: &Correction) -> Option<ControlFlow<StopReason, StopReason>> {
        let (coordinate, value) = self.bound_ahead(&next.z)?;
        let (from, to) = (self.base.z[coordinate], next.z[coordinate]);
        let share = (value - from) / (to - from);
        let guess: Vec<f64> = self.base.z.iter().zip(&next.z).map(|(a, b)| a + share * (b - a)).collect();
        let length = distance(&next.z, &self.base.z);
        let last = self.on_plane(&guess, Hyperplane::fixing(coordinate, value, guess.len()), next);
        let Some(last) = last.filter(|last| distance(&last.z, &guess) <= length) else {
            let refusal = Refusal::BoundNotLocated { coordinate, value };
            return Some(ControlFlow::Continue(StopReason::StepTooSmall { step: length, refusal }));
        };
        Some(match self.go_to(&last, Vec::new()) {
            ControlFlow::Break(stop) => ControlFlow::Break(stop),
            ControlFlow::Continue(()) => ControlFlow::Continue(StopReason::Bound { coordinate, value }),
        })
    }

    /// The start, if the step to `end` passes it in the direction in which the branch left it.
    ///
    /// # Errors
    /// If the step passes the start and it is not known whether on the branch itself.
    pub(super) fn closing_point(&mut self, end: &Correction, h: f64) -> Result<Option<Correction>, Refusal> {
        let Some(first) = self.branch.points.first() else { return Ok(None) };
        let (z, tangent) = (first.z(), first.tangent.clone());
        let ahead = |at: &[f64]| dot(at, &tangent) - dot(&z, &tangent);
        let passes = ahead(&self.base.z) < 0.0 && ahead(&end.z) >= 0.0 && distance(&end.z, &z) < 2.0 * h;
        if !passes || dot(&end.tangent, &tangent) < 0.5 {
            return Ok(None);
        }
        let last = self.on_plane(&z, Hyperplane::through(&z, &tangent), end).ok_or(Refusal::StartNotLocated)?;
        let gap = distance(&last.z, &self.base.z) - distance(&z, &self.base.z);
        let is_start = distance(&last.z, &z) < 1e-6 && gap.abs() < 1e-6 && self.leads_to(&last);
        Ok(is_start.then_some(last))
    }

    /// Whether the branch itself, corrected across its own tangent, goes through this point of the step.
    fn leads_to(&mut self, c: &Correction) -> bool {
        let s = dot(&c.z, &self.base.tangent) - dot(&self.base.z, &self.base.tangent);
        let reached = reach(self.system, &mut self.corrector, &self.base, s);
        reached.is_ok_and(|r| distance(&r.z, &c.z) < 1e-6)
    }

    /// The solution on a plane between the base point and `end`, with its tangent in the direction of travel.
    fn on_plane(&mut self, guess: &[f64], plane: Hyperplane, end: &Correction) -> Option<Correction> {
        let mut last = self.corrector.correct(self.system, guess, &Surface::Plane(plane)).ok()?;
        if dot(&last.tangent, &end.tangent) < 0.0 {
            last.tangent.iter_mut().for_each(|t| *t = -*t);
            last.orientation = -last.orientation;
        }
        Some(last)
    }
}

/// Whether a coordinate that is within its bounds at both ends of a step may have been beyond them in between: where it
/// turns, and its two tangents meet beyond.
fn may_peak_beyond(bound: &Bound, from: &[f64], along: &[f64], end: &Correction) -> bool {
    let i = bound.coordinate;
    let (a, b) = (along[i], end.tangent[i]);
    if a * b >= 0.0 || bound.passed_by(from[i]).is_some() || bound.passed_by(end.z[i]).is_some() {
        return false;
    }
    // from + a s = end − b (h − s)
    let h = distance(from, &end.z);
    let s = ((end.z[i] - from[i] - b * h) / (a - b)).clamp(0.0, h);
    bound.passed_by(from[i] + a * s).is_some()
}
