//! A branch along which the number of harmonics grows with an error estimate.
//!
//! It is a chain of runs with one number of harmonics each. Every change asks for more than any before it, whether it
//! is found, stays or is taken back: so there are at most as many as the scene permits harmonics.

mod carry;
mod control;
mod run;
mod stretch;

use std::ops::ControlFlow;

use nlmodes_continuation::StopReason;
use nlmodes_modal::Event;

pub(super) use self::control::Control;
use self::stretch::{Base, Change, Stretch};
use super::BranchError;
use super::found::{First, Found, Shown};
use super::start::Seed;
use super::trace::Tracer;

/// Points that are gone back where no solution with more harmonics is found.
///
/// Next to an internal resonance branches with different numbers of harmonics lie further apart than some points before
/// it: without going back, the rod of 100 elements with an accuracy of 1e-3 has 27 points of 202 beyond that, and 1 of
/// 199 with it.
const BACK: [usize; 4] = [1, 3, 6, 10];

impl Tracer<'_> {
    /// [`Tracer::trace`] with as many harmonics as the accuracy takes.
    ///
    /// A point whose estimate is too large does not count: the branch goes back to the last one without events, whose
    /// estimate is not, so that the branch with more harmonics is near, and goes on from there with more. The energy is
    /// kept. The new tangent points to the same side as the old one by the way in which it is computed, and is compared
    /// with it.
    pub(super) fn trace_accurately(
        &mut self,
        mut control: Control,
        seed: &Seed,
        frequency: Option<[f64; 2]>,
        first: First,
        each: &mut dyn FnMut(Shown) -> ControlFlow<()>,
    ) -> Result<(Found, StopReason), BranchError> {
        let mut found = Found::new(&First::Plain);
        if self.too_few_modes {
            return Ok((found, StopReason::Stopped));
        }
        let mut stretch = Stretch::new(&first, frequency);
        let mut from = seed.clone();
        self.set_harmonics(from.harmonics)?;
        control.changed(from.harmonics);
        loop {
            let outcome = self.run(&mut control, &from, &mut stretch, &mut found, each);
            if self.settings.watch.has_ended() && !found.points.is_empty() {
                return Ok((found, StopReason::Stopped));
            }
            let (stop, change) = outcome?;
            let shown = found.points.len();
            from = match change {
                None => return Ok((found, stop)),
                Some(Change::From(base, harmonics)) => {
                    self.with_more(&mut control, &mut stretch, &mut found, base, harmonics)?
                }
                Some(Change::Undo(base)) => {
                    stretch.go_back_to(&base, &mut found);
                    self.unchanged(&mut control, &mut stretch, base)?
                }
            };
            if found.points.len() < shown && each(Shown::Withdrawn(found.points.len())).is_break() {
                return Ok((found, StopReason::Stopped));
            }
        }
    }

    /// The beginning with more harmonics at the last point that counts, or if there is none some points earlier, where
    /// the branches are nearer and the points since then are found anew; or else with as many as before.
    fn with_more(
        &mut self,
        control: &mut Control,
        stretch: &mut Stretch,
        found: &mut Found,
        last: Base,
        harmonics: usize,
    ) -> Result<Seed, BranchError> {
        for (tried, base) in stretch.bases(&last, &BACK).into_iter().enumerate() {
            if let Some(seed) = self.carried_over(found, stretch.frequency, &base, harmonics, tried == 0)? {
                stretch.go_back_to(&base, found);
                if base.is_shown {
                    (stretch.first, stretch.known) = (vec![Event::Harmonics], false);
                }
                stretch.changes.push(base);
                control.changed(seed.harmonics);
                return Ok(seed);
            }
        }
        self.unchanged(control, stretch, last)
    }

    /// The beginning at this point with its own number of harmonics, which stays for now.
    fn unchanged(&mut self, control: &mut Control, stretch: &mut Stretch, base: Base) -> Result<Seed, BranchError> {
        if base.is_shown {
            (stretch.first, stretch.known) = (Vec::new(), true);
        }
        let harmonics = base.series.n_harmonics;
        self.set_harmonics(harmonics)?;
        control.changed(harmonics);
        control.stay();
        Ok(Seed { x: base.point.x, p: base.point.p, direction: base.point.tangent, harmonics })
    }
}
