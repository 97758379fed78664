mod bounds;
mod replay;
mod several;

use std::ops::ControlFlow;
use std::rc::Rc;

use crate::bend::{self, Bend};
use crate::corner::{self, Passage};
use crate::corrector::{Correction, Corrector, along, distance, dot};
use crate::crossing::{Choice, Registry};
use crate::events::{FoldWatch, Located, Search};
use crate::pencil::Bordered;
use crate::predictor::Behind;
use crate::record::RunLog;
use crate::scales::Scaled;
use crate::singular::{NEARLY_FREE, SingularDirections};
use crate::step::{Foot, Watched, watched_step};
use crate::step_control::StepControl;
use crate::{Branch, BranchPoint, Continuation, EventKind, ParametricSystem, Refusal, StopReason};

/// The state of a run: what following a branch would otherwise carry in a dozen variables.
pub(crate) struct Run<'a, 's, E> {
    settings: &'a Continuation,
    control: StepControl,
    system: &'a mut Scaled<'s, E>,
    observe: &'a mut dyn FnMut(&BranchPoint) -> ControlFlow<()>,
    corrector: Corrector,
    branch: Branch,
    foot: Foot,
    /// Regularity of the foot before, and its distance; `None` behind a corner.
    before: Option<(f64, f64)>,
    folds: FoldWatch,
    /// What other branches have passed, and the number of this one among them.
    known: Option<(&'a mut Registry, usize)>,
    log: &'a mut dyn RunLog,
    /// The crossing that the step in progress passed.
    passed: Option<Choice>,
    /// Points of the step in progress that were shown before.
    shown: usize,
    /// The row below the Jacobian at the foot, while steps of a log are repeated.
    row: Option<Vec<f64>>,
}

/// Where a step passes a crossing, and the arms there.
type Crossing = (Located, Choice);

/// A step that is shown to stay on the branch.
struct Taken {
    end: Correction,
    /// Distance of the end from the tangent of the foot.
    moved: f64,
    crossing: Option<Crossing>,
    /// Where the branch ends within the step, and why.
    last: Option<(StopReason, Correction)>,
    /// Changes of the pattern, where they have been looked for.
    changes: Option<Vec<Located>>,
    /// The Jacobian at the end.
    border: Option<Rc<Bordered>>,
}

impl<'a, 's, E: std::error::Error + 'static> Run<'a, 's, E> {
    pub fn new(
        settings: &'a Continuation,
        system: &'a mut Scaled<'s, E>,
        observe: &'a mut dyn FnMut(&BranchPoint) -> ControlFlow<()>,
        corrector: Corrector,
        start: &Correction,
        log: &'a mut dyn RunLog,
    ) -> Self {
        let mut folds = FoldWatch::new(system.dim(), &settings.watched);
        folds.update(&start.tangent);
        let branch = Branch {
            points: Vec::new(),
            crossings: Vec::new(),
            stop: StopReason::MaxPoints,
            scales: system.scales.clone(),
            evaluations: 0,
            refused_steps: 0,
        };
        let foot = Foot { border: corrector.border().map(Rc::new), ..Foot::from(start) };
        let (control, known, passed) = (StepControl::new(&settings.step), None, None);
        let (before, row) = (None, corrector.border_row());
        Self {
            settings,
            control,
            system,
            observe,
            corrector,
            branch,
            foot,
            before,
            folds,
            known,
            log,
            passed,
            shown: 0,
            row,
        }
    }

    /// As branch `number` of several, which does not go where another has been.
    pub fn within(self, registry: &'a mut Registry, number: usize) -> Self {
        Self { known: Some((registry, number)), ..self }
    }

    /// Keeps the start and follows the branch to its end.
    pub fn finish(mut self, start: &Correction) -> Branch {
        self.branch.stop = match self.begin(start) {
            ControlFlow::Break(stop) => stop,
            ControlFlow::Continue(h) => self.follow(h),
        };
        self.branch.evaluations = self.corrector.evaluations;
        self.in_units()
    }

    /// The branch, whose points are shares of the sizes so far, in the units of the system.
    fn in_units(self) -> Branch {
        let (scales, branch) = (&self.system.scales, self.branch);
        Branch {
            points: branch.points.into_iter().map(|q| scales.point_in_units(q)).collect(),
            crossings: branch.crossings.into_iter().map(|crossing| scales.crossing_in_units(crossing)).collect(),
            stop: scales.stop_in_units(branch.stop),
            ..branch
        }
    }

    /// Shows a point to the observer.
    fn show(&mut self, point: &BranchPoint) -> ControlFlow<()> {
        (self.observe)(&self.system.scales.point_in_units(point.clone()))
    }

    /// Takes the steps that the log knows, or else keeps the start; and the length of the next step.
    fn begin(&mut self, start: &Correction) -> ControlFlow<StopReason, f64> {
        let mut h = self.control.initial();
        let mut repeated = 0;
        for record in self.log.begin(&self.system.scales.correction_for_log(start.clone())) {
            let record = self.system.scales.record_in_scales(record);
            if !self.holds(&record) {
                break;
            }
            h = self.repeat(record, h)?;
            repeated += 1;
        }
        let told = self.log.computing(repeated);
        if self.branch.points.is_empty() {
            let border = self.foot.border.take();
            let outcome = self.go_to(start, Vec::new()).map_continue(|()| h);
            self.foot.border = border;
            return self.record(0, outcome);
        }
        self.restore_border();
        if told.is_break() { ControlFlow::Break(StopReason::Stopped) } else { ControlFlow::Continue(h) }
    }

    fn follow(&mut self, mut h: f64) -> StopReason {
        loop {
            let from = self.branch.points.len();
            let refused = self.control.refused_in_a_row();
            if refused == 1 || (refused == 0 && self.corrector.is_blurred()) {
                self.look_at_rounding();
                h = h.max(self.control.limits.min);
            }
            self.corrector.max_iterations =
                self.control.limits.max_iterations * if self.control.is_precious(h) { 3 } else { 1 };
            let outcome = match self.try_step(h) {
                Ok(taken) => {
                    let next = self.control.after_taken(h, taken.moved, &self.foot.z);
                    self.accept(taken, h, next)
                }
                Err(refusal) => {
                    self.branch.refused_steps += 1;
                    let around_bend = if refused == 0 { self.bend_at_start() } else { None };
                    match (around_bend, self.control.after_refused(h, &refusal)) {
                        (Some(bend), _) => self.go_around(&bend),
                        (None, Some(shorter)) => {
                            h = shorter;
                            continue;
                        }
                        (None, None) => {
                            let too_small = StopReason::StepTooSmall { step: h, refusal };
                            self.pass_corner().unwrap_or(ControlFlow::Break(too_small))
                        }
                    }
                }
            };
            self.control.begin();
            match self.record(from, outcome) {
                ControlFlow::Break(stop) => return stop,
                ControlFlow::Continue(next) => h = next,
            }
        }
    }

    /// The tight bend at which the branch begins. Elsewhere it is located first.
    fn bend_at_start(&mut self) -> Option<Bend> {
        (self.branch.points.len() == 1).then(|| self.bend_here()).flatten()
    }

    fn bend_here(&mut self) -> Option<Bend> {
        bend::around_bend(self.system, &mut self.corrector, &self.control.limits, &self.foot)
    }

    /// How well points near the foot are known, and the shortest step that makes sense there: along directions that are nearly free,
    /// with singular values σ of the Jacobian, a residual that is zero up to rounding ε leaves a solution unknown up to ε/σ.
    fn look_at_rounding(&mut self) {
        self.corrector.look_at_rounding(self.system, &self.foot.z, &self.foot.tangent);
        self.control.set_blur(if self.corrector.is_blurred() { self.corrector.blur } else { 0.0 });
    }

    /// A step that stays on the branch, the crossing that it passes, if it does, and where the branch ends within it, if it does.
    fn try_step(&mut self, h: f64) -> Result<Taken, Refusal> {
        let watched = watched_step(self.system, &mut self.corrector, &self.control.limits, &self.foot, h)?;
        let Watched { end, border, singular } = watched;
        let (crossing, changes) = match self.several_passed(&end, h, &singular)? {
            Some(crossing) => (Some(crossing), None),
            None => self.crossing_passed(&end, border.as_deref(), h)?,
        };
        let last = match self.bound_crossed(&end, h)? {
            None => self.closing_point(&end, h)?.map(|last| (StopReason::Closed, last)),
            bound => bound,
        };
        let moved = distance(&end.z, &along(&self.foot.z, h, &self.foot.tangent));
        Ok(Taken { end, moved, crossing, last, changes, border })
    }

    /// The crossing within a step, if there is one, and the changes of the pattern, where they have been looked for.
    ///
    /// `det [J; tᵀ]` keeps its sign along a curve, corners included, unless other branches cross it. So a change of sign without
    /// a crossing is a jump to another arm.
    fn crossing_passed(
        &mut self,
        end: &Correction,
        border: Option<&Bordered>,
        h: f64,
    ) -> Result<(Option<Crossing>, Option<Vec<Located>>), Refusal> {
        let mut search = Search { system: self.system, corrector: &mut self.corrector, foot: &self.foot, end, h };
        if end.orientation * self.foot.orientation < 0.0 {
            let crossing = search.crossing().ok_or(Refusal::CrossingNotLocated)?;
            let choice = self.arms_at(&crossing, end, h).ok_or(Refusal::OtherArm)?;
            return Ok((Some((crossing, choice)), None));
        }
        let changes = (end.pattern != self.foot.pattern).then(|| search.pattern_changes());
        let touched = changes.as_ref().and_then(|changes| self.touched_corner(changes, end, border, h));
        Ok((touched, changes))
    }

    /// A change of the pattern within a step at which the corner of another curve touches this one: that leaves the sign of
    /// `det [J; tᵀ]` as it was, but the Jacobian becomes singular there.
    fn touched_corner(
        &mut self,
        changes: &[Located],
        end: &Correction,
        border: Option<&Bordered>,
        h: f64,
    ) -> Option<Crossing> {
        changes.iter().find_map(|change| {
            if !self.becomes_singular(&change.point.z, border) {
                return None;
            }
            let change = Located { kinds: vec![EventKind::BranchPoint], ..change.clone() };
            let choice = self.arms_at(&change, end, h)?;
            Some((change, choice))
        })
    }

    /// Whether the Jacobian at a point of a step is nearly singular beside those at its ends, or where these are not known by itself.
    fn becomes_singular(&mut self, z: &[f64], end: Option<&Bordered>) -> bool {
        let foot = self.foot.border.clone();
        let ends = [foot.as_deref(), end].into_iter().flatten();
        if let (Some(_), Some(_)) = (&foot, end) {
            let at = self.corrector.border_at(self.system, z, &self.foot.tangent);
            // A contact that closes is stiff beside one that is open: only what is singular in terms of both ends is so by itself.
            return at.is_none_or(|at| ends.into_iter().all(|end| at.is_singular_beside(end)));
        }
        self.corrector.evaluate(self.system, z).is_ok()
            && SingularDirections::of(self.corrector.linearization()).is_some_and(|free| free.ratio <= NEARLY_FREE)
    }

    /// The arms at a point of a step; `None` if only two meet.
    fn arms_at(&mut self, at: &Located, end: &Correction, h: f64) -> Option<Choice> {
        // The Jacobian has no tangent to offer where arms meet.
        let tangent = between(&self.foot.tangent, &end.tangent, at.s / h);
        corner::crossing(self.system, &mut self.corrector, &self.control.limits, &at.point.z, &tangent)
    }

    /// Goes on along the arm that continues the branch through a corner or a crossing; `None` if no arm leaves.
    fn pass_corner(&mut self) -> Option<ControlFlow<StopReason, f64>> {
        let bounds = &self.settings.bounds;
        let within = |z: &[f64]| bounds.iter().all(|b| b.passed_by(z[b.coordinate]).is_none());
        let from = self.foot.clone();
        if !corner::approach(self.system, &mut self.corrector, &self.control.limits, &mut self.foot, within)
            && let Some(next) = self.step_below_the_shortest(from)
        {
            return Some(next);
        }
        if let Some(bend) = self.bend_here() {
            return Some(self.go_around(&bend));
        }
        let (points, foot) = (&self.branch.points, &self.foot);
        let latest = || points.iter().rev().map(|q| (q.z(), q.tangent.as_slice()));
        let way_back = |radius| corner::way_back(latest(), foot, radius);
        let passage = corner::pass(self.system, &mut self.corrector, &self.control.limits, 0, foot, way_back)?;
        Some(self.go_through(passage))
    }

    /// Goes on behind a bend, within which coordinates may turn.
    fn go_around(&mut self, bend: &Bend) -> ControlFlow<StopReason, f64> {
        let corner = self.corner_point(&bend.end, false);
        if !corner.events.is_empty() {
            self.keep(corner.clone())?;
        }
        for (i, kind) in self.folds.update(&bend.end.tangent) {
            let turned = bend.turn(self.system, &mut self.corrector, &self.foot, i);
            let turned = turned.map_or_else(|| corner.clone(), |turned| point(&turned, Vec::new()));
            self.keep(BranchPoint { events: vec![kind], ..turned })?;
        }
        self.leave_for(&bend.end, distance(&bend.end.z, &self.foot.z))
    }

    /// One step of those that lead away from a point at which a longer one was refused, though there is no corner; what happens within is
    /// looked for as in any other.
    fn step_below_the_shortest(&mut self, from: Foot) -> Option<ControlFlow<StopReason, f64>> {
        let ahead = std::mem::replace(&mut self.foot, from);
        let h = corner::APPROACHING * self.control.limits.min;
        match self.try_step(h) {
            Ok(taken) => {
                let next = self.control.after_taken(h, taken.moved, &self.foot.z);
                Some(self.accept(taken, h, next))
            }
            Err(_) => {
                self.foot = ahead;
                None
            }
        }
    }

    fn go_through(&mut self, passage: Passage) -> ControlFlow<StopReason, f64> {
        let (next, choice) = match passage {
            Passage::Corner(next) => (next, None),
            Passage::Crossing(choice) => (choice.arms[choice.arm(self.settings.at_branch_point)].clone(), Some(choice)),
        };
        let mut corner = self.corner_point(&next, choice.is_some());
        corner.events.extend(self.folds.update(&next.tangent).into_iter().map(|(_, kind)| kind));
        if !corner.events.is_empty() {
            self.keep(corner)?;
        }
        if let Some(choice) = choice {
            let way = self.choose(&choice);
            self.note(&choice, way)?;
        }
        let length = distance(&next.z, &self.foot.z);
        self.leave_for(&next, length)
    }

    /// Goes on at the first point beyond a corner or a crossing, unless a bound lies in between.
    fn leave_for(&mut self, next: &Correction, length: f64) -> ControlFlow<StopReason, f64> {
        if let Some(stop) = self.bound_before(next) {
            return ControlFlow::Break(stop?);
        }
        self.go_to(next, Vec::new())?;
        (self.before, self.foot.behind) = (None, None);
        ControlFlow::Continue(length)
    }

    /// The arm on which the branch is to leave a crossing; `None` if that has been passed before.
    fn choose(&mut self, choice: &Choice) -> Option<usize> {
        let arm = choice.arm(self.settings.at_branch_point);
        let number = self.branch.crossings.len();
        let free = self.known.as_mut().is_none_or(|(registry, branch)| registry.enter(choice, arm, *branch, number));
        self.passed = Some(choice.clone());
        free.then_some(arm)
    }

    /// Notes the crossing, whose point has been kept; the branch ends there if it has no way to go.
    fn note(&mut self, choice: &Choice, way: Option<usize>) -> ControlFlow<StopReason> {
        let named = |q: &BranchPoint| q.events.contains(&EventKind::BranchPoint);
        let point = self.branch.points.iter().rposition(named).unwrap_or(0);
        self.branch.crossings.push(choice.crossing(point, way));
        if way.is_some() { ControlFlow::Continue(()) } else { ControlFlow::Break(StopReason::Joined) }
    }

    /// The corner with its events.
    fn corner_point(&mut self, next: &Correction, crossing: bool) -> BranchPoint {
        let foot = &self.foot;
        let mut events = Vec::new();
        // Nothing is known of a branch before it begins.
        let at_start = self.branch.points.len() == 1;
        if crossing {
            events.push(EventKind::BranchPoint);
        } else if !at_start && dot(&foot.tangent, &next.tangent).clamp(-1.0, 1.0).acos() > self.settings.step.max_turn {
            events.push(EventKind::Kink);
        }
        if foot.pattern != next.pattern {
            events.push(EventKind::PatternChange { from: foot.pattern, to: next.pattern });
        }
        let residual = self.corrector.evaluate(self.system, &foot.z).unwrap_or(f64::INFINITY);
        let Foot { z, tangent, orientation, pattern, regularity, .. } = foot.clone();
        point(&Correction { z, tangent, orientation, residual, iterations: 0, pattern, regularity }, events)
    }

    /// Keeps the events of an accepted step and its end, or the point on the bound or at the start where the branch ends; and
    /// the length of the next step.
    fn accept(&mut self, taken: Taken, h: f64, next: f64) -> ControlFlow<StopReason, f64> {
        let Taken { end, crossing, last, changes, border, .. } = &taken;
        let changes = if last.is_none() { changes.clone() } else { None };
        let ahead = |c: &Correction| dot(&c.z, &self.foot.tangent) - dot(&self.foot.z, &self.foot.tangent);
        let length = last.as_ref().map_or(h, |(_, last)| ahead(last));
        let crossing = crossing.clone().filter(|(located, _)| located.s <= length);
        let way = crossing.as_ref().map(|(_, choice)| self.choose(choice));
        let end = last.as_ref().map_or(end, |(_, last)| last);
        match (crossing, way) {
            (Some((mut located, choice)), Some(way)) if way != Some(choice.own) => {
                let start = &choice.arms[way.unwrap_or(choice.own)];
                // What turns does so at the crossing, where the Jacobian has no tangent to offer.
                let turned = if way.is_some() { self.folds.update(&start.tangent) } else { Vec::new() };
                located.kinds.extend(turned.into_iter().map(|(_, kind)| kind));
                let (s, point) = (located.s, located.point.clone());
                self.keep_located(&point, &[], Some(located), None, s)?;
                self.note(&choice, way)?;
                return self.leave_for(start, distance(&start.z, &choice.z));
            }
            (Some((located, choice)), way) => {
                self.keep_events(end, Some(located), changes, length)?;
                self.note(&choice, way.flatten())?;
            }
            (None, _) => self.keep_events(end, None, changes, length)?,
        }
        self.go_to(end, Vec::new())?;
        self.foot.border.clone_from(border);
        last.as_ref().map_or(ControlFlow::Continue(next), |(stop, _)| ControlFlow::Break(stop.clone()))
    }

    fn keep_events(
        &mut self,
        end: &Correction,
        crossing: Option<Located>,
        changes: Option<Vec<Located>>,
        h: f64,
    ) -> ControlFlow<StopReason> {
        let turned = self.folds.update(&end.tangent);
        self.keep_located(end, &turned, crossing, changes, h)
    }

    fn keep_located(
        &mut self,
        end: &Correction,
        turned: &[(usize, EventKind)],
        crossing: Option<Located>,
        changes: Option<Vec<Located>>,
        h: f64,
    ) -> ControlFlow<StopReason> {
        if h <= 0.0 {
            return ControlFlow::Continue(());
        }
        let mut search = Search { system: self.system, corrector: &mut self.corrector, foot: &self.foot, end, h };
        let changes = changes.unwrap_or_else(|| search.pattern_changes());
        for located in search.all(turned, changes.into_iter().chain(crossing)) {
            self.keep(point(&located.point, located.kinds))?;
        }
        ControlFlow::Continue(())
    }

    /// Keeps a point from which the branch goes on.
    fn go_to(&mut self, c: &Correction, events: Vec<EventKind>) -> ControlFlow<StopReason> {
        let mut foot = Foot::from(c);
        let distance = distance(&foot.z, &self.foot.z);
        self.before = (distance > 0.0).then_some((self.foot.regularity, distance));
        let smooth = self.before.is_some() && foot.pattern == self.foot.pattern;
        foot.behind = smooth.then(|| Behind { z: self.foot.z.clone(), tangent: self.foot.tangent.clone() });
        self.foot = foot;
        let n = c.z.len() - 1;
        self.system.accepted(&c.z[..n], c.z[n]);
        self.keep(point(c, events))
    }

    fn keep(&mut self, mut point: BranchPoint) -> ControlFlow<StopReason> {
        let near = 2.0 * self.settings.step.min;
        let z = point.z();
        let recent = self.branch.points.iter().rev().take_while(|q| distance(&q.z(), &z) < 20.0 * near);
        let known: Vec<EventKind> =
            recent.filter(|q| distance(&q.z(), &z) < near).flat_map(|q| q.events.clone()).collect();
        let named = !point.events.is_empty();
        point.events.retain(|e| !known.contains(e));
        if named && point.events.is_empty() {
            return ControlFlow::Continue(());
        }
        let told = match self.shown.checked_sub(1) {
            Some(rest) => {
                self.shown = rest;
                ControlFlow::Continue(())
            }
            None => self.show(&point),
        };
        self.branch.points.push(point);
        self.go_on_if(told)
    }

    /// Unless the observer or the number of points says no.
    fn go_on_if(&self, told: ControlFlow<()>) -> ControlFlow<StopReason> {
        if told.is_break() {
            return ControlFlow::Break(StopReason::Stopped);
        }
        if self.branch.points.len() >= self.settings.max_points {
            return ControlFlow::Break(StopReason::MaxPoints);
        }
        ControlFlow::Continue(())
    }
}

/// Unit vector between two, at this share of the way.
fn between(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    let sum: Vec<f64> = from.iter().zip(to).map(|(a, b)| (1.0 - share) * a + share * b).collect();
    let length = dot(&sum, &sum).sqrt();
    sum.iter().map(|s| s / length).collect()
}

fn point(c: &Correction, events: Vec<EventKind>) -> BranchPoint {
    let n = c.z.len() - 1;
    BranchPoint {
        x: c.z[..n].to_vec(),
        p: c.z[n],
        tangent: c.tangent.clone(),
        residual: c.residual,
        iterations: c.iterations,
        pattern: c.pattern,
        events,
    }
}
