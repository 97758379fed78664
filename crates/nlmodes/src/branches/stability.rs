//! Floquet multipliers of the points of a branch that has been followed.

use nlmodes_continuation::{Budget, Continuation, Watched};
use nlmodes_modal::{EndReason, Event, ModalPoint, Stability};
use nlmodes_timestep::{GalerkinReduction, MAX_SHOOTING_MODES, ModeShooting, ShootingScales};

use super::branch::ComputedBranch;
use super::viewer::Viewer;
use super::{BesideSettings, BranchError, BranchMethod, StabilityRule, Watch};

/// What is done, for whoever looks on.
const STABILITY: &str = "computing the stability of the branch";

/// Finds the stability of points.
enum Probe<'b> {
    /// The points are exact motions.
    Exact(Box<ModeShooting>),
    /// The points are motions in harmonics, beside which an exact one is sought first.
    Beside(Box<Beside<'b>>),
}

/// The exact motions of a structure whose points are known in harmonics.
struct Beside<'b> {
    shooting: ModeShooting,
    watch: Watch,
    budget: &'b mut Budget,
    settings: BesideSettings,
}

/// The stability of a point.
#[derive(Clone)]
struct Known {
    stability: Stability,
    /// Unknowns and parameter of the exact motion less those of the point in harmonics; none of an exact point.
    offset: Vec<f64>,
}

/// A direction along the branch, and what is known of the point there.
struct Neighbour<'p> {
    point: &'p ModalPoint,
    known: Option<&'p Known>,
}

impl ComputedBranch {
    /// Finds the stability of the points within the budget, and adds the points at which it changes; the numbers of
    /// those before which one was added.
    pub(super) fn find_stability(&mut self, budget: &mut Budget) -> Vec<usize> {
        if self.branch.end.has(EndReason::Stopped) {
            // Whoever has stopped the branch does not wait for its stability either.
            return Vec::new();
        }
        let watch = self.settings.watch.clone();
        let Some(mut probe) = self.probe(budget) else { return Vec::new() };
        if watch.begins(STABILITY).is_err() {
            self.end_before_stability();
            return Vec::new();
        }
        let mut known = vec![None; self.branch.points.len()];
        let left_out = self.probe_forward(&mut probe, &mut known);
        self.probe_backward(&mut probe, &mut known);
        for (point, known) in self.branch.points.iter_mut().zip(&known) {
            point.stability = known.as_ref().map(|known: &Known| known.stability);
        }
        let changes = self.changes(&mut probe, &known);
        let places = changes.iter().map(|(number, ..)| *number).collect();
        for (number, x, point) in changes.into_iter().rev() {
            self.branch.points.insert(number, point);
            self.unknowns.insert(number, x);
        }
        self.branch.end = self.branch.end.clone().without_stability(left_out);
        if watch.has_ended() {
            self.end_before_stability();
        }
        places
    }

    /// The computation was asked to end while the stability was not known yet: the branch is not complete without it.
    fn end_before_stability(&mut self) {
        let end = &mut self.branch.end;
        end.message += "; it was asked to stop before the stability of its points was known";
        (end.reasons, end.complete) = (vec![EndReason::Stopped], false);
    }

    /// `None` where the stability is not asked for, or too expensive to be found unasked.
    fn probe<'b>(&self, budget: &'b mut Budget) -> Option<Probe<'b>> {
        let (settings, model) = (&self.settings, self.structure.model());
        let most = match (settings.method, settings.stability) {
            (_, StabilityRule::Never) => return None,
            (BranchMethod::Shooting, _) => {
                return self.exact().ok().flatten().map(|exact| Probe::Exact(Box::new(exact)));
            }
            (BranchMethod::HarmonicBalance, StabilityRule::Auto) => settings.stability_modes,
            (BranchMethod::HarmonicBalance, StabilityRule::Always) => MAX_SHOOTING_MODES,
        };
        let size = model.linear_dofs().len();
        let is_large =
            size > 4 * settings.stability_modes || model.contact_dofs().len() > settings.beside.most_contacts;
        if settings.stability == StabilityRule::Auto && is_large {
            return None;
        }
        let reduced = GalerkinReduction::new(model.clone(), size.min(most)).ok()?;
        // A structure of more modes than are cheap is not to be judged by some of them unasked.
        if settings.stability == StabilityRule::Auto && reduced.n_held_modes() < size {
            return None;
        }
        let near = ShootingScales { omega: self.grazing.omega, energy: self.grazing.energy };
        let shooting = ModeShooting::new(reduced, near, settings.harmonics).ok()?;
        Some(Probe::Beside(Box::new(Beside {
            shooting,
            watch: settings.watch.clone(),
            budget,
            settings: settings.beside,
        })))
    }

    /// The points in their order, and how many the budget left out. After each search in a row that finds nothing one
    /// more point is skipped: where the harmonics are too few for an exact motion to be near, all searches would fail.
    fn probe_forward(&self, probe: &mut Probe, known: &mut [Option<Known>]) -> usize {
        let (mut failures, mut next) = (0, 0);
        while next < known.len() && !self.settings.watch.asks_to_end() {
            known[next] = self.stability_of(probe, next, next.checked_sub(1), known);
            if known[next].is_none() && probe.is_used_up() {
                return known.len() - next;
            }
            failures = if known[next].is_some() { 0 } else { failures + 1 };
            next += failures.max(1);
        }
        0
    }

    /// The points before those whose stability is known, from there.
    fn probe_backward(&self, probe: &mut Probe, known: &mut [Option<Known>]) {
        for number in (0..known.len().saturating_sub(1)).rev() {
            if known[number].is_none() && known[number + 1].is_some() {
                known[number] = self.stability_of(probe, number, Some(number + 1), known);
            }
        }
    }

    fn stability_of(
        &self,
        probe: &mut Probe,
        number: usize,
        beside: Option<usize>,
        known: &[Option<Known>],
    ) -> Option<Known> {
        let points = &self.branch.points;
        let neighbour = beside.map(|beside| Neighbour { point: &points[beside], known: known[beside].as_ref() });
        probe.of(&self.unknowns[number], &points[number], neighbour)
    }

    /// The points at which the stability changes, each with its unknowns and the number of the point behind it.
    fn changes(&self, probe: &mut Probe, known: &[Option<Known>]) -> Vec<(usize, Vec<f64>, ModalPoint)> {
        let mut changes = Vec::new();
        for number in 1..known.len() {
            let [Some(before), Some(now)] = &known[number - 1..=number] else { continue };
            // A change of the number of harmonics is no way along which to look.
            let is_way = self.unknowns[number - 1].len() == self.unknowns[number].len();
            if before.stability.stable != now.stability.stable
                && is_way
                && let Ok(Some((x, mut point))) = self.change(probe, number, now)
            {
                point.events.push(Event::StabilityChange);
                changes.push((number, x, point));
            }
        }
        changes
    }

    /// The first solution before a point whose stability is that of this point, by bisection along the branch.
    fn change(
        &self,
        probe: &mut Probe,
        number: usize,
        now: &Known,
    ) -> Result<Option<(Vec<f64>, ModalPoint)>, BranchError> {
        let mut viewer = Viewer::new(&self.structure, &self.settings_at(number), &self.grazing)?;
        let (mut low, mut high, mut found) = (self.solution(number - 1), self.solution(number), None);
        for _ in 0..self.settings.beside.halvings {
            let along: Vec<f64> = high.iter().zip(&low).map(|(a, b)| a - b).collect();
            if length(&along) < self.settings.beside.located {
                break;
            }
            let middle: Vec<f64> = high.iter().zip(&low).map(|(a, b)| 0.5 * (a + b)).collect();
            let Some((x, residual, z)) = viewer.solution(&middle, &along) else { return Ok(None) };
            let Some(mut point) = viewer.see(&x, residual) else { return Ok(None) };
            let neighbour = Neighbour { point: &self.branch.points[number], known: Some(now) };
            let Some(Known { stability, .. }) = probe.of(&x, &point, Some(neighbour)) else { return Ok(None) };
            if stability.stable == now.stability.stable {
                high = z;
                point.stability = Some(stability);
                found = Some((x, point));
            } else {
                low = z;
            }
        }
        Ok(found)
    }
}

impl Probe<'_> {
    /// Whether there is no time left for searches.
    fn is_used_up(&self) -> bool {
        matches!(self, Self::Beside(beside) if beside.budget.is_used_up())
    }

    /// Stability of the point with the unknowns `x`; `None` where it could not be found.
    fn of(&mut self, x: &[f64], point: &ModalPoint, neighbour: Option<Neighbour>) -> Option<Known> {
        match self {
            Self::Exact(shooting) => {
                let stability = shooting.floquet(x).ok()?.stability();
                Some(Known { stability, offset: Vec::new() })
            }
            Self::Beside(beside) => beside.of(point, neighbour),
        }
    }
}

impl Beside<'_> {
    fn guess(&mut self, point: &ModalPoint) -> Option<Vec<f64>> {
        let (x, p) = self.shooting.unknowns(&point.coefficients, point.omega).ok()?;
        Some(x.into_iter().chain([p]).collect())
    }

    /// The multipliers of a motion that does not quite return mean nothing by themselves: those of the exact motion
    /// beside it are given. It is sought as far from the point as that of its neighbour is from that, and across the
    /// direction of the branch, so that folds do not matter.
    fn of(&mut self, point: &ModalPoint, neighbour: Option<Neighbour>) -> Option<Known> {
        let guess = self.guess(point)?;
        let (_, upward) = self.shooting.start();
        let before = neighbour.as_ref().and_then(|neighbour| self.guess(neighbour.point));
        let along = before.map(|before| guess.iter().zip(&before).map(|(a, b)| a - b).collect::<Vec<f64>>());
        let along = along.filter(|d| length(d) > 1e-9 * length(&guess)).unwrap_or(upward);
        let offset = neighbour.and_then(|neighbour| neighbour.known).map(|known| &known.offset);
        let start: Vec<f64> = match offset {
            Some(offset) => guess.iter().zip(offset).map(|(a, b)| a + b).collect(),
            None => guess.clone(),
        };
        let (shooting, settings) = (&mut self.shooting, self.settings);
        self.budget.spend(&self.watch, |watch| {
            let mut watched = Watched { system: &mut **shooting, watch };
            let exact = Continuation::default().first_point(&mut watched, &start, &along, &mut ()).ok()??;
            let offset: Vec<f64> = exact.z().iter().zip(&guess).map(|(a, b)| a - b).collect();
            let (_, unknowns) = guess.split_last()?;
            if length(&offset) > settings.near * length(unknowns) {
                return None;
            }
            let fundamental = shooting.fundamental(&exact.x).ok()?;
            if (fundamental - point.fundamental).abs() > settings.same_fundamental * point.fundamental.abs() {
                return None;
            }
            Some(Known { stability: shooting.floquet(&exact.x).ok()?.stability(), offset })
        })
    }
}

pub(super) fn length(z: &[f64]) -> f64 {
    z.iter().map(|z| z * z).sum::<f64>().sqrt()
}
