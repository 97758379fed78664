use std::ops::ControlFlow;

use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Bound, Branch, BranchPoint, Budget, Continuation, ParametricSystem, StopReason};
use nlmodes_hbm::{PeriodicMotion, PeriodicSystem, PhaseLag, Refined, ResponseRow, Source};
use nlmodes_modal::{BranchEnd, EndReason};
use num_complex::Complex64;

use crate::branches::event_of;
use crate::response::curve::{Solved, curve_end, energy_bound, frequency_bound, lost};
use crate::response::exact::exact_stability;
use crate::response::losses::{is_loss, name_lost_stability};
use crate::response::{ResponseCurve, ResponseError, ResponseModel, ResponsePoint, ResponseSettings, Stability};

/// A curve to follow: a system, where it starts, and what its points are called.
pub(crate) struct Curve<'a> {
    pub system: PeriodicSystem,
    pub x: Vec<f64>,
    pub p: f64,
    pub direction: Vec<f64>,
    pub bounds: Vec<Bound>,
    pub drive: Option<PhaseLag>,
    pub settings: &'a ResponseSettings,
    pub solver: &'a dyn LcpSolver,
    /// For the multipliers of its points.
    pub budget: Budget,
}

impl<'a> Curve<'a> {
    /// From the lower end of a range of the parameter upwards; its unknowns are still to be given.
    pub fn rising(
        system: PeriodicSystem,
        range: [f64; 2],
        model: &ResponseModel,
        settings: &'a ResponseSettings,
        solver: &'a dyn LcpSolver,
    ) -> Result<Self, ResponseError> {
        let mut direction = vec![0.0; system.dim() + 1];
        direction[system.dim()] = 1.0;
        let (drive, budget) = (model.drive(settings)?, settings.budget());
        let (x, bounds) = (Vec::new(), Vec::new());
        let mut curve = Self { system, x, p: range[0], direction, bounds, drive, settings, solver, budget };
        curve.within(range);
        Ok(curve)
    }

    /// Bounds of the parameter alone.
    pub fn within(&mut self, [min, max]: [f64; 2]) {
        self.bounds = vec![Bound { coordinate: self.parameter(), min, max }];
    }
}

impl Curve<'_> {
    pub fn run(&mut self) -> Result<Branch, ResponseError> {
        let watch = &self.settings.watch;
        self.run_watched(&mut |_| watch.lets_go_on())
    }

    /// As [`run`](Self::run), as long as `watch` lets it.
    pub fn run_watched(
        &mut self,
        watch: &mut dyn FnMut(&BranchPoint) -> ControlFlow<()>,
    ) -> Result<Branch, ResponseError> {
        let method = self.begin();
        let mut log = self.settings.log.clone();
        Ok(method.run_with_log(&mut self.system, &self.x, self.p, &self.direction, &mut log, watch)?)
    }

    /// Follows the curve and those that branch off, at most `most` in all; the first one is the curve itself.
    pub fn follow_all(&mut self, omega: (usize, f64), most: usize) -> Result<Vec<ResponseCurve>, ResponseError> {
        let method = self.begin();
        let watch = |_: usize, _: &BranchPoint| self.settings.watch.lets_go_on();
        let mut log = self.settings.log.clone();
        let (system, direction) = (&mut self.system, &self.direction);
        let tree = method.run_tree_with_log(system, &self.x, self.p, direction, most, &mut log, watch)?;
        tree.branches.iter().map(|found| self.curve(&found.branch, omega)).collect()
    }

    /// Follows the curve; `omega` is the coordinate of the frequency and its unit (of the load, rad/s).
    pub fn follow(&mut self, omega: (usize, f64)) -> Result<ResponseCurve, ResponseError> {
        let branch = self.run()?;
        self.curve(&branch, omega)
    }

    /// The motions of a branch.
    pub fn curve(&mut self, branch: &Branch, omega: (usize, f64)) -> Result<ResponseCurve, ResponseError> {
        let points = branch.points.iter().map(|point| self.point(point)).collect::<Result<Vec<_>, _>>()?;
        let points = self.locate_losses(branch, points)?;
        let mut points = self.locate_peaks(points)?;
        name_lost_stability(&mut points);
        self.decide(&mut points);
        let end = match unsolved(&points) {
            Some(why) => lost(why),
            None => self.end(&branch.stop, omega),
        };
        let end = end.without_stability(self.budget.left_out());
        let at_levels = self.at_levels(branch)?;
        let finer = match self.settings.finer {
            Some(settings) => self.finer(&points, &settings, self.budget.beside())?,
            None => Vec::new(),
        };
        Ok(ResponseCurve { points, end, at_levels, finer })
    }

    /// Stability by the exact motions next to the points in contact at which the estimate from the instants in
    /// harmonics is least certain. Where there is none, an estimate that hardly decides is left open.
    fn decide(&mut self, points: &mut [ResponsePoint]) {
        let (system, settings) = (&self.system, self.settings);
        let mut budget = settings.budget();
        let touches = |point: &ResponsePoint| point.motion.contacts.iter().any(|contact| contact.closed_share > 0.0);
        let doubt = |point: &ResponsePoint| point.stability.map_or(0.0, |estimate| estimate.doubt());
        let mut open: Vec<&mut ResponsePoint> = points
            .iter_mut()
            // A loss of stability is where the estimate passes the unit circle.
            .filter(|point| touches(point) && doubt(point) > settings.multiplier_margin)
            .filter(|point| !point.events.iter().any(is_loss))
            .collect();
        open.sort_by(|a, b| doubt(b).total_cmp(&doubt(a)));
        for (k, point) in open.into_iter().enumerate() {
            let found = (k < settings.exact_motions).then(|| {
                budget.spend(&settings.watch, |_| {
                    exact_stability(system.structure(), system.load(), &point.motion, settings.same_motion)
                })
            });
            if let Some(found) = found.flatten() {
                point.stability = Some(found);
            } else if doubt(point) > settings.verdict_margin {
                point.stability = point.stability.map(|estimate| Stability { stable: None, ..estimate });
            }
        }
    }

    /// Why there are no further points; `omega` as in [`follow`](Self::follow).
    pub fn end(&self, stop: &StopReason, omega: (usize, f64)) -> BranchEnd {
        let is_free = self.system.load().terms().is_empty();
        // Beside laws of force a mode begins before any stop is touched.
        let structure = self.system.structure();
        let start = match structure.laws().is_empty() {
            false => "the start",
            true if structure.is_pressed() => "lift-off",
            true if structure.gaps().contains(&0.0) => "the start",
            true => "grazing",
        };
        let is_upper = |coordinate: usize, value: f64| {
            self.bounds.iter().any(|bound| bound.coordinate == coordinate && value > 0.5 * (bound.min + bound.max))
        };
        curve_end(stop, self.settings.max_points, |coordinate, value| match coordinate {
            own if own == omega.0 => frequency_bound(value * omega.1),
            _ if is_free => energy_bound(value, start),
            own if is_upper(own, value) => (EndReason::Limit, "the largest level was reached".to_owned()),
            _ => (EndReason::Limit, "the smallest level was reached".to_owned()),
        })
    }

    /// The points of a curve over `ln(level)` at the levels that were asked for.
    fn at_levels(&mut self, branch: &Branch) -> Result<Vec<ResponsePoint>, ResponseError> {
        let Source::LogParameter { reference } = self.system.closing().level else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for (i, pair) in branch.points.windows(2).enumerate() {
            let [a, b] = pair else { continue };
            let wanted = self.settings.levels.iter().map(|level| ((level / reference).ln(), *level));
            // The end of a step belongs to it, its beginning to the step before.
            let within = |p: &f64| (a.p - p) * (b.p - p) < 0.0 || b.p == *p || (i == 0 && a.p == *p);
            let mut between: Vec<(f64, f64)> = wanted.filter(|(p, _)| within(p)).collect();
            between.sort_by(|p, q| (p.0 - a.p).abs().total_cmp(&(q.0 - a.p).abs()));
            for (p, level) in between {
                let share = if a.p == b.p { 0.0 } else { (p - a.p) / (b.p - a.p) };
                let x = a.x.iter().zip(&b.x).map(|(a, b)| a + share * (b - a)).collect();
                let held = (0..=a.x.len()).map(|j| f64::from(u8::from(j == a.x.len()))).collect();
                let guess = BranchPoint::guess(x, p, held);
                // The level as it was asked for, without the rounding of its logarithm.
                let point = ResponsePoint { level, ..self.point(&guess)? };
                // Where the step between is too long for Newton's method, the nearer end is used instead, with its own
                // level.
                let nearer = if share < 0.5 { a } else { b };
                found.push(if point.residual < CONVERGED { point } else { self.point(nearer)? });
            }
        }
        Ok(found)
    }

    /// The solution next to a point, to rounding.
    fn solved(&mut self, at: &BranchPoint) -> Refined {
        // A free phase is held at that of the point itself, not at that of the last one that was found.
        self.system.hold_phase(&at.x);
        refined(&mut self.system, at)
    }

    pub fn point(&mut self, at: &BranchPoint) -> Result<ResponsePoint, ResponseError> {
        let found = self.solved(at);
        self.point_of(at, found)
    }

    /// The same of the solution across the tangent of a guess, wherever its parameter goes: next to a fold there may be
    /// none at that of the guess.
    pub fn point_across(&mut self, at: &BranchPoint) -> Result<ResponsePoint, ResponseError> {
        let found = self.across(at);
        self.point_of(at, found)
    }

    /// The motion across the tangent of a guess, without stability, events and gradients.
    pub fn near_across(&mut self, at: &BranchPoint) -> Result<ResponsePoint, ResponseError> {
        let found = self.across(at);
        self.motion(None, found)
    }

    fn across(&mut self, at: &BranchPoint) -> Refined {
        self.system.hold_phase(&at.x);
        self.system.refine(&at.x, at.p, &at.tangent)
    }

    fn point_of(&mut self, at: &BranchPoint, found: Refined) -> Result<ResponsePoint, ResponseError> {
        let gradients = match &self.settings.gradients {
            gradients if gradients.changes.is_empty() || self.settings.watch.asks_to_end() => Vec::new(),
            gradients => self.system.sensitivities(&found, gradients.watched.as_ref(), &gradients.changes)?,
        };
        // Of a long curve the multipliers take longer than who asks for an end waits.
        let stability = match self.settings.stability && !self.settings.watch.asks_to_end() {
            true => self.stability(&found.x, found.p)?,
            false => None,
        };
        let events = at.events.iter().map(|event| event_of(*event)).collect();
        Ok(ResponsePoint { stability, events, gradients, ..self.motion(None, found)? })
    }

    /// The point of a solution, of this problem or of `another` with more harmonics; without stability, events and
    /// gradients.
    pub fn motion(
        &mut self,
        another: Option<&mut PeriodicSystem>,
        found: Refined,
    ) -> Result<ResponsePoint, ResponseError> {
        let system = another.unwrap_or(&mut self.system);
        let motion = system.motion(&found.x, found.p)?;
        let Refined { x, p, residual, .. } = found;
        let of = |row: &ResponseRow, harmonic: usize| amplitude(system, &motion, row, harmonic);
        let drive = self.drive.as_ref().map_or(Complex64::default(), |drive| of(&drive.row, drive.harmonic));
        let watched = self.settings.gradients.watched.as_ref();
        let watched = watched.map_or(0.0, |watched| of(&watched.row, watched.harmonic).norm());
        Ok(ResponsePoint {
            omega: motion.at.omega * self.settings.subharmonic as f64,
            level: motion.at.level,
            drive,
            watched,
            stability: None,
            residual,
            events: Vec::new(),
            gradients: Vec::new(),
            solved: Solved { x, p, coefficients: (system.n_coefficients(), system.unit()) },
            motion,
        })
    }

    /// Stability of the point with the unknowns `x`; none where the budget is used up.
    fn stability(&mut self, x: &[f64], p: f64) -> Result<Option<Stability>, ResponseError> {
        let (system, solver) = (&mut self.system, self.solver);
        let found = self.budget.spend(&self.settings.watch, |_| Some(system.floquet(x, p, solver)));
        Ok(found.transpose()?.map(|floquet| floquet.stability()))
    }

    /// The unknowns where the parameter arrives at a bound, otherwise where the curve ends, and why.
    pub fn arrive(&mut self, at: f64) -> Result<Result<Vec<f64>, (f64, String)>, ResponseError> {
        let branch = self.run()?;
        let (p, x) = branch.points.into_iter().next_back().map_or((0.0, Vec::new()), |last| (last.p, last.x));
        match &branch.stop {
            StopReason::Bound { coordinate, value } if *coordinate == self.parameter() && *value == at => Ok(Ok(x)),
            StopReason::Stopped => Err(ResponseError::Stopped),
            stop => Ok(Err((p, self.end(stop, (usize::MAX, 1.0)).message))),
        }
    }

    /// Tells the equations of the start, and how they are to be followed.
    fn begin(&mut self) -> Continuation {
        self.system.hold_phase(&self.x);
        let (bounds, max_points) = (self.bounds.clone(), self.settings.max_points);
        Continuation { bounds, max_points, ..Continuation::default() }
    }

    /// Number of unknowns, which is the coordinate of the parameter.
    pub fn parameter(&self) -> usize {
        self.system.dim()
    }
}

/// Complex amplitude of a displacement of a motion in one harmonic, with what the load moves statically.
pub(crate) fn amplitude(
    system: &PeriodicSystem,
    motion: &PeriodicMotion,
    row: &ResponseRow,
    harmonic: usize,
) -> Complex64 {
    let own = system.load().terms().iter().zip(&row.loads).filter(|(term, _)| term.harmonic == harmonic);
    let moved = own.map(|(term, a)| a * motion.at.level * motion.at.omega.powi(term.omega_power));
    motion.displacement(row)[harmonic] + moved.sum::<Complex64>()
}

/// Share of the parameter in the tangent above which it is held while a point is refined.
pub(crate) const HELD: f64 = 0.05;

/// Residual of a point that was found at a level.
pub(crate) const CONVERGED: f64 = 1e-8;

/// A point taken from the tolerance of the continuation to rounding, at the same parameter or, next to a fold, across
/// the tangent. Where powers nearly cancel, that tolerance would be seen in their balance.
fn refined(system: &mut PeriodicSystem, point: &BranchPoint) -> Refined {
    let n = system.dim();
    if point.tangent[n].abs() <= HELD {
        return system.refine(&point.x, point.p, &point.tangent);
    }
    let held: Vec<f64> = (0..=n).map(|j| f64::from(u8::from(j == n))).collect();
    system.refine(&point.x, point.p, &held)
}

/// What is to be reported where a curve has no points: it is not complete then, wherever it ended.
fn unsolved(points: &[ResponsePoint]) -> Option<String> {
    let off = points.iter().map(|point| point.residual).filter(|residual| residual.is_nan() || *residual > CONVERGED);
    let (count, most) = off.fold((0_usize, 0.0_f64), |(n, most), residual| (n + 1, most.max(residual)));
    (count > 0).then(|| format!("{count} of its points were not solved, with residuals up to {most:.0e}"))
}

/// Unknowns near `x` that solve the system at the parameter `p`; `None` where Newton's method does not get there.
pub(crate) fn newton(system: &mut PeriodicSystem, x: &[f64], p: f64) -> Option<Vec<f64>> {
    let mut across = vec![0.0; x.len() + 1];
    across[x.len()] = 1.0;
    let found = Continuation::default().first_point(system, &[x, &[p]].concat(), &across, &mut ());
    found.ok()?.map(|point| point.x)
}
