//! A branch along which the number of harmonics follows an error estimate.
//!
//! It is a chain of runs with one number of harmonics each, and ends for three reasons. From one point, trials of more harmonics are larger and larger
//! ones, up to the most, and then the number stays for some points, whatever their error. Points are taken back only where the branch has come further than when
//! some were last taken back. And a change that leads back is undone at most twice: then there are no more changes.

mod carry;
mod control;
mod run;
mod stretch;

use std::ops::ControlFlow;

use nlmodes_continuation::{BranchPoint, StopReason};
use nlmodes_hbm::RealSeries;
use nlmodes_modal::Event;

pub(super) use self::control::Control;
use self::stretch::{Change, Stretch};
use super::BranchError;
use super::found::{First, Found, Shown};
use super::start::Seed;
use super::trace::Tracer;

/// Points that are gone back where none is found.
///
/// Next to an internal resonance branches with different numbers of harmonics lie further apart than some points before it: without going back, the rod of 100
/// elements with an accuracy of 1e-3 has 27 points of 202 beyond that, and 1 of 199 with it.
const BACK: [usize; 4] = [1, 3, 6, 10];

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
        frequency: Option<[f64; 2]>,
        first: First,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), BranchError> {
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
            furthest: 0,
            first: if let First::Named(event) = first { vec![event] } else { Vec::new() },
            known: matches!(first, First::Known),
            at_limit: false,
            tried_from: None,
            in_vain: false,
            changes: Vec::new(),
            back: 0,
            from_grazing: matches!(first, First::Named(Event::Grazing)),
        };
        let mut from = seed.clone();
        self.set_harmonics(from.harmonics)?;
        control.changed(from.harmonics);
        loop {
            let outcome = self.run(control, &from, frequency, &mut stretch, &mut found, each);
            if self.settings.watch.has_ended() && !found.points.is_empty() {
                return Ok((found, StopReason::Stopped));
            }
            let (stop, change) = outcome?;
            let Some(change) = change else { return Ok((found, stop)) };
            from = match change {
                Change::BackTo(harmonics) => {
                    if give_back(&mut stretch, &mut found, each).is_break() {
                        return Ok((found, StopReason::Stopped));
                    }
                    let Some(base) = stretch.base.clone() else { return Ok((found, stop)) };
                    let seed = self.back_to(control, &mut stretch, &mut found, base, harmonics)?;
                    control.stay();
                    seed
                }
                Change::Undo => {
                    let Some(undo) = stretch.changes.pop() else { return Ok((found, stop)) };
                    stretch.back = 0;
                    found.truncate(undo.kept);
                    stretch.passed.truncate(undo.passed);
                    if each(Shown::Withdrawn(found.points.len())).is_break() {
                        return Ok((found, StopReason::Stopped));
                    }
                    (stretch.base_is_shown, stretch.base_is_accurate) = (true, undo.base_is_accurate);
                    (stretch.base, stretch.tried_from, stretch.in_vain) = (Some(undo.base.clone()), None, true);
                    let (base, series) = undo.base;
                    let seed = self.unchanged(control, &mut stretch, base, series)?;
                    control.undo();
                    seed
                }
                Change::To(harmonics) => {
                    let Some(base) = stretch.base.clone() else { return Ok((found, stop)) };
                    stretch.begin_trial(&base, harmonics);
                    let before = found.points.len();
                    let undo = stretch.undo(&base, found.points.len());
                    let seed = self.go_on_with(control, &mut stretch, &mut found, base, harmonics)?;
                    if seed.harmonics != undo.base.1.n_harmonics && found.points.len() == undo.kept {
                        stretch.changes.push(undo);
                        stretch.back = 0;
                    }
                    if found.points.len() < before && each(Shown::Withdrawn(found.points.len())).is_break() {
                        return Ok((found, StopReason::Stopped));
                    }
                    seed
                }
            };
        }
    }

    /// The beginning with another number of harmonics at the base, or if there is none some points earlier, or else with the same number.
    fn go_on_with(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        found: &mut Found,
        (base, series): (BranchPoint, RealSeries),
        harmonics: usize,
    ) -> Result<Seed, BranchError> {
        if let Some(seed) = self.carried_over(found, &base, series, harmonics, true)? {
            return Ok(taken_over(control, stretch, found, seed));
        }
        if let Some(seed) = self.taken_back(stretch, found, series, harmonics)? {
            control.changed(seed.harmonics);
            control.pause();
            return Ok(seed);
        }
        if harmonics > series.n_harmonics {
            control.stay();
        } else {
            control.pause();
        }
        self.unchanged(control, stretch, base, series)
    }

    /// The beginning at the base with its own number of harmonics.
    fn unchanged(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        base: BranchPoint,
        series: RealSeries,
    ) -> Result<Seed, BranchError> {
        if stretch.base_is_shown {
            (stretch.first, stretch.known) = (Vec::new(), true);
        }
        let harmonics = series.n_harmonics;
        self.set_harmonics(harmonics)?;
        control.changed(harmonics);
        Ok(Seed { x: base.x, p: base.p, direction: base.tangent, harmonics })
    }

    /// The beginning at the base after more harmonics have been tried from there: with the best of them, or its own.
    fn back_to(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        found: &mut Found,
        (base, series): (BranchPoint, RealSeries),
        harmonics: usize,
    ) -> Result<Seed, BranchError> {
        stretch.in_vain = true;
        let better = match harmonics > series.n_harmonics {
            true => self.carried_over(found, &base, series, harmonics, true)?,
            false => None,
        };
        let Some(seed) = better else { return self.unchanged(control, stretch, base, series) };
        Ok(taken_over(control, stretch, found, seed))
    }

    /// The beginning with more harmonics some points earlier, where the branches are nearer; the points since then are taken back.
    fn taken_back(
        &mut self,
        stretch: &mut Stretch,
        found: &mut Found,
        series: RealSeries,
        harmonics: usize,
    ) -> Result<Option<Seed>, BranchError> {
        let shown = found.points.len();
        if harmonics <= series.n_harmonics || shown <= stretch.furthest {
            return Ok(None);
        }
        for back in BACK {
            let Some(index) = stretch.passed.len().checked_sub(back + 1) else { return Ok(None) };
            let (base, series, kept) = stretch.passed[index].clone();
            if let Some(seed) = self.carried_over(found, &base, series, harmonics, false)? {
                stretch.furthest = shown;
                let passed = stretch.passed.split_off(index + 1);
                let mut taken_back = (found.split_off(kept), passed);
                if let Some(trial) = &mut stretch.tried_from {
                    if let Some((points, mut passed)) = trial.taken_back.take() {
                        taken_back.0.append(points);
                        taken_back.1.append(&mut passed);
                    }
                    trial.taken_back = Some(taken_back);
                }
                found.changes += 1;
                (stretch.base, stretch.base_is_shown, stretch.base_is_accurate) = (Some((base, series)), true, true);
                (stretch.first, stretch.known) = (vec![Event::Harmonics], false);
                return Ok(Some(seed));
            }
        }
        Ok(None)
    }
}

/// The beginning at the base with another number of harmonics, which counts as a change where the base is shown.
fn taken_over(control: &mut Control, stretch: &mut Stretch, found: &mut Found, seed: Seed) -> Seed {
    if stretch.base_is_shown {
        (stretch.first, stretch.known) = (vec![Event::Harmonics], false);
        found.changes += 1;
    }
    control.changed(seed.harmonics);
    seed
}

/// Goes back to where more harmonics were tried from, with the points that were taken back for it.
fn give_back(
    stretch: &mut Stretch,
    found: &mut Found,
    each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let Some(trial) = stretch.tried_from.take() else { return ControlFlow::Continue(()) };
    stretch.base = Some(trial.base);
    (stretch.base_is_shown, stretch.base_is_accurate) = (trial.base_is_shown, trial.base_is_accurate);
    (stretch.first, stretch.known) = (trial.first, trial.known);
    let Some((points, mut passed)) = trial.taken_back else { return ControlFlow::Continue(()) };
    stretch.passed.append(&mut passed);
    let before = found.points.len();
    found.append(points);
    found.points[before..].iter().map(Shown::Point).try_for_each(each)
}
