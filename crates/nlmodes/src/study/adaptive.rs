//! A branch along which the number of harmonics follows an error estimate.

use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, BranchPoint, EventKind, ParametricSystem, StopReason};
use nlmodes_hbm::{RealSeries, TruncationError};

use super::accuracy::{Control, Decision};
use super::prepare::continuation;
use super::start::{Seed, one_point};
use super::trace::{First, Found, Shown, Tracer, Viewer};
use super::{StudyError, homotopy};

/// Event of the first point with another number of harmonics; it lies where the one before it lies.
pub(super) const HARMONICS: &str = "harmonics";

/// Event of a point with another number of harmonics of which it could not be shown that the branch is the same.
pub(super) const UNPROVEN: &str = "harmonics-unproven";

/// Event of the first point from which on the most harmonics do not reach the accuracy.
pub(super) const LIMIT: &str = "accuracy-limit";

/// Smallest cosine between the tangents with the old and the new number of harmonics.
const SAME_WAY: f64 = 0.9;

/// Harmonics beyond those wanted, and distances ahead along the tangent, with which a start is tried.
const FURTHER: [usize; 2] = [0, 1];
const AHEAD: [f64; 3] = [0.0, 1e-3, 1e-2];

/// Points that are gone back where none is found.
const BACK: [usize; 4] = [1, 3, 6, 10];

/// Largest change of the unknowns with the number of harmonics; a solution further away is another one.
const NEAR: f64 = 0.1;

/// Share of the energy in the tangent above which the energy is kept when the number of harmonics changes.
const ENERGY_CHANGES: f64 = 0.05;

/// Points that wait to be shown until one without events behind them counts, and where the branch goes on if none does.
struct Stretch {
    /// The last point without events that counts, and the layout of its unknowns.
    base: Option<(BranchPoint, RealSeries)>,
    base_is_shown: bool,
    /// Whether its error is as small as was asked for: then the branch with more harmonics is near.
    base_is_accurate: bool,
    waiting: Vec<(BranchPoint, Option<TruncationError>, Vec<String>)>,
    /// Events of the first point of the next run.
    first: Vec<String>,
    /// Points without events that were shown with this accuracy, each with the number of points shown by then.
    passed: Vec<(BranchPoint, RealSeries, usize)>,
    /// The first point of the next run is known and is not kept.
    known: bool,
    at_limit: bool,
}

impl Tracer<'_> {
    /// [`Tracer::trace`] with as many harmonics as the accuracy takes.
    ///
    /// A point whose estimate is too large does not count: the branch goes back to the last one without events, whose estimate is
    /// not, so that the branch with more harmonics is near, and goes on from there with more. The energy is kept. The
    /// new tangent points to the same side as the old one by the way in which it is computed, and is compared with it.
    pub(super) fn trace_accurately(
        &mut self,
        control: &mut Control,
        seed: &Seed,
        bound: Option<Bound>,
        first: First,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), StudyError> {
        let mut found = Found::new(&First::Plain);
        if self.too_few_modes {
            return Ok((found, StopReason::Stopped));
        }
        let mut stretch = Stretch {
            base: None,
            base_is_shown: matches!(first, First::Known),
            base_is_accurate: true,
            waiting: Vec::new(),
            passed: Vec::new(),
            first: if let First::Named(name) = first { vec![name.to_owned()] } else { Vec::new() },
            known: matches!(first, First::Known),
            at_limit: false,
        };
        let mut from = seed.clone();
        self.set_harmonics(from.harmonics)?;
        control.changed(from.harmonics);
        loop {
            let (stop, change) = self.run(control, &from, bound, &mut stretch, &mut found, each)?;
            let Some(harmonics) = change else { return Ok((found, stop)) };
            let Some((base, series)) = stretch.base.clone() else { return Ok((found, stop)) };
            match self.carried_over(&base, series, harmonics)? {
                Some(seed) => {
                    if stretch.base_is_shown {
                        (stretch.first, stretch.known) = (vec![HARMONICS.to_owned()], false);
                        found.changes += 1;
                    }
                    control.changed(seed.harmonics);
                    from = seed;
                }
                None => {
                    if let Some(seed) = self.from_further_back(&mut stretch, &mut found, series, harmonics)? {
                        if each(Shown::Withdrawn(found.points.len())).is_break() {
                            return Ok((found, StopReason::Stopped));
                        }
                        control.changed(seed.harmonics);
                        control.pause();
                        from = seed;
                        continue;
                    }
                    if stretch.base_is_shown {
                        (stretch.first, stretch.known) = (Vec::new(), true);
                    }
                    let harmonics = series.n_harmonics;
                    self.set_harmonics(harmonics)?;
                    control.changed(harmonics);
                    control.stay();
                    from = Seed { x: base.x, p: base.p, direction: base.tangent, harmonics };
                }
            }
        }
    }

    /// One run with the same number of harmonics, and that with which it is to go on.
    fn run(
        &mut self,
        control: &mut Control,
        from: &Seed,
        bound: Option<Bound>,
        stretch: &mut Stretch,
        found: &mut Found,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(StopReason, Option<usize>), StudyError> {
        let mut method = continuation(&self.settings, self.grazing, self.problem.frequency_index(), self.problem.dim());
        method.bounds.extend(bound);
        stretch.waiting.clear();
        found.begin();
        let (mut change, mut is_first) = (None, true);
        let (Some(estimator), Some(problem)) = (self.estimator.as_mut(), self.problem.harmonics()) else {
            return Ok((StopReason::Stopped, None));
        };
        let (viewer, too_few_modes, series) = (&mut self.viewer, &mut self.too_few_modes, problem.series());
        let branch = method.run(&mut self.problem, &from.x, from.p, &from.direction, |point| {
            let singular = point.events.iter().any(|e| matches!(e, EventKind::BranchPoint | EventKind::Kink));
            let error = (!singular).then(|| estimator.estimate(&point.x, point.p, &point.tangent));
            let mut names = Vec::new();
            if std::mem::take(&mut is_first) {
                names.clone_from(&stretch.first);
                let proven = stretch.base_is_accurate && same_way(&point.tangent, &from.direction);
                if names.iter().any(|n| n == HARMONICS) && !proven {
                    names.push(UNPROVEN.to_owned());
                }
            }
            let Some(error) = error.filter(|_| point.events.is_empty()) else {
                stretch.waiting.push((point.clone(), error, names));
                return ControlFlow::Continue(());
            };
            let decision = control.decide(&error);
            match decision {
                Decision::Modes => {
                    *too_few_modes = true;
                    return ControlFlow::Break(());
                }
                Decision::More(harmonics) => {
                    if stretch.base.is_none() {
                        stretch.base = Some((point.clone(), series));
                    }
                    change = Some(harmonics);
                    return ControlFlow::Break(());
                }
                Decision::Limit => {
                    if !std::mem::replace(&mut stretch.at_limit, true) {
                        names.push(LIMIT.to_owned());
                    }
                }
                Decision::Keep | Decision::Fewer(_) => stretch.at_limit = false,
            }
            let begins = stretch.waiting.is_empty() && found.is_at_start();
            stretch.waiting.push((point.clone(), Some(error), names));
            stretch.base = Some((point.clone(), series));
            stretch.base_is_accurate = !matches!(decision, Decision::Limit);
            if begins {
                // It is shown when it is sure that the branch goes on with this number of harmonics.
                stretch.base_is_shown = stretch.known;
                found.leave_start(point);
                return ControlFlow::Continue(());
            }
            stretch.base_is_shown = true;
            show(stretch, found, viewer, each)?;
            if stretch.base_is_accurate {
                stretch.passed.push((point.clone(), series, found.points.len()));
            }
            if let Decision::Fewer(harmonics) = decision {
                change = Some(harmonics);
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })?;
        found.count(&branch);
        if change.is_none() && !self.too_few_modes {
            let _ = show(stretch, found, viewer, each);
        }
        Ok((branch.stop, change))
    }

    /// The beginning with more harmonics some points earlier, where the branches are nearer; the points since then are taken back.
    fn from_further_back(
        &mut self,
        stretch: &mut Stretch,
        found: &mut Found,
        series: RealSeries,
        harmonics: usize,
    ) -> Result<Option<Seed>, StudyError> {
        if harmonics <= series.n_harmonics {
            return Ok(None);
        }
        for back in BACK {
            let Some(index) = stretch.passed.len().checked_sub(back + 1) else { return Ok(None) };
            let (base, series, kept) = stretch.passed[index].clone();
            if let Some(seed) = self.carried_over(&base, series, harmonics)? {
                found.truncate(kept);
                found.changes += 1;
                stretch.passed.truncate(index + 1);
                (stretch.base, stretch.base_is_shown, stretch.base_is_accurate) = (Some((base, series)), true, true);
                (stretch.first, stretch.known) = (vec![HARMONICS.to_owned()], false);
                return Ok(Some(seed));
            }
        }
        Ok(None)
    }

    /// The beginning at `base` with so many harmonics or a few more, or, where a contact is about to open or close there, a little
    /// ahead of it; `None` where Newton's method finds none.
    fn carried_over(
        &mut self,
        base: &BranchPoint,
        series: RealSeries,
        harmonics: usize,
    ) -> Result<Option<Seed>, StudyError> {
        let most = self.settings.accuracy.map_or(usize::MAX, |accuracy| accuracy.max_harmonics);
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
                let found = one_point(&self.settings, self.grazing, &mut self.problem, &z, across)
                    .or_else(|| homotopy::solve(&mut self.problem, &z, coordinate, &self.settings.step));
                let near = |x: &[f64], p: f64| {
                    let moved = x.iter().chain([&p]).zip(&z).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                    moved.sqrt() < NEAR
                };
                if let Some((x, p)) = found.filter(|(x, p)| near(x, *p)) {
                    return Ok(Some(Seed { x, p, direction: direction.clone(), harmonics }));
                }
            }
        }
        Ok(None)
    }
}

/// Shows the points that wait.
fn show(
    stretch: &mut Stretch,
    found: &mut Found,
    viewer: &mut Viewer,
    each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
) -> ControlFlow<()> {
    for (point, error, names) in stretch.waiting.drain(..) {
        if std::mem::take(&mut stretch.known) {
            continue;
        }
        found.keep_named(viewer, &point, names, error).iter().map(Shown::Point).try_for_each(&mut *each)?;
    }
    ControlFlow::Continue(())
}

fn same_way(tangent: &[f64], direction: &[f64]) -> bool {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    dot(tangent, direction) > SAME_WAY * dot(direction, direction).sqrt()
}
