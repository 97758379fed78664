//! Points of a response solved again with more harmonics: what the harmonics left out do to them.

use std::time::Duration;

use nlmodes_hbm::{PeriodicSystem, RealSeries, Refined, Source};
use nlmodes_modal::Event;

use crate::finer::FinerSettings;
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

impl Curve<'_> {
    /// Points of the curve solved again with more harmonics; it took `time` to compute.
    pub fn finer(
        &mut self,
        points: &[ResponsePoint],
        settings: &FinerSettings,
        time: Duration,
    ) -> Result<Vec<FinerPoint>, ResponseError> {
        let own = self.system.settings().harmonics;
        let to = settings.factor.max(1) * own;
        let order = self.candidates(points, settings);
        let watch = self.settings.watch.clone();
        let found = settings.each(&order, (time, &watch), |point| {
            settings.reach([own, to], |steps| self.over(points, point, steps, settings))
        })?;
        Ok(found.into_iter().map(|(point, found)| FinerPoint { point, found: found.map(Box::new) }).collect())
    }

    /// The points in the order in which they are solved again; those of linear motions, which have all their harmonics,
    /// are none of them.
    fn candidates(&self, points: &[ResponsePoint], settings: &FinerSettings) -> Vec<usize> {
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
        let amplitude = |point: &ResponsePoint| point.watched;
        let folds = own.iter().copied().filter(|&k| points[k].events.contains(&Event::Fold));
        let middle = own.get(own.len() / 2).copied();
        let chosen = largest(&motion).into_iter().chain(folds).chain(largest(&force)).chain(largest(&amplitude));
        settings.order(chosen.chain(own.last().copied()).chain(middle), &own)
    }

    /// A point over these numbers of harmonics; `None` where one of them is not found, or does not lead back.
    fn over(
        &mut self,
        points: &[ResponsePoint],
        point: usize,
        steps: &[usize],
        settings: &FinerSettings,
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
        let Some((mut finer, found)) = last.filter(|_| self.leads_back(own, (&x, p, from), &border, settings)) else {
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
    fn leads_back(
        &mut self,
        own: &Solved,
        (x, p, from): (&[f64], f64, RealSeries),
        border: &[f64],
        settings: &FinerSettings,
    ) -> bool {
        let guess = self.system.resized(x, from);
        self.system.hold_phase(&own.x);
        let back = self.system.refine(&guess, p, border);
        back.residual <= CONVERGED && settings.is_same(&back.x, &own.x)
    }
}
