//! A branch along which the number of harmonics grows with an error estimate.
//!
//! It is a chain of runs with one number of harmonics each. A point whose estimate is too large does not count: the
//! branch goes on from the last one that does, with more harmonics at the same energy, or where that finds none from
//! one of some points before it. Every change asks for more than any before it, whether it is found or not: so there
//! are at most as many as the scene permits harmonics.

mod control;

use std::ops::ControlFlow;

use nlmodes_continuation::{BranchPoint, EventKind, ParametricSystem, StopReason};
use nlmodes_hbm::{RealSeries, TruncationError};
use nlmodes_modal::Event;

pub(super) use self::control::Control;
use self::control::Decision;
use super::found::{First, Found};
use super::homotopy::{self, Effort};
use super::refined::at_energy;
use super::stability::length;
use super::start::Seed;
use super::trace::Tracer;
use super::{BranchError, BranchProgress};

/// A point without events that counts, from which the branch may go on with another number of harmonics.
#[derive(Clone)]
struct Base {
    point: BranchPoint,
    /// The layout of its unknowns.
    series: RealSeries,
    /// Whether its error is as small as was asked for: then the branch with more harmonics is near.
    is_accurate: bool,
    is_shown: bool,
    /// Points that were shown up to it.
    shown: usize,
}

/// What runs with one number of harmonics leave to the next one.
#[derive(Default)]
struct Chain {
    /// The last point without events that counts.
    base: Option<Base>,
    /// Points that wait to be shown until one without events behind them counts.
    waiting: Vec<(BranchPoint, Option<TruncationError>, Vec<Event>)>,
    /// Events of the first point of the next run.
    first: Vec<Event>,
    /// The first point of the next run is known and is not kept.
    known: bool,
    at_limit: bool,
    /// Points that were shown with the accuracy.
    accurate: Vec<Base>,
}

impl Tracer<'_> {
    /// [`Tracer::trace`] with as many harmonics as the accuracy takes.
    pub(super) fn trace_accurately(
        &mut self,
        mut control: Control,
        seed: &Seed,
        frequency: Option<[f64; 2]>,
        first: First,
        each: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), BranchError> {
        let mut found = Found::new(&First::Plain);
        if self.too_few_modes {
            return Ok((found, StopReason::Stopped));
        }
        let (first, known) = match first {
            First::Named(event) => (vec![event], false),
            First::Known => (Vec::new(), true),
            First::Plain => (Vec::new(), false),
        };
        let mut chain = Chain { first, known, ..Chain::default() };
        let mut from = seed.clone();
        self.set_harmonics(from.harmonics)?;
        control.changed(from.harmonics);
        loop {
            let outcome = self.run(&mut control, &from, frequency, &mut chain, &mut found, each);
            if self.settings.watch.has_ended() && !found.points.is_empty() {
                return Ok((found, StopReason::Stopped));
            }
            let (stop, change) = outcome?;
            from = match change {
                None => return Ok((found, stop)),
                Some((last, harmonics)) => {
                    let earlier = self
                        .settings
                        .growth
                        .back
                        .into_iter()
                        .filter_map(|back| chain.accurate.len().checked_sub(back + 1));
                    let bases: Vec<Base> =
                        std::iter::once(&last).chain(earlier.map(|k| &chain.accurate[k])).cloned().collect();
                    let mut tries = bases.into_iter().map(|base| {
                        let seed = self.with_more(&base, frequency, harmonics)?;
                        Ok::<_, BranchError>(seed.map(|seed| (base, seed)))
                    });
                    match tries.find_map(Result::transpose).transpose()? {
                        Some((base, seed)) => {
                            if base.is_shown {
                                (chain.first, chain.known) = (vec![Event::Harmonics], false);
                            }
                            if go_back_to(&base, &mut chain, &mut found, each).is_break() {
                                return Ok((found, StopReason::Stopped));
                            }
                            control.changed(harmonics);
                            seed
                        }
                        None => self.unchanged(&mut control, &mut chain, last)?,
                    }
                }
            };
        }
    }

    /// The beginning at this point with its own number of harmonics, which stays for now.
    fn unchanged(&mut self, control: &mut Control, chain: &mut Chain, base: Base) -> Result<Seed, BranchError> {
        if base.is_shown {
            (chain.first, chain.known) = (Vec::new(), true);
        }
        let harmonics = base.series.n_harmonics;
        self.set_harmonics(harmonics)?;
        control.changed(harmonics);
        control.stay();
        Ok(Seed { x: base.point.x, p: base.point.p, direction: base.point.tangent, harmonics })
    }

    /// The beginning at the energy of a point with so many harmonics, where that is shown to be on the same branch: its
    /// tangent points the same way, and it lies no further off than the estimate with the fewer harmonics says. Next to
    /// an internal-resonance branch that only one of them has neither holds.
    fn with_more(
        &mut self,
        Base { point, series, .. }: &Base,
        frequency: Option<[f64; 2]>,
        harmonics: usize,
    ) -> Result<Option<Seed>, BranchError> {
        self.set_harmonics(series.n_harmonics)?;
        let estimate = self.estimator.as_mut().map(|own| own.estimate(&point.x, point.p, &point.tangent).motion);
        self.set_harmonics(harmonics)?;
        let Some(problem) = self.problem.harmonics() else { return Ok(None) };
        let (z, direction) = (problem.resized(&point.z(), *series), problem.resized(&point.tangent, *series));
        let (last, step) = (z.len() - 1, self.settings.step.clone());
        let found = at_energy(&self.settings, self.grazing, &mut self.problem, (&z, Some(&direction)), self.log)
            .or_else(|| homotopy::solve(&mut self.problem, &z, last, &step, Effort::LITTLE, self.log));
        let Some((x, p)) = found else { return Ok(None) };
        let seed = Seed { x, p, direction, harmonics };
        let method = self.within(frequency);
        let found = method.first_point(&mut self.problem, &seed.point(), &seed.direction, self.log).ok().flatten();
        let expected = estimate.unwrap_or(f64::INFINITY) * length(&seed.x);
        let growth = self.settings.growth;
        let is_same = |found: &BranchPoint| {
            let moved: Vec<f64> = found.z().iter().zip(&z).map(|(a, b)| a - b).collect();
            cosine(&found.tangent, &seed.direction) > growth.same_way && length(&moved) <= growth.off * expected
        };
        Ok(found.filter(is_same).map(|_| seed))
    }

    /// One run with the same number of harmonics, and how it is to go on.
    fn run(
        &mut self,
        control: &mut Control,
        from: &Seed,
        frequency: Option<[f64; 2]>,
        chain: &mut Chain,
        found: &mut Found,
        each: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
    ) -> Result<(StopReason, Option<(Base, usize)>), BranchError> {
        let method = self.within(frequency);
        chain.waiting.clear();
        found.begin();
        let (mut change, mut is_first) = (None, true);
        let (Some(estimator), Some(problem)) = (self.estimator.as_mut(), self.problem.harmonics()) else {
            return Ok((StopReason::Stopped, None));
        };
        let (viewer, too_few_modes) = (&mut self.viewer, &mut self.too_few_modes);
        let series = problem.series();
        let (problem, log) = (&mut self.problem, &mut *self.log);
        let watch = &self.settings.watch;
        problem.accepted(&from.x, from.p);
        let mut show = |chain: &mut Chain, found: &mut Found| -> ControlFlow<()> {
            for (point, error, names) in chain.waiting.drain(..) {
                if std::mem::take(&mut chain.known) {
                    continue;
                }
                found
                    .keep_named(viewer, &point, names, error)
                    .iter()
                    .map(BranchProgress::of_first)
                    .try_for_each(&mut *each)?;
            }
            ControlFlow::Continue(())
        };
        let branch = method.run_with_log(problem, &from.x, from.p, &from.direction, log, |point| {
            if watch.has_ended() {
                return ControlFlow::Break(());
            }
            let singular = point.events.iter().any(|e| matches!(e, EventKind::BranchPoint | EventKind::Kink));
            let error = (!singular).then(|| estimator.estimate(&point.x, point.p, &point.tangent));
            let mut names = Vec::new();
            if std::mem::take(&mut is_first) {
                names.clone_from(&chain.first);
                if names.contains(&Event::Harmonics) && chain.base.as_ref().is_some_and(|base| !base.is_accurate) {
                    names.push(Event::HarmonicsUnproven);
                }
            }
            let Some(error) = error.filter(|_| point.events.is_empty()) else {
                chain.waiting.push((point.clone(), error, names));
                return ControlFlow::Continue(());
            };
            let begins = chain.waiting.is_empty() && found.is_at_start();
            let here =
                |is_accurate, is_shown, shown| Base { point: point.clone(), series, is_accurate, is_shown, shown };
            let is_accurate = match control.decide(&error) {
                Decision::Modes => {
                    *too_few_modes = true;
                    return ControlFlow::Break(());
                }
                Decision::More(harmonics) => {
                    let base = chain.base.clone().unwrap_or_else(|| here(false, chain.known, found.points.len()));
                    change = Some((base, harmonics));
                    return ControlFlow::Break(());
                }
                Decision::Limit { tried_here } => {
                    if !std::mem::replace(&mut chain.at_limit, true) {
                        names.push(Event::AccuracyLimit);
                    }
                    if tried_here {
                        names.push(Event::HarmonicsNoHelp);
                    }
                    false
                }
                Decision::Keep => {
                    chain.at_limit = false;
                    true
                }
            };
            chain.waiting.push((point.clone(), Some(error), names));
            if begins {
                // It is shown when it is sure that the branch goes on with this number of harmonics.
                chain.base = Some(here(is_accurate, chain.known, found.points.len()));
                found.leave_start(point);
                return ControlFlow::Continue(());
            }
            show(chain, found)?;
            let base = here(is_accurate, true, found.points.len());
            chain.accurate.extend(Some(base.clone()).filter(|base| base.is_accurate));
            chain.base = Some(base);
            ControlFlow::Continue(())
        })?;
        found.count(&branch);
        if change.is_none() && !*too_few_modes {
            let _ = show(chain, found);
        }
        Ok((branch.stop, change))
    }
}

/// The branch goes on from this point: what was shown since then is found anew.
fn go_back_to(
    base: &Base,
    chain: &mut Chain,
    found: &mut Found,
    each: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let shown = found.points.len();
    found.truncate(base.shown);
    chain.accurate.retain(|accurate| accurate.shown <= base.shown);
    chain.base = Some(base.clone());
    if base.shown < shown {
        each(BranchProgress::Withdrawn { branch: 0, kept: base.shown })
    } else {
        ControlFlow::Continue(())
    }
}

fn cosine(tangent: &[f64], direction: &[f64]) -> f64 {
    let along: f64 = tangent.iter().zip(direction).map(|(a, b)| a * b).sum();
    along / length(direction)
}
