//! A run that was cut off and goes on from its log is the run that was never cut off.

use std::cell::Cell;
use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{
    Branch, BranchPoint, BranchTree, Continuation, Correction, EventKind, Linearization, ParametricSystem, RunLog,
    StepRecord, StopReason,
};

use crate::samples::{piecewise, smooth, window};

/// The steps of runs, in their order.
#[derive(Default, Clone)]
struct Log {
    runs: Vec<(Correction, Vec<StepRecord>)>,
    /// Number of the run in progress, from 1.
    run: usize,
    /// Steps that the run in progress has repeated.
    repeated: usize,
}

impl Log {
    /// As if the computation had been cut off behind so many steps.
    fn cut(&self, steps: usize) -> Self {
        let (mut runs, mut left) = (Vec::new(), steps);
        for (start, records) in &self.runs {
            let kept = records.len().min(left);
            left -= kept;
            if kept > 0 {
                runs.push((start.clone(), records[..kept].to_vec()));
            }
        }
        Self { runs, run: 0, repeated: 0 }
    }

    fn steps(&self) -> usize {
        self.runs.iter().map(|(_, records)| records.len()).sum()
    }
}

impl RunLog for Log {
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord> {
        self.run += 1;
        match self.runs.get(self.run - 1) {
            Some((known, records)) => {
                assert_eq!(known.z, start.z);
                records.clone()
            }
            None => {
                self.runs.push((start.clone(), Vec::new()));
                Vec::new()
            }
        }
    }

    fn computing(&mut self, repeated: usize) -> ControlFlow<()> {
        self.repeated = repeated;
        self.runs[self.run - 1].1.truncate(repeated);
        ControlFlow::Continue(())
    }

    fn record(&mut self, step: &StepRecord) -> ControlFlow<()> {
        let records = &mut self.runs[self.run - 1].1;
        // What was asked to end goes on now.
        records.pop_if(|last| last.stop.is_some());
        records.push(step.clone());
        ControlFlow::Continue(())
    }
}

/// Counts how often a system is evaluated.
struct Counted<'a, S>(S, &'a Cell<usize>);

impl<S: ParametricSystem> ParametricSystem for Counted<'_, S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        self.1.set(self.1.get() + 1);
        self.0.linearize(x, p, out)
    }

    fn pattern(&self) -> u64 {
        self.0.pattern()
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        self.0.accepted(x, p);
    }
}

/// Follows a curve with the log; `shown` sees the points and may stop it.
fn follow<S: ParametricSystem>(
    settings: &Continuation,
    mut system: S,
    from: &[f64],
    log: &mut Log,
    shown: impl FnMut(&BranchPoint) -> ControlFlow<()>,
) -> Branch {
    log.run = 0;
    let n = from.len() - 1;
    let direction: Vec<f64> = (0..=n).map(|j| f64::from(u8::from(j == n))).collect();
    settings.run_with_log(&mut system, &from[..n], from[n], &direction, log, shown).unwrap()
}

/// Cuts the run at every step and at every point, and compares.
fn check<S: ParametricSystem<Error = Infallible>>(settings: &Continuation, system: impl Fn() -> S, from: &[f64]) {
    let mut whole = Log::default();
    let go_on = |_: &BranchPoint| ControlFlow::Continue(());
    let expected = follow(settings, system(), from, &mut whole, go_on);
    for steps in 0..=whole.steps() {
        let mut log = whole.cut(steps);
        let (count, mut seen) = (Cell::new(0), Vec::new());
        let found = follow(settings, Counted(system(), &count), from, &mut log, |point| {
            seen.push(point.clone());
            ControlFlow::Continue(())
        });
        assert_eq!(found, expected, "cut behind step {steps}");
        assert_eq!(seen, expected.points, "each point is shown once");
        assert_eq!(log.runs, whole.runs);
        if steps == whole.steps() {
            // One for each point and each half-branch, to see that they solve the equations.
            let arms: usize = expected.crossings.iter().map(|crossing| crossing.arms.len()).sum();
            let (known, count) = (expected.points.len() + arms, count.get());
            assert!(count < known + 5, "{count} evaluations for a branch of {known} points that are known");
        }
    }
    for point in 1..=expected.points.len() {
        let (mut log, mut count) = (Log::default(), 0);
        let stopped = follow(settings, system(), from, &mut log, |_| {
            count += 1;
            if count == point { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(stopped.points, expected.points[..point]);
        let mut seen = Vec::new();
        let found = follow(settings, system(), from, &mut log, |point| {
            seen.push(point.clone());
            ControlFlow::Continue(())
        });
        assert_eq!((&found, &seen), (&expected, &expected.points), "stopped at point {point}");
        assert_eq!(log.runs, whole.runs);
    }
}

#[test]
fn a_closed_curve_goes_on_wherever_it_was_cut() {
    let circle = || smooth(|x, p| [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]);
    check(&Continuation::default(), circle, &[1.0, 0.0]);
}

#[test]
fn a_curve_through_a_crossing_goes_on_wherever_it_was_cut() {
    let pitchfork = || smooth(|x: f64, p: f64| [x * (p - x * x), p - 3.0 * x * x, x]);
    check(&window(1, -1.0, 0.9), pitchfork, &[0.0, -0.613]);
}

#[test]
fn a_curve_around_a_corner_goes_on_wherever_it_was_cut() {
    let slope = |p: f64| if p < 0.0 { 0.2 } else { -8.0 };
    let corner = || piecewise(move |x, p| [x - slope(p) * p, 1.0, -slope(p)], |_, p| u64::from(p >= 0.0));
    check(&window(1, -0.7, 0.6), corner, &[-0.14, -0.7]);
}

/// An oscillation in two harmonics, `x₀ cos + x₁ sin + x₂ cos 2 + x₃ sin 2`, whose phase is free: it does not move
/// along the turn of the last point. Something sets in at `p = 0.3`.
struct FreePhase {
    turn: [f64; 4],
    pattern: u64,
}

impl FreePhase {
    fn at(x: &[f64]) -> Self {
        Self { turn: [-x[1], x[0], -2.0 * x[3], 2.0 * x[2]], pattern: 0 }
    }
}

impl ParametricSystem for FreePhase {
    type Error = Infallible;

    fn dim(&self) -> usize {
        4
    }

    /// `|z| = h(p)` and `w = i k(p) z²` for `z = x₀ + i x₁`, `w = x₂ + i x₃`: the same for each phase.
    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let beyond = (p - 0.3).max(0.0);
        self.pattern = u64::from(p > 0.3);
        let k = 0.4 + 0.3 * p;
        out.residual[0] = x[0] * x[0] + x[1] * x[1] - 1.0 - 0.5 * p.sin() - 40.0 * beyond.powf(1.5);
        out.residual[1] = x[2] + 2.0 * k * x[0] * x[1];
        out.residual[2] = x[3] - k * (x[0] * x[0] - x[1] * x[1]);
        out.residual[3] = (0..4).map(|i| self.turn[i] * x[i]).sum();
        let rows = [
            [2.0 * x[0], 2.0 * x[1], 0.0, 0.0, -0.5 * p.cos() - 60.0 * beyond.sqrt()],
            [2.0 * k * x[1], 2.0 * k * x[0], 1.0, 0.0, 0.6 * x[0] * x[1]],
            [-2.0 * k * x[0], 2.0 * k * x[1], 0.0, 1.0, -0.3 * (x[0] * x[0] - x[1] * x[1])],
            [self.turn[0], self.turn[1], self.turn[2], self.turn[3], 0.0],
        ];
        for (i, j) in (0..4).flat_map(|i| (0..5).map(move |j| (i, j))) {
            out.jacobian[(i, j)] = rows[i][j];
        }
        Ok(())
    }

    fn pattern(&self) -> u64 {
        self.pattern
    }

    fn accepted(&mut self, x: &[f64], _: f64) {
        self.turn = Self::at(x).turn;
    }
}

#[test]
fn a_motion_whose_phase_is_held_at_the_last_point_goes_on_wherever_it_was_cut() {
    let size = (1.0 + 0.5 * (-0.4_f64).sin()).sqrt();
    let start = [size, 0.0, 0.0, 0.28 * size * size, -0.4];
    check(&window(4, -0.4, 0.9), || FreePhase::at(&start), &start);
}

#[test]
fn a_tree_goes_on_wherever_it_was_cut() {
    let circles = || {
        smooth(|x: f64, p: f64| {
            let (a, b) = (x * x + p * p - 1.0, (x - 1.0) * (x - 1.0) + p * p - 1.0);
            [a * b, 2.0 * x * b + 2.0 * (x - 1.0) * a, 2.0 * p * (a + b)]
        })
    };
    let follow = |log: &mut Log| -> BranchTree {
        log.run = 0;
        let go_on = |_: usize, _: &BranchPoint| ControlFlow::Continue(());
        Continuation::default().run_tree_with_log(&mut circles(), &[-1.0], 0.0, &[0.0, 1.0], 20, log, go_on).unwrap()
    };
    let mut whole = Log::default();
    let expected = follow(&mut whole);
    assert!(expected.branches.len() > 1);
    for steps in 0..=whole.steps() {
        let mut log = whole.cut(steps);
        assert_eq!(follow(&mut log), expected, "cut behind step {steps}");
        assert_eq!(log.runs, whole.runs);
    }
}

/// What makes a step that is read back none, and whether it applies to this one.
type Damage = (&'static str, fn(&mut StepRecord) -> bool);

fn damages() -> Vec<Damage> {
    fn point(step: &mut StepRecord, damage: impl Fn(&mut BranchPoint)) -> bool {
        step.points.last_mut().map(damage).is_some()
    }
    fn arm(step: &mut StepRecord, damage: impl Fn(&mut Correction)) -> bool {
        step.crossing.as_mut().and_then(|choice| choice.arms.last_mut()).map(damage).is_some()
    }
    vec![
        ("an unknown that is no number", |s| point(s, |q| q.x[0] = f64::NAN)),
        ("one unknown too many", |s| point(s, |q| q.x.push(0.0))),
        ("an infinite parameter", |s| point(s, |q| q.p = f64::INFINITY)),
        ("a tangent of another length", |s| point(s, |q| q.tangent[0] += 0.1)),
        ("a tangent without entries", |s| point(s, |q| q.tangent.clear())),
        ("a residual that is no number", |s| point(s, |q| q.residual = f64::NAN)),
        ("an unknown that there is not", |s| point(s, |q| q.events.push(EventKind::UnknownFold { index: 1 }))),
        ("a point beside the curve", |s| point(s, |q| q.x[0] += 0.1)),
        ("no orientation", |s| {
            s.orientation = f64::NAN;
            true
        }),
        ("no way on", |s| {
            s.next = 0.0;
            s.stop.is_none()
        }),
        ("a step back", |s| {
            s.next = -s.next;
            s.stop.is_none()
        }),
        ("no points", |s| {
            s.points.clear();
            s.stop.is_none()
        }),
        ("a negative blur", |s| {
            s.blur = -1e-9;
            true
        }),
        ("a sense that is no number", |s| s.senses.first_mut().map(|sense| *sense = f64::NAN).is_some()),
        ("the rounding of other equations", |s| {
            s.rounding.push(1e-15);
            true
        }),
        ("a regularity that is none", |s| s.before.as_mut().map(|before| before.0 = f64::NAN).is_some()),
        ("no distance", |s| s.before.as_mut().map(|before| before.1 = 0.0).is_some()),
        ("more evaluations than there can be", |s| {
            s.evaluations = usize::MAX;
            true
        }),
        ("more refused steps than there can be", |s| {
            s.refused_steps = usize::MAX;
            true
        }),
        ("a bound of no coordinate", |s| {
            s.stop = Some(StopReason::Bound { coordinate: 2, value: 0.0 });
            true
        }),
        ("a bound that is none", |s| {
            s.stop = Some(StopReason::Bound { coordinate: 1, value: f64::NAN });
            true
        }),
        ("an arm that there is not", |s| s.crossing.as_mut().map(|choice| choice.own = choice.arms.len()).is_some()),
        ("a crossing elsewhere", |s| s.crossing.as_mut().map(|choice| choice.z.push(0.0)).is_some()),
        ("no way back", |s| s.crossing.as_mut().map(|choice| choice.back.fill(0.0)).is_some()),
        ("an arm of another system", |s| arm(s, |arm| arm.z.push(0.0))),
        ("an arm without direction", |s| arm(s, |arm| arm.tangent.fill(0.0))),
        ("an arm without orientation", |s| arm(s, |arm| arm.orientation = f64::NAN)),
        ("an arm beside the curve", |s| arm(s, |arm| arm.z[0] += 0.1)),
    ]
}

/// A file may have been altered: the run repeats what precedes that, and takes the rest anew.
#[test]
fn from_a_step_on_that_cannot_be_one_a_run_is_computed_again() {
    let pitchfork = || smooth(|x: f64, p: f64| [x * (p - x * x), p - 3.0 * x * x, x]);
    let (settings, from) = (window(1, -0.3, 0.3), [0.0, -0.213]);
    let go_on = |_: &BranchPoint| ControlFlow::Continue(());
    let mut whole = Log::default();
    let expected = follow(&settings, pitchfork(), &from, &mut whole, go_on);
    assert!(!expected.crossings.is_empty());
    for (what, damage) in damages() {
        let mut applied = 0;
        for step in 0..whole.steps() {
            let mut log = whole.clone();
            if damage(&mut log.runs[0].1[step]) {
                applied += 1;
                let found = follow(&settings, pitchfork(), &from, &mut log, go_on);
                assert_eq!(log.repeated, step, "{what}");
                assert_eq!(found, expected, "{what} at step {step}");
                assert_eq!(log.runs, whole.runs, "{what} at step {step}");
            }
        }
        assert!(applied > 0, "{what}");
    }
}
