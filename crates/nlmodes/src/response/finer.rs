//! Points of a curve solved again with more harmonics: what the harmonics left out do to them.

use std::collections::HashSet;
use std::time::{Duration, Instant};

use nlmodes_hbm::{PeriodicSystem, RealSeries, Refined, Source};
use nlmodes_modal::Event;

use crate::response::curve::Solved;
use crate::response::follow::{CONVERGED, Curve, HELD};
use crate::response::{ResponseError, ResponsePoint};

/// A point of a curve, and the motion with more harmonics next to it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FinerPoint {
    /// Number of the point in its curve.
    pub point: usize,
    /// The motion with more harmonics, at the same energy or level; of curves over the frequency on the line across the
    /// curve, where folds and peaks move in frequency as in amplitude. `None` where Newton's method finds none, or
    /// where it does not lead back from there to the point.
    pub found: Option<Box<ResponsePoint>>,
}

/// Which points of a curve are solved again with more harmonics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinerSettings {
    /// How many times as many harmonics. Default 2.
    pub factor: usize,
    /// Points that suffice: the largest motion, folds, the largest contact force, then others; twice as many are tried
    /// at most. Default 6.
    pub enough: usize,
    /// Wall time, over that of the curve, after which no further point is begun. Default 1.
    pub share_of_curve: f64,
    /// Wall time that is spent where that is less, s. Default 0.5.
    pub least_s: f64,
}

impl Default for FinerSettings {
    fn default() -> Self {
        Self { factor: 2, enough: 6, share_of_curve: 1.0, least_s: 0.5 }
    }
}

/// Numbers of harmonics in between where the step to the last is too far.
const STEPS: usize = 4;

/// Relative distance up to which two solutions of the same equations are one.
const SAME: f64 = 1e-5;

/// Evenly spaced points that are tried behind the chosen ones.
const OTHERS: usize = 8;

impl Curve<'_> {
    /// Points of the curve solved again with more harmonics; it took `time` to compute.
    pub fn finer(
        &mut self,
        points: &[ResponsePoint],
        settings: &FinerSettings,
        time: Duration,
    ) -> Result<Vec<FinerPoint>, ResponseError> {
        let budget = Duration::from_secs_f64(settings.least_s).max(time.mul_f64(settings.share_of_curve));
        let (began, mut all) = (Instant::now(), Vec::<FinerPoint>::new());
        let harmonics = self.system.settings().harmonics;
        let finest = settings.factor.max(1) * harmonics;
        let mut steps: Vec<usize> =
            (1..=STEPS).map(|k| harmonics + ((finest - harmonics) * k).div_ceil(STEPS)).collect();
        steps.dedup();
        for point in self.candidates(points) {
            let is_enough = all.iter().filter(|finer| finer.found.is_some()).count() >= settings.enough;
            let is_enough = is_enough || all.len() >= 2 * settings.enough;
            if is_enough || (!all.is_empty() && began.elapsed() > budget) || self.settings.watch.asks_to_end() {
                break;
            }
            let found = match self.over(points, point, &[finest])? {
                None if steps.len() > 1 => self.over(points, point, &steps)?,
                found => found,
            };
            all.push(FinerPoint { point, found: found.map(Box::new) });
        }
        Ok(all)
    }

    /// The points in the order in which they are solved again; those of linear motions, which have all their harmonics,
    /// are none of them.
    fn candidates(&self, points: &[ResponsePoint]) -> Vec<usize> {
        let has_laws = !self.system.structure().laws().is_empty();
        let switches = |point: &ResponsePoint| {
            let contacts = &point.motion.contacts;
            contacts.iter().any(|contact| contact.touches > 0 && contact.closed_share < 1.0)
        };
        let own: Vec<usize> = (0..points.len()).filter(|&k| has_laws || switches(&points[k])).collect();
        let largest = |of: &dyn Fn(&ResponsePoint) -> f64| {
            own.iter().copied().max_by(|&a, &b| of(&points[a]).total_cmp(&of(&points[b])))
        };
        let force = |point: &ResponsePoint| point.motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max);
        let motion = |point: &ResponsePoint| point.motion.kinetic_energy / point.omega.powi(2);
        let folds = own.iter().copied().filter(|&k| points[k].events.contains(&Event::Fold));
        let others = (0..=OTHERS).filter_map(|k| own.get(k * own.len().saturating_sub(1) / OTHERS).copied());
        let middle = own.get(own.len() / 2).copied();
        let mut all: Vec<usize> = largest(&motion).into_iter().chain(folds).chain(largest(&force)).collect();
        all.extend(own.last().copied().into_iter().chain(middle).chain(others));
        let mut known = HashSet::new();
        all.retain(|k| known.insert(*k));
        all
    }

    /// A point over these numbers of harmonics; `None` where one of them is not found, or does not lead back.
    fn over(
        &mut self,
        points: &[ResponsePoint],
        point: usize,
        steps: &[usize],
    ) -> Result<Option<ResponsePoint>, ResponseError> {
        let (own, series) = (&points[point].solved, self.system.series());
        let border = self.border(points, point);
        let (mut x, mut p, mut from) = (own.x.clone(), own.p, series);
        let mut last: Option<(PeriodicSystem, Refined)> = None;
        for &harmonics in steps {
            let mut finer = self.system.with_harmonics(harmonics, self.solver)?;
            let guess = finer.resized(&x, from);
            let n = border.len() - 1;
            let mut across = finer.resized(&border[..n], series);
            across.push(border[n]);
            finer.hold_phase(&guess);
            let found = finer.refine(&guess, p, &across);
            if found.residual.is_nan() || found.residual > CONVERGED {
                return Ok(None);
            }
            (x, p, from) = (found.x.clone(), found.p, finer.series());
            last = Some((finer, found));
        }
        let Some((mut finer, found)) = last.filter(|_| self.leads_back(own, (&x, p, from), &border)) else {
            return Ok(None);
        };
        self.motion(Some(&mut finer), found).map(Some)
    }

    /// Across what a point is solved again: along the curve it stays. Where the parameter is no frequency, it is held
    /// but near folds.
    fn border(&self, points: &[ResponsePoint], point: usize) -> Vec<f64> {
        let [before, behind] = [point.saturating_sub(1), (point + 1).min(points.len() - 1)].map(|k| &points[k].solved);
        let mut along: Vec<f64> = behind.x.iter().zip(&before.x).map(|(a, b)| a - b).collect();
        along.push(behind.p - before.p);
        let length = along.iter().map(|v| v * v).sum::<f64>().sqrt();
        let n = along.len() - 1;
        let is_frequency = matches!(self.system.closing().omega, Source::Parameter { .. });
        if length == 0.0 || (!is_frequency && along[n].abs() > HELD * length) {
            return (0..=n).map(|j| f64::from(u8::from(j == n))).collect();
        }
        along.iter().map(|v| v / length).collect()
    }

    /// Whether Newton's method leads from a motion with more harmonics, on the same line, to the point.
    fn leads_back(&mut self, own: &Solved, (x, p, from): (&[f64], f64, RealSeries), border: &[f64]) -> bool {
        let guess = self.system.resized(x, from);
        self.system.hold_phase(&own.x);
        let back = self.system.refine(&guess, p, border);
        let size = |of: &mut dyn Iterator<Item = f64>| of.map(|v| v * v).sum::<f64>().sqrt();
        let off = size(&mut back.x.iter().zip(&own.x).map(|(a, b)| a - b));
        back.residual <= CONVERGED && off <= SAME * size(&mut own.x.iter().copied())
    }
}
