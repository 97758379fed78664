//! A solution with one number of harmonics taken over by another, where that is shown to be on the same branch.

use std::ops::ControlFlow;

use nlmodes_continuation::BranchPoint;
use nlmodes_hbm::RealSeries;

use super::stretch::Base;
use crate::branches::BranchError;
use crate::branches::found::Found;
use crate::branches::homotopy::{self, Effort};
use crate::branches::stability::length;
use crate::branches::start::{Seed, one_point};
use crate::branches::trace::Tracer;

/// Smallest cosine between the tangents with the old and the new number of harmonics.
const SAME_WAY: f64 = 0.9;

/// Harmonics beyond those wanted, and distances ahead along the tangent, with which a start is tried.
const FURTHER: [usize; 2] = [0, 1];
const AHEAD: [f64; 3] = [0.0, 1e-3, 1e-2];

/// Largest change of the unknowns with the number of harmonics, whatever the estimate says; a solution further away is
/// another one.
const NEAR: f64 = 0.1;

/// Largest change over the estimated one, and the smallest estimate that counts.
const OFF: f64 = 2.0;
const RESOLVED: f64 = 1e-7;

/// Distance over the estimated error below which points cannot be distinguished, and how far a branch is off the chord
/// between two points, over their distance.
pub(super) const LIKE: f64 = 4.0;
const STRAIGHT: f64 = 0.1;

/// Share of the energy in the tangent above which the energy is kept when the number of harmonics changes.
const ENERGY_CHANGES: f64 = 0.05;

impl Tracer<'_> {
    /// The beginning at `base` with so many harmonics or a few more, or, where a contact is about to open or close
    /// there, a little ahead of it; `None` where Newton's method finds none.
    pub(super) fn carried_over(
        &mut self,
        earlier: &Found,
        frequency: Option<[f64; 2]>,
        Base { point: base, series, .. }: &Base,
        harmonics: usize,
        deform: bool,
    ) -> Result<Option<Seed>, BranchError> {
        let series = *series;
        let most = self.settings.accuracy.map_or(usize::MAX, |accuracy| accuracy.max_harmonics);
        self.set_harmonics(series.n_harmonics)?;
        let own = self.estimator.as_mut().map(|own| own.estimate(&base.x, base.p, &base.tangent).motion);
        let expected = own.unwrap_or(f64::INFINITY).max(RESOLVED);
        let tries = AHEAD.into_iter().flat_map(|ahead| FURTHER.map(|more| ((harmonics + more).min(most), ahead)));
        for (harmonics, ahead) in tries {
            self.set_harmonics(harmonics)?;
            let z: Vec<f64> = base.z().iter().zip(&base.tangent).map(|(z, t)| z + ahead * t).collect();
            let Some(problem) = self.problem.harmonics() else { return Ok(None) };
            let (z, direction) = (problem.resized(&z, series), problem.resized(&base.tangent, series));
            let mut energy = vec![0.0; direction.len()];
            let last = direction.len() - 1;
            energy[last] = direction[last].signum();
            let keeps_energy = direction[last].abs() > ENERGY_CHANGES;
            for across in [Some(&energy).filter(|_| keeps_energy), Some(&direction)].into_iter().flatten() {
                let coordinate = if std::ptr::eq(across, &energy) { last } else { self.problem.frequency_index() };
                let found =
                    one_point(&self.settings, self.grazing, &mut self.problem, &z, across, self.log).or_else(|| {
                        if !deform || ahead > 0.0 {
                            return None;
                        }
                        let step = &self.settings.step;
                        homotopy::solve(&mut self.problem, &z, coordinate, step, Effort::LITTLE, self.log)
                    });
                let near = |x: &[f64], p: f64| {
                    let moved = x.iter().chain([&p]).zip(&z).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                    moved.sqrt() < NEAR
                };
                let Some((x, p)) = found.filter(|(x, p)| near(x, *p)) else { continue };
                let seed = Seed { x, p, direction: direction.clone(), harmonics };
                if self.is_same(&seed, frequency, &z, expected, earlier)? {
                    return Ok(Some(seed));
                }
            }
        }
        Ok(None)
    }

    /// Whether a solution with more harmonics than the guess `z` is shown to be on the same branch, within these limits
    /// of the frequency: its tangent points the same way, and it lies no further off than the estimate with the fewer
    /// harmonics says, `expected` over the unknowns. Next to an internal-resonance branch that only one of them knows
    /// neither holds.
    fn is_same(
        &mut self,
        seed: &Seed,
        frequency: Option<[f64; 2]>,
        z: &[f64],
        expected: f64,
        earlier: &Found,
    ) -> Result<bool, BranchError> {
        let mut method = self.within(frequency);
        method.max_points = 1;
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let run = method.run_with_log(problem, &seed.x, seed.p, &seed.direction, log, |_| ControlFlow::Continue(()));
        let Some(point) = run.ok().and_then(|run| run.points.into_iter().next()) else { return Ok(false) };
        if !same_way(&point.tangent, &seed.direction) {
            return Ok(false);
        }
        let moved = point.z().iter().zip(z).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        let expected = expected * length(&point.x);
        let Some(problem) = self.problem.harmonics() else { return Ok(false) };
        let place =
            Place { series: problem.series(), contacts: self.structure.n_contact_dofs(), energy: self.grazing.energy };
        Ok(moved <= OFF * expected && !place.passed_before(&point, LIKE * expected, earlier, usize::MAX))
    }
}

/// The unknowns of a number of harmonics.
pub(super) struct Place {
    pub series: RealSeries,
    /// Contact coordinates.
    pub contacts: usize,
    /// At grazing, J.
    pub energy: f64,
}

impl Place {
    /// Unknowns with another number of harmonics, as these.
    fn resized(&self, x: &[f64], from: RealSeries) -> Vec<f64> {
        let (n, width) = (self.contacts, from.width());
        let coefficients = (0..n).flat_map(|d| from.resized(&x[d * width..(d + 1) * width], self.series));
        coefficients.chain(x[n * width..].iter().copied()).collect()
    }

    /// Whether the branch has passed here before among its first `count` points, the other way, for all that can be
    /// reported with this error: on the far side of an internal-resonance branch that only the fewer harmonics have,
    /// other ones have but the branch beside it, and lead back along that.
    pub fn passed_before(&self, at: &BranchPoint, error: f64, earlier: &Found, count: usize) -> bool {
        let rises = at.tangent.last().is_some_and(|t| *t > 0.0);
        let energy = |k: usize| (earlier.points[k].kinetic_energy / self.energy).ln();
        let harmonics = |k: usize| earlier.points[k].coefficients.n_harmonics();
        (1..earlier.points.len().min(count)).filter(|&k| harmonics(k) == harmonics(k - 1)).any(|k| {
            let (from, to) = (energy(k - 1), energy(k));
            if (to > from) == rises || !(from.min(to)..=from.max(to)).contains(&at.p) {
                return false;
            }
            let share = if to == from { 0.5 } else { (at.p - from) / (to - from) };
            let (a, b) = (&earlier.unknowns[k - 1], &earlier.unknowns[k]);
            let between: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
            let series = RealSeries { n_harmonics: harmonics(k), ..self.series };
            let between = self.resized(&between, series);
            distance(&between, &at.x) < error + STRAIGHT * distance(a, b)
        })
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

pub(super) fn same_way(tangent: &[f64], direction: &[f64]) -> bool {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    dot(tangent, direction) > SAME_WAY * dot(direction, direction).sqrt()
}
